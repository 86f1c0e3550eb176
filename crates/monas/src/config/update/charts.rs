//! Statecharts with what they have of their own, as they are written.

use super::super::edit::{attribute_text, element_text};
use super::super::element::Element;
use super::{Splice, Update, activity, word};
use crate::agent::{ChartProfile, ChartSettings};
use crate::monitors::{OnViolation, Rules};

impl Update<'_> {
    /// What is another now of a statechart that is written.
    pub(super) fn update_chart(&self, element: &Element, now: &ChartProfile, splices: &mut Vec<Splice>) {
        if element.text() != now.model {
            let span = element.text_span();
            splices.push((span.start..span.end, element_text(&now.model)));
        }
        let changed = self.changed(element, attributes(&now.own).into_iter());
        splices.extend(self.document.attribute_splices(element, &changed));
        let mut behind = element.text_span().end;
        let mut coming = String::new();
        for said in &now.own.activities {
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

/// What a statechart has of its own, in attributes.
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

/// A statechart of an agent of which these activities run elsewhere, in its line.
pub(super) fn chart(chart: &ChartProfile, elsewhere: &[String]) -> String {
    let mut said = attributes(&chart.own);
    let elsewhere: Vec<&str> = elsewhere.iter().chain(&chart.own.elsewhere).map(String::as_str).collect();
    if !elsewhere.is_empty() {
        said.push(("elsewhere", elsewhere.join(" ")));
    }
    let said: String =
        said.iter().map(|(key, value)| format!(" {key}=\"{}\"", attribute_text(value))).collect();
    let within: String = chart.own.activities.iter().map(activity).collect();
    let monitors = monitors(&chart.own.rules, "");
    format!("<statechart{said}>{}{within}{monitors}</statechart>", element_text(&chart.model))
}

/// Files of properties, each after these blanks.
pub(super) fn monitors(rules: &[Rules], blanks: &str) -> String {
    let element = |rules: &Rules| {
        let acts = match rules.on_violation {
            OnViolation::Log => "",
            OnViolation::Policy => " on_violation=\"policy\"",
        };
        format!("{blanks}<monitor{acts}>{}</monitor>", element_text(&rules.file))
    };
    rules.iter().filter(|rules| !rules.file.is_empty()).map(element).collect()
}
