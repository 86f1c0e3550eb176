//! A tool's side of a control socket.

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

/// The name of a control socket ends so.
pub(super) const ENDING: &str = "sock";

/// An answer has at most so many bytes: a message with its names.
const ANSWER_LIMIT: usize = 64 << 20;

/// A run that does not answer for this long is not there.
const PATIENCE: Duration = Duration::from_secs(5);

/// The control sockets in a folder: the name of each run and where its socket is, by name. Some may be left over from runs that were
/// killed.
pub fn control_sockets(folder: &Path) -> Vec<(String, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let sockets = entries.map(|entry| entry.path());
    let named = sockets.filter(|path| path.extension().is_some_and(|end| end == ENDING));
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

/// The messages that are published in a run while one looks.
#[derive(Debug)]
pub struct Watching {
    stream: UnixStream,
    /// What has come and was not looked at yet.
    bytes: Vec<u8>,
    looked_at: usize,
}

impl ControlClient {
    /// Connects to the run whose socket is at `path`.
    ///
    /// # Errors
    /// Nobody is there.
    pub fn connect(path: &Path) -> Result<ControlClient, Error> {
        let failed =
            |error: io::Error| Error::new(ErrorKind::Connection, format!("{}: {error}", path.display()));
        let stream = UnixStream::connect(path).map_err(failed)?;
        stream.set_read_timeout(Some(PATIENCE)).map_err(failed)?;
        stream.set_write_timeout(Some(PATIENCE)).map_err(failed)?;
        Ok(ControlClient { stream })
    }

    /// What the run is.
    ///
    /// # Errors
    /// It does not answer.
    pub fn describe(&mut self) -> Result<Run, Error> {
        self.ask(&Request { describe: Some(Describe {}), ..Request::default() })?.run.ok_or_else(odd)
    }

    /// Topics of a host (of all, if the name is empty) that a pattern fits (all, if it is empty), as [`narukom::Narukom::subscriber`]
    /// has it.
    ///
    /// # Errors
    /// The run does not answer, or knows no such host or topic.
    pub fn topics(&mut self, host: &str, pattern: &str) -> Result<Vec<TopicEntry>, Error> {
        let topics = Some(ListTopics { host: host.into(), pattern: pattern.into() });
        let answer = self.ask(&Request { topics, ..Request::default() })?;
        answer.topics.map(|topics| topics.topics).ok_or_else(odd)
    }

    /// The message type of a topic.
    ///
    /// # Errors
    /// The run does not answer, or knows no such topic.
    pub fn schema(&mut self, path: &str) -> Result<Schema, Error> {
        let schema = Some(FetchSchema { path: path.into() });
        self.ask(&Request { schema, ..Request::default() })?.schema.ok_or_else(odd)
    }

    /// Publishes a message.
    ///
    /// # Errors
    /// The run does not answer, or refuses.
    pub fn publish(&mut self, host: &str, path: &str, payload: Vec<u8>) -> Result<(), Error> {
        let publish = Some(Publish { host: host.into(), path: path.into(), payload });
        self.ask(&Request { publish, ..Request::default() })?.published.map(drop).ok_or_else(odd)
    }

    /// Asks something of the agents, in their own words.
    ///
    /// # Errors
    /// The run does not answer, or refuses.
    pub fn manage(&mut self, inquiry: Vec<u8>) -> Result<Vec<u8>, Error> {
        let manage = Some(Manage { inquiry });
        let answer = self.ask(&Request { manage, ..Request::default() })?;
        answer.managed.map(|managed| managed.reply).ok_or_else(odd)
    }

    /// Watches topics, as [`topics`](ControlClient::topics) names them; with their messages, or only what is known of these.
    ///
    /// # Errors
    /// The run is gone. That it knows no such host or topic is said by [`Watching::wait`].
    pub fn watch(mut self, host: &str, pattern: &str, payload: bool) -> Result<Watching, Error> {
        let watch = Some(Watch { host: host.into(), pattern: pattern.into(), payload });
        self.send(&Request { watch, ..Request::default() })?;
        Ok(Watching { stream: self.stream, bytes: Vec::new(), looked_at: 0 })
    }

    fn send(&mut self, request: &Request) -> Result<(), Error> {
        frame::write(request, &mut self.stream).map_err(lost)
    }

    fn ask(&mut self, request: &Request) -> Result<Answer, Error> {
        // A run that serves too many says so before it hears the request.
        let sent = self.send(request);
        let answer = frame::read(&mut self.stream, ANSWER_LIMIT).map_err(lost);
        match (sent, answer) {
            (_, Ok(answer)) => refusal(answer),
            (Err(error), Err(_)) | (Ok(()), Err(error)) => Err(error),
        }
    }
}

impl Watching {
    /// The next message; none if there is none for as long as `patience`.
    ///
    /// # Errors
    /// The run is gone, or refuses.
    pub fn wait(&mut self, patience: Duration) -> Result<Option<Seen>, Error> {
        // A patience of nothing would mean forever.
        self.stream.set_read_timeout(Some(patience.max(Duration::from_millis(1)))).map_err(lost)?;
        loop {
            if let Some(answer) = self.next()? {
                return refusal(answer)?.seen.map(Some).ok_or_else(odd);
            }
            let mut buffer = [0; 16 << 10];
            match self.stream.read(&mut buffer) {
                Ok(0) => return Err(lost(io::ErrorKind::UnexpectedEof.into())),
                Ok(count) => self.bytes.extend(&buffer[..count]),
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                    return Ok(None);
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => return Ok(None),
                Err(error) => return Err(lost(error)),
            }
        }
    }

    /// The next answer, if all of it is here.
    fn next(&mut self) -> Result<Option<Answer>, Error> {
        let rest = &self.bytes[self.looked_at..];
        let Some((length, rest)) = rest.split_first_chunk::<4>() else {
            return Ok(self.tidy());
        };
        let length = u32::from_le_bytes(*length) as usize;
        if length > ANSWER_LIMIT {
            return Err(odd());
        }
        let Some(bytes) = rest.get(..length) else { return Ok(self.tidy()) };
        let answer = Answer::decode(bytes).map_err(|_| odd())?;
        self.looked_at += 4 + length;
        Ok(Some(answer))
    }

    /// Lets go of what was looked at.
    fn tidy(&mut self) -> Option<Answer> {
        self.bytes.drain(..self.looked_at);
        self.looked_at = 0;
        None
    }
}

fn refusal(answer: Answer) -> Result<Answer, Error> {
    match answer.refused {
        Some(refused) => Err(Error::new(ErrorKind::Refused, refused.reason)),
        None => Ok(answer),
    }
}

fn lost(error: io::Error) -> Error {
    let text = match error.kind() {
        io::ErrorKind::UnexpectedEof | io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset => {
            "the run has ended".to_owned()
        }
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => "the run does not answer".to_owned(),
        _ => format!("the run is lost: {error}"),
    };
    Error::new(ErrorKind::Connection, text)
}

fn odd() -> Error {
    Error::new(ErrorKind::Connection, "the run answers what was not asked; it may be of another version")
}
