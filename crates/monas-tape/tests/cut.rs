//! Tapes that were cut off or damaged.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

mod ball;

use ball::*;
use monas_tape::{Recording, Tape};
use proptest::prelude::*;

/// How many messages are read before the end or the first error.
fn readable(bytes: Vec<u8>) -> usize {
    let recording = Recording::from_bytes(bytes);
    recording.messages().map_or(0, |messages| messages.take_while(Result::is_ok).count())
}

#[test]
fn what_a_killed_process_wrote_is_read_up_to_the_last_second() {
    let output = Shared::default();
    let tape = Tape::to_writer(output.clone()).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    play(&[hub], 45);
    let bytes = output.bytes();
    let count = readable(bytes.clone());
    // 4.5 s of 30 messages each; of the last second up to all may be missing.
    assert!((120 - 3..=135).contains(&count), "{count}");
    let recording = Recording::from_bytes(bytes);
    assert!(!recording.is_finished());
    assert!(recording.messages().unwrap().all(|message| message.is_ok()));
}

#[test]
fn a_cut_anywhere_leaves_what_stands_before_it() {
    let bytes = recorded(30);
    let whole = readable(bytes.clone());
    let mut before = 0;
    for length in (0..=bytes.len()).step_by(7) {
        let count = readable(bytes[..length].to_vec());
        assert!(count >= before && count <= whole, "{length} bytes: {count} after {before}");
        before = count;
    }
    assert_eq!(before, whole);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damage_is_met_without_a_panic(places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut bytes = recorded(3);
        for (place, value) in places {
            let index = place.index(bytes.len());
            bytes[index] = value;
        }
        readable(bytes);
    }

    #[test]
    fn any_bytes_are_met_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let mut tape = mcap::MAGIC.to_vec();
        tape.extend(&bytes);
        readable(tape);
        readable(bytes);
    }
}
