//! Random charts and scripts, made from a row of random bytes; the shorter the row, the smaller what comes out.

use std::time::Duration;

use yase::TopicId;
use yase::expression::{parse_actions, parse_transition};
use yase::statechart::{Node, NodeId, NodeKind, Statechart, Transition};

use crate::kit::script::{Input, Script};

/// A chart with so many nodes gets no more composites.
const MANY: usize = 25;

/// Random choices out of bytes; when they have run out, always the first.
pub(crate) struct Choices<'a> {
    bytes: std::slice::Iter<'a, u8>,
}

impl<'a> Choices<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Choices<'a> {
        Choices { bytes: bytes.iter() }
    }

    /// A number below `count`.
    fn below(&mut self, count: usize) -> usize {
        usize::from(self.bytes.next().copied().unwrap_or(0)) % count
    }

    fn percent(&mut self, percent: usize) -> bool {
        self.below(100) >= 100 - percent
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}

/// A chart and what happens to it.
pub(crate) fn case(choices: &mut Choices<'_>) -> (Statechart, Script) {
    let script = script(choices);
    let mut maker = Maker { chart: Statechart::new("c"), choices, names: 0, timers: 0 };
    maker.composite(Statechart::ROOT, 0);
    maker.transitions();
    (maker.chart, script)
}

fn script(choices: &mut Choices<'_>) -> Script {
    let mut inputs: Vec<(u64, Input)> = (0..8 + choices.below(24))
        .map(|_| {
            let time = 5 * choices.below(30) as u64;
            let input = match choices.below(4) {
                0 => Input::Message(TopicId(choices.below(3) as u32), choices.below(4) as i64),
                _ => Input::Event(choices.pick(&["e", "f", "g", "h"]).to_owned()),
            };
            (time, input)
        })
        .collect();
    inputs.sort_by_key(|(time, _)| *time);
    Script { inputs, until: 200 }
}

struct Maker<'a, 'b> {
    chart: Statechart,
    choices: &'a mut Choices<'b>,
    names: usize,
    timers: usize,
}

impl Maker<'_, '_> {
    fn name(&mut self, prefix: &str) -> String {
        self.names += 1;
        format!("{prefix}{}", self.names)
    }

    fn composite(&mut self, composite: NodeId, depth: usize) {
        self.chart.add(composite, Node::new(NodeKind::Start, ""));
        for _ in 0..2 + self.choices.below(3) {
            self.state(composite, depth);
        }
        for _ in 0..self.choices.below(2) {
            let kind = self.choices.pick(&[NodeKind::Condition, NodeKind::Junction]);
            let name = self.name("c");
            self.chart.add(composite, Node::new(kind, name));
        }
        if self.choices.percent(70) {
            self.chart.add(composite, Node::new(NodeKind::End, ""));
        }
        if self.choices.percent(4) {
            let name = self.name("x");
            self.chart.add(composite, Node::new(NodeKind::Terminate, name));
        }
    }

    fn state(&mut self, parent: NodeId, depth: usize) {
        let kind = match self.choices.below(10) {
            0..5 => NodeKind::Basic,
            5..7 if depth < 4 && self.names < MANY => NodeKind::Or,
            7.. if depth < 3 && self.names < MANY => NodeKind::And,
            _ => NodeKind::Basic,
        };
        let name = self.name("s");
        let mut node = Node::new(kind, name);
        if kind == NodeKind::Basic && self.choices.percent(50) {
            let name = self.choices.pick(&["work", "work", "work", "ongoing", "failing"]);
            node.activity = Some(self.name(name));
            node.duration = Some(Duration::from_millis(self.choices.pick(&[20, 0, 10, 35])));
        }
        if self.choices.percent(15) {
            node.entry = parse_actions(&self.actions()).0;
        }
        if self.choices.percent(15) {
            node.exit = parse_actions(&self.actions()).0;
        }
        if self.choices.percent(12) {
            node.defer = vec![self.choices.pick(&["e", "f", "g"]).to_owned()];
        }
        let id = self.chart.add(parent, node);
        match kind {
            NodeKind::Or => self.composite(id, depth + 1),
            NodeKind::And => {
                for _ in 0..2 + self.choices.below(2) {
                    let name = self.name("r");
                    let region = self.chart.add(id, Node::new(NodeKind::Or, name));
                    self.composite(region, depth + 1);
                }
            }
            _ => {}
        }
    }

    fn transitions(&mut self) {
        let nodes: Vec<NodeId> = self.chart.nodes().map(|(id, _)| id).collect();
        for &node in nodes.iter().skip(1) {
            match self.chart.node(node).kind {
                NodeKind::Start => self.out_of_start(node),
                NodeKind::Condition | NodeKind::Junction => self.out_of_connector(node),
                NodeKind::Or | NodeKind::And | NodeKind::Basic => {
                    for _ in 0..1 + self.choices.below(4) {
                        self.out_of_state(node, &nodes);
                    }
                }
                _ => {}
            }
        }
    }

    fn siblings(&self, node: NodeId, wanted: impl Fn(NodeKind) -> bool) -> Vec<NodeId> {
        let parent = self.chart.node(node).parent.unwrap();
        let children = self.chart.children(parent).iter().copied();
        children.filter(|&child| wanted(self.chart.node(child).kind)).collect()
    }

    fn out_of_start(&mut self, start: NodeId) {
        let all = self.siblings(start, |kind| match kind {
            NodeKind::Start | NodeKind::Terminate => false,
            NodeKind::End => self.choices.bytes.len().is_multiple_of(8),
            _ => true,
        });
        if self.choices.percent(25) {
            let target = self.choices.pick(&all);
            let text = format!("{} {}", self.guard(), self.slash_actions(20));
            self.connect(start, target, &text);
        }
        if !self.choices.percent(5) {
            let target = self.choices.pick(&all);
            let text = self.slash_actions(20);
            self.connect(start, target, &text);
        }
    }

    /// Two ways to siblings, so that connectors never lead in a circle.
    fn out_of_connector(&mut self, connector: NodeId) {
        let all = self.siblings(connector, |kind| {
            !matches!(kind, NodeKind::Start | NodeKind::Condition | NodeKind::Junction)
        });
        let first = self.choices.pick(&all);
        let text = format!("{} {}", self.guard(), self.slash_actions(40));
        self.connect(connector, first, &text);
        let second = self.choices.pick(&all);
        let text = self.slash_actions(20);
        self.connect(connector, second, &text);
    }

    fn out_of_state(&mut self, node: NodeId, nodes: &[NodeId]) {
        let parent = self.chart.node(node).parent.unwrap();
        let is_region = self.chart.node(parent).kind == NodeKind::And;
        let near = self.siblings(node, |kind| kind != NodeKind::Start);
        let target = match is_region || self.choices.percent(20) {
            true => self.choices.pick(nodes),
            false => self.choices.pick(&near),
        };
        let internal = self.choices.percent(8);
        let target = if internal { node } else { target };
        if !internal && !self.is_legal(node, target) {
            return;
        }
        let mut text = self.trigger();
        if text.is_empty() && self.chart.node(node).activity.is_none() || self.choices.percent(40) {
            text += &self.guard();
        }
        text += &self.slash_actions(30);
        let mut transition = Transition::new(node, target);
        transition.internal = internal;
        transition.interrupts = self.choices.percent(10);
        transition.priority = self.choices.pick(&[0, 0, 0, 1, -1]);
        transition.expression = parse(&text);
        self.chart.connect(transition);
    }

    fn connect(&mut self, source: NodeId, target: NodeId, text: &str) {
        let mut transition = Transition::new(source, target);
        transition.expression = parse(text);
        self.chart.connect(transition);
    }

    /// Not into START or the root, not from one region to another of the same AND, not from a connector's ways out of its composite.
    fn is_legal(&self, source: NodeId, target: NodeId) -> bool {
        let chart = &self.chart;
        let kind = chart.node(target).kind;
        if target == Statechart::ROOT || kind == NodeKind::Start {
            return false;
        }
        let connector = matches!(kind, NodeKind::Condition | NodeKind::Junction);
        if connector && chart.node(source).parent != chart.node(target).parent {
            return false;
        }
        let inside =
            |node: NodeId, outer: NodeId| node == outer || chart.ancestors(node).any(|above| above == outer);
        let common = chart.ancestors(source).find(|&above| target != above && inside(target, above));
        let across = common.is_some_and(|common| chart.node(common).kind == NodeKind::And);
        !across || inside(source, target) || inside(target, source)
    }

    fn trigger(&mut self) -> String {
        let timer = format!("v{}", self.choices.below(4));
        match self.choices.below(12) {
            0..4 => String::new(),
            4..7 => self.choices.pick(&["e", "f", "g"]).to_owned(),
            7 => "e | g".to_owned(),
            8 => "not e".to_owned(),
            9 => "*".to_owned(),
            10 => "A".to_owned(),
            _ => timer,
        }
    }

    /// A guard; a timer in it is started by the transition itself, so that it is one of its blackboard.
    fn guard(&mut self) -> String {
        let message = self.choices.pick(&["A", "B", "C"]);
        let number = self.choices.below(4);
        match self.choices.below(12) {
            0 => format!(" [{message}.n < {number}]"),
            1 => format!(" [{message}.n == {number}]"),
            2 => format!(" [!({message}.n > {number})]"),
            3 => format!(" [{message} == NULL]"),
            4 => format!(" [{message} != NULL && {message}.n != {number}]"),
            5 => " [false]".to_owned(),
            6 => " [true]".to_owned(),
            7 => format!(" [{message}.n < fail() || B.n > 0]"),
            8 => self.timed("v"),
            9 => self.timed("TimeoutCheck(v)"),
            10 => self.timed("v && A.n >= 1"),
            _ => format!(" [In({})]", self.some_state()),
        }
    }

    fn timed(&mut self, form: &str) -> String {
        self.timers += 1;
        let timer = format!("v{}", self.timers % 4);
        let delay = self.choices.pick(&[20, 10, 30]);
        format!(" [{}] / StartTimeout({timer}, {delay}ms)", form.replace('v', &timer))
    }

    fn some_state(&mut self) -> String {
        let named: Vec<NodeId> = self
            .chart
            .nodes()
            .filter(|(_, node)| {
                matches!(node.kind, NodeKind::Basic | NodeKind::Or | NodeKind::And) && node.name != "c"
            })
            .map(|(id, _)| id)
            .collect();
        let node = self.choices.pick(&named);
        self.chart.node(node).name.clone()
    }

    fn slash_actions(&mut self, percent: usize) -> String {
        if self.choices.percent(percent) { format!(" / {}", self.actions()) } else { String::new() }
    }

    fn actions(&mut self) -> String {
        let count = 1 + self.choices.below(2);
        (0..count).map(|_| self.action()).collect::<Vec<_>>().join(", ")
    }

    fn action(&mut self) -> String {
        let message = self.choices.pick(&["A", "B", "C"]);
        match self.choices.below(9) {
            0 => format!("raise({})", self.choices.pick(&["f", "g", "e"])),
            1 => format!("{message}.n = {}", self.choices.below(4)),
            2 => format!("{message}.n = {message}.n + 1"),
            3 => format!("StartTimeout(v{}, {}ms)", self.choices.below(4), self.choices.pick(&[10, 25])),
            4 => "process_messages".to_owned(),
            5 => "publish_all".to_owned(),
            6 => format!("publish.{message}"),
            7 => format!("{message}.n = 2000000"),
            _ => format!("B.n = {message}.n"),
        }
    }
}

/// Two parts may both bring actions.
fn parse(text: &str) -> yase::expression::TransitionExpression {
    let mut parts = text.split(" / ");
    let head = parts.next().unwrap_or_default();
    let actions: Vec<&str> = parts.collect();
    let text = match actions.is_empty() {
        true => head.to_owned(),
        false => format!("{head} / {}", actions.join(", ")),
    };
    let (expression, found) = parse_transition(&text);
    assert!(found.is_empty(), "{text}: {found:?}");
    expression
}
