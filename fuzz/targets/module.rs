//! Files that may be modules: the note in them is read, or refused with a reason, and what was read can be written down and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use monas::BuildNote;

fuzz_target!(|bytes: &[u8]| {
    match BuildNote::of_file(bytes) {
        Ok(note) => {
            assert!(!note.module().is_empty(), "{note:?}");
            assert_eq!(note.to_string().lines().count(), note.fields().count(), "{note:?}");
        }
        Err(reason) => assert!(!reason.is_empty()),
    }
});
