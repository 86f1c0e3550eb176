//! Statecharts of agents, with their settings.

use monas_link::PublishAs;
use narukom::Hub;
use yase::Statechart;
use yase::diagnostic::nearest;
use yase::statechart::ConstantValue;

use super::super::element::{Attribute, Element};
use super::super::model;
use super::super::paths;
use super::super::values::Values;
use super::{AgentReader, is_enabled, parameters};
use monas_core::agent::{ActivityProfile, Agent, ChartSettings, FailurePolicy};
use monas_core::binder::{Binder, CompiledModel};
use monas_core::call;
use monas_core::error::Error;
use monas_core::frequency::Hz;

impl AgentReader<'_> {
    pub(crate) fn statechart(&mut self, element: &Element, agent: Agent) -> Agent {
        if element.text().is_empty() {
            return agent; // which has been said
        }
        let values = Values::of(element, self.grammar);
        let (enabled, elsewhere) = (is_enabled(&values), values.given("elsewhere").cloned());
        let agent = match self.registry.chart(element.text()) {
            Some(Ok(generated)) if enabled => {
                self.refuse_constants(element);
                agent.generated_as(element.text(), generated)
            }
            Some(Ok(_)) => return agent,
            Some(Err(error)) => return self.unusable(element, &error, agent),
            None => match self.chart(element).filter(|_| enabled) {
                Some((chart, model)) => agent.chart_of(element.text(), chart).compiled_to(model),
                None => return agent,
            },
        };
        let own = self.own(element, &agent);
        let own = match elsewhere.zip(agent.charts().last()) {
            Some((given, chart)) => {
                self.elsewhere(&given, chart).into_iter().fold(own, ChartSettings::elsewhere)
            }
            None => own,
        };
        let agent = agent.chart_settings(own);
        let monitors: Vec<&Element> = element.children_named("monitor").collect();
        monitors.into_iter().fold(agent, |agent, monitor| {
            let own = agent.chart_settings.last().cloned().unwrap_or_default();
            let own = self.monitor_of_chart(monitor, own, &agent);
            agent.chart_settings(own)
        })
    }

    /// The settings of the statechart added last.
    fn own(&mut self, element: &Element, agent: &Agent) -> ChartSettings {
        let values = Values::of(element, self.grammar);
        let mut own = ChartSettings {
            frequency: values.number("thread_frequency").map(|hertz: f64| Hz(hertz)),
            priority: values.number("priority"),
            real_time: values.flag("is_real_time"),
            statistics_every: values.number("stats_cycle").map(|steps: u64| (steps > 0).then_some(steps)),
            workers: values.number("workers"),
            cores: values.given("cores").map(|_| self.cores(&values)),
            policy: values.word("on_failure", &FailurePolicy::NAMES),
            ..ChartSettings::new()
        };
        for said in element.children_named("activity") {
            if let Some(known) = self.activity_of_chart(said, agent, &own) {
                own.activities.push(known);
            }
        }
        own
    }

    /// The settings of an activity of the chart added last; none if it is disabled or in error.
    fn activity_of_chart(
        &mut self,
        element: &Element,
        agent: &Agent,
        own: &ChartSettings,
    ) -> Option<ActivityProfile> {
        let (name, values) = (element.text(), Values::of(element, self.grammar));
        if name.is_empty() || !is_enabled(&values) {
            return None; // what is empty has been said
        }
        let chart = agent.charts().last()?;
        let known = names_of_activities(chart);
        if !known.contains(&name) {
            let message = format!("the chart `{}` has no activity `{name}`", chart.name);
            let diagnostic = element.error("E0338", element.text_span(), message);
            self.diagnostics.push(diagnostic.with_nearest(name, known));
            return None;
        }
        if own.of_activity(name).is_some() {
            let message = format!("the activity `{name}` of the chart `{}` is configured twice", chart.name);
            let diagnostic = element.error("E0311", element.text_span(), message);
            self.diagnostics.push(
                diagnostic.with_hint("use one `activity` element: it applies to every state that runs it"),
            );
            return None;
        }
        let parameters = parameters(&values);
        // Generated charts contain their activities; other charts name registered ones, or have a
        // diagnostic.
        let is_generated = agent.generated.contains_key(&(agent.charts().len() - 1));
        let generated =
            agent.models.last().filter(|_| is_generated).and_then(|name| self.registry.chart(name));
        let mut activity = match generated {
            Some(generated) => generated.ok()?.into_activity(name)?,
            None => self.registry.activity(name).ok()?,
        };
        call::configure(&mut *activity, &parameters);
        self.faults(element, &parameters);
        Some(ActivityProfile {
            name: name.to_owned(),
            parameters,
            policy: values.word("on_failure", &FailurePolicy::NAMES),
        })
    }

    /// Reports that a generated chart cannot be used.
    fn unusable(&mut self, element: &Element, error: &Error, agent: Agent) -> Agent {
        let diagnostic = element.error("E0322", element.text_span(), error.to_string());
        self.diagnostics.push(match error.hint() {
            Some(hint) => diagnostic.with_hint(hint),
            None => diagnostic,
        });
        agent
    }

    /// The activities of a chart that another process executes: each must belong to the chart, and
    /// links must deliver its topics.
    fn elsewhere(&mut self, given: &Attribute, chart: &Statechart) -> Vec<String> {
        let names: Vec<String> = given.value.split_whitespace().map(str::to_owned).collect();
        let known = names_of_activities(chart);
        for name in &names {
            if !known.contains(&name.as_str()) {
                let message = format!("the chart `{}` has no activity `{name}`", chart.name);
                let diagnostic = given.error("E0338", message);
                self.diagnostics.push(diagnostic.with_nearest(name, known.iter().copied()));
            } else if let Ok(activity) = self.registry.activity(name) {
                let topics = activity.topics();
                let published = topics.published_paths().iter();
                let missing: Vec<&str> = published.copied().filter(|topic| !self.is_brought(topic)).collect();
                for topic in missing {
                    let message =
                        format!("`{name}` runs in another process, but no link receives its `{topic}`");
                    let hint = format!("add to a `<link>`: `<receive topics=\"{topic}\" as=\"own\"/>`");
                    self.diagnostics.push(given.error("E0339", message).with_hint(hint));
                }
            }
        }
        names
    }

    /// Whether a link delivers a topic as one of this host.
    pub(super) fn is_brought(&self, topic: &str) -> bool {
        let rules = self.setup.links.iter().flat_map(|link| &link.settings.receive);
        let mut own = rules.filter(|rule| rule.publish_as == PublishAs::Own);
        let hub = Hub::with_linked_topics("configuration").ok();
        hub.is_some_and(|hub| {
            let slot = hub.topic(topic);
            own.any(|rule| {
                let brought = hub.matching(&rule.topics).unwrap_or_default();
                slot.is_some_and(|slot| brought.contains(&slot))
            })
        })
    }

    /// Gives constants of a model the values of the configuration.
    fn set_constants(&mut self, element: &Element, chart: &mut Statechart) {
        for given in element.children_named("constant") {
            let values = Values::of(given, self.grammar);
            let (Some(name), text) = (values.text("name"), given.text()) else { continue };
            let known = chart.constants.iter().map(|constant| constant.name.as_str());
            let Some(index) = known.clone().position(|known| known == name) else {
                let message = format!("the chart `{}` has no constant `{name}`", chart.name);
                let diagnostic = given.error("E0344", given.name_span(), message);
                self.diagnostics.push(diagnostic.with_nearest(name, known));
                continue;
            };
            match aseme::srm::constant_value(text) {
                Some(value) if same_kind(&value, &chart.constants[index].value) => {
                    chart.constants[index].value = value;
                }
                _ => {
                    let message = format!("`{text}` is not a value for the constant `{name}`");
                    let hint = format!("the model gives it {}", kind(&chart.constants[index].value));
                    self.diagnostics.push(given.error("E0344", given.text_span(), message).with_hint(hint));
                }
            }
        }
    }

    /// Constants are compiled into generated charts.
    fn refuse_constants(&mut self, element: &Element) {
        for given in element.children_named("constant") {
            let message = format!("the constants of the generated chart `{}` are compiled", element.text());
            let hint = "name the model file instead, or change the model and generate the chart again";
            self.diagnostics.push(given.error("E0344", given.name_span(), message).with_hint(hint));
        }
    }

    /// The model named by a statechart, and its compiled form; none, with diagnostics, on errors.
    fn chart(&mut self, element: &Element) -> Option<(Statechart, Option<CompiledModel>)> {
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
        // A chart with faulty formulas is incomplete, so further diagnostics would mislead.
        let is_known = !aseme::have_formula_errors(&diagnostics);
        self.diagnostics.extend(diagnostics);
        let (mut chart, source) = chart.filter(|_| is_known)?;
        self.set_constants(element, &mut chart);
        let compiled = match Binder::new(&self.registry) {
            Ok(binder) => binder.compile(&chart, &source),
            Err(error) => Err(vec![element.error("E0318", element.text_span(), error.to_string())]),
        };
        let compiled = compiled.map_err(|diagnostics| self.diagnostics.extend(diagnostics)).ok();
        Some((chart, compiled))
    }
}

fn same_kind(one: &ConstantValue, other: &ConstantValue) -> bool {
    kind(one) == kind(other)
}

fn kind(value: &ConstantValue) -> &'static str {
    match value {
        ConstantValue::Bool(_) => "true or false",
        ConstantValue::Number(_) => "a number, which a unit may follow",
        ConstantValue::Text(_) => "a text in quotes",
    }
}

/// The names of the activities of a chart's states, in order.
fn names_of_activities(chart: &Statechart) -> Vec<&str> {
    let mut known: Vec<&str> = chart.nodes().filter_map(|(_, node)| node.activity.as_deref()).collect();
    known.sort_unstable();
    known.dedup();
    known
}
