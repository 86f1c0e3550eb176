//! Files of properties monitored on statecharts.

use yase::Diagnostic;

use super::super::element::Element;
use super::super::paths;
use super::super::values::Values;
use super::{AgentReader, is_enabled};
use monas_core::agent::{Agent, ChartSettings};
use monas_core::binder::Binder;
use monas_core::monitors::{PropertySet, ViolationResponse, needs_one_chart};

impl AgentReader<'_> {
    /// The properties monitored on the agent's only chart.
    pub(crate) fn monitor(&mut self, element: &Element, agent: Agent) -> Agent {
        let Some(rules) = self.rules(element) else { return agent };
        match needs_one_chart(agent.name(), agent.charts().len()) {
            None => self.judge(&rules, &agent),
            // A chart that could not be read has a diagnostic already.
            Some(_) if agent.charts().is_empty() && self.diagnostics.iter().any(Diagnostic::is_error) => {}
            Some(wrong) => {
                let error = element.error(wrong.code, element.text_span(), wrong.message);
                self.diagnostics.push(error.with_hint(wrong.hint.unwrap_or_default()));
            }
        }
        agent.with_property_set(rules)
    }

    /// The properties monitored on the chart added last.
    pub(crate) fn monitor_of_chart(
        &mut self,
        element: &Element,
        own: ChartSettings,
        agent: &Agent,
    ) -> ChartSettings {
        let Some(rules) = self.rules(element) else { return own };
        self.judge(&rules, agent);
        own.with_property_set(rules)
    }

    /// Reads a file of properties; none, with a diagnostic, if it cannot be read.
    fn rules(&mut self, element: &Element) -> Option<PropertySet> {
        let values = Values::of(element, self.grammar);
        if element.text().is_empty() || !is_enabled(&values) {
            return None; // what is empty has been said
        }
        let found = match paths::locate(self.path, element.text()) {
            Ok(found) => found,
            Err(hint) => {
                let message = format!("no file of properties `{}`", element.text());
                let wrong = element.error("E0316", element.text_span(), message);
                self.diagnostics.push(match hint {
                    Some(hint) => wrong.with_hint(format!("did you mean `{hint}`?")),
                    None => wrong,
                });
                return None;
            }
        };
        let source = match paths::read(&found) {
            Ok(source) => source,
            Err(unread) => {
                self.diagnostics.push(*unread);
                return None;
            }
        };
        let (properties, wrong) = aseme_verify::properties::parse(&source.text);
        self.diagnostics.extend(wrong.into_iter().map(|wrong| wrong.in_source(&source)));
        let on_violation = values.word("on_violation", &ViolationResponse::NAMES).unwrap_or_default();
        let file = element.text().to_owned();
        Some(PropertySet { file, properties, on_violation, source: Some(source) })
    }

    /// Reports names in properties that are unknown to the chart added last.
    fn judge(&mut self, rules: &PropertySet, agent: &Agent) {
        let Some(index) = agent.charts().len().checked_sub(1) else { return };
        // Errors of the type environment or the chart are reported elsewhere.
        let Ok(binder) = Binder::new(&self.registry) else { return };
        let checked = match &agent.compiled[index] {
            Some(model) => binder.monitors(None, std::slice::from_ref(rules), &model.chart),
            None => {
                let generated = agent.generated.get(&index);
                let Ok(compiled) = binder.compiled(&agent.charts()[index], generated) else { return };
                binder.monitors(None, std::slice::from_ref(rules), &compiled)
            }
        };
        self.diagnostics.extend(checked.err().into_iter().flatten());
    }
}
