//! Special actions: findings fit, there are poses exactly if none is an error, and each angle is of
//! a joint and within its limits.

use monas_config::poses;
use yase::{Diagnostic, Source};

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn poses(data: &[u8]) {
    let text = text_of(data);
    let anatomy = monas_nao::anatomy();
    let (poses, findings) = poses::read(&Source::new("poses.xml", text), anatomy);
    assert_findings_fit(text, &findings);
    assert_eq!(poses.is_none(), findings.iter().any(Diagnostic::is_error), "{findings:?}");
    for pose in poses.iter().flatten() {
        assert!(pose.seconds > 0.0, "{pose:?}");
        for &(joint, angle) in &pose.angles {
            let limits = anatomy.joints[joint].limits;
            assert!((limits.low..=limits.high).contains(&angle), "{pose:?}");
        }
    }
}
