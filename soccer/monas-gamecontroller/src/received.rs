//! Packets from the network.

use std::io;
use std::net::{SocketAddr, UdpSocket};

use crate::{Error, Peer};

/// Longer than any packet of the protocol, so that one that is too long is seen as such.
const BUFFER_SIZE: usize = 256;

/// A packet that has arrived, or why it cannot be read.
#[derive(Clone, PartialEq, Debug)]
pub struct Received<T> {
    /// Its sender.
    pub from: Peer,
    /// Its content.
    pub content: Result<T, Error>,
}

/// A socket that is never waited for.
pub(crate) fn socket(address: SocketAddr) -> io::Result<UdpSocket> {
    let socket = UdpSocket::bind(address)?;
    socket.set_nonblocking(true)?;
    Ok(socket)
}

/// The next packet that has arrived, if there is one.
pub(crate) fn next<T>(
    socket: &UdpSocket,
    decode: impl FnOnce(&[u8]) -> Result<T, Error>,
) -> io::Result<Option<Received<T>>> {
    let mut bytes = [0; BUFFER_SIZE];
    match socket.recv_from(&mut bytes) {
        Ok((length, from)) => Ok(Some(Received { from: Peer(from.ip()), content: decode(&bytes[..length]) })),
        Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(None),
        Err(error) => Err(error),
    }
}
