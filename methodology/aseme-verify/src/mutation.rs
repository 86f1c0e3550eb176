//! Mutation of charts: single faults, inserted one at a time, that measure how many faults
//! scenarios detect.
//!
//! [`mutants`] makes all mutants in a fixed order. Each is a whole chart with one change: a
//! [guard](MutationKind::GuardNegated), a number in a guard, a timer's delay, an action, the target
//! of a transition, its presence, or the order of two transitions. Its name is stable as long as
//! the model is unchanged at that place; its description names the change and what a scenario has
//! to distinguish.
//!
//! Changes without effect are no mutants: a transition that is never taken (`[false]`) gets no
//! other target, the order of transitions of which only one can be enabled is kept, and equal
//! changes are made once. Mutants that may be equivalent are made; the developer decides about
//! those that no scenario detects.
//!
//! ```
//! use yase::Source;
//!
//! let role = Source::new("lamp.srm", "
//! Role: lamp
//! Liveness:
//! lamp = Look . (On | Off)
//! Transitions:
//! CONDITION -> On : [Light.level < 3]
//! CONDITION -> Off : [Light.level >= 3]
//! ");
//! let mutants = aseme_verify::mutation::mutants(&role).expect("the role is in order");
//! let first = mutants.iter().find(|mutant| mutant.name.starts_with("CONDITION -> On")).expect("there are some");
//! assert_eq!(first.name, "CONDITION -> On #guard-negated");
//! assert_eq!(first.description, "CONDITION -> On: the guard `[Light.level < 3]` becomes `[Light.level >= 3]`");
//! assert_eq!(role.position(first.span.start).0, 6);
//! ```

mod actions;
mod constants;
mod guards;
mod transitions;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use yase::expression::Expression;
use yase::{Diagnostic, Source, Span, Statechart, Transition, TransitionId};

use aseme::path::shortest_transition;

/// What was changed.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum MutationKind {
    /// A guard says the contrary.
    GuardNegated,
    /// A guard is gone.
    GuardRemoved,
    /// A comparison is its neighbour: `<` is `<=`, `==` is `!=`.
    Comparison,
    /// One part of `a && b` or `a || b` is gone.
    PartDropped,
    /// `&&` becomes `||`, or vice versa.
    AndOr,
    /// A number in a guard, or a constant that guards name, is a little larger or smaller.
    Number,
    /// A timer runs half as long, or twice, or is never started.
    Timeout,
    /// An action is gone.
    ActionRemoved,
    /// A transition leads to a sibling of where it should.
    Target,
    /// A transition is never taken.
    TransitionRemoved,
    /// Of two ways the one that is tried later is tried first.
    Priority,
}

impl MutationKind {
    /// All kinds, in the order of reports.
    pub const ALL: [MutationKind; 11] = [
        MutationKind::GuardNegated,
        MutationKind::GuardRemoved,
        MutationKind::Comparison,
        MutationKind::PartDropped,
        MutationKind::AndOr,
        MutationKind::Number,
        MutationKind::Timeout,
        MutationKind::ActionRemoved,
        MutationKind::Target,
        MutationKind::TransitionRemoved,
        MutationKind::Priority,
    ];

    /// The word for it in names of mutants and in reports.
    pub const fn word(self) -> &'static str {
        match self {
            MutationKind::GuardNegated => "guard-negated",
            MutationKind::GuardRemoved => "guard-removed",
            MutationKind::Comparison => "comparison",
            MutationKind::PartDropped => "part-dropped",
            MutationKind::AndOr => "and-or",
            MutationKind::Number => "number",
            MutationKind::Timeout => "timeout",
            MutationKind::ActionRemoved => "action-removed",
            MutationKind::Target => "target",
            MutationKind::TransitionRemoved => "transition-removed",
            MutationKind::Priority => "priority",
        }
    }
}

/// A chart with one thing changed.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Mutant {
    /// What was changed.
    pub kind: MutationKind,
    /// What it is called: where the change is, `#`, the kind, and a number from the second of that
    /// kind there on.
    pub name: String,
    /// What was changed, in the words of the model.
    pub description: String,
    /// What a scenario has to tell apart so as to notice it.
    pub wanted: String,
    /// Where what was changed stands in the model's text; its beginning for what stands nowhere.
    pub span: Span,
    /// The chart.
    pub chart: Statechart,
}

/// All mutants of a model's chart, in the order of its transitions, then of its states, then of its
/// constants.
///
/// # Errors
/// What keeps the model from being read, and of models of a kind that has no chart that.
pub fn mutants(source: &Arc<Source>) -> Result<Vec<Mutant>, Vec<Diagnostic>> {
    let (chart, places) = crate::checked_model::chart_and_places(source)?;
    let mut making =
        MutantCollector { source, chart: &chart, places: &places, known: BTreeSet::new(), made: Vec::new() };
    for (id, _) in chart.transitions() {
        guards::of_transition(&mut making, id);
        actions::of_transition(&mut making, id);
        transitions::of_transition(&mut making, id);
    }
    actions::of_states(&mut making);
    constants::all(&mut making);
    Ok(making.named())
}

/// The mutants so far.
struct MutantCollector<'a> {
    source: &'a Arc<Source>,
    chart: &'a Statechart,
    places: &'a [Span],
    /// What each has changed, so that none is made twice.
    known: BTreeSet<String>,
    made: Vec<(String, Mutant)>,
}

/// The description of a mutant.
struct MutantDescription {
    kind: MutationKind,
    /// What is changed into what, without where that is.
    change: String,
    wanted: String,
}

impl MutantCollector<'_> {
    /// The name of a transition.
    fn arrow(&self, id: TransitionId) -> String {
        shortest_transition(self.chart, id)
    }

    /// A mutant in which one transition is another.
    fn transition(
        &mut self,
        id: TransitionId,
        told: MutantDescription,
        change: impl FnOnce(&mut Transition),
    ) {
        self.changed(id, told, |chart| change(chart.transition_mut(id)));
    }

    /// A mutant in which one transition is another, and what goes with it.
    fn changed(&mut self, id: TransitionId, told: MutantDescription, change: impl FnOnce(&mut Statechart)) {
        let mut chart = self.chart.clone();
        change(&mut chart);
        if chart.transition(id) == self.chart.transition(id) {
            return;
        }
        let it = chart.transition(id);
        let what = format!("{} {} {} {}", id.0, it.target.0, it.priority, it.expression);
        let span = self.places.get(id.0 as usize).copied().unwrap_or_default();
        self.add(&what, self.arrow(id), span, told, chart);
    }

    /// A mutant, unless it is one that is there.
    fn add(&mut self, what: &str, place: String, span: Span, told: MutantDescription, chart: Statechart) {
        if !self.known.insert(what.to_owned()) {
            return;
        }
        let MutantDescription { kind, change, wanted } = told;
        let description = format!("{place}: {change}");
        self.made.push((place, Mutant { kind, name: String::new(), description, wanted, span, chart }));
    }

    /// The mutants with their names.
    fn named(self) -> Vec<Mutant> {
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let name = |(place, mutant): (String, Mutant)| {
            let name = format!("{place} #{}", mutant.kind.word());
            let number = numbers.entry(name.clone()).or_default();
            *number += 1;
            let name = if *number == 1 { name } else { format!("{name}-{number}") };
            Mutant { name, ..mutant }
        };
        self.made.into_iter().map(name).collect()
    }
}

/// A guard as it stands on a transition.
fn bracketed(guard: Option<&Expression>) -> String {
    guard.map_or_else(|| String::from("no guard"), |guard| format!("`[{guard}]`"))
}

#[cfg(test)]
mod tests;
