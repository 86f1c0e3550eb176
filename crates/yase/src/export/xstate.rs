//! Charts for XState: a machine's configuration, version 5, as JSON.
//!
//! Guards, actions and activities are named by their canonical text; whoever runs the machine provides them under these names.
//!
//! | here | there |
//! |---|---|
//! | START | `initial`, or a state with `always` if it has guards |
//! | END | `final` |
//! | CONDITION, JUNCTION, FORK, JOIN, entry and exit points | no states: each way over them is one transition, they are in its `meta.via` |
//! | CHOICE | a state with `always` |
//! | TERMINATE | a `final` state of the root |
//! | activity | `invoke` |
//! | transition without event out of a state that has completed | `onDone`; if it has a guard, `always` of a state `completed` beside `working` |
//! | other transition without event | `always`, or `after` if it waits for nothing but a timer of this state |

mod after;
mod joins;
mod states;
mod ways;

use super::Exported;
use super::ids::Ids;
use super::json::Writer;
use super::lost::Lost;
use super::notation::refinements;
use super::outline::{Visit, is_region, visits};
use crate::expression::{Path, Trigger};
use crate::statechart::{NodeId, NodeKind, Statechart};
use after::Timers;
use ways::{Role, Way, Ways, role};

/// The chart as the configuration of an XState machine, for `createMachine`.
///
/// Each state has its `id` as its key; its name is in `meta`. Constants are the `context`.
pub fn to_xstate(chart: &Statechart) -> Exported {
    let mut lost = match Lost::new(chart, "XState") {
        Ok(lost) => lost,
        Err(nothing) => return nothing,
    };
    let ways = all_ways(chart, &mut lost);
    let machine = Machine {
        chart,
        ids: Ids::of(chart),
        timers: Timers::of(chart),
        runs: running(chart),
        merged: merged(chart, &ways),
        ways,
        lost,
        writer: Writer::default(),
    };
    machine.document()
}

struct Machine<'a> {
    chart: &'a Statechart,
    ids: Ids,
    timers: Timers<'a>,
    /// By node: whether an activity may run in it.
    runs: Vec<bool>,
    /// By node: whether it is a START that is no more than its composite's `initial`.
    merged: Vec<bool>,
    /// By node.
    ways: Vec<Vec<Way<'a>>>,
    lost: Lost<'a>,
    writer: Writer,
}

/// What makes a way happen, in XState's words.
enum Occasion {
    /// These events.
    On(Vec<String>),
    /// A delay in milliseconds, in its canonical form.
    After(String),
    /// The source has completed.
    Done,
    /// Nothing.
    Always,
}

impl Machine<'_> {
    fn document(mut self) -> Exported {
        for visit in visits(self.chart) {
            match visit {
                Visit::Enter(id) => self.enter(id),
                Visit::Leave(id) => self.leave(id),
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

    /// Whether something is a state there, where it stands.
    fn is_state(&self, id: NodeId) -> bool {
        let is_terminate = self.chart.node(id).kind == NodeKind::Terminate;
        role(self.chart, id) == Role::Rest && !self.merged[id.0 as usize] && !is_terminate
    }

    /// When a way out of a node happens.
    fn occasion(&self, id: NodeId, way: &Way<'_>) -> Occasion {
        if let Some(delay) = self.timers.delay(id, way) {
            return Occasion::After((delay.as_nanos() as f64 / 1e6).to_string());
        }
        match way.trigger() {
            Some(Trigger::OneOf(events)) => {
                return Occasion::On(events.iter().map(descriptor).collect());
            }
            Some(Trigger::Any | Trigger::Not(_)) => return Occasion::On(vec!["*".into()]),
            None => {}
        }
        let node = self.chart.node(id);
        let guarded = way.segments.first().is_some_and(|first| first.expression.guard.is_some());
        let completes = match node.kind {
            NodeKind::Basic => node.activity.is_some(),
            NodeKind::Or | NodeKind::And => !guarded || way.targets == [id],
            _ => false,
        };
        if completes && way.joined.is_empty() { Occasion::Done } else { Occasion::Always }
    }

    /// Whether a way out of a node waits for a guard after the node has completed. `onDone` reads a guard once only.
    fn waits_when_done(&self, id: NodeId) -> bool {
        self.ways[id.0 as usize]
            .iter()
            .any(|way| way.has_guard() && !way.is_never() && matches!(self.occasion(id, way), Occasion::Done))
    }

    /// Says of the ways out of a node what XState does otherwise.
    fn compare(&mut self, id: NodeId) {
        let mut any = false;
        for way in &self.ways[id.0 as usize] {
            let Some(first) = way.segments.first() else { continue };
            let arrow = self.lost.arrow(first);
            if way.segments.iter().any(|segment| segment.weight.is_some()) {
                self.lost.of_transition(first, "the weight");
            }
            match way.trigger() {
                Some(Trigger::Any | Trigger::Not(_)) => {
                    any = true;
                    let message = format!(
                        "the event `*` of {arrow} is for XState also the end of states and activities"
                    );
                    self.lost.moment(message);
                }
                Some(Trigger::OneOf(_)) if any => {
                    self.lost.moment(format!("{arrow} comes after one for any event, for XState before it"));
                }
                _ => {}
            }
            if let Some(Trigger::OneOf(events)) = way.trigger()
                && events.iter().any(|event| descriptor(event) != event.text())
            {
                self.lost.of_transition(first, "the name of an event");
            }
            if self.stops(id, way) {
                let message =
                    format!("{arrow} waits until activities have returned, for XState it stops them");
                self.lost.moment(message);
            }
        }
        self.compare_choice(id);
    }

    /// Whether a way stops activities that it would wait for here.
    fn stops(&self, id: NodeId, way: &Way<'_>) -> bool {
        let internal = way.segments.first().is_some_and(|first| first.internal);
        let leaves = !(internal && way.targets == [id]) && self.runs[id.0 as usize];
        let interrupts = way.segments.iter().any(|segment| segment.interrupts);
        leaves && !interrupts && !way.is_never() && !matches!(self.occasion(id, way), Occasion::Done)
    }

    fn compare_choice(&mut self, id: NodeId) {
        let node = self.chart.node(id);
        if node.kind == NodeKind::Choice && self.ways[id.0 as usize].iter().all(Way::has_guard) {
            let path = self.chart.path(id);
            self.lost
                .moment(format!("`{path}` without an open branch is an error, for XState it waits there"));
        }
    }
}

/// An event as XState listens for it. A name that it reads as a pattern is kept in backquotes.
fn descriptor(event: &Path) -> String {
    let name = event.text();
    if name == "*" || name.ends_with(".*") { format!("`{name}`") } else { name }
}

/// The ways out of each node; what they cannot say is noted.
fn all_ways<'a>(chart: &'a Statechart, lost: &mut Lost<'_>) -> Vec<Vec<Way<'a>>> {
    let mut ways = Ways::of(chart);
    let mut all = joins::joins(chart, &mut ways, lost);
    for (id, _) in chart.nodes().filter(|&(id, _)| role(chart, id) == Role::Rest) {
        let own = ways.from(id, lost);
        all[id.0 as usize].splice(0..0, own);
    }
    let has_place = chart.node(Statechart::ROOT).kind == NodeKind::Or;
    for way in all.iter_mut() {
        way.retain(|way| can_arrive(chart, way, has_place, lost));
    }
    let mut reached = vec![false; chart.nodes().len()];
    for connector in all.iter().flatten().flat_map(|way| way.via(chart)) {
        reached[connector.0 as usize] = true;
    }
    for (id, _) in chart.nodes().filter(|&(id, _)| role(chart, id) != Role::Rest && !reached[id.0 as usize]) {
        lost.kind(id, "nothing, as no way leads over it");
        for segment in ways.outgoing(id) {
            lost.left_out(format!("no way leads over {}", lost.arrow(segment)));
        }
    }
    all
}

fn can_arrive(chart: &Statechart, way: &Way<'_>, has_place: bool, lost: &mut Lost<'_>) -> bool {
    let wrong = way.targets.iter().find(|&&target| match chart.node(target).kind {
        NodeKind::Start => true,
        NodeKind::Terminate => !has_place,
        _ => false,
    });
    let ends = way.segments.first().filter(|first| {
        let kind = chart.node(first.source).kind;
        matches!(kind, NodeKind::End | NodeKind::Terminate)
    });
    if let (Some(&wrong), Some(first)) = (wrong, way.segments.first()) {
        lost.left_out(format!("{} leads to `{}`", lost.arrow(first), chart.path(wrong)));
    }
    if let Some(first) = ends {
        lost.left_out(format!("{} leads out of a final state", lost.arrow(first)));
    }
    wrong.is_none() && ends.is_none()
}

/// For each node whether an activity may run in it.
fn running(chart: &Statechart) -> Vec<bool> {
    let mut runs: Vec<bool> = chart.nodes().map(|(_, node)| node.activity.is_some()).collect();
    // a parent stands before its children
    let nodes: Vec<(NodeId, Option<NodeId>)> = chart.nodes().map(|(id, node)| (id, node.parent)).collect();
    for (id, parent) in nodes.into_iter().rev() {
        if let (true, Some(parent)) = (runs[id.0 as usize], parent) {
            runs[parent.0 as usize] = true;
        }
    }
    runs
}

/// For each node whether it is a START with one way, without guard and connectors, to a sibling that is a state.
fn merged(chart: &Statechart, ways: &[Vec<Way<'_>>]) -> Vec<bool> {
    let plain = |id: NodeId| {
        let node = chart.node(id);
        let [way] = ways[id.0 as usize].as_slice() else { return false };
        let ([segment], [target]) = (way.segments.as_slice(), way.targets.as_slice()) else { return false };
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
            && !is_region(chart, way.targets[0])
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
