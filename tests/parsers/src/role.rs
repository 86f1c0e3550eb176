//! Roles: findings are valid, entries lie within the text, and the resulting chart can be printed,
//! drawn and checked.

use aseme::SrmFile;
use yase::{Source, TypeEnvironment};

use crate::{assert_findings_fit, text_of};

/// Charts with more nodes than this are not drawn, to save time.
const MAX_DRAWN_NODES: usize = 2000;

/// Checks the documented guarantees for one input.
pub fn role(data: &[u8]) {
    let text = text_of(data);
    let (file, _) = SrmFile::parse(text);
    assert_eq!(file.text(), text);
    for entry in file.entries() {
        assert!(text.get(entry.span.start..entry.span.end).is_some(), "{entry:?}");
    }
    let (chart, findings) = aseme_models::statechart_of(&Source::new("role.srm", text));
    assert_findings_fit(text, &findings);
    if chart.nodes().len() <= MAX_DRAWN_NODES {
        assert!(!aseme::to_text(&chart).is_empty());
        assert!(yase_export::to_svg(&chart).ends_with("</svg>\n"));
        assert!(serde_json::to_value(aseme::to_json(&chart)).is_ok_and(|json| json.is_object()));
        if let Err(findings) = chart.compile(&TypeEnvironment::default()) {
            assert!(!findings.is_empty());
        }
    }
}
