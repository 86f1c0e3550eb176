//! Bytes from elsewhere: they are published as a message of the topic, or refused with a reason, and nothing is left over.
//!
//! The first byte chooses the topic. What is accepted is encoded again: the new bytes must be accepted as well, and give themselves.
#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use monas_robot as _;
use narukom::{Arrival, ErrorKind, Moment, Narukom};

fn hub() -> &'static Narukom {
    static HUB: OnceLock<Narukom> = OnceLock::new();
    HUB.get_or_init(|| match Narukom::with_linked_topics("host") {
        Ok(hub) => hub,
        Err(error) => panic!("{error}"),
    })
}

/// The bytes that a message has once it was published, or nothing if it was refused.
fn published(path: &str, bytes: &[u8]) -> Option<Vec<u8>> {
    let (Ok(mut tap), Ok(mut publisher)) = (hub().tap(path), hub().publisher_by_name(path, "stranger")) else {
        panic!("`{path}` is declared");
    };
    while tap.next_encoded().is_some() {}
    if let Err(error) = publisher.publish_bytes(bytes, Moment::ZERO) {
        assert_eq!(error.kind(), ErrorKind::Malformed);
        assert!(error.to_string().contains(path), "{error}");
        assert!(tap.next_encoded().is_none(), "what was refused was published");
        return None;
    }
    tap.next_encoded().map(|encoded| encoded.bytes().to_vec())
}

fuzz_target!(|bytes: &[u8]| {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let topics = hub().topics();
    let path = topics[usize::from(*choice) % topics.len()].path();
    let first = published(path, bytes);
    if let Some(first) = &first {
        assert_eq!(published(path, first).as_ref(), Some(first), "what was encoded is not read back on `{path}`");
    }
    let Ok(mut receiver) = hub().receiver("elsewhere", "stranger", path) else { panic!("`{path}` is declared") };
    let arrival =
        Arrival { sequence: 1, published: Moment::MAX, local: Moment::ZERO, received: Moment::ZERO };
    assert_eq!(receiver.receive_bytes(bytes, arrival).is_ok(), first.is_some(), "`{path}`");
});
