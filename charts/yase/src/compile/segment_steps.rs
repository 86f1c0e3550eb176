//! The effects of a path, segment by segment.
//!
//! A segment leaves the states up to the boundary that it crosses, and enters those around its
//! target. The boundary is the scope of the segment: the lowest OR around both its ends, or the
//! composite of an exit point or entry point that stands on it.

use crate::compile::build::ChartCompiler;
use crate::compile::compound_transitions::{CompoundPath, ConfigurationChange, PathEnd};
use crate::compile::node_span::{self, NodeSpan};
use crate::compile::{NodeIndex, SegmentStep, TransitionTarget};
use crate::expression::Effect;
use crate::semantics::{Firing, TerminateExit};
use crate::statechart::{NodeId, NodeKind, Statechart, Transition, TransitionId};

/// A segment of a path under examination.
struct PathSegment<'a> {
    path: &'a CompoundPath,
    /// Its index in the path.
    index: usize,
    transition: &'a Transition,
}

impl ChartCompiler<'_> {
    /// The steps of a path; none if it is taken as a whole.
    pub(crate) fn steps(
        &self,
        path: &CompoundPath,
        effects: &[(TransitionId, Box<[Effect]>)],
    ) -> Box<[SegmentStep]> {
        if self.semantics.firing != Firing::EachSegment {
            return Box::default();
        }
        let mut ends = path.leaves.iter().copied();
        let mut steps = Vec::with_capacity(path.segments.len());
        for (index, &id) in path.segments.iter().enumerate() {
            let segment = PathSegment { path, index, transition: self.chart.transition(id) };
            let mut step = self.step(&segment, &mut ends);
            step.effects = effects.iter().position(|(other, _)| *other == id);
            steps.push(step);
        }
        steps.into()
    }

    fn step(&self, segment: &PathSegment<'_>, ends: &mut dyn Iterator<Item = PathEnd>) -> SegmentStep {
        let (path, target) = (segment.path, segment.transition.target);
        let mut step = SegmentStep {
            exits: None,
            empties_composite: false,
            effects: None,
            enters: Box::default(),
            end: None,
        };
        let is_last = segment.index + 1 == path.segments.len();
        match path.change {
            ConfigurationChange::Vacates if is_last => {
                step.exits = self.inside(self.layout.index_of(path.scope));
                return step;
            }
            ConfigurationChange::None if path.leaves[..] == [PathEnd::Node(path.source)] => return step,
            _ => {}
        }
        if self.waits_for_others(segment) {
            let region =
                path.others.iter().chain([&path.source]).find(|&&node| node == segment.transition.source);
            let around = self.around_sources(path);
            let region = region.and_then(|&node| node_span::child_towards(self.chart, around, node));
            step.exits = region.and_then(|region| self.inside(self.layout.index_of(region)));
            return step;
        }
        if self.kind(target) == NodeKind::Terminate && self.semantics.terminate == TerminateExit::Nothing {
            step.end = ends.next().map(|end| self.leaf(end));
            return step;
        }
        // a transition from an entry point to its own composite ends where that was entered
        let source = segment.transition.source;
        if self.kind(source) == NodeKind::EntryPoint && self.parent(source) == target {
            ends.next();
            return step;
        }
        let boundary = self.boundary(segment);
        step.exits = self.exits(segment, boundary);
        step.empties_composite = self.kind(target) == NodeKind::ExitPoint && self.parent(target) == boundary;
        let (around, entered) = match self.kind(target) {
            NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End | NodeKind::Start => {
                (Some(target), ends.next().map(|end| self.leaf(end)))
            }
            NodeKind::ShallowHistory | NodeKind::DeepHistory => {
                (self.chart.node(target).parent, ends.next().map(|end| self.leaf(end)))
            }
            NodeKind::EntryPoint if self.stands_for_composite(target) => {
                (self.chart.node(target).parent, ends.next().map(|end| self.leaf(end)))
            }
            NodeKind::EntryPoint if !self.leads_inside(segment) => {
                let composite = self.parent(target);
                (Some(composite), Some(TransitionTarget::Node(self.layout.index_of(composite))))
            }
            NodeKind::Choice | NodeKind::Terminate => {
                (Some(self.position(target)), ends.next().map(|end| self.leaf(end)))
            }
            NodeKind::Join if self.contains(self.around_sources(path), target) => (None, None),
            _ => (Some(self.position(target)), None),
        };
        step.enters = around.map(|node| self.down_to(boundary, node)).unwrap_or_default();
        step.end = entered;
        step
    }

    fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    fn parent(&self, node: NodeId) -> NodeId {
        self.chart.node(node).parent.unwrap_or(Statechart::ROOT)
    }

    fn contains(&self, outer: NodeId, inner: NodeId) -> bool {
        outer != inner && self.layout.contains(self.layout.index_of(outer), self.layout.index_of(inner))
    }

    fn span(&self, node: NodeId) -> NodeSpan {
        NodeSpan::of(self.layout.index_of(node))
    }

    /// Segments into a JOIN that is taken together: all but the last leave their regions only.
    fn waits_for_others(&self, segment: &PathSegment<'_>) -> bool {
        let path = segment.path;
        let next = path.segments.get(segment.index + 1).map(|&id| self.chart.transition(id));
        !path.others.is_empty()
            && self.kind(segment.transition.target) == NodeKind::Join
            && next.is_some_and(|next| next.target == segment.transition.target)
    }

    /// The AND whose regions a JOIN joins on this path.
    fn around_sources(&self, path: &CompoundPath) -> NodeId {
        if let Some(arrival) = path.arrival {
            return self.parent(arrival.region);
        }
        let spans = path.others.iter().map(|&node| self.span(node));
        node_span::lowest_node(self.chart, &self.layout, spans.fold(self.span(path.source), NodeSpan::with))
    }

    /// The node inside which a segment leaves and enters.
    fn boundary(&self, segment: &PathSegment<'_>) -> NodeId {
        let Transition { source, target, internal, .. } = *segment.transition;
        if segment.index == 0 && internal && self.is_state(source) && self.contains(source, target) {
            return source;
        }
        if self.kind(target) == NodeKind::ExitPoint && self.contains(self.parent(target), source) {
            return self.parent(target);
        }
        let mut hull =
            self.beside(segment).map(|target| self.span(target)).fold(self.span(target), NodeSpan::with);
        if self.kind(target) == NodeKind::Join || self.kind(source) == NodeKind::Join {
            hull = hull.with(self.span(self.around_sources(segment.path)));
        }
        let own = self.stands_in(source);
        let fits = |&node: &NodeId| {
            let index = self.layout.index_of(node);
            (self.kind(node) == NodeKind::Or || node == own && self.is_point(source))
                && self.layout.first(index) <= hull.first()
                && hull.last() < index
        };
        self.chart.ancestors(source).find(fits).unwrap_or(Statechart::ROOT)
    }

    /// The targets of the segments of a path that leave a FORK, or an entry point that forks,
    /// together with this one.
    fn beside(&self, segment: &PathSegment<'_>) -> impl Iterator<Item = NodeId> {
        let source = segment.transition.source;
        let forks = matches!(self.kind(source), NodeKind::Fork | NodeKind::EntryPoint);
        let all = segment.path.segments.iter().filter(move |_| forks).map(|&id| self.chart.transition(id));
        all.filter(move |other| other.source == source).map(|other| other.target)
    }

    /// The index range of the nodes that a segment leaves: from its source up to the boundary. The
    /// first segment out of a FORK leaves for all of them.
    fn exits(&self, segment: &PathSegment<'_>, boundary: NodeId) -> Option<(NodeIndex, NodeIndex)> {
        let Transition { source, target, .. } = *segment.transition;
        let stands = self.stands_in(source);
        if self.kind(target) == NodeKind::ExitPoint && self.parent(target) == boundary {
            // from the border or the composite itself nothing is left until the point is passed
            let is_inside = source != boundary && !(self.is_point(source) && stands == boundary);
            return self.inside(self.layout.index_of(boundary)).filter(|_| is_inside);
        }
        if boundary == source {
            return self.inside(self.layout.index_of(source));
        }
        let is_first = self.beside(segment).next().is_none_or(|first| first == target);
        if !is_first || !self.is_state(source) && stands == boundary {
            return None;
        }
        let child = node_span::child_towards(self.chart, boundary, source)?;
        let node = self.layout.index_of(child);
        Some((self.layout.first(node), node))
    }

    fn is_state(&self, node: NodeId) -> bool {
        use NodeKind::{And, Basic, End, Or, Start};
        matches!(self.kind(node), Or | And | Basic | End | Start)
    }

    /// Whether a node stands on the border of its composite, or for what is in it.
    fn is_point(&self, node: NodeId) -> bool {
        use NodeKind::{DeepHistory, EntryPoint, ExitPoint, ShallowHistory};
        matches!(self.kind(node), EntryPoint | ExitPoint | ShallowHistory | DeepHistory)
    }

    /// The innermost node that is active when a path leaves a node.
    fn stands_in(&self, node: NodeId) -> NodeId {
        if self.is_point(node) { self.parent(node) } else { self.above(node) }
    }

    /// The innermost node that is entered when a path reaches a connector.
    fn position(&self, connector: NodeId) -> NodeId {
        match self.kind(connector) {
            NodeKind::ExitPoint => self.above(self.parent(connector)),
            _ => self.stands_in(connector),
        }
    }

    /// The lowest OR around a node.
    fn above(&self, node: NodeId) -> NodeId {
        let mut around = self.chart.ancestors(node);
        around.find(|&node| self.kind(node) == NodeKind::Or).unwrap_or(Statechart::ROOT)
    }

    /// An entry point that leads nowhere.
    fn stands_for_composite(&self, point: NodeId) -> bool {
        !self.chart.transitions().any(|(_, transition)| transition.source == point)
    }

    /// Whether a path goes on from an entry point to something inside its composite.
    fn leads_inside(&self, segment: &PathSegment<'_>) -> bool {
        let point = segment.transition.target;
        let Some(&next) = segment.path.segments.get(segment.index + 1) else { return true };
        let Transition { source, target, .. } = *self.chart.transition(next);
        let on_border = self.kind(target) == NodeKind::ExitPoint && self.parent(target) == self.parent(point);
        source != point || self.contains(self.parent(point), target) && !on_border
    }

    /// The nodes from inside a boundary down to a node, outermost first. A boundary that is an AND
    /// comes before them, since its other regions may have been left.
    fn down_to(&self, boundary: NodeId, node: NodeId) -> Box<[NodeIndex]> {
        let up = std::iter::once(node).chain(self.chart.ancestors(node));
        let mut path: Vec<NodeIndex> = up
            .take_while(|&node| self.contains(boundary, node))
            .map(|node| self.layout.index_of(node))
            .collect();
        let is_and = self.kind(boundary) == NodeKind::And && self.contains(boundary, node);
        path.extend(is_and.then(|| self.layout.index_of(boundary)));
        path.reverse();
        path.into()
    }
}
