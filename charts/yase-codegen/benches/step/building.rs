//! Time to compile charts.

use std::hint::black_box;

use yase::Statechart;
use yase::statechart::{Node, NodeId, NodeKind, Transition, TransitionId};

use crate::harness::{Contestant, Race};
use crate::ours::{connect, vocabulary};

pub(crate) fn run(race: &Race) {
    for states in [1_000, 100_000] {
        let vocabulary = vocabulary();
        let both = move || tree(states).compile(&vocabulary).expect("the chart is in order");
        let mut contestants: Vec<Box<dyn Contestant>> = vec![
            building("a tree, its texts parsed", move || tree(states)),
            building("a tree, parsed and compiled", both),
            compiling("a tree, compiled", tree(states)),
            compiling("all in one composite, compiled", wide(states)),
            compiling("the same without guards, compiled", unguarded(states)),
        ];
        race.run(&format!("charts of {states} states, ns a chart"), &mut contestants);
    }
    let mut contestants: Vec<Box<dyn Contestant>> =
        vec![compiling("one in the other, compiled", nested(1_000))];
    race.run("charts of 1000 levels, ns a chart", &mut contestants);
}

/// A construction that is timed repeatedly.
struct Building<'a, T, F> {
    name: &'a str,
    make: F,
    made: Option<T>,
}

impl<T, F: Fn() -> T> Contestant for Building<'_, T, F> {
    fn name(&self) -> &str {
        self.name
    }

    fn prepare(&mut self) {
        self.made = None;
    }

    fn run(&mut self, times: u64) {
        for _ in 0..times {
            self.made = Some(black_box((self.make)()));
        }
    }

    fn check(&self) {
        assert!(self.made.is_some());
    }
}

fn compiling(name: &str, chart: Statechart) -> Box<dyn Contestant + '_> {
    let vocabulary = vocabulary();
    building(name, move || chart.compile(&vocabulary).expect("the chart is in order"))
}

fn building<'a, T: 'a>(name: &'a str, make: impl Fn() -> T + 'a) -> Box<dyn Contestant + 'a> {
    Box::new(Building { name, make, made: None })
}

/// Composites of ten states, each state with a transition to its neighbour, each composite
/// likewise.
fn tree(states: usize) -> Statechart {
    let mut chart = Statechart::new("tree");
    let mut open = std::collections::VecDeque::from([Statechart::ROOT]);
    while chart.nodes().len() < states {
        let Some(around) = open.pop_front() else { break };
        chart.node_mut(around).kind = NodeKind::Or;
        let left = states - chart.nodes().len();
        open.extend(ring(&mut chart, around, left.min(10)));
    }
    chart
}

fn wide(states: usize) -> Statechart {
    let mut chart = Statechart::new("wide");
    ring(&mut chart, Statechart::ROOT, states);
    chart
}

fn unguarded(states: usize) -> Statechart {
    let mut chart = wide(states);
    let transitions: Vec<TransitionId> = chart.transitions().map(|(id, _)| id).collect();
    transitions.into_iter().for_each(|transition| chart.transition_mut(transition).expression.guard = None);
    chart
}

/// This many states in one composite, each with a transition to the next.
fn ring(chart: &mut Statechart, around: NodeId, states: usize) -> Vec<NodeId> {
    let start = chart.add(around, Node::new(NodeKind::Start, ""));
    let ring: Vec<NodeId> = (0..states)
        .map(|number| chart.add(around, Node::new(NodeKind::Basic, format!("s{number}"))))
        .collect();
    connect(chart, start, ring[0], "");
    for (index, &state) in ring.iter().enumerate() {
        let next = ring[(index + 1) % ring.len()];
        connect(chart, state, next, &format!("e{} [M.n > 3]", index % 10));
    }
    ring
}

fn nested(levels: usize) -> Statechart {
    let mut chart = Statechart::new("nested");
    let mut around = Statechart::ROOT;
    for level in 0..levels {
        let start = chart.add(around, Node::new(NodeKind::Start, ""));
        let kind = if level + 1 < levels { NodeKind::Or } else { NodeKind::Basic };
        let state = chart.add(around, Node::new(kind, "s"));
        connect(&mut chart, start, state, "");
        chart.connect(Transition::new(state, state));
        around = state;
    }
    chart
}
