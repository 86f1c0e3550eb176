//! What reads bytes from sockets, for those who hand it random ones.

use crate::control::{frame, messages};
use crate::protocol::Packet;
use crate::transport::local;

/// A message on a stream is read up to this length.
pub const LIMIT: usize = 1 << 16;

/// How many requests stand on a stream before the first that is refused, and all of them, written again.
pub fn requests(stream: &[u8]) -> (usize, Vec<u8>) {
    all::<messages::Request>(stream)
}

/// The same of what a run answers.
pub fn answers(stream: &[u8]) -> (usize, Vec<u8>) {
    all::<messages::Answer>(stream)
}

/// The packet that a datagram is taken for.
pub fn datagram(bytes: &[u8]) -> Packet {
    local::read(bytes)
}

fn all<M: prost::Message + Default>(mut stream: &[u8]) -> (usize, Vec<u8>) {
    let (mut count, mut written) = (0, Vec::new());
    while let Ok(message) = frame::read::<M>(&mut stream, LIMIT) {
        frame::append(&message, &mut written);
        count += 1;
    }
    (count, written)
}
