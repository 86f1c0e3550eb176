//! Module files: the note is read or rejected with a reason, and a note that was read is equal
//! after writing and reading it again.

use monas_module::read_fingerprint;

/// Checks the documented guarantees for one input.
pub fn module(bytes: &[u8]) {
    match read_fingerprint(bytes) {
        Ok(note) => {
            assert!(!note.module().is_empty(), "{note:?}");
            assert_eq!(note.to_string().lines().count(), note.fields().count(), "{note:?}");
        }
        Err(reason) => assert!(!reason.is_empty()),
    }
}
