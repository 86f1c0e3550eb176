//! Mutation of charts: single faults, inserted one at a time, that measure how many faults
//! scenarios detect.
//!
//! [`mutants`] makes all mutants in a fixed order. Each is a whole chart with one change: a
//! [guard](MutationKind::GuardNegated), a number in a guard, a timer's delay, an action, the target
//! of a transition, its presence, or the order of two transitions. Its name is stable as long as
//! the model is unchanged at that place; its description names the change and what a scenario has
//! to distinguish.
//!
//! Changes without effect yield no mutants: a transition that is never taken (`[false]`) gets no
//! other target, the order of transitions is kept if only one can be enabled, and equal changes
//! yield one mutant. Possibly equivalent mutants are kept; the developer decides about those that
//! no scenario detects.
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

use crate::diagnostic_names::DiagnosticNames;

/// The kind of a change.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum MutationKind {
    /// A guard is negated.
    GuardNegated,
    /// A guard is removed.
    GuardRemoved,
    /// A comparison is replaced by a similar one: `<` by `<=`, `==` by `!=`.
    Comparison,
    /// One operand of `a && b` or `a || b` is removed.
    PartDropped,
    /// `&&` becomes `||`, or vice versa.
    AndOr,
    /// A number in a guard, or a constant used by guards, is slightly larger or smaller.
    Number,
    /// A timer runs half or twice as long, or is never started.
    Timeout,
    /// An action is removed.
    ActionRemoved,
    /// A transition leads to a sibling of its target.
    Target,
    /// A transition is never taken.
    TransitionRemoved,
    /// Two transitions out of one node change places in the selection order.
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

    /// The word for the kind in names of mutants and in reports.
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

/// A chart with one change.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Mutant {
    /// The kind of change.
    pub kind: MutationKind,
    /// The name: the changed element, `#`, the kind, and a number from the second of that kind on.
    pub name: String,
    /// The path of the changed element, or those of the ends of a transition.
    pub path: String,
    /// The change, in the notation of the model.
    pub description: String,
    /// The distinction that a scenario has to make to detect it.
    pub wanted: String,
    /// The span of the changed element in the model's text; the beginning if it has none.
    pub span: Span,
    /// The changed chart.
    pub chart: Statechart,
}

/// All mutants of a model's chart, in the order of its transitions, then of its states, then of its
/// constants.
///
/// # Errors
/// The errors that prevent reading the model, or an error if its kind has no chart.
pub fn mutants(source: &Arc<Source>) -> Result<Vec<Mutant>, Vec<Diagnostic>> {
    let (chart, spans) = crate::checked_model::chart_and_transition_spans(source)?;
    let mut making = MutantCollector {
        source,
        chart: &chart,
        names: DiagnosticNames::new(&chart),
        spans: &spans,
        known: BTreeSet::new(),
        made: Vec::new(),
    };
    for (id, _) in chart.transitions() {
        guards::of_transition(&mut making, id);
        actions::of_transition(&mut making, id);
        transitions::of_transition(&mut making, id);
    }
    actions::of_states(&mut making);
    constants::all(&mut making);
    Ok(making.named())
}

/// The most characters of a transition as a role writes it in the name of a mutant.
const MAX_TRANSITION_LENGTH: usize = 80;

/// Collects mutants.
struct MutantCollector<'a> {
    source: &'a Arc<Source>,
    chart: &'a Statechart,
    names: DiagnosticNames,
    spans: &'a [Span],
    /// The changes so far, to skip duplicates.
    known: BTreeSet<String>,
    made: Vec<(String, Mutant)>,
}

/// The description of a mutant.
struct MutantDescription {
    kind: MutationKind,
    /// The change without its location.
    change: String,
    wanted: String,
}

impl MutantCollector<'_> {
    /// The name of a transition.
    fn arrow(&self, id: TransitionId) -> String {
        let written = shortest_transition(self.chart, id);
        if written.chars().count() <= MAX_TRANSITION_LENGTH { written } else { self.names.transition(id) }
    }

    /// Adds a mutant with one transition replaced.
    fn transition(
        &mut self,
        id: TransitionId,
        mutation: MutantDescription,
        change: impl FnOnce(&mut Transition),
    ) {
        self.changed(id, mutation, |chart| change(chart.transition_mut(id)));
    }

    /// Adds a mutant with one transition and dependent elements replaced.
    fn changed(
        &mut self,
        id: TransitionId,
        mutation: MutantDescription,
        change: impl FnOnce(&mut Statechart),
    ) {
        let mut chart = self.chart.clone();
        change(&mut chart);
        if chart.transition(id) == self.chart.transition(id) {
            return;
        }
        let it = chart.transition(id);
        let what = format!("{} {} {} {}", id.0, it.target.0, it.priority, it.expression);
        let span = self.spans.get(id.0 as usize).copied().unwrap_or_default();
        self.add(&what, (self.arrow(id), self.names.transition_path(id)), span, mutation, chart);
    }

    /// Adds a mutant of an element with a name and a path, unless an equal one exists.
    fn add(
        &mut self,
        what: &str,
        (element, path): (String, String),
        span: Span,
        mutation: MutantDescription,
        chart: Statechart,
    ) {
        if !self.known.insert(what.to_owned()) {
            return;
        }
        let MutantDescription { kind, change, wanted } = mutation;
        let description = format!("{element}: {change}");
        self.made
            .push((element, Mutant { kind, name: String::new(), path, description, wanted, span, chart }));
    }

    /// Assigns names to the mutants.
    fn named(self) -> Vec<Mutant> {
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let name = |(element, mutant): (String, Mutant)| {
            let name = format!("{element} #{}", mutant.kind.word());
            let number = numbers.entry(name.clone()).or_default();
            *number += 1;
            let name = if *number == 1 { name } else { format!("{name}-{number}") };
            Mutant { name, ..mutant }
        };
        self.made.into_iter().map(name).collect()
    }
}

/// A guard in brackets.
fn bracketed(guard: Option<&Expression>) -> String {
    guard.map_or_else(|| String::from("no guard"), |guard| format!("`[{guard}]`"))
}

#[cfg(test)]
mod tests;
