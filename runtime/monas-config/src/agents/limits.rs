//! Limits of a host's body that concern activities of its agents.

use std::collections::BTreeMap;

use monas_core::activity::Topics;
use monas_robot::{BodyEnvironment, BodyLimit, Capability};
use yase::{Diagnostic, Severity, Statechart};

use super::super::element::Element;
use super::AgentReader;

impl AgentReader<'_> {
    /// Reports what the body cannot do, effect by effect, with the activities of each agent that
    /// rely on it. Capabilities that no activity uses are not mentioned.
    pub(super) fn limits(&mut self, elements: &[Element], surroundings: BodyEnvironment) {
        let Some((element, body)) = body_element(elements).zip(self.setup.body.as_ref()) else { return };
        let limits = body.limits(surroundings);
        if limits.is_empty() {
            return;
        }
        let (kind, uses) = (body.kind.clone(), self.uses());
        let mut effects: Vec<&str> = Vec::new();
        for limit in &limits {
            if !effects.contains(&&*limit.effect) {
                effects.push(&limit.effect);
            }
        }
        for effect in effects {
            let same: Vec<&BodyLimit> = limits.iter().filter(|limit| limit.effect == effect).collect();
            let relying = uses.iter().filter_map(|(agent, activities)| {
                let concerned: Vec<String> = activities
                    .iter()
                    .filter(|(_, topics)| same.iter().any(|limit| relies(topics, limit.capability)))
                    .map(|(name, _)| format!("`{name}`"))
                    .collect();
                (!concerned.is_empty()).then(|| format!("{} of {agent}", concerned.join(", ")))
            });
            let relying: Vec<String> = relying.collect();
            if relying.is_empty() {
                continue;
            }
            let message = format!("body `{kind}`: {effect}; this concerns {}", relying.join(", "));
            let diagnostic = Diagnostic::warning("E0370", element.name_span(), message);
            let information = Diagnostic { severity: Severity::Information, ..diagnostic };
            self.diagnostics.push(information.in_source(element.source()));
        }
    }

    /// The activities of each agent with what they declare, by names.
    fn uses(&self) -> BTreeMap<String, BTreeMap<String, Topics>> {
        let mut uses = BTreeMap::new();
        for agent in &self.setup.agents {
            let listed = agent.activities.iter();
            let mut activities: BTreeMap<String, Topics> =
                listed.map(|listed| (listed.name.clone(), listed.activity.topics())).collect();
            let nodes = agent.charts().iter().flat_map(Statechart::nodes);
            for name in nodes.filter_map(|(_, node)| node.activity.as_deref()) {
                if let Ok(activity) = self.registry.activity(name) {
                    activities.insert(name.to_owned(), activity.topics());
                }
            }
            uses.insert(agent.name.clone(), activities);
        }
        uses
    }
}

/// The element of the body.
fn body_element(elements: &[Element]) -> Option<&Element> {
    elements.iter().find_map(|element| match element {
        agents if agents.is("agents") => body_element(agents.children()),
        other => other.is("body").then_some(other),
    })
}

/// Whether an activity relies on a capability.
fn relies(topics: &Topics, capability: Capability) -> bool {
    match capability {
        Capability::Skill(skill) => topics.skills().contains(&skill.as_str_name()),
        Capability::Topic(path) => {
            topics.read_paths().contains(&path) || topics.published_paths().contains(&path)
        }
    }
}
