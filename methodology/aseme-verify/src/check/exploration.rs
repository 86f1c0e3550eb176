//! Checks by exploration ([`yase_explore`]): M04 for JOIN, M12 to M15, M21, M22 and M26 to M28.
//!
//! Guards on data are free inputs as far as they are satisfiable together; activities return,
//! events arrive and timers expire at any time. A state found unreachable is therefore unreachable
//! in every environment. This holds only for a complete exploration; an incomplete one reports only
//! what it found.

mod completion;
mod dead_by_design;
mod restless_loops;

use std::collections::BTreeSet;

use yase::expression::ActionKind;
use yase::{
    Diagnostic, MachineErrorKind, NodeId, NodeKind, Severity, Span, Statechart, Status, TransitionId,
};
use yase_explore::{Exploration, ExplorationProgress, FailedStep, QUEUED, Trace, explore};

use super::messages;
use crate::abstraction::Abstraction;
use crate::check_settings::CheckSettings;
use crate::checked_model::CheckedModel;
use crate::conformance;
use crate::conformance::{ConformanceDifference, DifferenceKind};
use crate::exploration_extent::ExplorationExtent;
use crate::finding::Finding;
use dead_by_design::DeadByDesign;

/// The default number of activities that an agent's pool runs at once.
const DEFAULT_POOL_SIZE: usize = 12;

/// Findings of the exploration and its extent, or none if the chart cannot be explored. `known`
/// holds the findings of the other checks.
pub(crate) fn check(
    subject: &CheckedModel,
    settings: &CheckSettings,
    known: &[Diagnostic],
) -> (Vec<Finding>, Option<ExplorationExtent>) {
    let abstraction = match Abstraction::new(subject) {
        Ok(abstraction) => abstraction,
        Err(reasons) => {
            return (reasons.into_iter().map(|reason| not_explored(subject, reason)).collect(), None);
        }
    };
    let mut surroundings = abstraction.surroundings();
    let found = explore(&abstraction.chart, &mut surroundings, settings.limits());
    drop(surroundings);
    let checks = ExplorationCheck {
        subject,
        abstraction: &abstraction,
        found: &found,
        intended: DeadByDesign::new(subject),
        reported: known.iter().map(|diagnostic| diagnostic.span).collect(),
        is_whole: known.iter().all(|diagnostic| diagnostic.severity == Severity::Information),
    };
    let explored = ExplorationExtent::of(&found);
    (checks.all(settings, &explored), Some(explored))
}

/// Reports why a chart is not explored; otherwise it would look free of faults.
fn not_explored(subject: &CheckedModel, reason: Diagnostic) -> Finding {
    if reason.code.starts_with('M') {
        // a structural fault that shows only when segments are joined into compound transitions
        let span =
            if reason.span == Span::default() { subject.spans.node(Statechart::ROOT) } else { reason.span };
        return Diagnostic { span, ..reason }.into();
    }
    let message = format!("not explored: {}", reason.message);
    Diagnostic { severity: Severity::Warning, message, ..reason }.into()
}

struct ExplorationCheck<'a> {
    subject: &'a CheckedModel,
    abstraction: &'a Abstraction,
    found: &'a Exploration,
    intended: DeadByDesign,
    /// The spans of earlier findings; their consequences are not reported again.
    reported: BTreeSet<Span>,
    /// Whether no other check has a finding above information.
    is_whole: bool,
}

impl ExplorationCheck<'_> {
    fn all(&self, settings: &CheckSettings, explored: &ExplorationExtent) -> Vec<Finding> {
        let mut findings = self.livelocks();
        let waiting = completion::check(self.subject);
        let uncompleted: BTreeSet<TransitionId> = waiting.iter().map(|(id, _)| *id).collect();
        findings.extend(waiting.into_iter().map(|(_, diagnostic)| diagnostic.into()));
        if self.found.is_finished() {
            findings.extend(self.joins());
            findings.extend(self.unreachable_nodes());
            let (held, stuck) = (self.held(), self.stuck_states());
            let mut accounted: BTreeSet<TransitionId> = uncompleted;
            accounted.extend(held.iter().map(|(id, _)| *id));
            accounted.extend(stuck.iter().flat_map(|&node| self.subject.outgoing(node)));
            findings.extend(self.unreachable_transitions(&accounted));
            findings.extend(held.into_iter().map(|(_, finding)| finding));
            findings.extend(self.dead_ends(&stuck));
        }
        if let Some(world) = settings.world.as_ref().filter(|_| self.found.is_finished()) {
            findings.extend(messages::undelivered(self.subject, world, settings, self.found));
        }
        if let Some(world) = &settings.world {
            findings.extend(messages::concurrent_publishers(self.subject, world, self.found));
        }
        if findings.is_empty() && self.is_whole {
            findings.extend(self.differences(settings));
        }
        findings.extend(self.crowded_queues());
        findings.extend(restless_loops::check(self.subject, self.found).into_iter().map(Finding::from));
        findings.extend(self.pool(settings));
        findings.push(self.metrics(explored, settings).into());
        findings
    }

    fn with_trace(diagnostic: Diagnostic, trace: &Trace) -> Finding {
        Finding { diagnostic, trace: Some(trace.to_string()) }
    }

    /// M13: a livelock. It is proven if the values that it requires of data are satisfiable.
    fn livelocks(&self) -> Vec<Finding> {
        let is_exact = |it: &&FailedStep| it.from.is_none_or(|from| self.found.states()[from].is_exact);
        let failures = self.found.failures().iter().filter(|it| it.kind == MachineErrorKind::NeverRests);
        let failures = failures.filter(is_exact);
        failures
            .map(|failure| Self::with_trace(self.livelock(failure), &self.found.trace_of(failure)))
            .collect()
    }

    fn livelock(&self, failure: &FailedStep) -> Diagnostic {
        let is_proven =
            failure.step.decisions.is_empty() || self.abstraction.can_be(&failure.step.decisions).is_yes();
        let mut cycle: Vec<TransitionId> = failure.cycle.clone();
        cycle.dedup();
        let arrows: Vec<String> = cycle.iter().map(|&id| format!("`{}`", self.subject.arrow(id))).collect();
        let message = format!("livelock: the chart repeats {} again and again", arrows.join(", "));
        let span = cycle.first().map_or(Span::default(), |&id| self.subject.spans.transition(id));
        let severity = if is_proven { Severity::Error } else { Severity::Warning };
        let found = Diagnostic { severity, ..Diagnostic::warning("M13", span, message) };
        found.with_hint("let a transition of the cycle wait for an event, a timer or an activity")
    }

    /// M04: a JOIN whose sources are never active together.
    fn joins(&self) -> Vec<Finding> {
        let joins = self.subject.chart.nodes().filter(|(_, node)| node.kind == NodeKind::Join);
        let never = joins.filter(|(id, _)| {
            let sources: Vec<NodeId> = self
                .subject
                .incoming(*id)
                .iter()
                .map(|&transition| self.subject.transition(transition).source)
                .collect();
            sources.iter().all(|&source| self.found.was_entered(source))
                && self.found.first(|state| sources.iter().all(|&source| state.is_active(source))).is_none()
        });
        never
            .map(|(id, _)| {
                let message = format!("the sources of `{}` are never active together", self.subject.path(id));
                let found = Diagnostic::error("M04", self.subject.spans.node(id), message);
                found.with_hint("each source of a JOIN waits for the others").into()
            })
            .collect()
    }

    /// M12 for states: the outermost of the unreachable states.
    fn unreachable_nodes(&self) -> Vec<Finding> {
        let is_place = |id: NodeId| self.subject.is_state(id) || self.subject.kind(id) == NodeKind::End;
        let nodes = self.subject.chart.nodes().map(|(id, _)| id);
        let unreached = nodes.filter(|&id| is_place(id) && !self.found.was_entered(id));
        let outermost = unreached.filter(|&id| {
            let parent = self.subject.chart.node(id).parent;
            parent.is_some_and(|parent| self.found.was_entered(parent)) && !self.intended.is_cut_off(id)
        });
        outermost
            .filter(|&id| self.is_first_of_unreached(id))
            .map(|id| {
                let message = format!("`{}` is unreachable", self.subject.path(id));
                let hint = match self.subject.incoming(id).is_empty() {
                    true => "no transition leads to it: add one, or remove the state",
                    false => "only unreachable states lead to it",
                };
                self.subject.warn("M12", id, message).with_hint(hint).into()
            })
            .collect()
    }

    /// Whether no other finding explains why a node is unreachable: neither a transition to it from
    /// a reached node nor an unreached node before it.
    fn is_first_of_unreached(&self, id: NodeId) -> bool {
        self.subject.incoming(id).iter().all(|&transition| {
            let source = self.subject.transition(transition).source;
            !self.was_possible(transition) && (source >= id || self.subject.contains(id, source))
        })
    }

    /// Whether the source of a transition was active when its trigger could match.
    fn was_possible(&self, id: TransitionId) -> bool {
        let source = self.subject.transition(id).source;
        match self.subject.kind(source) {
            NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::Start => {
                self.found.was_entered(source)
            }
            _ => self.subject.incoming(source).iter().any(|&transition| self.found.was_taken(transition)),
        }
    }

    /// M12 for transitions: those that are never taken although their source is reachable.
    fn unreachable_transitions(&self, accounted: &BTreeSet<TransitionId>) -> Vec<Finding> {
        let ids = self.subject.chart.transitions().map(|(id, _)| id);
        let never = ids.filter(|&id| {
            let spans = &self.subject.spans;
            let (guard, whole) = (spans.guard(id), spans.transition(id));
            let is_told = guard != Span::default()
                && (self.reported.contains(&guard) || self.reported.contains(&whole));
            !self.found.was_taken(id)
                && self.was_possible(id)
                && !self.intended.is_never(id)
                && !accounted.contains(&id)
                && !is_told
        });
        never
            .map(|id| {
                let message = format!("`{}` is never taken", self.subject.arrow(id));
                let hint =
                    "another transition always precedes it, or its trigger or guard never occurs in that state";
                self.subject.warn_of("M12", id, message).with_hint(hint).into()
            })
            .collect()
    }

    /// M22: transitions that are blocked only because activities always run.
    fn held(&self) -> Vec<(TransitionId, Finding)> {
        let ids = self.subject.chart.transitions().map(|(id, _)| id);
        let never = ids.filter(|&id| !self.found.was_taken(id) && !self.intended.is_never(id));
        let held = never.filter(|&id| self.found.was_held(id) || self.never_becomes_quiescent(id));
        held.map(|id| {
            let message = format!(
                "`{}` is never taken, because an activity inside its source always runs",
                self.subject.arrow(id)
            );
            let hint = "write `interrupts` after its target, or let the activities inside complete";
            (id, self.subject.warn_of("M22", id, message).with_hint(hint).into())
        })
        .collect()
    }

    /// Whether a transition waits for a composite to be quiescent in which an activity always runs.
    fn never_becomes_quiescent(&self, id: TransitionId) -> bool {
        let transition = self.subject.transition(id);
        let is_composite = matches!(self.subject.kind(transition.source), NodeKind::Or | NodeKind::And);
        let by_guard = transition.expression.trigger.is_none() && transition.expression.guard.is_some();
        let runs_inside = |node: &NodeId| self.subject.contains(transition.source, *node);
        is_composite
            && by_guard
            && !transition.interrupts
            && self.found.was_entered(transition.source)
            && self
                .found
                .states()
                .iter()
                .filter(|state| state.is_active(transition.source))
                .all(|state| state.running.iter().any(runs_inside))
    }

    /// The reachable states that have exits but are never left.
    fn stuck_states(&self) -> Vec<NodeId> {
        let leaves = self
            .subject
            .chart
            .nodes()
            .filter(|(_, node)| matches!(node.kind, NodeKind::Basic | NodeKind::Start));
        let stuck = leaves.map(|(id, _)| id).filter(|&id| {
            self.found.was_entered(id)
                && !self.found.was_left(id)
                && self.intended.must_be_exited(self.subject, id)
        });
        stuck.collect()
    }

    /// M14: a state that is never left and is not an END.
    fn dead_ends(&self, stuck: &[NodeId]) -> Vec<Finding> {
        let mut findings: Vec<Finding> = stuck
            .iter()
            .filter_map(|&id| {
                let state = self.found.first(|state| state.is_active(id))?;
                let message =
                    format!("`{}` is reachable and never left, but is not an END", self.subject.path(id));
                let found = self.subject.warn("M14", id, message).with_hint("see the trace");
                Some(Self::with_trace(found, &self.found.trace_to(state)))
            })
            .collect();
        findings.extend(self.standstill(stuck));
        findings
    }

    /// M14 for the whole chart: a configuration that is never left, although each of its states is
    /// left in other configurations.
    fn standstill(&self, stuck: &[NodeId]) -> Option<Finding> {
        let states = self.found.states();
        let mut moves = vec![false; states.len()];
        for edge in self.found.edges() {
            if (edge.from != edge.to || edge.does_something)
                && let Some(moves) = moves.get_mut(edge.from)
            {
                *moves = true;
            }
        }
        let is_dead = |index: &usize| {
            let state = &states[*index];
            let leaves =
                || state.configuration.iter().filter(|&&node| self.subject.chart.children(node).is_empty());
            state.status == Status::Running
                && !moves[*index]
                && !leaves().any(|node| stuck.contains(node))
                && leaves().any(|&node| self.intended.must_be_exited(self.subject, node))
        };
        let index = (0..states.len()).find(is_dead)?;
        let to_be_left = |node: &&NodeId| self.intended.must_be_exited(self.subject, **node);
        let &node = states[index].configuration.iter().find(to_be_left)?;
        let message = format!("with `{}` active, the chart can deadlock", self.subject.path(node));
        let found = self.subject.warn("M14", node, message).with_hint("see the trace");
        Some(Self::with_trace(found, &self.found.trace_to(index)))
    }

    /// M24. Consequences of other findings are not reported again.
    fn differences(&self, settings: &CheckSettings) -> Vec<Finding> {
        let Some(liveness) = &self.subject.liveness else { return Vec::new() };
        let chart = &self.subject.chart;
        let states = self.found.states().len();
        let is_stopped =
            || settings.observer.stops(ExplorationProgress { states, ..ExplorationProgress::default() });
        let (differences, is_whole) = conformance::differences(chart, self.found, liveness, &is_stopped);
        let undecided = !is_whole && self.found.is_finished() && differences.is_empty();
        let cut = self.cut_short();
        let found = differences.into_iter().map(|difference| {
            let does_more = difference.kind.is_of_what_is_done();
            // leaving a composite early cuts traces short, as intended; only differences beyond
            // that are reported
            let beyond = match does_more && !cut.is_empty() {
                true => conformance::difference_beyond(chart, self.found, liveness, cut.clone()),
                false => None,
            };
            let is_meant = does_more && !cut.is_empty() && beyond.is_none();
            self.difference(beyond.unwrap_or(difference), is_meant)
        });
        found.chain(undecided.then(|| self.undecided().into())).collect()
    }

    /// Reports that the comparison exceeded its limit.
    fn undecided(&self) -> Diagnostic {
        let message = "undecided: the chart is too large to compare its traces with its formulas";
        let found = self.subject.warn("M24", Statechart::ROOT, message.into());
        found.with_hint("check its important parts as separate roles")
    }

    fn difference(&self, difference: ConformanceDifference, is_meant: bool) -> Finding {
        let before = match difference.before.as_slice() {
            [] => String::from("at the beginning"),
            names => format!("after `{}`", names.join(" ")),
        };
        let (node, says) = match &difference.kind {
            DifferenceKind::NotAllowed(node) => (
                *node,
                format!("`{}` is executed where the formulas do not allow it", self.subject.path(*node)),
            ),
            DifferenceKind::EndsEarly => {
                (Statechart::ROOT, String::from("the chart ends where the formulas continue"))
            }
            DifferenceKind::NeverDone(name) => {
                (Statechart::ROOT, format!("the formulas allow `{name}`, but the chart never executes it"))
            }
            DifferenceKind::NeverEnds => {
                (Statechart::ROOT, String::from("the formulas may end, but the chart cannot"))
            }
            DifferenceKind::Starves(names) if names.is_empty() => {
                (Statechart::ROOT, String::from("the chart can never continue as the formulas require"))
            }
            DifferenceKind::Starves(names) => {
                let said = format!("`{}` is never executed again", names.join("` and `"));
                (Statechart::ROOT, said)
            }
        };
        let found = self.subject.warn("M24", node, format!("{before} {says}"));
        let does_more = difference.kind.is_of_what_is_done();
        // the chart followed the formulas as long as the traces last
        let ceases = matches!(difference.kind, DifferenceKind::Starves(_));
        let severity = if is_meant || ceases { Severity::Warning } else { Severity::Error };
        let hint = match (does_more, is_meant) {
            _ if ceases => "the trace closes the way back, or a state is never left",
            (true, true) => {
                "a composite is left before it has completed: use the guard `[false]` or no guard to let it complete"
            }
            (true, false) => "a transition leads where the formulas do not",
            (false, _) => "a guard or transition prevents it",
        };
        let trace = difference.trace.map(|trace| trace.to_string());
        Finding { diagnostic: Diagnostic { severity, ..found }.with_hint(hint), trace }
    }

    /// The names of the composites that the chart leaves by a guard or an event.
    fn cut_short(&self) -> BTreeSet<String> {
        let left = self.subject.chart.transitions().filter(|(id, transition)| {
            let is_composite = matches!(self.subject.kind(transition.source), NodeKind::Or | NodeKind::And);
            is_composite && !completion::waits(self.subject, *id) && self.found.was_taken(*id)
        });
        left.map(|(_, transition)| self.subject.chart.node(transition.source).name.clone()).collect()
    }

    /// M28: events of which more may wait than are distinguished.
    fn crowded_queues(&self) -> Vec<Finding> {
        let raises = |event: &str| {
            self.subject.chart.transitions().map(|(id, _)| id).find(|&id| {
                let mut actions = self.subject.transition(id).expression.actions.iter();
                actions.any(|action| matches!(&action.kind, ActionKind::Raise(path) if path.text() == event))
            })
        };
        let found = self.found.overflowing().into_iter().map(|event| {
            let message =
                format!("more than {QUEUED} `{event}` may wait to be taken: nothing bounds their number");
            let hint = "raise it only where it is waited for, or take it faster than it is raised";
            match raises(event) {
                Some(id) => self.subject.warn_of("M28", id, message).with_hint(hint).into(),
                None => self.subject.warn("M28", Statechart::ROOT, message).with_hint(hint).into(),
            }
        });
        found.collect()
    }

    /// M21: more activities at once than the pool runs.
    fn pool(&self, settings: &CheckSettings) -> Option<Finding> {
        let size = settings.pool.unwrap_or(DEFAULT_POOL_SIZE);
        let state = self.found.first(|state| state.is_exact && state.running.len() > size)?;
        let max = self.found.states().iter().map(|state| state.running.len()).max()?;
        let message = format!("up to {max} activities run at once, and the pool runs {size}");
        let found = self.subject.warn("M21", Statechart::ROOT, message);
        let found =
            found.with_hint("the others wait: give the pool more threads, or the activities priorities");
        Some(Self::with_trace(found, &self.found.trace_to(state)))
    }

    /// M26.
    fn metrics(&self, explored: &ExplorationExtent, settings: &CheckSettings) -> Diagnostic {
        let depth = self.subject.chart.nodes().map(|(id, _)| self.subject.chart.ancestors(id).count()).max();
        let bound = if explored.is_finished { "" } else { " found before the end of the search" };
        let message = format!(
            "states nest {} levels deep; {} configurations, {} states of the machine{bound}{}",
            depth.unwrap_or(0),
            explored.configurations,
            explored.states,
            self.recorded(settings)
        );
        let found = self.subject.warn("M26", Statechart::ROOT, message);
        Diagnostic { severity: Severity::Information, ..found }
    }

    /// The coverage of the chart by recordings, if there are any.
    fn recorded(&self, settings: &CheckSettings) -> String {
        let Some(recorded) = settings.recorded.iter().find(|it| it.chart == self.subject.chart) else {
            return String::new();
        };
        let is_basic = |id: &NodeId| self.subject.kind(*id) == NodeKind::Basic;
        let states: Vec<NodeId> = self.subject.chart.nodes().map(|(id, _)| id).filter(is_basic).collect();
        let possible = self.subject.chart.transitions().filter(|(_, it)| !it.expression.is_never());
        let transitions: Vec<TransitionId> = possible.map(|(id, _)| id).collect();
        format!(
            "; recordings cover {} of {} basic states and {} of {} transitions",
            states.iter().filter(|&id| recorded.entered.contains(id)).count(),
            states.len(),
            transitions.iter().filter(|&id| recorded.fired.contains(id)).count(),
            transitions.len()
        )
    }
}
