//! Checks every parser on arbitrary input: any input leads to findings, never to a panic.
//!
//! Each function passes bytes to one parser and checks its documented guarantees: findings lie
//! within the text, and printed values parse to the same value. The tests of this crate call the
//! functions with the inputs in `fuzz/seeds` and with mutations of them; the targets in `fuzz` call
//! them with the inputs of libFuzzer.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // a failed check panics

mod bytes;
mod configuration;
mod control;
mod frames;
mod gamecontroller;
mod liveness;
mod lola;
mod match_file;
mod model;
mod module;
mod path;
mod poses;
mod property;
mod rcsssmj;
mod role;
mod scenario;
mod scxml;
mod tape;
mod topic;
mod transition;
mod urdf;

pub use bytes::bytes;
pub use configuration::configuration;
pub use control::control;
pub use frames::frames;
pub use gamecontroller::gamecontroller;
pub use liveness::liveness;
pub use lola::lola;
pub use match_file::match_file;
pub use model::model;
pub use module::module;
pub use path::path;
pub use poses::poses;
pub use property::property;
pub use rcsssmj::rcsssmj;
pub use role::role;
pub use scenario::scenario;
pub use scxml::scxml;
pub use tape::tape;
pub use topic::topic;
pub use transition::transition;
pub use urdf::urdf;

use yase::Diagnostic;

/// A target: its name in `fuzz`, and its function.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 21] = [
    ("bytes", bytes),
    ("configuration", configuration),
    ("control", control),
    ("frames", frames),
    ("gamecontroller", gamecontroller),
    ("liveness", liveness),
    ("lola", lola),
    ("match", match_file),
    ("model", model),
    ("module", module),
    ("path", path),
    ("poses", poses),
    ("property", property),
    ("rcsssmj", rcsssmj),
    ("role", role),
    ("scenario", scenario),
    ("scxml", scxml),
    ("tape", tape),
    ("topic", topic),
    ("transition", transition),
    ("urdf", urdf),
];

/// The longest prefix of the data that is text.
fn text_of(data: &[u8]) -> &str {
    match std::str::from_utf8(data) {
        Ok(text) => text,
        Err(error) => std::str::from_utf8(&data[..error.valid_up_to()]).unwrap_or_default(),
    }
}

/// Panics unless every finding lies within its text and can be displayed.
fn assert_findings_fit(text: &str, findings: &[Diagnostic]) {
    for finding in findings {
        let own = finding.source.as_ref().map_or(text, |source| source.text.as_str());
        let (start, end) = (finding.span.start, finding.span.end);
        assert!(start <= end && end <= own.len(), "{finding:?} in {} bytes", own.len());
        assert!(own.is_char_boundary(start) && own.is_char_boundary(end), "{finding:?} splits a character");
        assert!(!finding.message.is_empty());
        assert!(!finding.to_string().is_empty());
    }
}
