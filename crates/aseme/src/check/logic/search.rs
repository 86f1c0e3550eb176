//! The alternatives of a formula, one after the other, until one has no contradiction.

use std::collections::{BTreeMap, BTreeSet};

use super::bounds::{Bounds, Verdict};
use super::formula::{Formula, Literal, Says};
use super::{Answer, Example};

/// A search.
pub(super) struct Search {
    /// How many alternatives may still be looked at.
    left: usize,
    /// Whether an alternative may be, of which not all is known, or was not looked at.
    is_open: bool,
}

/// What is known in one alternative.
#[derive(Clone)]
struct Facts {
    flags: BTreeMap<String, bool>,
    equals: BTreeMap<String, String>,
    differs: BTreeSet<(String, String)>,
    bounds: Bounds,
    missing: BTreeSet<String>,
    present: BTreeSet<String>,
    is_exact: bool,
}

impl Search {
    pub(super) fn new(alternatives: usize) -> Search {
        Search { left: alternatives, is_open: false }
    }

    pub(super) fn answer(mut self, formula: Formula) -> Answer {
        let facts = Facts {
            flags: BTreeMap::new(),
            equals: BTreeMap::new(),
            differs: BTreeSet::new(),
            bounds: Bounds::new(),
            missing: BTreeSet::new(),
            present: BTreeSet::new(),
            is_exact: true,
        };
        match self.look(facts, vec![&formula], Vec::new()) {
            Some(example) => Answer::Yes(example),
            None if self.is_open => Answer::Unknown,
            None => Answer::No,
        }
    }

    /// What is certain comes first; then one of the alternatives that are left to be chosen from.
    fn look<'f>(
        &mut self,
        mut facts: Facts,
        mut certain: Vec<&'f Formula>,
        mut choices: Vec<&'f [Formula]>,
    ) -> Option<Example> {
        while let Some(formula) = certain.pop() {
            match formula {
                Formula::All(parts) => certain.extend(parts),
                Formula::Any(parts) => choices.push(parts),
                Formula::Is(literal) => {
                    if !self.take(&mut facts, literal) {
                        return None;
                    }
                }
            }
        }
        let Some(choice) = choices.pop() else { return self.found(facts) };
        for alternative in choice {
            if self.left == 0 {
                self.is_open = true;
                return None;
            }
            self.left -= 1;
            if let Some(example) = self.look(facts.clone(), vec![alternative], choices.clone()) {
                return Some(example);
            }
        }
        None
    }

    /// Whether what is said contradicts nothing.
    fn take(&mut self, facts: &mut Facts, literal: &Literal) -> bool {
        facts.is_exact &= literal.is_exact;
        facts.present.extend(literal.messages.iter().cloned());
        match facts.learn(&literal.says) {
            Verdict::Consistent => !facts.is_missing_what_is_present(),
            Verdict::Contradiction => false,
            Verdict::TooClose => {
                self.is_open = true;
                false
            }
        }
    }

    fn found(&mut self, facts: Facts) -> Option<Example> {
        if facts.is_exact {
            return Some(facts.example());
        }
        self.is_open = true;
        None
    }
}

impl Facts {
    fn learn(&mut self, says: &Says) -> Verdict {
        let holds = match says {
            Says::Flag(name, value) => {
                *self.flags.entry(name.clone()).or_insert(*value) == *value && self.timers_agree(name)
            }
            Says::Equals(name, value, true) => {
                let known = self.equals.entry(name.clone()).or_insert_with(|| value.clone());
                known == value && !self.differs.contains(&(name.clone(), value.clone()))
            }
            Says::Equals(name, value, false) => {
                self.differs.insert((name.clone(), value.clone()));
                self.equals.get(name) != Some(value)
            }
            Says::Bound { more, less, limit, strict } => {
                return self.bounds.add(more.as_deref(), less.as_deref(), *limit, *strict);
            }
            Says::Missing(message) => {
                self.missing.insert(message.clone());
                true
            }
            Says::Present(message) => {
                self.present.insert(message.clone());
                true
            }
        };
        if holds { Verdict::Consistent } else { Verdict::Contradiction }
    }

    /// A timer that was started and is over is over by its bare name too.
    fn timers_agree(&self, name: &str) -> bool {
        let bare = name.strip_prefix("TimeoutCheck(").and_then(|rest| rest.strip_suffix(')')).unwrap_or(name);
        let checked = self.flags.get(&format!("TimeoutCheck({bare})"));
        !(checked == Some(&true) && self.flags.get(bare) == Some(&false))
    }

    /// Parts of a message arrive with it.
    fn is_missing_what_is_present(&self) -> bool {
        let within = |inner: &str, outer: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let meets = |one: &str| self.present.iter().any(|other| within(one, other) || within(other, one));
        self.missing.iter().any(|message| meets(message))
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
