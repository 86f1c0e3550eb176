//! Random input for every parser: whatever a person or a disk may hold, Monas answers with findings, never with a panic.
//!
//! Each file in `targets` hands libFuzzer's bytes to one parser, and checks what its page promises: that a finding lies within the
//! text it speaks of, that what is printed reads back as the same. `seeds` are where the fuzzer begins, `dictionaries` the words that
//! it tries; what it finds on its way it keeps in `corpus`, which is not part of the project.
//!
//! ```text
//! cargo install cargo-fuzz          # once; and a nightly toolchain with a C++ compiler
//! fuzz/run 60                       # every target for 60 seconds
//! fuzz/run 600 role                 # one target for ten minutes
//! cargo +nightly fuzz run role fuzz/artifacts/role/crash-0123      # a crash again
//! ```

use yase::Diagnostic;

/// Panics unless every finding lies within the text that it speaks of, and can be shown.
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
