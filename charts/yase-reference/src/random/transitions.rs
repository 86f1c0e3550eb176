//! The transitions of a random chart.

use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

use super::Maker;
use super::expressions::parse;

fn is_state(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic)
}

fn is_history(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::ShallowHistory | NodeKind::DeepHistory)
}

/// Whether a node is a border node through which transitions enter a composite.
fn is_border(kind: NodeKind) -> bool {
    is_history(kind) || kind == NodeKind::EntryPoint
}

fn is_branch(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Condition | NodeKind::Junction | NodeKind::Choice)
}

impl Maker<'_, '_> {
    pub(crate) fn transitions(&mut self) {
        let nodes: Vec<NodeId> = self.chart.nodes().map(|(id, _)| id).collect();
        for &node in nodes.iter().skip(1) {
            match self.kind(node) {
                NodeKind::Start => self.out_of_start(node),
                kind if is_branch(kind) => self.out_of_branch(node),
                NodeKind::Fork => self.out_of_fork(node),
                NodeKind::Join => self.around_join(node),
                NodeKind::ShallowHistory | NodeKind::DeepHistory => self.out_of_history(node),
                NodeKind::EntryPoint => self.out_of_entry(node),
                NodeKind::ExitPoint => self.out_of_exit(node),
                NodeKind::Or | NodeKind::And | NodeKind::Basic => {
                    let short = self.short.contains(&self.parent(node));
                    for _ in 0..if short { self.choices.below(2) } else { 1 + self.choices.below(4) } {
                        self.out_of_state(node, &nodes);
                    }
                    self.towards_ends(node);
                }
                _ => {}
            }
        }
    }

    fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    fn children(&self, parent: NodeId, wanted: impl Fn(NodeKind) -> bool) -> Vec<NodeId> {
        self.chart.children(parent).iter().copied().filter(|&child| wanted(self.kind(child))).collect()
    }

    fn inside(&self, outer: NodeId, wanted: impl Fn(NodeKind) -> bool) -> Vec<NodeId> {
        let all = self.chart.nodes().map(|(id, _)| id);
        all.filter(|&node| self.is_inside(node, outer) && wanted(self.kind(node))).collect()
    }

    fn out_of_start(&mut self, start: NodeId) {
        let parent = self.parent(start);
        let all = self.children(parent, |kind| {
            let never = [NodeKind::Start, NodeKind::Join, NodeKind::End, NodeKind::ExitPoint];
            !never.contains(&kind) && kind != NodeKind::EntryPoint
        });
        if self.choices.percent(25) {
            let target = self.near_or_deep(parent, &all);
            let text = format!("{} {}", self.guard(), self.slash_actions(20));
            self.connect(start, target, &text);
        }
        if !self.choices.percent(5) {
            let ends = self.children(parent, |kind| kind == NodeKind::End);
            let target = match ends.first() {
                Some(&end) if self.choices.percent(8) => end,
                _ => self.near_or_deep(parent, &all),
            };
            let text = self.slash_actions(20);
            self.connect(start, target, &text);
        }
    }

    /// Mostly one of the given nodes, sometimes a descendant of the composite.
    fn near_or_deep(&mut self, composite: NodeId, near: &[NodeId]) -> NodeId {
        if self.choices.percent(12) {
            let deep = self.inside(composite, |kind| is_state(kind) || is_history(kind));
            let deep: Vec<NodeId> = deep.into_iter().filter(|&node| self.parent(node) != composite).collect();
            if !deep.is_empty() {
                return self.choices.pick(&deep);
            }
        }
        self.choices.pick(near)
    }

    /// Adds two transitions to siblings, not to preceding connectors, so that connectors form no
    /// cycle.
    fn out_of_branch(&mut self, connector: NodeId) {
        let all = self.children(self.parent(connector), |kind| {
            is_state(kind)
                || is_history(kind)
                || matches!(kind, NodeKind::End | NodeKind::Terminate | NodeKind::Fork)
        });
        let later = self.children(self.parent(connector), is_branch);
        let all: Vec<NodeId> =
            all.into_iter().chain(later.into_iter().filter(|&other| other > connector)).collect();
        let first = self.choices.pick(&all);
        let text = format!("{} {}", self.guard(), self.slash_actions(40));
        self.connect(connector, first, &text);
        let second = self.choices.pick(&all);
        let percent = if self.kind(connector) == NodeKind::Choice { 3 } else { 10 };
        let guard = match self.choices.percent(percent) {
            true => self.guard(), // possibly no path is enabled
            false => String::new(),
        };
        let text = format!("{guard} {}", self.slash_actions(20));
        self.connect(connector, second, &text);
    }

    /// Adds transitions to two or more regions of an AND in the same composite.
    fn out_of_fork(&mut self, fork: NodeId) {
        let ands = self.inside(self.parent(fork), |kind| kind == NodeKind::And);
        let and = self.choices.pick(&ands);
        self.fork_regions(fork, and);
    }

    fn fork_regions(&mut self, source: NodeId, and: NodeId) {
        let regions = self.children(and, is_state);
        let skipped = if regions.len() > 2 && self.choices.percent(40) { self.choices.below(3) } else { 99 };
        for (index, region) in regions.into_iter().enumerate() {
            if index != skipped {
                let inside =
                    self.inside(region, |kind| is_state(kind) || is_history(kind) || kind == NodeKind::End);
                let target = match inside.is_empty() || self.choices.percent(10) {
                    true => region,
                    false => self.choices.pick(&inside),
                };
                let text = self.slash_actions(25);
                self.connect(source, target, &text);
            }
        }
    }

    /// Adds transitions from two or more regions of an AND in the same composite, and one to a
    /// sibling.
    fn around_join(&mut self, join: NodeId) {
        let ands = self.inside(self.parent(join), |kind| kind == NodeKind::And);
        let and = self.choices.pick(&ands);
        let regions = self.children(and, is_state);
        let skipped = if regions.len() > 2 && self.choices.percent(40) { self.choices.below(3) } else { 99 };
        for (index, region) in regions.into_iter().enumerate() {
            if index != skipped {
                let inside = match self.choices.percent(60) {
                    true => self.children(region, |kind| kind == NodeKind::Basic),
                    false => self.inside(region, is_state),
                };
                let whole = self.choices.percent(20);
                let source = match inside.is_empty() || whole {
                    true => region,
                    false => self.choices.pick(&inside),
                };
                let guard = if self.choices.percent(15) { self.guard() } else { String::new() };
                let text = format!("{guard} {}", self.slash_actions(25));
                self.connect(source, join, &text);
            }
        }
        let targets = self.children(self.parent(join), |kind| {
            let connectors = [NodeKind::Choice, NodeKind::Junction, NodeKind::Terminate];
            is_state(kind) || kind == NodeKind::End || connectors.contains(&kind)
        });
        let target = self.choices.pick(&targets);
        let text = self.slash_actions(40);
        self.connect(join, target, &text);
    }

    /// Adds a default to a history. Without one, or if its guard is false, a history leads to
    /// START; if START leads to the history, the chart stays at START.
    fn out_of_history(&mut self, history: NodeId) {
        if self.choices.percent(50) {
            let inside = self.inside(self.parent(history), |kind| is_state(kind) || kind == NodeKind::End);
            let target = self.choices.pick(&inside);
            let guard = if self.choices.percent(20) { self.guard() } else { String::new() };
            let text = format!("{guard} {}", self.slash_actions(40));
            self.connect(history, target, &text);
        }
    }

    fn out_of_entry(&mut self, point: NodeId) {
        if self.makes_uml() && self.choices.percent(25) {
            return;
        }
        let around = self.parent(point);
        if self.kind(around) == NodeKind::And && self.choices.percent(70) {
            return self.fork_regions(point, around);
        }
        let inside = self.inside(around, |kind| is_state(kind) || is_history(kind) || kind == NodeKind::End);
        self.branches(point, &inside);
    }

    fn out_of_exit(&mut self, point: NodeId) {
        let around = self.parent(self.parent(point));
        let outside = self.children(around, |kind| is_state(kind) || kind == NodeKind::End);
        self.branches(point, &outside);
        let owner = self.parent(point);
        if self.kind(owner) == NodeKind::And && self.choices.percent(60) {
            self.regions_to_exit(owner, point);
        }
        if self.makes_uml() && self.choices.percent(20) {
            let text = format!("{} {}", self.trigger(), self.slash_actions(30));
            let mut transition = Transition::new(owner, point);
            transition.internal = self.choices.percent(70);
            transition.expression = parse(&text);
            self.chart.connect(transition);
        }
    }

    /// Adds a transition from a state in each region of an AND, sometimes with an event.
    fn regions_to_exit(&mut self, and: NodeId, point: NodeId) {
        for region in self.children(and, is_state) {
            let inside = self.inside(region, |kind| kind == NodeKind::Basic);
            let source = if inside.is_empty() { region } else { self.choices.pick(&inside) };
            let trigger = if self.choices.percent(50) { self.trigger() } else { String::new() };
            let text = format!("{trigger} {}", self.slash_actions(30));
            self.connect(source, point, &text);
        }
    }

    fn branches(&mut self, source: NodeId, targets: &[NodeId]) {
        if self.choices.percent(40) {
            let target = self.choices.pick(targets);
            let text = format!("{} {}", self.guard(), self.slash_actions(30));
            self.connect(source, target, &text);
        }
        let target = self.choices.pick(targets);
        let text = self.slash_actions(30);
        self.connect(source, target, &text);
    }

    fn out_of_state(&mut self, node: NodeId, nodes: &[NodeId]) {
        let near = self.children(self.parent(node), |kind| kind != NodeKind::Start);
        let borders: Vec<NodeId> =
            near.iter().flat_map(|&sibling| self.children(sibling, is_border)).collect();
        let target = match self.choices.below(8) {
            0..2 => self.choices.pick(nodes),
            2 if !borders.is_empty() => self.choices.pick(&borders),
            _ => self.choices.pick(&near),
        };
        let internal = self.choices.percent(8);
        let target = if internal { self.local_target(node) } else { target };
        if !internal && !self.is_legal(node, target) {
            return;
        }
        let mut text = self.trigger();
        let onward = self.leads_on(node, target) && !self.is_hasty();
        if text.is_empty() && (!onward || self.choices.percent(30)) {
            text += &self.passing_guard();
        } else if text.is_empty() && self.chart.node(node).activity.is_none() || self.choices.percent(40) {
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

    /// Whether a chart that has only transitions of this kind becomes stable.
    fn leads_on(&self, source: NodeId, target: NodeId) -> bool {
        let region = self.kind(self.parent(source)) == NodeKind::And;
        let border = is_border(self.kind(target)) || is_branch(self.kind(target));
        target > source && !self.is_inside(target, source) && !region && !border
    }

    /// Sometimes adds a transition to END from a BASIC state or a completed composite.
    fn towards_ends(&mut self, node: NodeId) {
        let composite = self.kind(node) != NodeKind::Basic;
        let wanted = if composite { is_state } else { |kind: NodeKind| kind == NodeKind::End };
        let mut targets = self.children(self.parent(node), wanted);
        targets.retain(|&target| self.leads_on(node, target));
        let percent = if self.short.contains(&self.parent(node)) { 100 } else { 30 };
        if !targets.is_empty() && (percent == 100 || !self.is_hasty()) && self.choices.percent(percent) {
            let target = self.choices.pick(&targets);
            let text = self.slash_actions(20);
            self.connect(node, target, &text);
        }
    }

    /// The node or one of its descendants.
    fn local_target(&mut self, node: NodeId) -> NodeId {
        let inside = self.inside(node, is_state);
        match inside.is_empty() || self.choices.percent(40) {
            true => node,
            false => self.choices.pick(&inside),
        }
    }

    fn connect(&mut self, source: NodeId, target: NodeId, text: &str) {
        let mut transition = Transition::new(source, target);
        transition.expression = parse(text);
        self.chart.connect(transition);
    }

    /// Whether a target is legal: connectors are reached only from their own composite, border
    /// points from their side.
    fn is_legal(&self, source: NodeId, target: NodeId) -> bool {
        let same = self.parent(source) == self.parent(target);
        let owner = self.parent(target);
        match self.kind(target) {
            _ if target == Statechart::ROOT => false,
            NodeKind::Start | NodeKind::Join => false,
            NodeKind::Condition | NodeKind::Junction | NodeKind::Choice | NodeKind::Fork => same,
            NodeKind::EntryPoint => source != owner && !self.is_inside(source, owner),
            NodeKind::ExitPoint => self.is_inside(source, owner),
            _ => true,
        }
    }

    /// Whether a source is legal: sources of connectors lie in the same composite, sources of
    /// border points on their side.
    pub(crate) fn weights(&mut self) {
        let nodes: Vec<NodeId> = self.chart.nodes().map(|(id, _)| id).collect();
        for node in nodes {
            let transitions = self.chart.transitions();
            let mut out: Vec<_> = transitions.filter(|(_, it)| it.source == node).map(|(id, _)| id).collect();
            out.retain(|&id| self.kind(self.chart.transition(id).target) != NodeKind::Join);
            // all transitions out of a FORK are taken, also those of forking border points of ANDs
            let forks = self.kind(node) == NodeKind::Fork
                || self.kind(node) == NodeKind::EntryPoint && self.kind(self.parent(node)) == NodeKind::And;
            let percent = if is_state(self.kind(node)) { 10 } else { 20 };
            if out.len() < 2 || forks || !self.choices.percent(percent) {
                continue;
            }
            let shares: &[f64] = match out.len() {
                2 => self.choices.pick(&[&[0.5, 0.5], &[0.25, 0.75]]),
                _ => self.choices.pick(&[&[0.5, 0.5], &[0.25, 0.25, 0.5]]),
            };
            for (&id, &share) in out.iter().zip(shares) {
                self.chart.transition_mut(id).weight = Some(share);
            }
        }
    }
}
