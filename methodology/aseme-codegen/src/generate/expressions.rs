//! Guards and assigned values as functions.

use std::collections::{BTreeMap, BTreeSet};

use yase::expression::{
    Additive, BooleanTerm, Comparison, Effect, Expression, ExpressionKind, Literal, MessageSource,
    Multiplicative, Origin, ValueTerm,
};
use yase::statechart::ConstantValue;
use yase::vocabulary::ValueType;
use yase::{ActionLocation, CompiledChart, Diagnostic, FieldId, ScopeId, TransitionId};

use super::body::{AssignmentBody, GeneratedFunctions};
use super::code::{RustCode, literal, quoted};
use super::name_table::NameTable;
use super::names::field;
use super::refusal;
use super::states::GeneratedStates;

/// Writes the functions of a chart.
///
/// # Errors
/// Expressions that cannot be represented in Rust.
pub(crate) fn functions(
    chart: &CompiledChart,
    states: &GeneratedStates,
    glossary: &mut NameTable<'_>,
) -> Result<GeneratedFunctions, Vec<Diagnostic>> {
    let mut functions = GeneratedFunctions::default();
    let mut found = Vec::new();
    let mut guards: BTreeMap<TransitionId, RustCode> = BTreeMap::new();
    for (id, region, guard) in chart.guards().filter(|(_, _, guard)| !guard.is_literally_false()) {
        let expression = chart.statechart().transition(id).expression.guard.as_ref();
        let mut writer = ExpressionWriter { chart, states, glossary, region, named: named(expression) };
        match writer.test(guard.test()) {
            Ok(code) if guards.get(&id).is_some_and(|other| *other != code) => found.push(differs(chart, id)),
            Ok(code) => drop(guards.insert(id, code)),
            Err(diagnostic) => found.push(diagnostic),
        }
    }
    guards.into_iter().for_each(|(id, code)| functions.guard(chart, id, code));
    for (location, region, effects) in chart.effects() {
        for (index, effect) in effects.iter().enumerate() {
            let Effect::Assign { topic, field, value } = effect else { continue };
            let target = MessageSource { topic: *topic, origin: Origin::Own };
            let mut writer = ExpressionWriter {
                chart,
                states,
                glossary,
                region,
                named: named(assigned(chart, location, index)),
            };
            match writer.assignment(&target, field, value.term()) {
                Ok(body) => functions.value(chart, (location, index), body),
                Err(diagnostic) => found.push(diagnostic),
            }
        }
    }
    if found.is_empty() { Ok(functions) } else { Err(found) }
}

fn differs(chart: &CompiledChart, id: TransitionId) -> Diagnostic {
    let transition = chart.statechart().transition(id);
    let message = format!(
        "a name in the guard from `{}` to `{}` has different meanings in the scopes of its source",
        chart.short_path(transition.source),
        chart.short_path(transition.target)
    );
    refusal("E0920", message, "rename the timer or the constant")
}

/// The expression that an action assigns.
fn assigned(chart: &CompiledChart, location: ActionLocation, index: usize) -> Option<&Expression> {
    let statechart = chart.statechart();
    let actions = match location {
        ActionLocation::Transition(id) => &statechart.transition(id).expression.actions,
        ActionLocation::Entry(id) => &statechart.node(id).entry,
        ActionLocation::Exit(id) => &statechart.node(id).exit,
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

/// Writes the code of one expression in one scope.
struct ExpressionWriter<'a, 'g, 'w> {
    chart: &'a CompiledChart,
    states: &'a GeneratedStates,
    glossary: &'g mut NameTable<'w>,
    region: ScopeId,
    /// The bare names of its text, to recognise constants of the model.
    named: BTreeSet<String>,
}

type CodeResult = Result<RustCode, Diagnostic>;

impl ExpressionWriter<'_, '_, '_> {
    /// A boolean; `?` returns early where it is unknown.
    fn test(&mut self, test: &BooleanTerm) -> CodeResult {
        Ok(match test {
            BooleanTerm::Literal(value) => RustCode::plain(value.to_string()),
            BooleanTerm::All(parts) => RustCode::tried("all!", self.tests(parts)?),
            BooleanTerm::Any(parts) => RustCode::tried("any!", self.tests(parts)?),
            BooleanTerm::Not(part) => not(self.test(part)?),
            BooleanTerm::Compare(left, comparison, right) => {
                let left = self.left(left, may_fail(right))?;
                RustCode::tried(word(*comparison), vec![left, self.term(right, None)?])
            }
            BooleanTerm::FieldIs { source, path, comparison, literal } => {
                let kind = self.glossary.fields(source, path).map(|(_, kind)| kind);
                let literal = self.literal(literal, kind);
                RustCode::tried(word(*comparison), vec![self.field(source, path)?, literal])
            }
            BooleanTerm::Absent(source) => {
                let (source, _) = self.glossary.source(source)?;
                RustCode::call("input.is_absent", vec![RustCode::Plain(source)])
            }
            BooleanTerm::Over { timer, when_unset } => {
                let timer = self.glossary.timer(self.chart.timer_name(self.region, *timer));
                let method = if *when_unset { "input.is_over" } else { "input.has_expired" };
                RustCode::call(method, vec![RustCode::Plain(timer)])
            }
            BooleanTerm::NeverStarted(timer) => {
                RustCode::call("input.has_expired", vec![RustCode::Plain(self.glossary.timer(timer))])
            }
            BooleanTerm::Active(state) => {
                let state = format!("State::{}", self.states.variant(*state));
                RustCode::call("input.is_in", vec![RustCode::Plain(state)])
            }
            BooleanTerm::Holds(term) => RustCode::tried("holds", vec![self.term(term, None)?]),
            _ => return Err(self.not_expressible()),
        })
    }

    fn not_expressible(&self) -> Diagnostic {
        let message = format!("an expression of the chart `{}` is a script", self.chart.statechart().name);
        refusal("E0920", message, "write it as a condition or an action, or as a registered function")
    }

    fn tests(&mut self, tests: &[BooleanTerm]) -> Result<Vec<RustCode>, Diagnostic> {
        tests.iter().map(|test| self.test(test)).collect()
    }

    /// An operand.
    fn term(&mut self, term: &ValueTerm, kind: Option<&ValueType>) -> CodeResult {
        Ok(match term {
            ValueTerm::Literal(literal) => self.literal(literal, kind),
            ValueTerm::Field(source, path) => self.field(source, path)?,
            ValueTerm::Message(source) => {
                let (source, _) = self.glossary.source(source)?;
                RustCode::tried("input.message", vec![RustCode::Plain(source)])
            }
            ValueTerm::Call(function, arguments) => {
                let function = self.glossary.function(*function).ok_or_else(|| self.not_expressible())?;
                let arguments = arguments.iter().map(|argument| self.argument(argument));
                let arguments = RustCode::List(arguments.collect::<Result<_, _>>()?);
                RustCode::tried("input.call", vec![RustCode::Plain(function), arguments])
            }
            ValueTerm::Negative(term) => RustCode::tried("negative", vec![self.term(term, None)?]),
            ValueTerm::Sum(first, rest) => {
                let sign = |sign| if sign == Additive::Plus { "plus" } else { "minus" };
                self.chain(first, rest.iter().map(|(additive, term)| (sign(*additive), term)))?
            }
            ValueTerm::Product(first, rest) => {
                let sign = |sign| if sign == Multiplicative::Times { "times" } else { "over" };
                self.chain(first, rest.iter().map(|(multiplicative, term)| (sign(*multiplicative), term)))?
            }
            ValueTerm::Truth(test) => self.test(test)?,
            _ => return Err(self.not_expressible()),
        })
    }

    /// Evaluates from left to right; a missing message on the left does not hide an error on the
    /// right.
    fn chain<'t>(
        &mut self,
        first: &ValueTerm,
        rest: impl Iterator<Item = (&'static str, &'t ValueTerm)>,
    ) -> CodeResult {
        let mut result = self.term(first, None)?;
        let mut misses = may_be_missing(first);
        for (operator, term) in rest {
            if misses && may_fail(term) {
                result = attempted(result);
            }
            misses |= may_be_missing(term);
            result = RustCode::tried(operator, vec![result, self.term(term, None)?]);
        }
        Ok(result)
    }

    /// The left side of a comparison.
    fn left(&mut self, term: &ValueTerm, right_fails: bool) -> CodeResult {
        let code = self.term(term, None)?;
        Ok(if right_fails && may_be_missing(term) { attempted(code) } else { code })
    }

    fn argument(&mut self, term: &ValueTerm) -> CodeResult {
        let code = self.term(term, None)?;
        let is_value = matches!(
            term,
            ValueTerm::Message(_)
                | ValueTerm::Call(..)
                | ValueTerm::Negative(_)
                | ValueTerm::Sum(..)
                | ValueTerm::Product(..)
        ) || self.is_whole(term);
        Ok(if is_value { code } else { RustCode::tried("given", vec![code]) })
    }

    /// Whether a term is a message nested in a message.
    fn is_whole(&self, term: &ValueTerm) -> bool {
        let ValueTerm::Field(source, path) = term else { return false };
        matches!(self.glossary.fields(source, path), Some((_, ValueType::Message(_))))
    }

    fn field(&mut self, source: &MessageSource, path: &[FieldId]) -> CodeResult {
        let (names, kind) = self.glossary.fields(source, path).ok_or_else(|| self.not_expressible())?;
        let (constant, _) = self.glossary.source(source)?;
        let Some((last, outer)) = names.split_last() else { return Err(self.not_expressible()) };
        let mut code = format!("input.latest({constant})?");
        for name in outer {
            code = format!("inside(&{code}.{})?", field(name));
        }
        let code = format!("{code}.{}", field(last));
        Ok(match kind {
            ValueType::Text => RustCode::Plain(format!("&{code}")),
            ValueType::Message(_) => RustCode::tried("whole", vec![RustCode::Plain(format!("&{code}"))]),
            _ => RustCode::Plain(code),
        })
    }

    fn literal(&mut self, value: &Literal, kind: Option<&ValueType>) -> RustCode {
        let mut constant = |value: ConstantValue| self.glossary.constant(&self.named, &value);
        RustCode::Plain(match value {
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

    /// `message.field = value`: the code of the value and the function that sets it.
    fn assignment(
        &mut self,
        target: &MessageSource,
        path: &[FieldId],
        value: &ValueTerm,
    ) -> Result<AssignmentBody, Diagnostic> {
        let (names, kind) = self.glossary.fields(target, path).ok_or_else(|| self.not_expressible())?;
        let (constant, rust) = self.glossary.source(target)?;
        let code = self.term(value, Some(kind))?;
        let value = match self.argument_like(value) {
            true => code.untried(),
            false => RustCode::call("given", vec![code]),
        };
        let Some((last, outer)) = names.split_last() else { return Err(self.not_expressible()) };
        let target = outer
            .iter()
            .fold("message".to_owned(), |target, name| format!("inside_mut(&mut {target}.{})", field(name)));
        let arguments = vec![
            RustCode::Plain(format!("&mut {target}.{}", field(last))),
            RustCode::plain("value"),
            RustCode::Plain(literal(last)),
        ];
        Ok(AssignmentBody {
            value,
            put: RustCode::call("set", arguments),
            target: constant,
            rust,
            field: names.join("_"),
        })
    }

    /// Whether a term is written as an expression of type [`Value`](yase::Value).
    fn argument_like(&self, term: &ValueTerm) -> bool {
        matches!(
            term,
            ValueTerm::Call(..) | ValueTerm::Negative(_) | ValueTerm::Sum(..) | ValueTerm::Product(..)
        )
    }
}

/// The negation.
fn not(code: RustCode) -> RustCode {
    match code {
        RustCode::Before("!", code) => *code,
        RustCode::Plain(text) if text == "true" => RustCode::plain("false"),
        RustCode::Plain(text) if text == "false" => RustCode::plain("true"),
        code => RustCode::Before("!", Box::new(code)),
    }
}

fn attempted(code: RustCode) -> RustCode {
    RustCode::tried("attempt", vec![RustCode::Plain(format!("|| {}", code.untried().flat()))])
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

/// Whether a term may have no value because a message is missing.
fn may_be_missing(term: &ValueTerm) -> bool {
    !matches!(term, ValueTerm::Literal(_))
}

/// Whether the evaluation of a term may fail.
fn may_fail(term: &ValueTerm) -> bool {
    match term {
        ValueTerm::Literal(_) | ValueTerm::Field(..) | ValueTerm::Message(_) => false,
        ValueTerm::Truth(test) => test_fails(test),
        _ => true,
    }
}

fn test_fails(test: &BooleanTerm) -> bool {
    match test {
        BooleanTerm::All(tests) | BooleanTerm::Any(tests) => tests.iter().any(test_fails),
        BooleanTerm::Not(test) => test_fails(test),
        BooleanTerm::Literal(_)
        | BooleanTerm::Absent(_)
        | BooleanTerm::Over { .. }
        | BooleanTerm::NeverStarted(_)
        | BooleanTerm::Active(_) => false,
        BooleanTerm::Holds(term) => may_fail(term),
        _ => true,
    }
}
