//! Charts for XState: a machine configuration, version 5, as JSON.
//!
//! Guards, actions and activities are named by their canonical text; the program that runs the
//! machine provides them under these names.
//!
//! - START: `initial`, or a state with `always` if it has guards
//! - END: `final`
//! - CONDITION, JUNCTION, FORK, JOIN, entry and exit points: no states; each path over them is one
//!   transition with the connectors in its `meta.via`
//! - CHOICE: a state with `always`
//! - TERMINATE: a `final` state of the root
//! - activity: `invoke`
//! - completion transition: `onDone`; with a guard, `always` of a state `completed` beside
//!   `working`
//! - other transition without event: `always`, or `after` if it waits only for a timer of its state

mod joins;
mod states;
mod timer_starts;
mod transitions;

use super::Exported;
use super::ids::Ids;
use super::json::JsonWriter;
use super::loss_report::LossReport;
use super::notation::refinements;
use super::outline::{TreeEvent, is_region, visits};
use timer_starts::TimerStarts;
use transitions::{ConnectorRole, ResolvedTransition, TransitionResolver, role};
use yase::expression::{Path, Trigger};
use yase::statechart::{NodeId, NodeKind, Statechart};

/// The chart as the configuration of an XState machine, for `createMachine`.
///
/// Each state has its `id` as its key; its name is in `meta`. Constants are the `context`.
pub fn to_xstate(chart: &Statechart) -> Exported {
    let mut lost = match LossReport::new(chart, "XState") {
        Ok(lost) => lost,
        Err(nothing) => return nothing,
    };
    let transitions = all_transition_paths(chart, &mut lost);
    let machine = XStateWriter {
        chart,
        ids: Ids::of(chart),
        timers: TimerStarts::of(chart),
        runs: running(chart),
        merged: merged(chart, &transitions),
        transitions,
        lost,
        writer: JsonWriter::default(),
    };
    machine.document()
}

struct XStateWriter<'a> {
    chart: &'a Statechart,
    ids: Ids,
    timers: TimerStarts<'a>,
    /// By node: whether an activity may run in it.
    runs: Vec<bool>,
    /// By node: whether it is a START expressed by its composite's `initial`.
    merged: Vec<bool>,
    /// By node.
    transitions: Vec<Vec<ResolvedTransition<'a>>>,
    lost: LossReport<'a>,
    writer: JsonWriter,
}

/// The trigger of a transition path, in XState's terms.
enum XStateTrigger {
    /// These events.
    On(Vec<String>),
    /// A delay in milliseconds, in its canonical form.
    After(String),
    /// The source has completed.
    Done,
    /// Nothing.
    Always,
}

impl XStateWriter<'_> {
    fn document(mut self) -> Exported {
        for visit in visits(self.chart) {
            match visit {
                TreeEvent::Enter(id) => self.enter(id),
                TreeEvent::Leave(id) => self.leave(id),
            }
        }
        self.lost.with(self.writer.text())
    }

    fn enter(&mut self, id: NodeId) {
        let node = self.chart.node(id);
        if self.is_state(id) {
            self.open(id);
        } else if node.kind != NodeKind::Terminate {
            let said = refinements(node).join(", ");
            if !said.is_empty() {
                self.lost.of_node(id, &format!("`{said}`"));
            }
        }
    }

    fn leave(&mut self, id: NodeId) {
        if id == Statechart::ROOT {
            let terminates = self.chart.nodes().filter(|(_, node)| node.kind == NodeKind::Terminate);
            terminates.map(|(id, _)| id).for_each(|id| self.terminate(id));
        }
        if self.is_state(id) {
            self.close(id);
        }
    }

    /// Whether a node is represented by a state.
    fn is_state(&self, id: NodeId) -> bool {
        let is_terminate = self.chart.node(id).kind == NodeKind::Terminate;
        role(self.chart, id) == ConnectorRole::Rest && !self.merged[id.0 as usize] && !is_terminate
    }

    /// The trigger of a transition path out of a node.
    fn occasion(&self, id: NodeId, transition: &ResolvedTransition<'_>) -> XStateTrigger {
        if let Some(delay) = self.timers.delay(id, transition) {
            return XStateTrigger::After((delay.as_nanos() as f64 / 1e6).to_string());
        }
        match transition.trigger() {
            Some(Trigger::OneOf(events)) => {
                return XStateTrigger::On(events.iter().map(descriptor).collect());
            }
            Some(Trigger::Any | Trigger::Not(_)) => return XStateTrigger::On(vec!["*".into()]),
            None => {}
        }
        let node = self.chart.node(id);
        let guarded = transition.segments.first().is_some_and(|first| first.expression.guard.is_some());
        let completes = match node.kind {
            NodeKind::Basic => node.activity.is_some(),
            NodeKind::Or | NodeKind::And => !guarded || transition.targets == [id],
            _ => false,
        };
        if completes && transition.joined.is_empty() { XStateTrigger::Done } else { XStateTrigger::Always }
    }

    /// Whether a path out of a node waits for a guard after the node has completed. `onDone`
    /// evaluates a guard only once.
    fn waits_when_done(&self, id: NodeId) -> bool {
        self.transitions[id.0 as usize].iter().any(|transition| {
            transition.has_guard()
                && !transition.is_never()
                && matches!(self.occasion(id, transition), XStateTrigger::Done)
        })
    }

    /// Reports where XState treats the paths out of a node differently.
    fn compare(&mut self, id: NodeId) {
        let mut any = false;
        for transition in &self.transitions[id.0 as usize] {
            let Some(first) = transition.segments.first() else { continue };
            let arrow = self.lost.arrow(first);
            if transition.segments.iter().any(|segment| segment.weight.is_some()) {
                self.lost.of_transition(first, "the weight");
            }
            match transition.trigger() {
                Some(Trigger::Any | Trigger::Not(_)) => {
                    any = true;
                    let message = format!(
                        "in XState the event `*` of {arrow} also matches the completion of states and activities"
                    );
                    self.lost.moment(message);
                }
                Some(Trigger::OneOf(_)) if any => {
                    self.lost.moment(format!(
                        "{arrow} follows a transition for any event, in XState it precedes it"
                    ));
                }
                _ => {}
            }
            if let Some(Trigger::OneOf(events)) = transition.trigger()
                && events.iter().any(|event| descriptor(event) != event.text())
            {
                self.lost.of_transition(first, "the name of an event");
            }
            if self.stops(id, transition) {
                let message =
                    format!("{arrow} waits until activities have returned, in XState it stops them");
                self.lost.moment(message);
            }
        }
        self.compare_choice(id);
    }

    /// Whether a path stops activities that YASE would wait for.
    fn stops(&self, id: NodeId, transition: &ResolvedTransition<'_>) -> bool {
        let internal = transition.segments.first().is_some_and(|first| first.internal);
        let leaves = !(internal && transition.targets == [id]) && self.runs[id.0 as usize];
        let interrupts = transition.segments.iter().any(|segment| segment.interrupts);
        leaves
            && !interrupts
            && !transition.is_never()
            && !matches!(self.occasion(id, transition), XStateTrigger::Done)
    }

    fn compare_choice(&mut self, id: NodeId) {
        let node = self.chart.node(id);
        if node.kind == NodeKind::Choice
            && self.transitions[id.0 as usize].iter().all(ResolvedTransition::has_guard)
        {
            let path = self.chart.path(id);
            self.lost.moment(format!("`{path}` without an enabled branch is an error, in XState it waits"));
        }
    }
}

/// The event descriptor of XState. A name that it would read as a pattern is kept in backquotes.
fn descriptor(event: &Path) -> String {
    let name = event.text();
    if name == "*" || name.ends_with(".*") { format!("`{name}`") } else { name }
}

/// The transition paths out of each node; their losses are recorded.
fn all_transition_paths<'a>(
    chart: &'a Statechart,
    lost: &mut LossReport<'_>,
) -> Vec<Vec<ResolvedTransition<'a>>> {
    let mut resolver = TransitionResolver::of(chart);
    let mut all = joins::joins(chart, &mut resolver, lost);
    for (id, _) in chart.nodes().filter(|&(id, _)| role(chart, id) == ConnectorRole::Rest) {
        let own = resolver.from(id, lost);
        all[id.0 as usize].splice(0..0, own);
    }
    let root_is_or = chart.node(Statechart::ROOT).kind == NodeKind::Or;
    for transitions in all.iter_mut() {
        transitions.retain(|transition| can_arrive(chart, transition, root_is_or, lost));
    }
    let mut reached = vec![false; chart.nodes().len()];
    for connector in all.iter().flatten().flat_map(|path| path.via(chart)) {
        reached[connector.0 as usize] = true;
    }
    for (id, _) in
        chart.nodes().filter(|&(id, _)| role(chart, id) != ConnectorRole::Rest && !reached[id.0 as usize])
    {
        lost.kind(id, "nothing, because no path uses it");
        for segment in resolver.outgoing(id) {
            lost.report_omitted(format!("no path uses {}", lost.arrow(segment)));
        }
    }
    all
}

fn can_arrive(
    chart: &Statechart,
    transition: &ResolvedTransition<'_>,
    root_is_or: bool,
    lost: &mut LossReport<'_>,
) -> bool {
    let wrong = transition.targets.iter().find(|&&target| match chart.node(target).kind {
        NodeKind::Start => true,
        NodeKind::Terminate => !root_is_or,
        _ => false,
    });
    let ends = transition.segments.first().filter(|first| {
        let kind = chart.node(first.source).kind;
        matches!(kind, NodeKind::End | NodeKind::Terminate)
    });
    if let (Some(&wrong), Some(first)) = (wrong, transition.segments.first()) {
        lost.report_omitted(format!("{} leads to `{}`", lost.arrow(first), chart.path(wrong)));
    }
    if let Some(first) = ends {
        lost.report_omitted(format!("{} leads out of a final state", lost.arrow(first)));
    }
    wrong.is_none() && ends.is_none()
}

/// For each node whether an activity may run in it.
fn running(chart: &Statechart) -> Vec<bool> {
    let mut runs: Vec<bool> = chart.nodes().map(|(_, node)| node.activity.is_some()).collect();
    // a parent precedes its children
    let nodes: Vec<(NodeId, Option<NodeId>)> = chart.nodes().map(|(id, node)| (id, node.parent)).collect();
    for (id, parent) in nodes.into_iter().rev() {
        if let (true, Some(parent)) = (runs[id.0 as usize], parent) {
            runs[parent.0 as usize] = true;
        }
    }
    runs
}

/// For each node whether it is a START with one path, without guard and connectors, to a sibling
/// that is a state.
fn merged(chart: &Statechart, transitions: &[Vec<ResolvedTransition<'_>>]) -> Vec<bool> {
    let plain = |id: NodeId| {
        let node = chart.node(id);
        let [transition] = transitions[id.0 as usize].as_slice() else { return false };
        let ([segment], [target]) = (transition.segments.as_slice(), transition.targets.as_slice()) else {
            return false;
        };
        let (expression, target) = (&segment.expression, chart.node(*target));
        let rests = matches!(
            target.kind,
            NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End | NodeKind::Choice
        );
        node.kind == NodeKind::Start
            && node.name.is_empty()
            && chart.children(id).is_empty()
            && target.parent == node.parent
            && rests
            && expression.trigger.is_none()
            && expression.guard.is_none()
            && !is_region(chart, transition.targets[0])
            && segment.weight.is_none()
    };
    let mut has_one = vec![false; chart.nodes().len()];
    let mut merged = vec![false; chart.nodes().len()];
    for (id, node) in chart.nodes() {
        let Some(parent) = node.parent else { continue };
        if plain(id) && !has_one[parent.0 as usize] {
            merged[id.0 as usize] = true;
        }
        has_one[parent.0 as usize] |= node.kind == NodeKind::Start;
    }
    merged
}
