//! State paths: a parsed path prints as a path that parses to the same.
#![no_main]

use aseme::path::Path;
use libfuzzer_sys::fuzz_target;
use monas_fuzz::assert_findings_fit;

fuzz_target!(|text: &str| match Path::parse(text) {
    Ok(path) => assert_eq!(Path::parse(&path.to_string()).ok().as_ref(), Some(&path), "{path}"),
    Err(finding) => assert_findings_fit(text, &[finding]),
});
