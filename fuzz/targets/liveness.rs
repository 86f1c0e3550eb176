//! Formulas: findings are valid, printed formulas parse to the same formulas, and every chart can
//! be built.
#![no_main]

use libfuzzer_sys::fuzz_target;
use monas_fuzz::assert_findings_fit;

fuzz_target!(|text: &str| {
    let (liveness, findings) = aseme::liveness::parse(text);
    assert_findings_fit(text, &findings);
    if findings.is_empty() {
        let printed = liveness.to_string();
        let (again, findings) = aseme::liveness::parse(&printed);
        assert_eq!(findings, [], "{printed}");
        assert_eq!(again.to_string(), printed);
    }
    let (_, findings) = aseme::liveness_to_statechart(&liveness);
    assert_findings_fit(text, &findings);
});
