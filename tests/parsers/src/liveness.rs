//! Formulas: findings are valid, printed formulas parse to the same formulas, and every chart can
//! be built.

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn liveness(data: &[u8]) {
    let text = text_of(data);
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
}
