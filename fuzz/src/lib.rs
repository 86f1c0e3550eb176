//! Fuzz targets for every parser: any input leads to findings, never to a panic.
//!
//! Each file in `targets` passes libFuzzer's bytes to one parser and checks its documented
//! guarantees: findings lie within the text, and printed values parse to the same value. `seeds`
//! are the initial inputs and `dictionaries` the tokens of the fuzzer; it stores new inputs in
//! `corpus`, which is not part of the project.
//!
//! ```text
//! cargo install cargo-fuzz          # once; and a nightly toolchain with a C++ compiler
//! fuzz/run 60                       # every target for 60 seconds
//! fuzz/run 600 role                 # one target for ten minutes
//! cargo +nightly fuzz run role fuzz/artifacts/role/crash-0123      # a crash again
//! ```

use yase::Diagnostic;

/// Panics unless every finding lies within its text and can be displayed.
pub fn assert_findings_fit(text: &str, findings: &[Diagnostic]) {
    for finding in findings {
        let own = finding.source.as_ref().map_or(text, |source| source.text.as_str());
        let (start, end) = (finding.span.start, finding.span.end);
        assert!(start <= end && end <= own.len(), "{finding:?} in {} bytes", own.len());
        assert!(own.is_char_boundary(start) && own.is_char_boundary(end), "{finding:?} splits a character");
        assert!(!finding.message.is_empty());
        assert!(!finding.to_string().is_empty());
    }
}
