//! Data from sockets: requests of tools, replies of runs, and datagrams of local links. Each is
//! read or rejected; a value that was read is equal after writing and reading it again.

use monas_link::fuzzed::{self, MAX_MESSAGE_SIZE};

/// Checks the documented guarantees for one input.
pub fn control(bytes: &[u8]) {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    match choice % 3 {
        0 => again(bytes, fuzzed::requests),
        1 => again(bytes, fuzzed::answers),
        _ => datagram(bytes),
    }
}

/// Reads a stream of messages up to the first rejected one, and writes them again.
fn again(bytes: &[u8], read: fn(&[u8]) -> (usize, Vec<u8>)) {
    let (count, written) = read(bytes);
    assert!(count <= bytes.len() / 4, "{count} messages in {} bytes", bytes.len());
    assert!(written.len() <= MAX_MESSAGE_SIZE * count.max(1));
    assert_eq!(read(&written), (count, written.clone()), "what was written reads as something else");
}

fn datagram(bytes: &[u8]) {
    let packet = fuzzed::datagram(bytes);
    assert!((1..=7).contains(&packet.priority), "{packet:?}");
    let held = packet.from.len()
        + packet.stamp.len()
        + packet.payload.len()
        + packet.path.as_ref().map_or(0, |path| path.len());
    assert!(held <= bytes.len(), "{held} bytes of {}", bytes.len());
    assert!(packet.path.is_none_or(|path| !path.is_empty()));
}
