//! Files of properties that statecharts are to keep to.

use yase::Diagnostic;

use super::super::element::Element;
use super::super::paths;
use super::super::values::Values;
use super::{Reader, is_enabled};
use crate::agent::{Agent, ChartSettings};
use crate::binder::Binder;
use crate::monitors::{OnViolation, Rules, needs_one_chart};

impl Reader<'_> {
    /// The properties that an agent's one chart is to keep to.
    pub(super) fn monitor(&mut self, element: &Element, agent: Agent) -> Agent {
        let Some(rules) = self.rules(element) else { return agent };
        match needs_one_chart(agent.name(), agent.charts().len()) {
            None => self.judge(&rules, &agent),
            // A chart that could not be read has been said.
            Some(_) if agent.charts().is_empty() && self.diagnostics.iter().any(Diagnostic::is_error) => {}
            Some(wrong) => {
                let error = element.error(wrong.code, element.text_span(), wrong.message);
                self.diagnostics.push(error.with_hint(wrong.hint.unwrap_or_default()));
            }
        }
        agent.ruled(rules)
    }

    /// The properties that the chart is to keep to that was added last.
    pub(super) fn monitor_of_chart(
        &mut self,
        element: &Element,
        own: ChartSettings,
        agent: &Agent,
    ) -> ChartSettings {
        let Some(rules) = self.rules(element) else { return own };
        self.judge(&rules, agent);
        own.ruled(rules)
    }

    /// What a file of properties says; none if there is none that can be read, which has been said.
    fn rules(&mut self, element: &Element) -> Option<Rules> {
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
        let (properties, wrong) = aseme::properties::parse(&source.text);
        self.diagnostics.extend(wrong.into_iter().map(|wrong| wrong.in_source(&source)));
        let on_violation = values.word("on_violation", &OnViolation::NAMES).unwrap_or_default();
        let file = element.text().to_owned();
        Some(Rules { file, properties, on_violation, source: Some(source) })
    }

    /// Says which names of properties the chart does not have that was added last.
    fn judge(&mut self, rules: &Rules, agent: &Agent) {
        let Some(place) = agent.charts().len().checked_sub(1) else { return };
        // What is wrong with the program's words or with the chart has been said.
        let Ok(binder) = Binder::new(&self.registry) else { return };
        let generated = agent.generated.get(&place);
        let Ok(compiled) = binder.compiled(&agent.charts()[place], generated) else { return };
        if let Err(wrong) = binder.monitors(None, std::slice::from_ref(rules), &compiled) {
            self.diagnostics.extend(wrong);
        }
    }
}
