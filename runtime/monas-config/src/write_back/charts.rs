//! Writes statecharts with their settings.

use super::super::element::Element;
use super::super::xml_editor::{attribute_text, element_text};
use super::{AgentWriteBack, Splice, activity, word};
use monas_core::agent::{ChartProfile, ChartSettings};
use monas_core::monitors::{PropertySet, ViolationResponse};

impl AgentWriteBack<'_> {
    /// Updates the changed settings of a statechart.
    pub(crate) fn update_chart(&self, element: &Element, now: &ChartProfile, splices: &mut Vec<Splice>) {
        if element.text() != now.model {
            let span = element.text_span();
            splices.push((span.start..span.end, element_text(&now.model)));
        }
        let changed = self.changed(element, attributes(&now.settings).into_iter());
        splices.extend(self.document.attribute_splices(element, &changed));
        let mut behind = element.text_span().end;
        let mut coming = String::new();
        for said in &now.settings.activities {
            match element.children_named("activity").find(|known| known.text() == said.name) {
                Some(known) => {
                    let changed = self.changed_parameters(known, said);
                    splices.extend(self.document.attribute_splices(known, &changed));
                    behind = behind.max(self.end_of(known));
                }
                None => coming += &format!("{}  {}", self.blanks_before(element), activity(said)),
            }
        }
        if !coming.is_empty() {
            splices.push((behind..behind, coming));
        }
    }
}

/// The settings of a statechart as attributes.
fn attributes(own: &ChartSettings) -> Vec<(&'static str, String)> {
    let said = [
        ("thread_frequency", own.frequency.map(|frequency| frequency.hertz().to_string())),
        ("priority", own.priority.map(|priority| priority.to_string())),
        ("is_real_time", own.real_time.map(|is_wanted| u8::from(is_wanted).to_string())),
        ("stats_cycle", own.statistics_every.map(|steps| steps.unwrap_or_default().to_string())),
        ("workers", own.workers.map(|workers| workers.to_string())),
        (
            "cores",
            own.cores.as_ref().map(|cores| cores.iter().map(usize::to_string).collect::<Vec<_>>().join(" ")),
        ),
        ("on_failure", own.policy.map(|policy| word(policy).to_owned())),
    ];
    said.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
}

/// A statechart as new text on one line, with the activities executed elsewhere.
pub(crate) fn chart(chart: &ChartProfile, elsewhere: &[String]) -> String {
    let mut said = attributes(&chart.settings);
    let elsewhere: Vec<&str> =
        elsewhere.iter().chain(&chart.settings.elsewhere).map(String::as_str).collect();
    if !elsewhere.is_empty() {
        said.push(("elsewhere", elsewhere.join(" ")));
    }
    let said: String =
        said.iter().map(|(key, value)| format!(" {key}=\"{}\"", attribute_text(value))).collect();
    let within: String = chart.settings.activities.iter().map(activity).collect();
    let monitors = monitors(&chart.settings.property_sets, "");
    format!("<statechart{said}>{}{within}{monitors}</statechart>", element_text(&chart.model))
}

/// Files of properties, each after this whitespace.
pub(crate) fn monitors(rules: &[PropertySet], blanks: &str) -> String {
    let element = |rules: &PropertySet| {
        let named =
            ViolationResponse::NAMES.into_iter().find(|(_, response)| *response == rules.on_violation);
        let written = named.filter(|(_, response)| *response != ViolationResponse::default());
        let acts = written.map_or(String::new(), |(name, _)| format!(" on_violation=\"{name}\""));
        format!("{blanks}<monitor{acts}>{}</monitor>", element_text(&rules.file))
    };
    rules.iter().filter(|rules| !rules.file.is_empty()).map(element).collect()
}
