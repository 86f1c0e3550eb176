//! Client side of a control socket.

use std::fs;
use std::io::{self, Read};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::Duration;

use prost::Message;

use super::frame;
use super::messages::{
    Answer, Describe, FetchSchema, ListTopics, Manage, Publish, Request, Run, Schema, Seen, TopicEntry, Watch,
};
use crate::error::{Error, ErrorKind};

/// File extension of control sockets.
pub(super) const EXTENSION: &str = "sock";

/// Longest reply, in bytes: a message with its names.
const ANSWER_LIMIT: usize = 64 << 20;

/// Time after which a run that does not reply is considered dead.
const TIMEOUT: Duration = Duration::from_secs(5);

/// The control sockets in a folder, sorted by name: the name of each run and the path of its
/// socket. Some may be left over from runs that were killed. A folder that other users can access
/// has none, since its sockets may be theirs.
pub fn control_sockets(folder: &Path) -> Vec<(String, PathBuf)> {
    if monas_files::check_private(folder).is_err() {
        return Vec::new();
    }
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let sockets = entries.map(|entry| entry.path());
    let named = sockets.filter(|path| path.extension().is_some_and(|end| end == EXTENSION));
    let mut found: Vec<(String, PathBuf)> =
        named.filter_map(|path| Some((path.file_stem()?.to_str()?.to_owned(), path))).collect();
    found.sort_unstable();
    found
}

/// A connection to a run.
#[derive(Debug)]
pub struct ControlClient {
    stream: UnixStream,
}

/// A stream of the messages that are published in a run.
#[derive(Debug)]
pub struct WatchStream {
    stream: UnixStream,
    /// Received bytes that have not been processed.
    bytes: Vec<u8>,
    searched: usize,
}

impl ControlClient {
    /// Connects to the run whose socket is at `path`.
    ///
    /// # Errors
    /// No run is listening.
    pub fn connect(path: &Path) -> Result<ControlClient, Error> {
        let failed =
            |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()));
        let stream = UnixStream::connect(path).map_err(failed)?;
        stream.set_read_timeout(Some(TIMEOUT)).map_err(failed)?;
        stream.set_write_timeout(Some(TIMEOUT)).map_err(failed)?;
        Ok(ControlClient { stream })
    }

    /// Describes the run.
    ///
    /// # Errors
    /// The run does not reply.
    pub fn describe(&mut self) -> Result<Run, Error> {
        self.request(&Request { describe: Some(Describe {}), ..Request::default() })?
            .run
            .ok_or_else(unexpected_reply)
    }

    /// Topics of a host (of all, if the name is empty) that match a pattern (all, if it is empty),
    /// with the syntax of [`narukom::Hub::subscriber`].
    ///
    /// # Errors
    /// The run does not reply, or has no such host or topic.
    pub fn topics(&mut self, host: &str, pattern: &str) -> Result<Vec<TopicEntry>, Error> {
        let topics = Some(ListTopics { host: host.into(), pattern: pattern.into() });
        let answer = self.request(&Request { topics, ..Request::default() })?;
        answer.topics.map(|topics| topics.topics).ok_or_else(unexpected_reply)
    }

    /// The message type of a topic.
    ///
    /// # Errors
    /// The run does not reply, or has no such topic.
    pub fn schema(&mut self, path: &str) -> Result<Schema, Error> {
        let schema = Some(FetchSchema { path: path.into() });
        self.request(&Request { schema, ..Request::default() })?.schema.ok_or_else(unexpected_reply)
    }

    /// Publishes a message.
    ///
    /// # Errors
    /// The run does not reply, or rejects the message.
    pub fn publish(&mut self, host: &str, path: &str, payload: Vec<u8>) -> Result<(), Error> {
        let publish = Some(Publish { host: host.into(), path: path.into(), payload });
        self.request(&Request { publish, ..Request::default() })?
            .published
            .map(drop)
            .ok_or_else(unexpected_reply)
    }

    /// Sends a management request to the agents, in the runtime's format.
    ///
    /// # Errors
    /// The run does not reply, or rejects the request.
    pub fn manage(&mut self, inquiry: Vec<u8>) -> Result<Vec<u8>, Error> {
        let manage = Some(Manage { inquiry });
        let answer = self.request(&Request { manage, ..Request::default() })?;
        answer.managed.map(|managed| managed.reply).ok_or_else(unexpected_reply)
    }

    /// Watches topics, selected as for [`topics`](ControlClient::topics); with their messages, or
    /// only their metadata.
    ///
    /// # Errors
    /// The connection is lost. An unknown host or topic is reported by [`WatchStream::wait`].
    pub fn watch(self, host: &str, pattern: &str, payload: bool) -> Result<WatchStream, Error> {
        self.watch_all(host, &[pattern], payload)
    }

    /// The same for several patterns. Those that match no topic are skipped if another does;
    /// messages of different patterns may arrive out of order.
    ///
    /// # Errors
    /// As [`watch`](ControlClient::watch).
    pub fn watch_all(mut self, host: &str, patterns: &[&str], payload: bool) -> Result<WatchStream, Error> {
        let mut patterns = patterns.iter().map(|pattern| (*pattern).to_owned());
        let (pattern, more) = (patterns.next().unwrap_or_default(), patterns.collect());
        let watch = Some(Watch { host: host.into(), pattern, payload, more });
        self.send(&Request { watch, ..Request::default() })?;
        Ok(WatchStream { stream: self.stream, bytes: Vec::new(), searched: 0 })
    }

    fn send(&mut self, request: &Request) -> Result<(), Error> {
        frame::write(request, &mut self.stream).map_err(connection_lost)
    }

    fn request(&mut self, request: &Request) -> Result<Answer, Error> {
        // A run that serves too many tools says so before it reads the request.
        let sent = self.send(request);
        let answer = frame::read(&mut self.stream, ANSWER_LIMIT).map_err(connection_lost);
        match (sent, answer) {
            (_, Ok(answer)) => refusal(answer),
            (Err(error), Err(_)) | (Ok(()), Err(error)) => Err(error),
        }
    }
}

impl WatchStream {
    /// The next message; `None` if there is none within `timeout`.
    ///
    /// # Errors
    /// The connection is lost, or the run rejects the request.
    pub fn wait(&mut self, timeout: Duration) -> Result<Option<Seen>, Error> {
        // A timeout of zero would mean no timeout.
        self.stream.set_read_timeout(Some(timeout.max(Duration::from_millis(1)))).map_err(connection_lost)?;
        loop {
            if let Some(answer) = self.next()? {
                return refusal(answer)?.seen.map(Some).ok_or_else(unexpected_reply);
            }
            let mut buffer = [0; 16 << 10];
            match self.stream.read(&mut buffer) {
                Ok(0) => return Err(connection_lost(io::ErrorKind::UnexpectedEof.into())),
                Ok(count) => self.bytes.extend(&buffer[..count]),
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                    return Ok(None);
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => return Ok(None),
                Err(error) => return Err(connection_lost(error)),
            }
        }
    }

    /// The next reply, if it is complete.
    fn next(&mut self) -> Result<Option<Answer>, Error> {
        let rest = &self.bytes[self.searched..];
        let Some((length, rest)) = rest.split_first_chunk::<4>() else {
            return Ok(self.discard_consumed());
        };
        let length = u32::from_le_bytes(*length) as usize;
        if length > ANSWER_LIMIT {
            return Err(unexpected_reply());
        }
        let Some(bytes) = rest.get(..length) else { return Ok(self.discard_consumed()) };
        let answer = Answer::decode(bytes).map_err(|_| unexpected_reply())?;
        self.searched += 4 + length;
        Ok(Some(answer))
    }

    /// Discards the processed bytes.
    fn discard_consumed(&mut self) -> Option<Answer> {
        self.bytes.drain(..self.searched);
        self.searched = 0;
        None
    }
}

fn refusal(answer: Answer) -> Result<Answer, Error> {
    match answer.refused {
        Some(refused) => Err(Error::new(ErrorKind::Refused, refused.reason)),
        None => Ok(answer),
    }
}

fn connection_lost(error: io::Error) -> Error {
    let text = match error.kind() {
        io::ErrorKind::UnexpectedEof | io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset => {
            "the run has ended".to_owned()
        }
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => "the run does not answer".to_owned(),
        _ => format!("the run is lost: {error}"),
    };
    Error::new(ErrorKind::Connection, text)
}

fn unexpected_reply() -> Error {
    Error::new(ErrorKind::Connection, "unexpected reply; is the run another version of monas?")
}
