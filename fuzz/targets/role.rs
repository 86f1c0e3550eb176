//! Roles: findings fit, entries lie within the text, and the chart that comes of it can be printed, drawn and checked.
#![no_main]

use aseme::SrmFile;
use libfuzzer_sys::fuzz_target;
use monas_fuzz::assert_findings_fit;
use yase::{Source, Vocabulary};

/// A drawing of a chart with more nodes than this takes longer than it tells.
const DRAWN: usize = 2000;

fuzz_target!(|text: &str| {
    let (file, _) = SrmFile::parse(text);
    assert_eq!(file.text(), text);
    for entry in file.entries() {
        assert!(text.get(entry.span.start..entry.span.end).is_some(), "{entry:?}");
    }
    let (chart, findings) = aseme::statechart_of(&Source::new("role.srm", text));
    assert_findings_fit(text, &findings);
    if chart.nodes().len() <= DRAWN {
        assert!(!aseme::to_text(&chart).is_empty());
        assert!(aseme::to_svg(&chart).ends_with("</svg>\n"));
        assert!(aseme::to_json(&chart).is_object());
        if let Err(findings) = chart.compile(&Vocabulary::default()) {
            assert!(!findings.is_empty());
        }
    }
});
