//! Match files: arbitrary text with references to existing and missing files, with an empty
//! registry.

use monas::Registry;
use monas_match::MatchSource;
use tempfile::TempDir;

use crate::{assert_findings_fit, text_of};

thread_local! {
    /// A folder with files that a match can refer to; the end of the thread removes it.
    static FOLDER: TempDir = folder();
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let role = "<agents><agent name=\"a\"/></agents>";
    for (name, text) in [("role.xml", role), ("field.xml", "<field/>"), ("simulator.xml", "<simulator/>")] {
        std::fs::write(folder.path().join(name), text).expect("there is room for a file");
    }
    folder
}

/// Checks the documented guarantees for one input.
pub fn match_file(data: &[u8]) {
    let text = text_of(data);
    let path = FOLDER.with(|folder| folder.path().join("match.xml"));
    std::fs::write(&path, text).expect("there is room for a file");
    if let Err(findings) = MatchSource::load(&path, &Registry::empty()) {
        assert!(!findings.is_empty(), "it is refused without a reason");
        assert_findings_fit(text, &findings);
    }
}
