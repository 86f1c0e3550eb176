//! The line of a micro-step: R23.

use yase::statechart::NodeId;

use super::{Stepper, Way, topic};
use crate::kit::world::World;

impl Stepper<'_> {
    pub(super) fn name(&self, node: NodeId) -> String {
        let path = self.chart.path(node);
        path.split_once('/').map_or(path.clone(), |(_, rest)| rest.to_owned())
    }

    pub(super) fn names(&self, nodes: &[NodeId]) -> String {
        nodes.iter().map(|&node| self.name(node)).collect::<Vec<_>>().join(", ")
    }

    pub(super) fn way_names(&self, ways: &[Way]) -> String {
        let one = |way: &Way| {
            let targets = way.iter().map(|&id| self.name(self.chart.transition(id).target));
            std::iter::once(self.name(self.source(way))).chain(targets).collect::<Vec<_>>().join(" -> ")
        };
        ways.iter().map(one).collect::<Vec<_>>().join(", ")
    }

    pub(super) fn print(
        &mut self,
        event: Option<&str>,
        fired: &[Way],
        losers: &[Way],
        held: &[Way],
        deferring: Option<NodeId>,
        world: &mut World,
    ) {
        let event = event.map(|event| match topic(event) {
            Some(_) => event.to_lowercase(), // messages are known by their topic
            None if self.is_known(event) => event.to_owned(),
            None => "?".to_owned(),
        });
        let selected = match (fired.is_empty(), event.is_some() && held.is_empty() && deferring.is_none()) {
            (false, _) => self.way_names(fired),
            (true, true) => "dropped".to_owned(),
            (true, false) => "nothing".to_owned(),
        };
        let mut text = format!("{} {}: {selected}", self.now, event.as_deref().unwrap_or("-"));
        let parts = [
            ("preempt", self.way_names(losers)),
            ("hold", self.way_names(held)),
            ("defer in", deferring.map(|node| self.name(node)).unwrap_or_default()),
            ("exit", self.names(&self.line.exits)),
            ("do", self.line.effects.join(", ")),
            ("enter", self.names(&self.line.entries)),
        ];
        for (title, part) in parts {
            if !part.is_empty() {
                text += &format!("; {title} {part}");
            }
        }
        world.say(text);
    }

    pub(super) fn is_known(&self, event: &str) -> bool {
        event.starts_with("error.") || self.is_named(event, true)
    }
}
