//! Topics that charts of a host read and none of its activities publishes.

use std::collections::BTreeSet;

use yase::expression::{Effect, Origin};
use yase::vocabulary::TopicEntry;
use yase::{CompiledChart, Diagnostic, Statechart};

use super::super::element::Element;
use super::AgentReader;
use monas_core::activity::Activity;

impl AgentReader<'_> {
    /// Warns of topics that a chart reads although no activity of the host's agents publishes them,
    /// if another activity of the program would. A topic that none publishes comes from the body,
    /// the world or the runtime, or is reported by `monas model check`.
    pub(super) fn unpublished(&mut self, elements: &[Element]) {
        let Some(published) = self.published() else { return };
        let Ok(vocabulary) = self.registry.vocabulary() else { return };
        for element in statecharts(elements) {
            let agents = self.setup.agents.iter();
            let charts = agents.flat_map(|agent| agent.models.iter().zip(&agent.compiled));
            let mut named = charts.filter(|(model, _)| model.as_str() == element.text());
            let Some((_, Some(compiled))) = named.next() else { continue };
            let read = read_topics(&compiled.chart, &vocabulary.topics);
            let written = written_topics(&compiled.chart, &vocabulary.topics);
            for path in read.difference(&written).filter(|path| !published.contains(**path)) {
                let others = self.publishers(path);
                if others.is_empty() || self.is_brought(path) {
                    continue;
                }
                let message = format!("`{}` reads `{path}`, but no agent here publishes it", element.text());
                let diagnostic =
                    Diagnostic::warning("E0369", element.text_span(), message).in_source(element.source());
                let hint = format!("let an agent run one of {}, or receive it by a link", others.join(", "));
                self.diagnostics.push(diagnostic.with_hint(hint));
            }
        }
    }

    /// The topics that the activities of all agents publish; none if one is unknown or does not
    /// declare them.
    fn published(&self) -> Option<BTreeSet<&'static str>> {
        let mut published = BTreeSet::new();
        for agent in &self.setup.agents {
            for listed in &agent.activities {
                published.extend(declared(&*listed.activity)?);
            }
            let nodes = agent.charts().iter().flat_map(Statechart::nodes);
            for name in nodes.filter_map(|(_, node)| node.activity.as_deref()) {
                published.extend(declared(&*self.registry.activity(name).ok()?)?);
            }
        }
        Some(published)
    }

    /// The activities of the program that publish a topic.
    fn publishers(&self, path: &str) -> Vec<String> {
        let publishes = |name: &&str| {
            let activity = self.registry.activity(name);
            activity.is_ok_and(|activity| activity.topics().published_paths().contains(&path))
        };
        self.registry.activity_names().filter(publishes).map(|name| format!("`{name}`")).collect()
    }
}

/// The elements of statecharts, in order.
fn statecharts(elements: &[Element]) -> Vec<&Element> {
    let mut found = Vec::new();
    for element in elements {
        if element.is("agents") {
            found.extend(statecharts(element.children()));
        } else if element.is("agent") {
            found.extend(element.children_named("statechart"));
        }
    }
    found
}

/// The topics that an activity publishes; none if it declares no topics.
fn declared(activity: &dyn Activity) -> Option<Vec<&'static str>> {
    let topics = activity.topics();
    topics.is_declared().then(|| topics.published_paths().to_vec())
}

/// The topics of the own host that guards and triggers read.
fn read_topics<'t>(chart: &CompiledChart, topics: &'t [TopicEntry]) -> BTreeSet<&'t str> {
    let own = chart.sources().filter(|source| source.origin == Origin::Own).map(|source| source.topic);
    let events = chart.events();
    let awaited = events.ids().filter(|&event| events.host(event).is_none());
    let read: BTreeSet<_> = own.chain(awaited.filter_map(|event| events.topic(event))).collect();
    topics.iter().filter(|topic| read.contains(&topic.id)).map(|topic| topic.path.as_str()).collect()
}

/// The topics that actions of the chart write.
fn written_topics<'t>(chart: &CompiledChart, topics: &'t [TopicEntry]) -> BTreeSet<&'t str> {
    let written: BTreeSet<_> = chart
        .effects()
        .flat_map(|(_, _, effects)| effects)
        .filter_map(|effect| match effect {
            Effect::Assign { topic, .. } | Effect::Publish { topic } => Some(*topic),
            _ => None,
        })
        .collect();
    topics.iter().filter(|topic| written.contains(&topic.id)).map(|topic| topic.path.as_str()).collect()
}
