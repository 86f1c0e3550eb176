//! Properties: findings are valid, the canonical text parses to itself, and names are resolved.

use std::sync::LazyLock;

use aseme_verify::properties::{Monitor, bind, parse};
use yase::{CompiledChart, Source, TypeEnvironment};

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn property(data: &[u8]) {
    let text = text_of(data);
    let (properties, findings) = parse(text);
    assert_findings_fit(text, &findings);
    for property in &properties {
        let printed = property.to_string();
        let (again, findings) = parse(&printed);
        assert_eq!(findings, [], "{printed}");
        assert_eq!(again, std::slice::from_ref(property));
        let Some(chart) = CHART.as_ref() else { continue };
        match bind(property, chart, &TypeEnvironment::default()) {
            Ok(bound) => {
                let mut monitor = Monitor::new(bound.plan);
                for (letter, now) in [(0, 0), (1, 10), (!0, 2_000_000_000), (2, u64::MAX)] {
                    monitor.step(letter, now);
                }
            }
            Err(findings) => assert_findings_fit(text, &findings),
        }
    }
}

/// A chart that defines some of the names.
static CHART: LazyLock<Option<CompiledChart>> = LazyLock::new(|| {
    let text = "Role: r\nLiveness:\nr = a . (b | c)\nTransitions:\na -> (b|c) : go\n";
    aseme_models::statechart_of(&Source::new("r.srm", text)).0.compile(&TypeEnvironment::default()).ok()
});
