//! The language of liveness formulas: which activities may return next, by partial derivatives.
//!
//! A trace is the order in which activities return. What is left of a formula after one has returned is its derivative by that activity (Antimirov's: several, if
//! there is more than one way to go on). `x || y` is the shuffle of both, `x~` never ends, and `|x~|n` is a shuffle of n.

use std::collections::{BTreeMap, BTreeSet};

use crate::liveness::{Liveness, Term, TermId};

/// What is left of a formula, by its place in a [`Language`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Rest(u32);

/// An activity, by its place in [`Language::letters`].
pub(super) type Letter = u32;

/// An `x~`, by its place in [`Language::endless`].
pub(super) type Endless = u32;

/// What may be left when an activity has returned, and what that was for.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Step {
    /// What is left.
    pub(super) rest: Rest,
    /// Whether it was part of what goes on forever, and not of what comes once.
    pub(super) recurs: bool,
    /// Each `x~` of which it began a turn.
    pub(super) begun: BTreeSet<Endless>,
}

#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Expression {
    /// Nothing is left.
    Done,
    Name(Letter),
    Sequence(Rest, Rest),
    Either(Rest, Rest),
    Shuffle(Rest, Rest),
    /// Any number of times.
    Star(Rest),
    /// Again and again; each `x~` of the formulas has a number of its own.
    Forever(Rest, Endless),
    /// What is left of one turn of what goes on forever, and that.
    Turn(Rest, Rest),
    /// No more of it than anyone likes.
    Cut(Rest),
}

/// So many different rests are told apart.
const MOST: usize = 50_000;

/// The rests of the formulas of a role.
pub(super) struct Language {
    expressions: Vec<Expression>,
    places: BTreeMap<Expression, Rest>,
    nullable: Vec<bool>,
    /// Whether it has no end.
    unending: Vec<bool>,
    letters: Vec<String>,
    numbers: BTreeMap<String, Letter>,
    /// The terms that go on forever, as they are written.
    endless: Vec<String>,
    steps: BTreeMap<(Rest, Letter), BTreeSet<Step>>,
    derivatives: BTreeMap<(Rest, Letter), BTreeSet<Rest>>,
    /// The terms that may be left before they are done, by what states are called that stand for them.
    cut: BTreeSet<String>,
}

impl Language {
    /// The language of formulas and all of the first one; none if they refine each other in a circle or are too large.
    pub(super) fn new(liveness: &Liveness) -> Option<(Language, Rest)> {
        Language::with_cut(liveness, BTreeSet::new())
    }

    /// The same, of formulas some terms of which may be left before they are done.
    pub(super) fn with_cut(liveness: &Liveness, cut: BTreeSet<String>) -> Option<(Language, Rest)> {
        let mut language = Language {
            expressions: Vec::new(),
            places: BTreeMap::new(),
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

    fn term(&mut self, liveness: &Liveness, id: TermId, open: &mut Vec<usize>) -> Option<Rest> {
        let rest = self.uncut(liveness, id, open)?;
        let is_cut = !self.cut.is_empty() && self.cut.contains(&liveness.compact(id));
        Some(if is_cut { self.cut(rest) } else { rest })
    }

    fn uncut(&mut self, liveness: &Liveness, id: TermId, open: &mut Vec<usize>) -> Option<Rest> {
        if open.len() > crate::transform::MAX_LEVELS || self.expressions.len() > MOST {
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
                    Some(self.place(Expression::Name(letter)))
                }
            },
            Term::Group(inner) => self.nested(liveness, *inner, open),
            Term::Sequence(items) => self.several(liveness, items, open, Language::sequence),
            Term::Choice(items) => {
                self.several(liveness, items, open, |it, one, other| it.place(Expression::Either(one, other)))
            }
            Term::Parallel(items) => self.several(liveness, items, open, Language::shuffle),
            Term::Copies { term, count } => {
                let copies = vec![*term; (*count).min(64) as usize];
                self.several(liveness, &copies, open, Language::shuffle)
            }
            Term::Optional(inner) => {
                let (inner, done) = (self.nested(liveness, *inner, open)?, self.done());
                Some(self.place(Expression::Either(inner, done)))
            }
            Term::ZeroOrMore(inner) => {
                let inner = self.nested(liveness, *inner, open)?;
                Some(self.place(Expression::Star(inner)))
            }
            Term::OneOrMore(inner) => {
                let inner = self.nested(liveness, *inner, open)?;
                let star = self.place(Expression::Star(inner));
                Some(self.sequence(inner, star))
            }
            Term::Forever(inner) => {
                let inner = self.nested(liveness, *inner, open)?;
                self.endless.push(liveness.compact(id));
                Some(self.place(Expression::Forever(inner, self.endless.len() as Endless - 1)))
            }
        }
    }

    /// A term within a term: what nests deeper than any chart is not judged.
    fn nested(&mut self, liveness: &Liveness, id: TermId, open: &mut Vec<usize>) -> Option<Rest> {
        // the formula that is refined stands for one level more
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
        join: impl Fn(&mut Language, Rest, Rest) -> Rest,
    ) -> Option<Rest> {
        let rests: Vec<Rest> =
            items.iter().map(|&item| self.nested(liveness, item, open)).collect::<Option<_>>()?;
        let (&last, before) = rests.split_last()?;
        Some(before.iter().rev().fold(last, |rest, &item| join(self, item, rest)))
    }

    fn letter(&mut self, name: &str) -> Letter {
        if let Some(&letter) = self.numbers.get(name) {
            return letter;
        }
        self.letters.push(name.to_owned());
        let letter = self.letters.len() as Letter - 1;
        self.numbers.insert(name.to_owned(), letter);
        letter
    }

    /// The letter of an activity, if a formula names it.
    pub(super) fn find(&self, name: &str) -> Option<Letter> {
        self.numbers.get(name).copied()
    }

    /// The activities that formulas name.
    pub(super) fn letters(&self) -> &[String] {
        &self.letters
    }

    /// Whether too many rests are told apart to go on.
    pub(super) fn is_too_large(&self) -> bool {
        self.expressions.len() > MOST
    }

    fn done(&mut self) -> Rest {
        self.place(Expression::Done)
    }

    fn cut(&mut self, rest: Rest) -> Rest {
        match self.expressions[rest.0 as usize] {
            Expression::Done | Expression::Cut(_) => rest,
            _ => self.place(Expression::Cut(rest)),
        }
    }

    fn sequence(&mut self, first: Rest, then: Rest) -> Rest {
        match self.expressions[first.0 as usize] {
            Expression::Done => then,
            _ => self.place(Expression::Sequence(first, then)),
        }
    }

    /// What is left of a turn, and then the next.
    fn turn(&mut self, left: Rest, forever: Rest) -> Rest {
        match self.expressions[left.0 as usize] {
            Expression::Done => forever,
            _ => self.place(Expression::Turn(left, forever)),
        }
    }

    fn shuffle(&mut self, one: Rest, other: Rest) -> Rest {
        let is_done = |it: &Language, rest: Rest| it.expressions[rest.0 as usize] == Expression::Done;
        match (is_done(self, one), is_done(self, other)) {
            (true, _) => other,
            (_, true) => one,
            _ => self.place(Expression::Shuffle(one, other)),
        }
    }

    fn place(&mut self, expression: Expression) -> Rest {
        if let Some(&rest) = self.places.get(&expression) {
            return rest;
        }
        let null = |rest: Rest| self.nullable[rest.0 as usize];
        let nullable = match expression {
            Expression::Done | Expression::Star(_) | Expression::Cut(_) => true,
            Expression::Name(_) | Expression::Forever(..) | Expression::Turn(..) => false,
            Expression::Sequence(one, other) | Expression::Shuffle(one, other) => null(one) && null(other),
            Expression::Either(one, other) => null(one) || null(other),
        };
        let endless = |rest: Rest| self.unending[rest.0 as usize];
        let unending = match expression {
            Expression::Forever(..) | Expression::Turn(..) => true,
            Expression::Sequence(one, other) | Expression::Shuffle(one, other) => {
                endless(one) || endless(other)
            }
            Expression::Either(one, other) => endless(one) && endless(other),
            Expression::Done | Expression::Name(_) | Expression::Star(_) | Expression::Cut(_) => false,
        };
        let rest = Rest(self.expressions.len() as u32);
        self.expressions.push(expression.clone());
        self.nullable.push(nullable);
        self.unending.push(unending);
        self.places.insert(expression, rest);
        rest
    }

    /// Whether nothing need come any more.
    pub(super) fn may_end(&self, rest: Rest) -> bool {
        self.nullable.get(rest.0 as usize).copied().unwrap_or(false)
    }

    /// What is left when an activity has returned; nothing if it may not.
    pub(super) fn after(&mut self, rest: Rest, letter: Letter) -> BTreeSet<Rest> {
        if let Some(known) = self.derivatives.get(&(rest, letter)) {
            return known.clone();
        }
        let derivatives: BTreeSet<Rest> =
            self.steps(rest, letter).into_iter().map(|step| step.rest).collect();
        self.derivatives.insert((rest, letter), derivatives.clone());
        derivatives
    }

    /// The same, with what the activity was for.
    pub(super) fn steps(&mut self, rest: Rest, letter: Letter) -> BTreeSet<Step> {
        if let Some(known) = self.steps.get(&(rest, letter)) {
            return known.clone();
        }
        let steps = self.derive(rest, letter);
        self.steps.insert((rest, letter), steps.clone());
        steps
    }

    fn derive(&mut self, rest: Rest, letter: Letter) -> BTreeSet<Step> {
        match self.expressions[rest.0 as usize] {
            Expression::Done => BTreeSet::new(),
            Expression::Name(name) if name == letter => {
                BTreeSet::from([Step { rest: self.done(), recurs: false, begun: BTreeSet::new() }])
            }
            Expression::Name(_) => BTreeSet::new(),
            Expression::Either(one, other) => &self.steps(one, letter) | &self.steps(other, letter),
            Expression::Sequence(first, then) => {
                let mut all = self.each(first, letter, |it, rest| it.sequence(rest, then));
                if self.may_end(first) {
                    all.extend(self.steps(then, letter));
                }
                all
            }
            Expression::Turn(left, forever) => {
                // what has no end itself keeps the next turn from ever beginning
                let recurs = !self.unending[left.0 as usize];
                let steps = self.each(left, letter, |it, rest| it.turn(rest, forever));
                let mut all: BTreeSet<Step> =
                    steps.into_iter().map(|step| Step { recurs: recurs || step.recurs, ..step }).collect();
                if self.may_end(left) {
                    all.extend(self.steps(forever, letter));
                }
                all
            }
            Expression::Shuffle(one, other) => {
                let mut all = self.each(one, letter, |it, rest| it.shuffle(rest, other));
                all.extend(self.each(other, letter, |it, rest| it.shuffle(one, rest)));
                all
            }
            Expression::Star(inner) => self.each(inner, letter, |it, after| it.sequence(after, rest)),
            Expression::Forever(inner, number) => {
                let steps = self.each(inner, letter, |it, after| it.turn(after, rest));
                let begun = |mut step: Step| {
                    step.begun.insert(number);
                    Step { recurs: true, ..step }
                };
                steps.into_iter().map(begun).collect()
            }
            Expression::Cut(inner) => self.each(inner, letter, |it, after| it.cut(after)),
        }
    }

    fn each(
        &mut self,
        rest: Rest,
        letter: Letter,
        make: impl Fn(&mut Language, Rest) -> Rest,
    ) -> BTreeSet<Step> {
        let steps = self.steps(rest, letter);
        steps.into_iter().map(|step| Step { rest: make(self, step.rest), ..step }).collect()
    }

    /// Whether it has no end.
    fn is_unending(&self, rest: Rest) -> bool {
        self.unending.get(rest.0 as usize).copied().unwrap_or(false)
    }

    /// The `x~` that have to be gone through again and again from here on; none if before that something has to come that comes once. One whose turns may be
    /// empty asks for nothing.
    pub(super) fn owed(&self, rest: Rest) -> Option<BTreeSet<Endless>> {
        match self.expressions[rest.0 as usize] {
            Expression::Done | Expression::Star(_) | Expression::Cut(_) => Some(BTreeSet::new()),
            Expression::Name(_) => None,
            Expression::Either(..) => self.may_end(rest).then(BTreeSet::new),
            Expression::Forever(inner, _) if self.may_end(inner) => Some(BTreeSet::new()),
            Expression::Forever(_, number) => Some(BTreeSet::from([number])),
            Expression::Sequence(first, _) | Expression::Turn(first, _) if self.is_unending(first) => {
                self.owed(first)
            }
            Expression::Turn(_, forever) => self.owed(forever),
            Expression::Sequence(first, then) if self.may_end(first) => self.owed(then),
            Expression::Sequence(..) => None,
            Expression::Shuffle(one, other) => Some(&self.owed(one)? | &self.owed(other)?),
        }
    }

    /// An `x~` as it is written.
    pub(super) fn endless(&self, number: Endless) -> &str {
        self.endless.get(number as usize).map_or("", String::as_str)
    }

    /// What is left of any of several when an activity has returned.
    pub(super) fn after_any(&mut self, rests: &BTreeSet<Rest>, letter: Letter) -> BTreeSet<Rest> {
        rests.iter().flat_map(|&rest| self.after(rest, letter)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a formula allows a trace, and whether that may be all of it.
    fn allows(formulas: &str, trace: &str) -> (bool, bool) {
        let (mut language, all) = Language::new(&crate::liveness::parse(formulas).0).unwrap();
        let mut rests = BTreeSet::from([all]);
        for name in trace.split_whitespace() {
            let letter = language.find(name).unwrap();
            rests = language.after_any(&rests, letter);
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
    fn what_is_cut_short_may_end_at_any_time_and_what_comes_behind_it_begin() {
        let (liveness, _) = crate::liveness::parse("r = (a . b~) . c");
        let allows = |cut: &[&str], trace: &str| {
            let cut = cut.iter().map(|&name| name.to_owned()).collect();
            let (mut language, all) = Language::with_cut(&liveness, cut).unwrap();
            trace.split_whitespace().fold(BTreeSet::from([all]), |rests, name| {
                let letter = language.find(name).unwrap();
                language.after_any(&rests, letter)
            })
        };
        for trace in ["c", "a c", "a b b c"] {
            assert!(allows(&[], trace).is_empty() && !allows(&["(a.b~)"], trace).is_empty(), "{trace}");
        }
        assert!(allows(&["(a.b~)"], "b").is_empty() && allows(&["b~"], "c").is_empty());
    }

    #[test]
    fn what_goes_on_forever_is_owed_until_its_turn_has_begun() {
        let owed = |formulas: &str, trace: &str| {
            let (mut language, all) = Language::new(&crate::liveness::parse(formulas).0).unwrap();
            let rests = trace.split_whitespace().fold(BTreeSet::from([all]), |rests, name| {
                let letter = language.find(name).unwrap();
                language.after_any(&rests, letter)
            });
            let names =
                |rest| Some(language.owed(rest)?.into_iter().map(|it| language.endless(it)).collect());
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
        let (mut language, all) = Language::new(&crate::liveness::parse("r = a || (b.a)~").0).unwrap();
        let (a, b) = (language.find("a").unwrap(), language.find("b").unwrap());
        let said = |steps: &BTreeSet<Step>| -> Vec<(bool, usize)> {
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
        assert!(Language::new(&crate::liveness::parse("r = a . x\nx = b . x").0).is_none());
    }
}
