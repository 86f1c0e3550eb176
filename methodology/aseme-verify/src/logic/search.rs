//! Search of the alternatives of a formula for a consistent one.

use std::collections::{BTreeMap, BTreeSet};

use super::bounds::{BoundsConsistency, DifferenceBounds};
use super::formula::{Atom, GuardLiteral, NegationNormalForm};
use super::{Example, Satisfiability};

/// Limit of choices with untried alternatives: each keeps what was assumed before it.
const MOST_BRANCHES: usize = 2_500;

/// The state of a search.
pub(crate) struct SatisfiabilitySearch {
    /// The number of alternatives that may still be searched.
    left: usize,
    /// Whether an alternative was skipped or is satisfiable only if an unknown value permits it.
    is_open: bool,
    /// Whether partially known values suffice.
    takes_inexact: bool,
}

/// Values of names, as far as they matter.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct GuardModel {
    pub(crate) flags: BTreeMap<String, bool>,
    /// Texts and values of enumerations.
    pub(crate) symbols: BTreeMap<String, String>,
    /// Pairs of a name and a value that are known to differ.
    pub(crate) differs: BTreeSet<(String, String)>,
    pub(crate) numbers: BTreeMap<String, f64>,
    /// The messages that have not arrived.
    pub(crate) missing: BTreeSet<String>,
}

/// The literals assumed in one alternative.
#[derive(Clone)]
struct Assumptions {
    flags: BTreeMap<String, bool>,
    equals: BTreeMap<String, String>,
    differs: BTreeSet<(String, String)>,
    bounds: DifferenceBounds,
    missing: BTreeSet<String>,
    present: BTreeSet<String>,
    is_exact: bool,
}

/// A choice whose alternatives are tried one after the other.
#[derive(Clone)]
struct Branch<'f> {
    /// The assumptions before it.
    facts: Assumptions,
    /// The last of the choices that remain beside it.
    last_choice: Option<usize>,
    /// The number of choices that were opened before its alternatives.
    opened: usize,
    untried: &'f [NegationNormalForm],
}

/// The choices that are not yet branches. Those of all branches share their common beginning.
#[derive(Default)]
struct OpenChoices<'f> {
    /// Alternatives, and the index of the choice before.
    all: Vec<(&'f [NegationNormalForm], Option<usize>)>,
    last: Option<usize>,
}

impl<'f> OpenChoices<'f> {
    fn push(&mut self, alternatives: &'f [NegationNormalForm]) {
        self.all.push((alternatives, self.last));
        self.last = Some(self.all.len() - 1);
    }

    fn pop(&mut self) -> Option<&'f [NegationNormalForm]> {
        let (alternatives, before) = *self.all.get(self.last?)?;
        self.last = before;
        Some(alternatives)
    }
}

impl SatisfiabilitySearch {
    pub(crate) fn new(alternatives: usize) -> SatisfiabilitySearch {
        SatisfiabilitySearch { left: alternatives, is_open: false, takes_inexact: false }
    }

    pub(crate) fn answer(mut self, formula: NegationNormalForm) -> Satisfiability {
        match self.first(&formula) {
            Some(facts) => Satisfiability::Yes(facts.example()),
            None if self.is_open => Satisfiability::Unknown,
            None => Satisfiability::No,
        }
    }

    /// Values with which a formula may hold, terms that are outside of the theory being names of
    /// their own. None if there are none, or if not all alternatives were looked at: then the
    /// second is false.
    pub(crate) fn candidate(mut self, formula: &NegationNormalForm) -> (Option<GuardModel>, bool) {
        self.takes_inexact = true;
        let found = self.first(formula).map(Assumptions::model);
        (found, !self.is_open)
    }

    fn first(&mut self, formula: &NegationNormalForm) -> Option<Assumptions> {
        let facts = Assumptions {
            flags: BTreeMap::new(),
            equals: BTreeMap::new(),
            differs: BTreeSet::new(),
            bounds: DifferenceBounds::default(),
            missing: BTreeSet::new(),
            present: BTreeSet::new(),
            is_exact: true,
        };
        self.solve(facts, formula)
    }

    /// Searches depth first. The branches are on a stack of their own: the conditions of a run can
    /// have thousands of choices, more than recursion has room for.
    fn solve(&mut self, mut facts: Assumptions, mut formula: &NegationNormalForm) -> Option<Assumptions> {
        let mut choices = OpenChoices::default();
        let mut branches: Vec<Branch<'_>> = Vec::new();
        loop {
            if self.assume_certain(&mut facts, formula, &mut choices) {
                match choices.pop() {
                    Some(untried) => {
                        let (last_choice, opened) = (choices.last, choices.all.len());
                        branches.push(Branch { facts, last_choice, opened, untried });
                    }
                    None => {
                        if let Some(found) = self.model_found(facts) {
                            return Some(found);
                        }
                    }
                }
            }
            while branches.pop_if(|branch| branch.untried.is_empty()).is_some() {}
            let branch = branches.pop()?;
            if self.left == 0 || branches.len() == MOST_BRANCHES {
                self.is_open = true;
                return None;
            }
            self.left -= 1;
            let (alternative, untried) = branch.untried.split_first()?;
            choices.all.truncate(branch.opened);
            choices.last = branch.last_choice;
            if !untried.is_empty() {
                branches.push(Branch { untried, ..branch.clone() });
            }
            (facts, formula) = (branch.facts, alternative);
        }
    }

    /// Assumes the literals that are certain and opens the choices. Returns whether the assumptions
    /// are consistent.
    fn assume_certain<'f>(
        &mut self,
        facts: &mut Assumptions,
        formula: &'f NegationNormalForm,
        choices: &mut OpenChoices<'f>,
    ) -> bool {
        let mut certain = vec![formula];
        while let Some(formula) = certain.pop() {
            match formula {
                NegationNormalForm::All(parts) => certain.extend(parts),
                NegationNormalForm::Any(parts) => choices.push(parts),
                NegationNormalForm::Is(literal) => {
                    if !self.assume(facts, literal) {
                        return false;
                    }
                }
            }
        }
        true
    }

    /// Adds a literal. Returns whether the assumptions are consistent.
    fn assume(&mut self, facts: &mut Assumptions, literal: &GuardLiteral) -> bool {
        facts.is_exact &= literal.is_exact;
        facts.present.extend(literal.messages.iter().cloned());
        match facts.assume_atom(&literal.atom) {
            BoundsConsistency::Consistent => !facts.is_missing_what_is_present(),
            BoundsConsistency::Contradiction => false,
            BoundsConsistency::TooClose => {
                self.is_open = true;
                false
            }
        }
    }

    fn model_found(&mut self, facts: Assumptions) -> Option<Assumptions> {
        if facts.is_exact || self.takes_inexact {
            return Some(facts);
        }
        self.is_open = true;
        None
    }
}

impl Assumptions {
    fn assume_atom(&mut self, says: &Atom) -> BoundsConsistency {
        let holds = match says {
            Atom::Flag(name, value) => {
                *self.flags.entry(name.clone()).or_insert(*value) == *value && self.timers_agree(name)
            }
            Atom::Equals(name, value, true) => {
                let known = self.equals.entry(name.clone()).or_insert_with(|| value.clone());
                known == value && !self.differs.contains(&(name.clone(), value.clone()))
            }
            Atom::Equals(name, value, false) => {
                self.differs.insert((name.clone(), value.clone()));
                self.equals.get(name) != Some(value)
            }
            Atom::Bound { more, less, limit, strict } => {
                return self.bounds.add(more.as_deref(), less.as_deref(), *limit, *strict);
            }
            Atom::Missing(message) => {
                self.missing.insert(message.clone());
                true
            }
            Atom::Present(message) => {
                self.present.insert(message.clone());
                true
            }
        };
        if holds { BoundsConsistency::Consistent } else { BoundsConsistency::Contradiction }
    }

    /// A timer that was started and has expired is also true by its bare name.
    fn timers_agree(&self, name: &str) -> bool {
        let bare = name.strip_prefix("TimeoutCheck(").and_then(|rest| rest.strip_suffix(')')).unwrap_or(name);
        let checked = self.flags.get(&format!("TimeoutCheck({bare})"));
        !(checked == Some(&true) && self.flags.get(bare) == Some(&false))
    }

    /// Whether a part of a present message is assumed missing: the parts arrive together.
    fn is_missing_what_is_present(&self) -> bool {
        let within = |inner: &str, outer: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let meets = |one: &str| self.present.iter().any(|other| within(one, other) || within(other, one));
        self.missing.iter().any(|message| meets(message))
    }

    fn model(self) -> GuardModel {
        GuardModel {
            flags: self.flags,
            symbols: self.equals,
            differs: self.differs,
            numbers: self.bounds.example().into_iter().collect(),
            missing: self.missing,
        }
    }

    fn example(self) -> Example {
        let mut values: BTreeMap<String, String> =
            self.flags.into_iter().map(|(name, value)| (name, value.to_string())).collect();
        let fixed: BTreeSet<String> = self.equals.keys().cloned().collect();
        let differs = self.differs.into_iter().filter(|(name, _)| !fixed.contains(name));
        for (name, value) in differs {
            let entry = values.entry(name).or_insert_with(|| "not".into());
            entry.push_str(if entry == "not" { " " } else { " or " });
            entry.push_str(&value);
        }
        values.extend(self.equals);
        values.extend(self.bounds.example().into_iter().map(|(name, value)| (name, value.to_string())));
        values.extend(self.missing.into_iter().map(|message| (message, "missing".into())));
        Example { values: values.into_iter().collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(number: usize) -> NegationNormalForm {
        let alternatives = ["a", "b"].map(|name| {
            NegationNormalForm::Is(GuardLiteral {
                atom: Atom::Flag(format!("{name}{number}"), true),
                messages: Vec::new(),
                is_exact: true,
            })
        });
        NegationNormalForm::Any(alternatives.into())
    }

    #[test]
    fn thousands_of_choices_do_not_exhaust_the_stack() {
        let search = |choices| {
            let formula = NegationNormalForm::All((0..choices).map(choice).collect());
            let (found, is_certain) = SatisfiabilitySearch::new(20_000).candidate(&formula);
            (found.map(|model| model.flags.len()), is_certain)
        };
        assert_eq!(search(2_000), (Some(2_000), true));
        assert_eq!(search(4_000), (None, false), "the limit of branches holds");
    }
}
