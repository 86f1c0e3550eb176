//! Guards and assigned values as functions.

use std::collections::{BTreeMap, BTreeSet};

use yase::expression::{
    Additive, Comparison, Effect, Expression, ExpressionKind, Literal, MessageSource, Multiplicative, Origin,
    Term, Test,
};
use yase::statechart::ConstantValue;
use yase::vocabulary::ValueType;
use yase::{ActionPlace, Chart, Diagnostic, FieldId, RegionId, TransitionId};

use super::body::{Body, Functions};
use super::code::{Code, literal, quoted};
use super::glossary::Glossary;
use super::names::field;
use super::refusal;
use super::states::States;

/// Writes the functions of a chart.
///
/// # Errors
/// What cannot be said in Rust.
pub(super) fn functions(
    chart: &Chart,
    states: &States,
    glossary: &mut Glossary<'_>,
) -> Result<Functions, Vec<Diagnostic>> {
    let mut functions = Functions::default();
    let mut found = Vec::new();
    let mut guards: BTreeMap<TransitionId, Code> = BTreeMap::new();
    for (id, region, guard) in chart.guards().filter(|(_, _, guard)| !guard.is_literally_false()) {
        let expression = chart.statechart().transition(id).expression.guard.as_ref();
        let mut writer = Writer { chart, states, glossary, region, named: named(expression) };
        match writer.test(guard.test()) {
            Ok(code) if guards.get(&id).is_some_and(|other| *other != code) => found.push(differs(chart, id)),
            Ok(code) => drop(guards.insert(id, code)),
            Err(diagnostic) => found.push(diagnostic),
        }
    }
    guards.into_iter().for_each(|(id, code)| functions.guard(chart, id, code));
    for (place, region, effects) in chart.effects() {
        for (index, effect) in effects.iter().enumerate() {
            let Effect::Assign { topic, field, value } = effect else { continue };
            let target = MessageSource { topic: *topic, origin: Origin::Own };
            let mut writer =
                Writer { chart, states, glossary, region, named: named(assigned(chart, place, index)) };
            match writer.assignment(&target, field, value.term()) {
                Ok(body) => functions.value(chart, (place, index), body),
                Err(diagnostic) => found.push(diagnostic),
            }
        }
    }
    if found.is_empty() { Ok(functions) } else { Err(found) }
}

fn differs(chart: &Chart, id: TransitionId) -> Diagnostic {
    let transition = chart.statechart().transition(id);
    let message = format!(
        "a name in the guard from `{}` to `{}` means one thing on one blackboard and another on the next",
        chart.short_path(transition.source),
        chart.short_path(transition.target)
    );
    refusal("E0920", message, "rename the timer or the constant")
}

/// The expression that an action assigns.
fn assigned(chart: &Chart, place: ActionPlace, index: usize) -> Option<&Expression> {
    let statechart = chart.statechart();
    let actions = match place {
        ActionPlace::Transition(id) => &statechart.transition(id).expression.actions,
        ActionPlace::Entry(id) => &statechart.node(id).entry,
        ActionPlace::Exit(id) => &statechart.node(id).exit,
    };
    match &actions.get(index)?.kind {
        yase::expression::ActionKind::Assign { value, .. } => Some(value),
        _ => None,
    }
}

/// The bare names in an expression.
fn named(expression: Option<&Expression>) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    if let Some(expression) = expression {
        collect(expression, &mut names);
    }
    names
}

fn collect(expression: &Expression, names: &mut BTreeSet<String>) {
    match &expression.kind {
        ExpressionKind::Variable(path) => names.extend(path.bare().map(str::to_owned)),
        ExpressionKind::Or(parts) | ExpressionKind::And(parts) | ExpressionKind::Call(_, parts) => {
            parts.iter().for_each(|part| collect(part, names));
        }
        ExpressionKind::Not(part) | ExpressionKind::Negative(part) => collect(part, names),
        ExpressionKind::Compare(left, _, right) => {
            collect(left, names);
            collect(right, names);
        }
        ExpressionKind::Sum(first, rest) => {
            collect(first, names);
            rest.iter().for_each(|(_, part)| collect(part, names));
        }
        ExpressionKind::Product(first, rest) => {
            collect(first, names);
            rest.iter().for_each(|(_, part)| collect(part, names));
        }
        _ => {}
    }
}

/// Writes one expression, on one blackboard.
struct Writer<'a, 'g, 'w> {
    chart: &'a Chart,
    states: &'a States,
    glossary: &'g mut Glossary<'w>,
    region: RegionId,
    /// The names it was written with: which numbers are constants of the model.
    named: BTreeSet<String>,
}

type Written = Result<Code, Diagnostic>;

impl Writer<'_, '_, '_> {
    /// A truth value; `?` gives up where it cannot be told.
    fn test(&mut self, test: &Test) -> Written {
        Ok(match test {
            Test::Literal(value) => Code::plain(value.to_string()),
            Test::All(parts) => Code::tried("all!", self.tests(parts)?),
            Test::Any(parts) => Code::tried("any!", self.tests(parts)?),
            Test::Not(part) => not(self.test(part)?),
            Test::Compare(left, comparison, right) => {
                let left = self.left(left, fails(right))?;
                Code::tried(word(*comparison), vec![left, self.term(right, None)?])
            }
            Test::FieldIs { source, path, comparison, literal } => {
                let kind = self.glossary.fields(source, path).map(|(_, kind)| kind);
                let literal = self.literal(literal, kind);
                Code::tried(word(*comparison), vec![self.field(source, path)?, literal])
            }
            Test::Absent(source) => {
                let (source, _) = self.glossary.source(source)?;
                Code::call("world.is_absent", vec![Code::Plain(source)])
            }
            Test::Over { timer, when_unset } => {
                let timer = self.glossary.timer(self.chart.timer_name(self.region, *timer));
                let method = if *when_unset { "world.is_over" } else { "world.has_expired" };
                Code::call(method, vec![Code::Plain(timer)])
            }
            Test::NeverStarted(timer) => {
                Code::call("world.has_expired", vec![Code::Plain(self.glossary.timer(timer))])
            }
            Test::Active(state) => {
                let state = format!("State::{}", self.states.variant(*state));
                Code::call("world.is_in", vec![Code::Plain(state)])
            }
            Test::Holds(term) => Code::tried("holds", vec![self.term(term, None)?]),
            _ => return Err(self.unspeakable()),
        })
    }

    fn unspeakable(&self) -> Diagnostic {
        let message = format!("an expression of the chart `{}` is a script", self.chart.statechart().name);
        refusal("E0920", message, "write it as a condition or an action, or as a registered function")
    }

    fn tests(&mut self, tests: &[Test]) -> Result<Vec<Code>, Diagnostic> {
        tests.iter().map(|test| self.test(test)).collect()
    }

    /// An operand.
    fn term(&mut self, term: &Term, kind: Option<&ValueType>) -> Written {
        Ok(match term {
            Term::Literal(literal) => self.literal(literal, kind),
            Term::Field(source, path) => self.field(source, path)?,
            Term::Message(source) => {
                let (source, _) = self.glossary.source(source)?;
                Code::tried("world.message", vec![Code::Plain(source)])
            }
            Term::Call(function, arguments) => {
                let function = self.glossary.function(*function).ok_or_else(|| self.unspeakable())?;
                let arguments = arguments.iter().map(|argument| self.argument(argument));
                let arguments = Code::List(arguments.collect::<Result<_, _>>()?);
                Code::tried("world.call", vec![Code::Plain(function), arguments])
            }
            Term::Negative(term) => Code::tried("negative", vec![self.term(term, None)?]),
            Term::Sum(first, rest) => {
                let sign = |sign| if sign == Additive::Plus { "plus" } else { "minus" };
                self.chain(first, rest.iter().map(|(additive, term)| (sign(*additive), term)))?
            }
            Term::Product(first, rest) => {
                let sign = |sign| if sign == Multiplicative::Times { "times" } else { "over" };
                self.chain(first, rest.iter().map(|(multiplicative, term)| (sign(*multiplicative), term)))?
            }
            Term::Truth(test) => self.test(test)?,
            _ => return Err(self.unspeakable()),
        })
    }

    /// From left to right; what is missing on the left does not keep what fails on the right from failing.
    fn chain<'t>(&mut self, first: &Term, rest: impl Iterator<Item = (&'static str, &'t Term)>) -> Written {
        let mut result = self.term(first, None)?;
        let mut misses = misses(first);
        for (operator, term) in rest {
            if misses && fails(term) {
                result = attempted(result);
            }
            misses |= self::misses(term);
            result = Code::tried(operator, vec![result, self.term(term, None)?]);
        }
        Ok(result)
    }

    /// The left side of a comparison.
    fn left(&mut self, term: &Term, right_fails: bool) -> Written {
        let code = self.term(term, None)?;
        Ok(if right_fails && misses(term) { attempted(code) } else { code })
    }

    fn argument(&mut self, term: &Term) -> Written {
        let code = self.term(term, None)?;
        let is_value = matches!(
            term,
            Term::Message(_) | Term::Call(..) | Term::Negative(_) | Term::Sum(..) | Term::Product(..)
        ) || self.is_whole(term);
        Ok(if is_value { code } else { Code::tried("given", vec![code]) })
    }

    /// Whether it is a message inside a message.
    fn is_whole(&self, term: &Term) -> bool {
        let Term::Field(source, path) = term else { return false };
        matches!(self.glossary.fields(source, path), Some((_, ValueType::Message(_))))
    }

    fn field(&mut self, source: &MessageSource, path: &[FieldId]) -> Written {
        let (names, kind) = self.glossary.fields(source, path).ok_or_else(|| self.unspeakable())?;
        let (constant, _) = self.glossary.source(source)?;
        let Some((last, outer)) = names.split_last() else { return Err(self.unspeakable()) };
        let mut code = format!("world.latest({constant})?");
        for name in outer {
            code = format!("inside(&{code}.{})?", field(name));
        }
        let code = format!("{code}.{}", field(last));
        Ok(match kind {
            ValueType::Text => Code::Plain(format!("&{code}")),
            ValueType::Message(_) => Code::tried("whole", vec![Code::Plain(format!("&{code}"))]),
            _ => Code::Plain(code),
        })
    }

    fn literal(&mut self, value: &Literal, kind: Option<&ValueType>) -> Code {
        let mut constant = |value: ConstantValue| self.glossary.constant(&self.named, &value);
        Code::Plain(match value {
            Literal::Bool(truth) => constant((*truth).into()).unwrap_or_else(|| truth.to_string()),
            Literal::Float(number) => constant((*number).into())
                .or_else(|| constant((-number).into()).map(|name| format!("-{name}")))
                .unwrap_or_else(|| format!("{number:?}")),
            Literal::Text(text) => constant((&**text).into()).unwrap_or_else(|| literal(text)),
            Literal::Int(number) if i32::try_from(*number).is_ok() => number.to_string(),
            Literal::Uint(number) if i32::try_from(*number).is_ok() => number.to_string(),
            Literal::Int(number) => format!("{number}_i64"),
            Literal::Uint(number) => format!("{number}_u64"),
            Literal::Enum(number) => match kind {
                Some(ValueType::Enumeration(name)) => self.glossary.value(name, *number),
                _ => None,
            }
            .unwrap_or_else(|| number.to_string()),
            other => quoted(&format!("{other:?}")),
        })
    }

    /// `message.field = value`: the value, and what puts it into its message.
    fn assignment(
        &mut self,
        target: &MessageSource,
        path: &[FieldId],
        value: &Term,
    ) -> Result<Body, Diagnostic> {
        let (names, kind) = self.glossary.fields(target, path).ok_or_else(|| self.unspeakable())?;
        let (constant, rust) = self.glossary.source(target)?;
        let code = self.term(value, Some(kind))?;
        let value = match self.argument_like(value) {
            true => code.untried(),
            false => Code::call("given", vec![code]),
        };
        let Some((last, outer)) = names.split_last() else { return Err(self.unspeakable()) };
        let place = outer
            .iter()
            .fold("message".to_owned(), |place, name| format!("inside_mut(&mut {place}.{})", field(name)));
        let arguments = vec![
            Code::Plain(format!("&mut {place}.{}", field(last))),
            Code::plain("value"),
            Code::Plain(literal(last)),
        ];
        Ok(Body { value, put: Code::call("set", arguments), target: constant, rust, field: names.join("_") })
    }

    /// Whether a term is written as what gives a [`Value`](yase::Value).
    fn argument_like(&self, term: &Term) -> bool {
        matches!(term, Term::Call(..) | Term::Negative(_) | Term::Sum(..) | Term::Product(..))
    }
}

/// The contrary.
fn not(code: Code) -> Code {
    match code {
        Code::Before("!", code) => *code,
        Code::Plain(text) if text == "true" => Code::plain("false"),
        Code::Plain(text) if text == "false" => Code::plain("true"),
        code => Code::Before("!", Box::new(code)),
    }
}

fn attempted(code: Code) -> Code {
    Code::tried("attempt", vec![Code::Plain(format!("|| {}", code.untried().flat()))])
}

fn word(comparison: Comparison) -> &'static str {
    match comparison {
        Comparison::Equal => "equal",
        Comparison::NotEqual => "differ",
        Comparison::Less => "less",
        Comparison::LessOrEqual => "at_most",
        Comparison::Greater => "more",
        Comparison::GreaterOrEqual => "at_least",
    }
}

/// Whether it may have no value because a message is missing.
fn misses(term: &Term) -> bool {
    !matches!(term, Term::Literal(_))
}

/// Whether it may fail.
fn fails(term: &Term) -> bool {
    match term {
        Term::Literal(_) | Term::Field(..) | Term::Message(_) => false,
        Term::Truth(test) => test_fails(test),
        _ => true,
    }
}

fn test_fails(test: &Test) -> bool {
    match test {
        Test::All(tests) | Test::Any(tests) => tests.iter().any(test_fails),
        Test::Not(test) => test_fails(test),
        Test::Literal(_) | Test::Absent(_) | Test::Over { .. } | Test::NeverStarted(_) | Test::Active(_) => {
            false
        }
        Test::Holds(term) => fails(term),
        _ => true,
    }
}
