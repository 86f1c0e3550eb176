//! Agents and links from a file: Listing 4.17 of the thesis, read with diagnostics.

use std::path::Path;
use std::sync::Arc;

use monas_link::Place;
use narukom::Narukom;
use yase::diagnostic::nearest;
use yase::{Diagnostic, Source, Statechart};

use super::links::LinkReader;
use super::model;
use super::paths;
use super::xml::{self, Attribute, Attributes, Element};
use crate::activity::Activity;
use crate::agent::{Agent, Policy};
use crate::binder::Binder;
use crate::error::{Error, ErrorKind};
use crate::frequency::{Frequency, Hz};
use crate::link::LinkConfig;
use crate::parameters::Parameters;
use crate::registry::Registry;

/// What a file says of a host.
#[derive(Debug, Default)]
pub struct Setup {
    /// The agents that run on it.
    pub agents: Vec<Agent>,
    /// Its links to other processes and hosts.
    pub links: Vec<LinkConfig>,
}

/// Reads the agents and links in a file, and everything that is wrong with it or with a model it names.
///
/// A file whose diagnostics hold no [error](Diagnostic::is_error) can be run.
pub fn load(path: impl AsRef<Path>, registry: &Registry) -> (Setup, Vec<Diagnostic>) {
    match paths::read(path.as_ref()) {
        Ok(source) => read(&source, path.as_ref(), registry),
        Err(diagnostic) => (Setup::default(), vec![*diagnostic]),
    }
}

/// As [`load`], of a text that is at hand; models are looked for from where `path` would be.
pub fn read(source: &Arc<Source>, path: &Path, registry: &Registry) -> (Setup, Vec<Diagnostic>) {
    let (elements, diagnostics) = xml::parse(source);
    let mut reader = Reader { path, registry, diagnostics, setup: Setup::default() };
    // What runs elsewhere is held against the links, wherever these stand.
    reader.links(&elements);
    reader.agents(&elements);
    (reader.setup, reader.diagnostics)
}

struct Reader<'a> {
    path: &'a Path,
    registry: &'a Registry,
    diagnostics: Vec<Diagnostic>,
    setup: Setup,
}

/// The elements that stand for an agent or a link, or hold some.
const TOP: [&str; 4] = ["agent", "provider", "link", "agents"];
/// The elements within an agent.
const WITHIN: [&str; 3] = ["name", "activity", "statechart"];

impl Reader<'_> {
    fn links(&mut self, elements: &[Element]) {
        for element in elements {
            if element.is("agents") {
                self.links(element.children());
            } else if element.is("link") {
                let mut reader = LinkReader { path: self.path, diagnostics: &mut self.diagnostics };
                self.setup.links.extend(reader.link(element));
            }
        }
    }

    fn agents(&mut self, elements: &[Element]) {
        for element in elements {
            if element.is("agents") {
                Attributes::new(element, &mut self.diagnostics).finish();
                self.agents(element.children());
            } else if element.is("agent") {
                self.agent(element);
            } else if element.is("provider") {
                self.provider(element);
            } else if !element.is("link") {
                self.diagnostics.push(element.unknown(&TOP));
            }
        }
    }

    fn agent(&mut self, element: &Element) {
        element.expect_children(&WITHIN, &mut self.diagnostics);
        let name = self.agent_name(element);
        let (mut agent, enabled) = self.settings(element, name);
        let parts = element.children_named("activity").chain(element.children_named("statechart"));
        let parts: Vec<&Element> = parts.collect();
        if parts.is_empty() && element.children().iter().all(|child| child.is("name")) {
            let message = format!("agent `{}` has no activity and no statechart", agent.name);
            self.diagnostics.push(element.error("E0319", element.name_span(), message));
        }
        for part in parts {
            agent =
                if part.is("activity") { self.activity(part, agent) } else { self.statechart(part, agent) };
        }
        self.add(element, agent, enabled);
    }

    /// A provider is an agent with the one activity that it is named after.
    fn provider(&mut self, element: &Element) {
        element.expect_children(&[], &mut self.diagnostics);
        let name = element.text().to_owned();
        let (agent, enabled) = self.settings(element, name.clone());
        let activity = self.instance(element, &name, &Parameters::new());
        let agent = match activity {
            Some(activity) => agent.named_activity(name, activity),
            None => agent,
        };
        self.add(element, agent, enabled);
    }

    fn agent_name(&mut self, element: &Element) -> String {
        let Some(name) = element.only_child("name", &mut self.diagnostics) else { return String::new() };
        Attributes::new(name, &mut self.diagnostics).finish();
        if name.text().is_empty() {
            self.diagnostics.push(name.error("E0310", name.name_span(), "an agent's name is empty"));
        }
        name.text().to_owned()
    }

    /// The attributes of an agent, and whether it is wanted.
    fn settings(&mut self, element: &Element, name: String) -> (Agent, bool) {
        let mut attributes = Attributes::new(element, &mut self.diagnostics);
        let real_time = attributes.flag("is_real_time").unwrap_or(false);
        let priority = attributes.integer("priority").unwrap_or(0);
        let frequency = frequency(&mut attributes);
        let statistics = attributes.integer("stats_cycle").unwrap_or(0);
        let workers = attributes.read("workers", "a whole number from 1", |text| text.parse().ok());
        let enabled = attributes.flag("enable").unwrap_or(true);
        let policy = attributes.one_of("on_failure", &Policy::NAMES).unwrap_or_default();
        attributes.finish();
        let mut agent = Agent::idle(name);
        (agent.frequency, agent.workers) = (frequency, workers);
        let agent = agent.urgency(priority, real_time).statistics_every(statistics).on_failure(policy);
        (agent, enabled)
    }

    fn activity(&mut self, element: &Element, agent: Agent) -> Agent {
        element.expect_children(&[], &mut self.diagnostics);
        let mut attributes = Attributes::new(element, &mut self.diagnostics);
        let enabled = attributes.flag("enable").unwrap_or(true);
        let rest = attributes.rest();
        let parameters = rest.iter().fold(Parameters::new(), |all, one| all.with(&*one.name, &*one.value));
        let activity = self.instance(element, element.text(), &parameters);
        match activity.filter(|_| enabled) {
            Some(activity) => agent.named_activity(element.text(), activity),
            None => agent,
        }
    }

    /// An activity with its parameters; none, and why, if there is none of that name.
    fn instance(
        &mut self,
        element: &Element,
        name: &str,
        parameters: &Parameters,
    ) -> Option<Box<dyn Activity>> {
        match self.registry.activity(name) {
            Ok(mut activity) => {
                activity.configure(parameters);
                self.faults(element, parameters);
                Some(activity)
            }
            Err(error) => {
                let code = if error.kind() == ErrorKind::AmbiguousActivity { "E0313" } else { "E0312" };
                let diagnostic = element.error(code, element.text_span(), error.to_string());
                self.diagnostics.push(match error.hint() {
                    Some(hint) => diagnostic.with_hint(hint),
                    None => diagnostic,
                });
                None
            }
        }
    }

    fn faults(&mut self, element: &Element, parameters: &Parameters) {
        for fault in parameters.faults() {
            let given = element.attributes().iter().find(|attribute| attribute.name == fault.key);
            let (code, span) = match given {
                Some(attribute) if fault.unknown => ("E0314", attribute.name_span),
                Some(attribute) => ("E0315", attribute.value_span),
                None => ("E0315", element.name_span()),
            };
            let diagnostic =
                element.error(code, span, format!("activity `{}`: {}", element.text(), fault.message));
            self.diagnostics.push(match fault.nearest {
                Some(known) => diagnostic.with_hint(format!("did you mean `{known}`?")),
                None => diagnostic,
            });
        }
    }

    fn statechart(&mut self, element: &Element, agent: Agent) -> Agent {
        element.expect_children(&[], &mut self.diagnostics);
        let mut attributes = Attributes::new(element, &mut self.diagnostics);
        let enabled = attributes.flag("enable").unwrap_or(true);
        let elsewhere = attributes.get("elsewhere").cloned();
        attributes.finish();
        let agent = match self.registry.chart(element.text()) {
            Some(Ok(generated)) if enabled => agent.generated(generated),
            Some(Ok(_)) => return agent,
            Some(Err(error)) => return self.unusable(element, &error, agent),
            None => match self.chart(element).filter(|_| enabled) {
                Some(chart) => agent.chart(chart),
                None => return agent,
            },
        };
        let chart = agent.charts().last();
        let named = elsewhere.zip(chart).map(|(given, chart)| self.elsewhere(element, &given, chart));
        named.unwrap_or_default().into_iter().fold(agent, Agent::elsewhere)
    }

    /// A generated chart cannot be used.
    fn unusable(&mut self, element: &Element, error: &Error, agent: Agent) -> Agent {
        let diagnostic = element.error("E0322", element.text_span(), error.to_string());
        self.diagnostics.push(match error.hint() {
            Some(hint) => diagnostic.with_hint(hint),
            None => diagnostic,
        });
        agent
    }

    /// The activities of a chart that another process runs: each must be one of the chart's, and links must bring what it publishes.
    fn elsewhere(&mut self, element: &Element, given: &Attribute, chart: &Statechart) -> Vec<String> {
        let names: Vec<String> = given.value.split_whitespace().map(str::to_owned).collect();
        let mut known: Vec<&str> = chart.nodes().filter_map(|(_, node)| node.activity.as_deref()).collect();
        known.sort_unstable();
        known.dedup();
        for name in &names {
            if !known.contains(&name.as_str()) {
                let message = format!("the chart `{}` has no activity `{name}`", chart.name);
                let diagnostic = element.error("E0338", given.value_span, message);
                self.diagnostics.push(diagnostic.with_nearest(name, known.iter().copied()));
            } else if let Ok(activity) = self.registry.activity(name) {
                let topics = activity.topics();
                let published = topics.published_paths().iter();
                let missing: Vec<&str> = published.copied().filter(|topic| !self.is_brought(topic)).collect();
                for topic in missing {
                    let message = format!("`{name}` runs elsewhere, and no link brings its `{topic}`");
                    let hint = format!("add to a `<link>`: `<receive topics=\"{topic}\" as=\"own\"/>`");
                    self.diagnostics.push(element.error("E0339", given.value_span, message).with_hint(hint));
                }
            }
        }
        names
    }

    /// Whether a link brings a topic as the host's own.
    fn is_brought(&self, topic: &str) -> bool {
        let rules = self.setup.links.iter().flat_map(|link| &link.settings.receive);
        let mut own = rules.filter(|rule| rule.place == Place::Own);
        let hub = Narukom::with_linked_topics("configuration").ok();
        hub.is_some_and(|hub| {
            let slot = hub.topic(topic);
            own.any(|rule| {
                let brought = hub.matching(&rule.topics).unwrap_or_default();
                slot.is_some_and(|slot| brought.contains(&slot))
            })
        })
    }

    /// The model that a statechart names, checked; none, and why, if it cannot be used.
    fn chart(&mut self, element: &Element) -> Option<Statechart> {
        let found = match paths::locate(self.path, element.text()) {
            Ok(found) => found,
            Err(hint) => {
                let what = match element.text().contains(['/', '.']) {
                    true => "no model file",
                    false => "no model file and no generated statechart",
                };
                let message = format!("{what} `{}`", element.text());
                let diagnostic = element.error("E0316", element.text_span(), message);
                let known = || nearest(element.text(), self.registry.chart_names()).map(str::to_owned);
                self.diagnostics.push(match hint.or_else(known) {
                    Some(hint) => diagnostic.with_hint(format!("did you mean `{hint}`?")),
                    None => diagnostic,
                });
                return None;
            }
        };
        let (chart, diagnostics) = model::load(&found);
        // Without its formulas a chart is not the one that was meant, and nothing more can be said of it.
        let is_known = !diagnostics.iter().any(model::is_about_formulas);
        self.diagnostics.extend(diagnostics);
        let (chart, source) = chart.filter(|_| is_known)?;
        let bound = match Binder::new(self.registry) {
            Ok(binder) => binder.check(&chart, Some(&source)),
            Err(error) => vec![element.error("E0318", element.text_span(), error.to_string())],
        };
        self.diagnostics.extend(bound);
        Some(chart)
    }

    fn add(&mut self, element: &Element, agent: Agent, enabled: bool) {
        if agent.frequency.is_none() && !agent.activities.is_empty() {
            let given = element.attributes().iter().any(|a| xml::is_written(&a.name, "thread_frequency"));
            if !given {
                let message = format!("agent `{}` has activities and no `thread_frequency`", agent.name);
                self.diagnostics.push(element.error("E0305", element.name_span(), message));
            }
        }
        if enabled {
            self.refuse_namesake(element, &agent.name);
            self.setup.agents.push(agent);
        }
    }

    fn refuse_namesake(&mut self, element: &Element, name: &str) {
        if !name.is_empty() && self.setup.agents.iter().any(|agent| agent.name == name) {
            let named = element.children_named("name").next().unwrap_or(element);
            let message = format!("another agent is named `{name}`");
            self.diagnostics.push(element.error("E0311", named.text_span(), message));
        }
    }
}

/// Cycles a second, if that is said.
fn frequency(attributes: &mut Attributes<'_>) -> Option<Frequency> {
    let fits = |hertz: &f64| (Frequency::LOWEST..=Frequency::HIGHEST).contains(hertz);
    let expected = format!("a number from {} to {}", Frequency::LOWEST, Frequency::HIGHEST);
    attributes
        .read("thread_frequency", &expected, |text| text.parse().ok().filter(fits))
        .map(|hertz: f64| Hz(hertz))
}
