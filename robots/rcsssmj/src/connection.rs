//! A TCP connection to the server, with messages in frames.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::time::Duration;

use crate::error::Error;
use crate::frame::{self, FrameReader};

/// The time limit of an attempt to connect.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);
/// A connection on which an awaited message does not arrive for this time counts as ended. The
/// server waits five seconds for an agent itself, and compiles its world anew when robots come and
/// go.
const RECEIVE_TIMEOUT: Duration = Duration::from_secs(20);
/// The time limit for sending a message.
const SEND_TIMEOUT: Duration = Duration::from_secs(5);

/// A connection to one of the server's ports.
#[derive(Debug)]
pub(crate) struct Connection {
    stream: TcpStream,
    reader: FrameReader,
    bytes: Vec<u8>,
    waits: bool,
}

impl Connection {
    /// Connects to an address such as `127.0.0.1:60000`.
    pub(crate) fn open(address: &str) -> Result<Connection, Error> {
        let failed =
            |error: std::io::Error| Error::disconnected(format!("{address} does not answer: {error}"));
        let mut last = None;
        for resolved in address.to_socket_addrs().map_err(failed)? {
            match TcpStream::connect_timeout(&resolved, CONNECT_TIMEOUT) {
                Ok(stream) => {
                    stream.set_nodelay(true).map_err(failed)?;
                    stream.set_read_timeout(Some(RECEIVE_TIMEOUT)).map_err(failed)?;
                    stream.set_write_timeout(Some(SEND_TIMEOUT)).map_err(failed)?;
                    let (reader, bytes) = (FrameReader::default(), Vec::new());
                    return Ok(Connection { stream, reader, bytes, waits: true });
                }
                Err(error) => last = Some(error),
            }
        }
        Err(match last {
            Some(error) => failed(error),
            None => Error::disconnected(format!("{address} is the address of nothing")),
        })
    }

    pub(crate) fn send(&mut self, message: &[u8]) -> Result<(), Error> {
        self.wait(true)?;
        self.bytes.clear();
        frame::write(message, &mut self.bytes);
        self.stream.write_all(&self.bytes).map_err(|error| ended(&error.to_string()))
    }

    /// Waits for the next message and reads it.
    pub(crate) fn receive<T>(&mut self, read: impl FnOnce(&[u8]) -> Result<T, Error>) -> Result<T, Error> {
        self.wait(true)?;
        while !self.reader.has_message()? {
            self.fill()?;
        }
        match self.reader.next_message()? {
            Some(message) => read(message),
            None => Err(ended("a message was lost")),
        }
    }

    /// Waits for the next message for a time; none if it does not arrive.
    pub(crate) fn receive_within(&mut self, time: Duration) -> Result<Option<&[u8]>, Error> {
        self.wait(true)?;
        self.stream.set_read_timeout(Some(time)).map_err(|error| ended(&error.to_string()))?;
        let mut bytes = [0; 16 * 1024];
        while !self.reader.has_message()? {
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(ended("the server has closed it")),
                Ok(length) => self.reader.push(&bytes[..length]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return Ok(None),
            }
        }
        self.stream.set_read_timeout(Some(RECEIVE_TIMEOUT)).map_err(|error| ended(&error.to_string()))?;
        self.reader.next_message()
    }

    /// Shuts down the sending side, and waits until the server has read everything and closes its
    /// side.
    pub(crate) fn finish(mut self) -> Result<(), Error> {
        self.wait(true)?;
        self.stream.shutdown(Shutdown::Write).map_err(|error| ended(&error.to_string()))?;
        let mut bytes = [0; 16 * 1024];
        loop {
            match self.stream.read(&mut bytes) {
                Ok(0) => return Ok(()),
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::ConnectionReset => return Ok(()),
                Err(error) => return Err(ended(&error.to_string())),
            }
        }
    }

    /// Calls `read` with each message that has arrived, and does not wait.
    pub(crate) fn drain(&mut self, mut read: impl FnMut(&[u8]) -> Result<(), Error>) -> Result<(), Error> {
        self.wait(false)?;
        loop {
            while let Some(message) = self.reader.next_message()? {
                read(message)?;
            }
            if !self.fill()? {
                return Ok(());
            }
        }
    }

    /// Reads what has arrived; returns false if nothing has, and reading does not wait.
    fn fill(&mut self) -> Result<bool, Error> {
        let mut bytes = [0; 16 * 1024];
        match self.stream.read(&mut bytes) {
            Ok(0) => Err(ended("the server has closed it")),
            Ok(length) => {
                self.reader.push(&bytes[..length]);
                Ok(true)
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(true),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                match self.waits {
                    true => Err(ended(&format!("nothing has arrived for {} s", RECEIVE_TIMEOUT.as_secs()))),
                    false => Ok(false),
                }
            }
            Err(error) => Err(ended(&error.to_string())),
        }
    }

    fn wait(&mut self, waits: bool) -> Result<(), Error> {
        if self.waits != waits {
            self.stream.set_nonblocking(!waits).map_err(|error| ended(&error.to_string()))?;
            self.waits = waits;
        }
        Ok(())
    }
}

/// Yields the processor to other processes; the time of the agents stands still meanwhile.
#[expect(clippy::disallowed_methods, reason = "waits for a simulation in another process")]
pub(crate) fn pause(time: Duration) {
    std::thread::sleep(time);
}

fn ended(why: &str) -> Error {
    Error::disconnected(format!("the connection to the simulation server has ended: {why}"))
}
