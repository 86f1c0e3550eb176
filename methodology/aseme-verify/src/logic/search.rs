//! Search of the alternatives of a formula for a consistent one.

use std::collections::{BTreeMap, BTreeSet};

use super::bounds::{BoundsConsistency, DifferenceBounds};
use super::formula::{Atom, GuardLiteral, NegationNormalForm};
use super::{Example, Satisfiability};

/// The state of a search.
pub(crate) struct SatisfiabilitySearch {
    /// How many alternatives may still be searched.
    left: usize,
    /// Whether an alternative was skipped or is satisfiable only if an unknown value permits it.
    is_open: bool,
    /// Whether values will do of which not all is known.
    takes_inexact: bool,
}

/// Values of names, as far as they matter.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct GuardModel {
    pub(crate) flags: BTreeMap<String, bool>,
    /// Texts and values of enumerations.
    pub(crate) symbols: BTreeMap<String, String>,
    /// What names are not.
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
            bounds: DifferenceBounds::new(),
            missing: BTreeSet::new(),
            present: BTreeSet::new(),
            is_exact: true,
        };
        self.solve(facts, vec![formula], Vec::new())
    }

    /// Assumes the certain literals first, then branches on the remaining alternatives.
    fn solve<'f>(
        &mut self,
        mut facts: Assumptions,
        mut certain: Vec<&'f NegationNormalForm>,
        mut choices: Vec<&'f [NegationNormalForm]>,
    ) -> Option<Assumptions> {
        while let Some(formula) = certain.pop() {
            match formula {
                NegationNormalForm::All(parts) => certain.extend(parts),
                NegationNormalForm::Any(parts) => choices.push(parts),
                NegationNormalForm::Is(literal) => {
                    if !self.assume(&mut facts, literal) {
                        return None;
                    }
                }
            }
        }
        let Some(choice) = choices.pop() else { return self.model_found(facts) };
        for alternative in choice {
            if self.left == 0 {
                self.is_open = true;
                return None;
            }
            self.left -= 1;
            if let Some(found) = self.solve(facts.clone(), vec![alternative], choices.clone()) {
                return Some(found);
            }
        }
        None
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
