//! Descriptions of robots: findings fit, there is an anatomy exactly if none is an error, each link
//! comes after the one that carries it, and each moves with a joint of the anatomy.

use monas_config::urdf;
use yase::{Diagnostic, Source};

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn urdf(data: &[u8]) {
    let text = text_of(data);
    let source = Source::new("robot.urdf", text);
    let (anatomy, findings) = urdf::read(&source);
    assert_findings_fit(text, &findings);
    assert_eq!(anatomy.is_none(), findings.iter().any(Diagnostic::is_error), "{findings:?}");
    let Some(anatomy) = anatomy else { return };
    for (index, link) in anatomy.links.iter().enumerate() {
        assert_eq!(link.parent.is_none(), index == 0, "{link:?}");
        assert!(link.parent.is_none_or(|parent| parent < index), "{link:?}");
        let joint = link.motion.map(|motion| motion.joint);
        assert!(joint.is_none_or(|joint| joint < anatomy.joints.len()), "{link:?}");
    }
    assert!(anatomy.joints.iter().all(|joint| joint.limits.low <= joint.limits.high));
    assert_eq!(urdf::read_variant(&source, &anatomy).0, Some(anatomy), "a robot is built like itself");
}
