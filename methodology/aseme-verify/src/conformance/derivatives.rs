//! The language of liveness formulas: which activities may return next, by partial derivatives.
//!
//! A trace is the order in which activities return. The residual of a formula after a return is its
//! derivative by that activity (Antimirov's partial derivatives: several, if there are several
//! continuations). `x || y` is the shuffle of both, `x~` never ends, and `|x~|n` is a shuffle of n
//! copies.

use std::collections::{BTreeMap, BTreeSet};

use aseme::liveness::{Liveness, Term, TermId};

/// A residual, as an index into a [`Language`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Residual(u32);

/// An activity, by its index in [`Language::letters`].
pub(crate) type Symbol = u32;

/// An `x~`, by its index in [`Language::endless`].
pub(crate) type LoopId = u32;

/// A residual after the return of an activity, and the loops that the return belongs to.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct DerivativeStep {
    /// The residual.
    pub(crate) rest: Residual,
    /// Whether the activity was inside an `x~`, as opposed to a part that occurs once.
    pub(crate) recurs: bool,
    /// Each `x~` of which it started an iteration.
    pub(crate) begun: BTreeSet<LoopId>,
}

#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum LanguageTerm {
    /// The empty trace.
    Done,
    Name(Symbol),
    Sequence(Residual, Residual),
    Either(Residual, Residual),
    Shuffle(Residual, Residual),
    /// Zero or more repetitions.
    Star(Residual),
    /// Endless repetition. Each `x~` of the formulas has its own number.
    Forever(Residual, LoopId),
    /// The residual of one iteration of an `x~`, followed by that `x~`.
    Turn(Residual, Residual),
    /// Any prefix of it.
    Cut(Residual),
}

/// Limit of distinct residuals.
const MAX_RESIDUALS: usize = 50_000;

/// The residuals of the formulas of a role.
pub(crate) struct Language {
    expressions: Vec<LanguageTerm>,
    residuals: BTreeMap<LanguageTerm, Residual>,
    nullable: Vec<bool>,
    /// Whether each residual has no end.
    unending: Vec<bool>,
    letters: Vec<String>,
    numbers: BTreeMap<String, Symbol>,
    /// The texts of the `x~`.
    endless: Vec<String>,
    steps: BTreeMap<(Residual, Symbol), BTreeSet<DerivativeStep>>,
    derivatives: BTreeMap<(Residual, Symbol), BTreeSet<Residual>>,
    /// The terms that may be left before they are done, by the names of their states.
    cut: BTreeSet<String>,
}

impl Language {
    /// The language of formulas and the residual of the first one. `None` if formulas refine each
    /// other in a cycle or are too large.
    pub(crate) fn new(liveness: &Liveness) -> Option<(Language, Residual)> {
        Language::with_cut(liveness, BTreeSet::new())
    }

    /// The language of formulas in which some terms may be left before they are done.
    pub(crate) fn with_cut(liveness: &Liveness, cut: BTreeSet<String>) -> Option<(Language, Residual)> {
        let mut language = Language {
            expressions: Vec::new(),
            residuals: BTreeMap::new(),
            nullable: Vec::new(),
            unending: Vec::new(),
            letters: Vec::new(),
            numbers: BTreeMap::new(),
            endless: Vec::new(),
            steps: BTreeMap::new(),
            derivatives: BTreeMap::new(),
            cut,
        };
        let first = liveness.formulas().first()?.expression?;
        let all = language.term(liveness, first, &mut vec![0])?;
        Some((language, all))
    }

    fn term(&mut self, liveness: &Liveness, id: TermId, open: &mut Vec<usize>) -> Option<Residual> {
        let rest = self.build_untruncated(liveness, id, open)?;
        let is_cut = !self.cut.is_empty() && self.cut.contains(&liveness.compact(id));
        Some(if is_cut { self.cut(rest) } else { rest })
    }

    fn build_untruncated(
        &mut self,
        liveness: &Liveness,
        id: TermId,
        open: &mut Vec<usize>,
    ) -> Option<Residual> {
        if open.len() > aseme::liveness::MAX_LEVELS || self.expressions.len() > MAX_RESIDUALS {
            return None;
        }
        match liveness.term(id) {
            Term::Name(name) => match liveness.by_name().get(name.as_str()) {
                Some(formula) if open.contains(formula) => None,
                Some(&formula) => {
                    open.push(formula);
                    let rest = self.term(liveness, liveness.formulas()[formula].expression?, open);
                    open.pop();
                    rest
                }
                None => {
                    let letter = self.letter(name);
                    Some(self.intern(LanguageTerm::Name(letter)))
                }
            },
            Term::Group(inner) => self.nested(liveness, *inner, open),
            Term::Sequence(items) => self.several(liveness, items, open, Language::sequence),
            Term::Choice(items) => self
                .several(liveness, items, open, |it, one, other| it.intern(LanguageTerm::Either(one, other))),
            Term::Parallel(items) => self.parallel(liveness, items, open),
            Term::Copies { term, count } => {
                let copies = vec![*term; (*count).min(64) as usize];
                self.parallel(liveness, &copies, open)
            }
            Term::Optional(inner) => {
                let (inner, done) = (self.nested(liveness, *inner, open)?, self.empty_residual());
                Some(self.intern(LanguageTerm::Either(inner, done)))
            }
            Term::ZeroOrMore(inner) => {
                let inner = self.nested(liveness, *inner, open)?;
                Some(self.intern(LanguageTerm::Star(inner)))
            }
            Term::OneOrMore(inner) => {
                let inner = self.nested(liveness, *inner, open)?;
                let star = self.intern(LanguageTerm::Star(inner));
                Some(self.sequence(inner, star))
            }
            Term::Forever(inner) => {
                let inner = self.nested(liveness, *inner, open)?;
                self.endless.push(liveness.compact(id));
                Some(self.intern(LanguageTerm::Forever(inner, self.endless.len() as LoopId - 1)))
            }
        }
    }

    /// A nested term. Terms that nest deeper than any chart are rejected.
    fn nested(&mut self, liveness: &Liveness, id: TermId, open: &mut Vec<usize>) -> Option<Residual> {
        // the formula that is refined takes one level more
        open.push(usize::MAX);
        let rest = self.term(liveness, id, open);
        open.pop();
        rest
    }

    fn several(
        &mut self,
        liveness: &Liveness,
        items: &[TermId],
        open: &mut Vec<usize>,
        join: impl Fn(&mut Language, Residual, Residual) -> Residual,
    ) -> Option<Residual> {
        let rests: Vec<Residual> =
            items.iter().map(|&item| self.nested(liveness, item, open)).collect::<Option<_>>()?;
        let (&last, before) = rests.split_last()?;
        Some(before.iter().rev().fold(last, |rest, &item| join(self, item, rest)))
    }

    /// A balanced tree of shuffles: a step changes as many residuals as the tree is deep.
    fn parallel(&mut self, liveness: &Liveness, items: &[TermId], open: &mut Vec<usize>) -> Option<Residual> {
        let mut rests: Vec<Residual> =
            items.iter().map(|&item| self.nested(liveness, item, open)).collect::<Option<_>>()?;
        while rests.len() > 1 {
            rests = rests
                .chunks(2)
                .map(|pair| match *pair {
                    [one, other] => self.shuffle(one, other),
                    _ => pair[0],
                })
                .collect();
        }
        rests.first().copied()
    }

    fn letter(&mut self, name: &str) -> Symbol {
        if let Some(&letter) = self.numbers.get(name) {
            return letter;
        }
        self.letters.push(name.to_owned());
        let letter = self.letters.len() as Symbol - 1;
        self.numbers.insert(name.to_owned(), letter);
        letter
    }

    /// The symbol of an activity that a formula names.
    pub(crate) fn find(&self, name: &str) -> Option<Symbol> {
        self.numbers.get(name).copied()
    }

    /// The activities that formulas name.
    pub(crate) fn letters(&self) -> &[String] {
        &self.letters
    }

    /// Whether the limit of residuals is reached.
    pub(crate) fn is_too_large(&self) -> bool {
        self.expressions.len() > MAX_RESIDUALS
    }

    fn empty_residual(&mut self) -> Residual {
        self.intern(LanguageTerm::Done)
    }

    fn cut(&mut self, rest: Residual) -> Residual {
        match self.expressions[rest.0 as usize] {
            LanguageTerm::Done | LanguageTerm::Cut(_) => rest,
            _ => self.intern(LanguageTerm::Cut(rest)),
        }
    }

    fn sequence(&mut self, first: Residual, then: Residual) -> Residual {
        match self.expressions[first.0 as usize] {
            LanguageTerm::Done => then,
            _ => self.intern(LanguageTerm::Sequence(first, then)),
        }
    }

    /// The residual of an iteration, followed by the next one.
    fn turn(&mut self, left: Residual, forever: Residual) -> Residual {
        match self.expressions[left.0 as usize] {
            LanguageTerm::Done => forever,
            _ => self.intern(LanguageTerm::Turn(left, forever)),
        }
    }

    fn shuffle(&mut self, one: Residual, other: Residual) -> Residual {
        let is_done = |it: &Language, rest: Residual| it.expressions[rest.0 as usize] == LanguageTerm::Done;
        match (is_done(self, one), is_done(self, other)) {
            (true, _) => other,
            (_, true) => one,
            _ => self.intern(LanguageTerm::Shuffle(one, other)),
        }
    }

    fn intern(&mut self, expression: LanguageTerm) -> Residual {
        if let Some(&rest) = self.residuals.get(&expression) {
            return rest;
        }
        let null = |rest: Residual| self.nullable[rest.0 as usize];
        let nullable = match expression {
            LanguageTerm::Done | LanguageTerm::Star(_) | LanguageTerm::Cut(_) => true,
            LanguageTerm::Name(_) | LanguageTerm::Forever(..) | LanguageTerm::Turn(..) => false,
            LanguageTerm::Sequence(one, other) | LanguageTerm::Shuffle(one, other) => {
                null(one) && null(other)
            }
            LanguageTerm::Either(one, other) => null(one) || null(other),
        };
        let endless = |rest: Residual| self.unending[rest.0 as usize];
        let unending = match expression {
            LanguageTerm::Forever(..) | LanguageTerm::Turn(..) => true,
            LanguageTerm::Sequence(one, other) | LanguageTerm::Shuffle(one, other) => {
                endless(one) || endless(other)
            }
            LanguageTerm::Either(one, other) => endless(one) && endless(other),
            LanguageTerm::Done | LanguageTerm::Name(_) | LanguageTerm::Star(_) | LanguageTerm::Cut(_) => {
                false
            }
        };
        let rest = Residual(self.expressions.len() as u32);
        self.expressions.push(expression.clone());
        self.nullable.push(nullable);
        self.unending.push(unending);
        self.residuals.insert(expression, rest);
        rest
    }

    /// Whether the trace may end here.
    pub(crate) fn may_end(&self, rest: Residual) -> bool {
        self.nullable.get(rest.0 as usize).copied().unwrap_or(false)
    }

    /// The activities that may return next, in the order of the letters.
    pub(crate) fn first_letters(&self, rests: &BTreeSet<Residual>) -> BTreeSet<Symbol> {
        let (mut letters, mut seen) = (BTreeSet::new(), BTreeSet::new());
        let mut open: Vec<Residual> = rests.iter().copied().collect();
        while let Some(rest) = open.pop() {
            if !seen.insert(rest) {
                continue;
            }
            match self.expressions[rest.0 as usize] {
                LanguageTerm::Done => {}
                LanguageTerm::Name(letter) => {
                    letters.insert(letter);
                }
                LanguageTerm::Sequence(first, then) | LanguageTerm::Turn(first, then) => {
                    open.push(first);
                    open.extend(self.may_end(first).then_some(then));
                }
                LanguageTerm::Either(one, other) | LanguageTerm::Shuffle(one, other) => {
                    open.extend([one, other]);
                }
                LanguageTerm::Star(inner) | LanguageTerm::Forever(inner, _) | LanguageTerm::Cut(inner) => {
                    open.push(inner)
                }
            }
        }
        letters
    }

    /// The residuals after an activity has returned; empty if it may not return.
    pub(crate) fn derivative(&mut self, rest: Residual, letter: Symbol) -> BTreeSet<Residual> {
        if let Some(known) = self.derivatives.get(&(rest, letter)) {
            return known.clone();
        }
        let derivatives: BTreeSet<Residual> =
            self.steps(rest, letter).into_iter().map(|step| step.rest).collect();
        self.derivatives.insert((rest, letter), derivatives.clone());
        derivatives
    }

    /// The derivative with the loops that the activity belongs to.
    pub(crate) fn steps(&mut self, rest: Residual, letter: Symbol) -> BTreeSet<DerivativeStep> {
        if let Some(known) = self.steps.get(&(rest, letter)) {
            return known.clone();
        }
        let steps = self.derive(rest, letter);
        self.steps.insert((rest, letter), steps.clone());
        steps
    }

    fn derive(&mut self, rest: Residual, letter: Symbol) -> BTreeSet<DerivativeStep> {
        match self.expressions[rest.0 as usize] {
            LanguageTerm::Done => BTreeSet::new(),
            LanguageTerm::Name(name) if name == letter => BTreeSet::from([DerivativeStep {
                rest: self.empty_residual(),
                recurs: false,
                begun: BTreeSet::new(),
            }]),
            LanguageTerm::Name(_) => BTreeSet::new(),
            LanguageTerm::Either(one, other) => &self.steps(one, letter) | &self.steps(other, letter),
            LanguageTerm::Sequence(first, then) => {
                let mut all = self.each(first, letter, |it, rest| it.sequence(rest, then));
                if self.may_end(first) {
                    all.extend(self.steps(then, letter));
                }
                all
            }
            LanguageTerm::Turn(left, forever) => {
                // a part without an end prevents the next iteration from starting
                let recurs = !self.unending[left.0 as usize];
                let steps = self.each(left, letter, |it, rest| it.turn(rest, forever));
                let mut all: BTreeSet<DerivativeStep> = steps
                    .into_iter()
                    .map(|step| DerivativeStep { recurs: recurs || step.recurs, ..step })
                    .collect();
                if self.may_end(left) {
                    all.extend(self.steps(forever, letter));
                }
                all
            }
            LanguageTerm::Shuffle(one, other) => {
                let mut all = self.each(one, letter, |it, rest| it.shuffle(rest, other));
                all.extend(self.each(other, letter, |it, rest| it.shuffle(one, rest)));
                all
            }
            LanguageTerm::Star(inner) => self.each(inner, letter, |it, after| it.sequence(after, rest)),
            LanguageTerm::Forever(inner, number) => {
                let steps = self.each(inner, letter, |it, after| it.turn(after, rest));
                let begun = |mut step: DerivativeStep| {
                    step.begun.insert(number);
                    DerivativeStep { recurs: true, ..step }
                };
                steps.into_iter().map(begun).collect()
            }
            LanguageTerm::Cut(inner) => self.each(inner, letter, |it, after| it.cut(after)),
        }
    }

    fn each(
        &mut self,
        rest: Residual,
        letter: Symbol,
        make: impl Fn(&mut Language, Residual) -> Residual,
    ) -> BTreeSet<DerivativeStep> {
        let steps = self.steps(rest, letter);
        steps.into_iter().map(|step| DerivativeStep { rest: make(self, step.rest), ..step }).collect()
    }

    /// Whether a residual has no end.
    fn is_unending(&self, rest: Residual) -> bool {
        self.unending.get(rest.0 as usize).copied().unwrap_or(false)
    }

    /// The `x~` that must be repeated forever from here on; `None` if a part that occurs once must
    /// come first. An `x~` whose iterations may be empty requires nothing.
    pub(crate) fn owed_loops(&self, rest: Residual) -> Option<BTreeSet<LoopId>> {
        match self.expressions[rest.0 as usize] {
            LanguageTerm::Done | LanguageTerm::Star(_) | LanguageTerm::Cut(_) => Some(BTreeSet::new()),
            LanguageTerm::Name(_) => None,
            LanguageTerm::Either(..) => self.may_end(rest).then(BTreeSet::new),
            LanguageTerm::Forever(inner, _) if self.may_end(inner) => Some(BTreeSet::new()),
            LanguageTerm::Forever(_, number) => Some(BTreeSet::from([number])),
            LanguageTerm::Sequence(first, _) | LanguageTerm::Turn(first, _) if self.is_unending(first) => {
                self.owed_loops(first)
            }
            LanguageTerm::Turn(_, forever) => self.owed_loops(forever),
            LanguageTerm::Sequence(first, then) if self.may_end(first) => self.owed_loops(then),
            LanguageTerm::Sequence(..) => None,
            LanguageTerm::Shuffle(one, other) => Some(&self.owed_loops(one)? | &self.owed_loops(other)?),
        }
    }

    /// An `x~` as written in the formula.
    pub(crate) fn endless(&self, number: LoopId) -> &str {
        self.endless.get(number as usize).map_or("", String::as_str)
    }

    /// The residuals of a set of residuals after the return of an activity.
    pub(crate) fn derivative_of_any(
        &mut self,
        rests: &BTreeSet<Residual>,
        letter: Symbol,
    ) -> BTreeSet<Residual> {
        rests.iter().flat_map(|&rest| self.derivative(rest, letter)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a formula allows a trace as a prefix, and as a complete trace.
    fn allows(formulas: &str, trace: &str) -> (bool, bool) {
        let (mut language, all) = Language::new(&aseme::liveness::parse(formulas).0).unwrap();
        let mut rests = BTreeSet::from([all]);
        for name in trace.split_whitespace() {
            let letter = language.find(name).unwrap();
            rests = language.derivative_of_any(&rests, letter);
        }
        (!rests.is_empty(), rests.iter().any(|&rest| language.may_end(rest)))
    }

    #[test]
    fn operators_allow_what_they_mean() {
        assert_eq!(allows("r = a . b", "a"), (true, false));
        assert_eq!(allows("r = a . b", "a b"), (true, true));
        assert_eq!(allows("r = a . b", "b"), (false, false));
        assert_eq!(allows("r = a | b", "b"), (true, true));
        assert_eq!(allows("r = [a] . b", "b"), (true, true));
        assert_eq!(allows("r = a*", ""), (true, true));
        assert_eq!(allows("r = a+", ""), (true, false));
        assert_eq!(allows("r = a+ . b", "a a a b"), (true, true));
        assert_eq!(allows("r = a~", "a a a"), (true, false));
        assert_eq!(allows("r = (a . b) || c", "a c b"), (true, true));
        assert_eq!(allows("r = (a . b) || c", "b"), (false, false));
        assert_eq!(allows("r = |(a.b)~|2", "a a b"), (true, false));
        assert_eq!(allows("r = |(a.b)~|2", "a a a"), (false, false));
        assert_eq!(allows("r = x . b\nx = a | c", "c b"), (true, true));
    }

    #[test]
    fn a_cut_term_may_end_at_any_time_and_its_successor_start() {
        let (liveness, _) = aseme::liveness::parse("r = (a . b~) . c");
        let allows = |cut: &[&str], trace: &str| {
            let cut = cut.iter().map(|&name| name.to_owned()).collect();
            let (mut language, all) = Language::with_cut(&liveness, cut).unwrap();
            trace.split_whitespace().fold(BTreeSet::from([all]), |rests, name| {
                let letter = language.find(name).unwrap();
                language.derivative_of_any(&rests, letter)
            })
        };
        for trace in ["c", "a c", "a b b c"] {
            assert!(allows(&[], trace).is_empty() && !allows(&["(a.b~)"], trace).is_empty(), "{trace}");
        }
        assert!(allows(&["(a.b~)"], "b").is_empty() && allows(&["b~"], "c").is_empty());
    }

    #[test]
    fn an_endless_term_is_required_until_an_iteration_starts() {
        let owed = |formulas: &str, trace: &str| {
            let (mut language, all) = Language::new(&aseme::liveness::parse(formulas).0).unwrap();
            let rests = trace.split_whitespace().fold(BTreeSet::from([all]), |rests, name| {
                let letter = language.find(name).unwrap();
                language.derivative_of_any(&rests, letter)
            });
            let names =
                |rest| Some(language.owed_loops(rest)?.into_iter().map(|it| language.endless(it)).collect());
            let owed: Vec<Option<Vec<&str>>> = rests.into_iter().map(names).collect();
            format!("{owed:?}")
        };
        assert_eq!(owed("r = a~ || (b.c)~", "b"), "[Some([\"a~\", \"(b.c)~\"])]");
        assert_eq!(owed("r = a~ || b", ""), "[None]", "`b` is to come first");
        assert_eq!(owed("r = a~ || b", "b"), "[Some([\"a~\"])]");
        assert_eq!(owed("r = a* . b~", "a"), "[Some([\"b~\"])]");
        assert_eq!(owed("r = (a . b~)~", "a b"), "[Some([\"b~\"])]", "nothing comes after it");
        assert_eq!(owed("r = ([a])~", ""), "[Some([])]");
        assert_eq!(owed("r = |a~|2", "a"), "[Some([\"a~\", \"a~\"])]", "each of the two");
        assert_eq!(owed("r = a~ | b", ""), "[None]", "neither has begun");
    }

    #[test]
    fn steps_say_what_they_are_for() {
        let (mut language, all) = Language::new(&aseme::liveness::parse("r = a || (b.a)~").0).unwrap();
        let (a, b) = (language.find("a").unwrap(), language.find("b").unwrap());
        let said = |steps: &BTreeSet<DerivativeStep>| -> Vec<(bool, usize)> {
            steps.iter().map(|step| (step.recurs, step.begun.len())).collect()
        };
        assert_eq!(said(&language.steps(all, a)), [(false, 0)]);
        let turn = language.steps(all, b);
        assert_eq!(said(&turn), [(true, 1)]);
        let mut both = said(&language.steps(turn.first().unwrap().rest, a));
        both.sort_unstable();
        assert_eq!(both, [(false, 0), (true, 0)], "the one that comes once, or the end of the turn");
    }

    #[test]
    fn formulas_in_a_circle_have_no_language() {
        assert!(Language::new(&aseme::liveness::parse("r = a . x\nx = b . x").0).is_none());
    }
}
