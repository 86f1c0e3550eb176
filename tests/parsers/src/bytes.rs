//! Encoded messages: they are published on the topic, or rejected with a reason and without effect.
//!
//! The first byte selects the topic. Accepted messages are encoded again: the new bytes must be
//! accepted and encode to themselves.

use std::sync::OnceLock;

use monas_robot as _;
use narukom::{ErrorKind, Hub, RemoteHeader, Timestamp};

fn hub() -> &'static Hub {
    static HUB: OnceLock<Hub> = OnceLock::new();
    HUB.get_or_init(|| match Hub::with_linked_topics("host") {
        Ok(hub) => hub,
        Err(error) => panic!("{error}"),
    })
}

/// The bytes of a message after publication; none if it was rejected.
fn published(path: &str, bytes: &[u8]) -> Option<Vec<u8>> {
    let (Ok(mut subscriber), Ok(mut publisher)) =
        (hub().encoded_subscriber(path), hub().publisher_by_name(path, "stranger"))
    else {
        panic!("`{path}` is declared");
    };
    while subscriber.next_encoded().is_some() {}
    if let Err(error) = publisher.publish_bytes(bytes, Timestamp::ZERO) {
        assert_eq!(error.kind(), ErrorKind::Malformed);
        assert!(error.to_string().contains(path), "{error}");
        assert!(subscriber.next_encoded().is_none(), "what was refused was published");
        return None;
    }
    subscriber.next_encoded().map(|encoded| encoded.bytes().to_vec())
}

/// Checks the documented guarantees for one input.
pub fn bytes(bytes: &[u8]) {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let topics = hub().topics();
    let path = topics[usize::from(*choice) % topics.len()].path();
    let first = published(path, bytes);
    if let Some(first) = &first {
        assert_eq!(
            published(path, first).as_ref(),
            Some(first),
            "what was encoded is not read back on `{path}`"
        );
    }
    let Ok(mut receiver) = hub().receiver("elsewhere", "stranger", path) else {
        panic!("`{path}` is declared")
    };
    let arrival = RemoteHeader {
        sequence: 1,
        published: Timestamp::MAX,
        local: Timestamp::ZERO,
        received: Timestamp::ZERO,
    };
    assert_eq!(receiver.receive_bytes(bytes, arrival).is_ok(), first.is_some(), "`{path}`");
}
