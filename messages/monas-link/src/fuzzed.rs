//! Parsers of bytes from sockets, exposed for fuzzing.

use crate::control::{frame, messages};
use crate::protocol::Packet;
use crate::transport::local;

/// Longest message that is read from a stream.
pub const MAX_MESSAGE_SIZE: usize = 1 << 16;

/// The number of requests on a stream before the first invalid one, and their re-encoding.
pub fn requests(stream: &[u8]) -> (usize, Vec<u8>) {
    all::<messages::Request>(stream)
}

/// The same for replies of a run.
pub fn answers(stream: &[u8]) -> (usize, Vec<u8>) {
    all::<messages::Answer>(stream)
}

/// Parses a datagram as a packet.
pub fn datagram(bytes: &[u8]) -> Packet {
    local::read(bytes)
}

fn all<M: prost::Message + Default>(mut stream: &[u8]) -> (usize, Vec<u8>) {
    let (mut count, mut written) = (0, Vec::new());
    while let Ok(message) = frame::read::<M>(&mut stream, MAX_MESSAGE_SIZE) {
        frame::append(&message, &mut written);
        count += 1;
    }
    (count, written)
}
