//! Agents from a file: Listing 4.17 of the thesis, read with diagnostics.

use std::path::Path;
use std::sync::Arc;

use yase::{Diagnostic, Source, Statechart};

use super::model;
use super::paths;
use super::xml::{self, Attributes, Element};
use crate::activity::Activity;
use crate::agent::{Agent, Policy};
use crate::binder::Binder;
use crate::error::ErrorKind;
use crate::frequency::{Frequency, Hz};
use crate::parameters::Parameters;
use crate::registry::Registry;

/// Reads the agents in a file, and everything that is wrong with it or with a model it names.
///
/// A file whose diagnostics hold no [error](Diagnostic::is_error) can be run.
pub fn load(path: impl AsRef<Path>, registry: &Registry) -> (Vec<Agent>, Vec<Diagnostic>) {
    match paths::read(path.as_ref()) {
        Ok(source) => read(&source, path.as_ref(), registry),
        Err(diagnostic) => (Vec::new(), vec![*diagnostic]),
    }
}

/// As [`load`], of a text that is at hand; models are looked for from where `path` would be.
pub fn read(source: &Arc<Source>, path: &Path, registry: &Registry) -> (Vec<Agent>, Vec<Diagnostic>) {
    let (elements, diagnostics) = xml::parse(source);
    let mut reader = Reader { path, registry, diagnostics, agents: Vec::new() };
    reader.agents(&elements);
    (reader.agents, reader.diagnostics)
}

struct Reader<'a> {
    path: &'a Path,
    registry: &'a Registry,
    diagnostics: Vec<Diagnostic>,
    agents: Vec<Agent>,
}

/// The elements that stand for an agent, or hold some.
const TOP: [&str; 3] = ["agent", "provider", "agents"];
/// The elements within an agent.
const WITHIN: [&str; 3] = ["name", "activity", "statechart"];

impl Reader<'_> {
    fn agents(&mut self, elements: &[Element]) {
        for element in elements {
            if element.is("agents") {
                Attributes::new(element, &mut self.diagnostics).finish();
                self.agents(element.children());
            } else if element.is("agent") {
                self.agent(element);
            } else if element.is("provider") {
                self.provider(element);
            } else {
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
        attributes.finish();
        match self.chart(element).filter(|_| enabled) {
            Some(chart) => agent.chart(chart),
            None => agent,
        }
    }

    /// The model that a statechart names, checked; none, and why, if it cannot be used.
    fn chart(&mut self, element: &Element) -> Option<Statechart> {
        let found = match paths::locate(self.path, element.text()) {
            Ok(found) => found,
            Err(hint) => {
                let message = format!("no model file `{}`", element.text());
                let diagnostic = element.error("E0316", element.text_span(), message);
                self.diagnostics.push(match hint {
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
            self.agents.push(agent);
        }
    }

    fn refuse_namesake(&mut self, element: &Element, name: &str) {
        if !name.is_empty() && self.agents.iter().any(|agent| agent.name == name) {
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
