//! Unix sockets that never block: bytes in and out, and messages on them.

use std::io::{ErrorKind, Read, Write};
use std::marker::PhantomData;
use std::os::unix::fs::MetadataExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use prost::Message;

use crate::error::Error;
use crate::lola::Decoded;

/// The most bytes that are kept of an incomplete packet or message: more than two images of 640 by
/// 480 pixels.
const MOST_BYTES: usize = 1 << 21;

/// A connection on which nothing arrives for this time has ended.
const RECEIVE_TIMEOUT: Duration = Duration::from_secs(1);

/// One end of a connection, or a listener for one.
pub(crate) struct Socket {
    listener: Option<Listener>,
    stream: Option<UnixStream>,
    received: Vec<u8>,
    /// The unsent rest of a message that was sent partially.
    unsent: Vec<u8>,
    /// Reading waits for bytes.
    waits: bool,
}

/// A listener, whose file is removed with it.
struct Listener {
    listener: UnixListener,
    path: PathBuf,
    /// Device and number of the file: another listener may have replaced it.
    file: Option<(u64, u64)>,
}

impl Listener {
    /// Listens at a path. An existing file is replaced.
    fn bind(path: &Path) -> std::io::Result<Listener> {
        if path.exists() {
            std::fs::remove_file(path)?;
        }
        let listener = UnixListener::bind(path)?;
        listener.set_nonblocking(true)?;
        Ok(Listener { listener, path: path.to_owned(), file: file_at(path) })
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        if self.file.is_some() && file_at(&self.path) == self.file {
            // If it cannot be removed, the next listener replaces it.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn file_at(path: &Path) -> Option<(u64, u64)> {
    std::fs::symlink_metadata(path).ok().map(|file| (file.dev(), file.ino()))
}

impl Socket {
    /// A connected stream.
    pub(crate) fn connected(stream: UnixStream) -> Result<Socket, Error> {
        stream.set_nonblocking(true).map_err(failed)?;
        Ok(Socket {
            listener: None,
            stream: Some(stream),
            received: Vec::new(),
            unsent: Vec::new(),
            waits: false,
        })
    }

    /// Connects to a path.
    pub(crate) fn connect(path: &Path) -> Result<Socket, Error> {
        Socket::connected(UnixStream::connect(path).map_err(|error| unanswered(path, &error))?)
    }

    /// Connects to a path; none if no process listens there. A killed process leaves its file.
    pub(crate) fn connect_if_served(path: &Path) -> Result<Option<Socket>, Error> {
        match UnixStream::connect(path) {
            Ok(stream) => Socket::connected(stream).map(Some),
            Err(error) if matches!(error.kind(), ErrorKind::ConnectionRefused | ErrorKind::NotFound) => {
                Ok(None)
            }
            Err(error) => Err(unanswered(path, &error)),
        }
    }

    /// Connects to a path; [`receive`](Socket::receive) then waits for bytes, up to a second.
    pub(crate) fn connect_blocking(path: &Path) -> Result<Socket, Error> {
        let socket = Socket::connect(path)?;
        if let Some(stream) = &socket.stream {
            stream.set_nonblocking(false).map_err(failed)?;
            stream.set_read_timeout(Some(RECEIVE_TIMEOUT)).map_err(failed)?;
        }
        Ok(Socket { waits: true, ..socket })
    }

    /// Listens at a path for one connection at a time. An existing file is replaced.
    pub(crate) fn listen(path: &Path) -> Result<Socket, Error> {
        let listener = Listener::bind(path)
            .map_err(|error| Error::disconnected(format!("cannot listen at {}: {error}", path.display())))?;
        Ok(Socket {
            listener: Some(listener),
            stream: None,
            received: Vec::new(),
            unsent: Vec::new(),
            waits: false,
        })
    }

    /// Two ends of one connection.
    pub(crate) fn pair() -> Result<(Socket, Socket), Error> {
        let (one, other) = UnixStream::pair().map_err(failed)?;
        Ok((Socket::connected(one)?, Socket::connected(other)?))
    }

    pub(crate) fn is_connected(&self) -> bool {
        self.stream.is_some()
    }

    /// Sends all bytes; none if the other end is not connected or has not read the earlier ones.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.accept();
        self.flush()?;
        if self.stream.is_some() && self.unsent.is_empty() {
            self.unsent.extend_from_slice(bytes);
            self.flush()?;
        }
        Ok(())
    }

    /// Continues to send pending bytes, as far as the other end has read.
    pub(crate) fn flush(&mut self) -> Result<(), Error> {
        while let Some(stream) = &mut self.stream
            && !self.unsent.is_empty()
        {
            match stream.write(&self.unsent) {
                Ok(sent) => drop(self.unsent.drain(..sent)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.closed(&error.to_string())),
            }
        }
        Ok(())
    }

    /// Reads what has arrived. A listener without a connection has nothing.
    fn fill(&mut self) -> Result<(), Error> {
        self.accept();
        let mut bytes = [0; 4096];
        while let Some(stream) = &mut self.stream
            && self.received.len() < MOST_BYTES
        {
            match stream.read(&mut bytes) {
                Ok(0) => return Err(self.closed("the other end has closed it")),
                Ok(length) => {
                    self.received.extend_from_slice(&bytes[..length]);
                    if self.waits {
                        return Ok(());
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock && self.waits => {
                    return Err(self.closed("nothing has arrived for a second"));
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.closed(&error.to_string())),
            }
        }
        Ok(())
    }

    fn accept(&mut self) {
        if self.stream.is_none()
            && let Some(Ok((stream, _))) = self.listener.as_ref().map(|it| it.listener.accept())
            && stream.set_nonblocking(true).is_ok()
        {
            self.stream = Some(stream);
        }
    }

    /// Drops a connection. A listener waits for the next one, which is not an error.
    fn closed(&mut self, why: &str) -> Error {
        (self.stream, self.unsent) = (None, Vec::new());
        Error::disconnected(format!("the connection has ended: {why}"))
    }

    /// Receives packets that `decode` reads, and keeps the newest. Returns whether there was one.
    pub(crate) fn receive(
        &mut self,
        mut decode: impl FnMut(&[u8]) -> Result<Decoded, Error>,
    ) -> Result<bool, Error> {
        let filled = self.fill();
        let (mut read, mut is_new) = (0, false);
        while read < self.received.len() {
            match decode(&self.received[read..]) {
                Ok(Decoded::Packet { bytes }) => (read, is_new) = (read + bytes, true),
                Ok(Decoded::Incomplete) => break,
                Err(error) => {
                    self.received.clear();
                    self.closed("it is not understood");
                    return Err(error);
                }
            }
        }
        self.received.drain(..read);
        if self.stream.is_none() {
            self.received.clear();
        }
        if self.received.len() >= MOST_BYTES {
            return Err(self.closed("a packet has no end"));
        }
        filled.map(|()| is_new)
    }
}

fn unanswered(path: &Path, error: &std::io::Error) -> Error {
    Error::disconnected(format!("nothing answers at {}: {error}", path.display()))
}

fn failed(error: std::io::Error) -> Error {
    Error::disconnected(error.to_string())
}

/// Protobuf messages on a socket, each after its length as four bytes, the lowest first.
pub(crate) struct MessageSocket<Sent, Received> {
    socket: Socket,
    bytes: Vec<u8>,
    messages: PhantomData<fn(Sent) -> Received>,
}

impl<Sent: Message, Received: Message + Default> MessageSocket<Sent, Received> {
    pub(crate) fn new(socket: Socket) -> MessageSocket<Sent, Received> {
        MessageSocket { socket, bytes: Vec::new(), messages: PhantomData }
    }

    /// Sends a message; it is lost if the other end is not connected or does not read.
    pub(crate) fn send(&mut self, message: &Sent) -> Result<(), Error> {
        self.bytes.clear();
        self.bytes.extend_from_slice(&(message.encoded_len() as u32).to_le_bytes());
        message.encode(&mut self.bytes).map_err(|error| Error::protocol(error.to_string()))?;
        self.socket.send(&self.bytes)
    }

    /// Continues to send a message that was sent partially. Returns whether anything was pending.
    pub(crate) fn flush(&mut self) -> Result<bool, Error> {
        let has_rest = !self.socket.unsent.is_empty();
        self.socket.flush().map(|()| has_rest)
    }

    /// Calls `take` with each message that has arrived.
    pub(crate) fn receive(&mut self, mut take: impl FnMut(Received)) -> Result<(), Error> {
        let read = |bytes: &[u8]| {
            let Some((length, rest)) = bytes.split_first_chunk::<4>() else { return Ok(Decoded::Incomplete) };
            let Some(encoded) = rest.get(..u32::from_le_bytes(*length) as usize) else {
                return Ok(Decoded::Incomplete);
            };
            take(Received::decode(encoded).map_err(|error| Error::protocol(error.to_string()))?);
            Ok(Decoded::Packet { bytes: 4 + encoded.len() })
        };
        self.socket.receive(read).map(drop)
    }
}
