//! Special actions: findings fit, there are poses exactly if none is an error, and each angle is of
//! a joint and within its limits.
#![no_main]

use libfuzzer_sys::fuzz_target;
use monas_config::poses;
use monas_fuzz::assert_findings_fit;
use yase::{Diagnostic, Source};

fuzz_target!(|text: &str| {
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
});
