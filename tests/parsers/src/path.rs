//! State paths: a parsed path prints as a path that parses to the same.

use aseme::path::Path;

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn path(data: &[u8]) {
    let text = text_of(data);
    match Path::parse(text) {
        Ok(path) => assert_eq!(Path::parse(&path.to_string()).ok().as_ref(), Some(&path), "{path}"),
        Err(finding) => assert_findings_fit(text, &[finding]),
    }
}
