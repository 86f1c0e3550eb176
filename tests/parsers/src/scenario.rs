//! Scenarios: findings are valid, and parsed scenarios are resolved against a chart.

use std::sync::LazyLock;

use aseme_verify::scenario::ScenarioText;
use yase::{CompiledChart, Source, TypeEnvironment};

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn scenario(data: &[u8]) {
    let text = text_of(data);
    let source = Source::new("a.scenario", text);
    let (script, findings) = ScenarioText::parse(&source);
    assert_findings_fit(text, &findings);
    for link in script.model.iter().chain(&script.after) {
        let line = text.get(link.span.start..link.span.end);
        assert!(line.is_some_and(|line| line.contains(&link.path)), "{link:?}");
    }
    let Some(chart) = CHART.as_ref() else { return };
    match script.bind(chart, &TypeEnvironment::default()) {
        Ok(steps) => steps.iter().for_each(|step| assert!(!step.passage.text().is_empty())),
        Err(findings) => assert_findings_fit(text, &findings),
    }
}

/// A chart that defines some of the names.
static CHART: LazyLock<Option<CompiledChart>> = LazyLock::new(|| {
    let text = "Role: r\nLiveness:\nr = Stand . (SearchBall | Track)\nTransitions:\n\
                Stand -> (SearchBall|Track) : go / StartTimeout(patience, 100ms)\n";
    aseme_models::statechart_of(&Source::new("r.srm", text)).0.compile(&TypeEnvironment::default()).ok()
});
