//! The nodes of a random chart.

use std::time::Duration;

use yase::expression::parse_actions;
use yase::statechart::{Node, NodeId, NodeKind};

use super::Maker;

/// Charts with this many nodes get no more composites.
const MAX_NODES_FOR_COMPOSITES: usize = 28;

impl Maker<'_, '_> {
    /// Adds the children of an OR.
    pub(crate) fn composite(&mut self, composite: NodeId, depth: usize) {
        let without = depth > 0 && self.makes_uml() && self.choices.percent(12);
        if !without {
            self.chart.add(composite, Node::new(NodeKind::Start, ""));
        }
        for _ in 0..2 + self.choices.below(3) {
            self.state(composite, depth);
        }
        for _ in 0..self.choices.pick(&[0, 0, 0, 1, 1, 2]) {
            let kinds = [NodeKind::Condition, NodeKind::Junction, NodeKind::Choice];
            let kind = self.choices.pick(&kinds[..if self.has_choices() { 3 } else { 2 }]);
            self.named(composite, kind, "c");
        }
        self.around_ands(composite);
        if depth > 0 {
            self.borders(composite);
        }
        if self.choices.percent(70) {
            self.chart.add(composite, Node::new(NodeKind::End, ""));
        }
        if self.choices.percent(8) {
            self.named(composite, NodeKind::End, "end");
        }
        if self.choices.percent(4) {
            self.named(composite, NodeKind::Terminate, "x");
        }
    }

    fn named(&mut self, parent: NodeId, kind: NodeKind, prefix: &str) {
        let name = self.name(prefix);
        let mut node = Node::new(kind, name);
        if kind == NodeKind::End && self.choices.percent(50) {
            node.entry = parse_actions(&self.actions()).0;
        }
        self.chart.add(parent, node);
    }

    /// Adds FORK and JOIN for an AND.
    fn around_ands(&mut self, composite: NodeId) {
        let and = |maker: &Self, node: NodeId| maker.chart.node(node).kind == NodeKind::And;
        let ands: Vec<NodeId> =
            self.chart.children(composite).iter().copied().filter(|&node| and(self, node)).collect();
        if !ands.is_empty() && self.choices.percent(60) {
            self.named(composite, NodeKind::Fork, "f");
        }
        if !ands.is_empty() && self.choices.percent(60) {
            self.named(composite, NodeKind::Join, "j");
        }
    }

    /// Adds entry points, exit points and a history to a composite.
    fn borders(&mut self, composite: NodeId) {
        for (kind, prefix, percent) in [
            (NodeKind::ShallowHistory, "h", 15),
            (NodeKind::DeepHistory, "hh", 15),
            (NodeKind::EntryPoint, "in", 12),
            (NodeKind::ExitPoint, "out", 12),
        ] {
            if self.choices.percent(percent) {
                self.named(composite, kind, prefix);
            }
        }
    }

    fn state(&mut self, parent: NodeId, depth: usize) {
        let kind = match self.choices.below(10) {
            5..7 if depth < 4 && self.names < MAX_NODES_FOR_COMPOSITES => NodeKind::Or,
            7.. if depth < 3 && self.names < MAX_NODES_FOR_COMPOSITES => NodeKind::And,
            _ => NodeKind::Basic,
        };
        self.state_of(parent, kind, "s", depth);
    }

    fn state_of(&mut self, parent: NodeId, kind: NodeKind, prefix: &str, depth: usize) {
        let name = self.name(prefix);
        let mut node = Node::new(kind, name);
        if kind == NodeKind::Basic && self.choices.percent(45) {
            let name = self.choices.pick(&["work", "work", "work", "ongoing", "failing"]);
            node.activity = Some(self.name(name));
            node.duration = Some(Duration::from_millis(self.choices.pick(&[20, 0, 10, 35])));
        }
        let is_composite = kind != NodeKind::Basic && self.chart.node(parent).kind != NodeKind::And;
        if is_composite && self.makes_uml() && self.choices.percent(15) {
            let name = self.choices.pick(&["work", "ongoing", "failing"]);
            node.activity = Some(self.name(name));
            node.duration = Some(Duration::from_millis(self.choices.pick(&[20, 0, 10])));
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
            NodeKind::And => self.regions(id, depth + 1),
            _ => {}
        }
    }

    /// Adds the regions of an AND: mostly ORs, but any state is possible.
    fn regions(&mut self, and: NodeId, depth: usize) {
        for _ in 0..2 + self.choices.below(2) {
            let kind = match self.choices.below(12) {
                0 => NodeKind::Basic,
                1 if depth < 3 && self.names < MAX_NODES_FOR_COMPOSITES => NodeKind::And,
                _ => NodeKind::Or,
            };
            match kind == NodeKind::Or && self.choices.percent(35) {
                true => self.short_region(and, depth),
                false => self.state_of(and, kind, "r", depth),
            }
        }
        self.borders(and);
    }

    /// Adds a region that completes early: one state and END.
    fn short_region(&mut self, and: NodeId, depth: usize) {
        let name = self.name("r");
        let region = self.chart.add(and, Node::new(NodeKind::Or, name));
        self.chart.add(region, Node::new(NodeKind::Start, ""));
        self.state_of(region, NodeKind::Basic, "s", depth + 1);
        self.chart.add(region, Node::new(NodeKind::End, ""));
        self.short.push(region);
    }
}
