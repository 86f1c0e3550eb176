//! Reading tapes.

use std::borrow::Cow;
use std::fmt;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use mcap::McapError;
use mcap::read::{Options, RawMessageStream};
use narukom::Moment;

use crate::error::Error;

/// Reads the tape at `path`; the short form of [`Recording::open`].
pub fn read(path: impl AsRef<Path>) -> Result<Recording, Error> {
    Recording::open(path)
}

/// A tape that was recorded, in memory.
#[derive(Clone, Debug)]
pub struct Recording {
    bytes: Vec<u8>,
}

impl Recording {
    /// Reads a file.
    pub fn open(path: impl AsRef<Path>) -> Result<Recording, Error> {
        let bytes = fs::read(path.as_ref()).map_err(|error| Error::file(path.as_ref(), error))?;
        Ok(Recording::from_bytes(bytes))
    }

    /// Takes the content of a file.
    pub fn from_bytes(bytes: Vec<u8>) -> Recording {
        Recording { bytes }
    }

    /// The messages in the order of publication. Of a file that was cut off, those before the cut.
    pub fn messages(&self) -> Result<Messages<'_>, Error> {
        let stream = RawMessageStream::new_with_options(&self.bytes, Options::IgnoreEndMagic.into());
        Ok(Messages { stream: stream.map_err(Error::damaged)?, channels: Vec::new() })
    }

    /// Whether the recording was finished: whether nothing is missing at its end.
    pub fn is_finished(&self) -> bool {
        self.bytes.len() > mcap::MAGIC.len() && self.bytes.ends_with(mcap::MAGIC)
    }
}

/// The messages of a [`Recording`].
pub struct Messages<'a> {
    stream: RawMessageStream<'a>,
    channels: Vec<Option<Arc<Channel>>>,
}

/// A recorded message.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Message<'a> {
    /// Where it was published and what it is.
    pub channel: Arc<Channel>,
    /// Counts the publisher's messages on the topic from 1; the lower 32 bits.
    pub sequence: u32,
    /// When it was published, by the publisher's clock.
    pub published: Moment,
    /// When it came to the hub that was recorded.
    pub received: Moment,
    /// Its protobuf encoding.
    pub bytes: Cow<'a, [u8]>,
}

/// What the messages of one host, topic and publisher have in common.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Channel {
    /// The host.
    pub host: String,
    /// Who published.
    pub publisher: String,
    /// The topic's path, without the host.
    pub topic: String,
    /// The way of keeping: `state`, `signal` or `data`.
    pub kind: String,
    /// The full name of the message type.
    pub message_type: String,
    /// The type's serialised `google.protobuf.FileDescriptorSet`.
    pub schema: Vec<u8>,
}

impl<'a> Iterator for Messages<'a> {
    type Item = Result<Message<'a>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let raw = match self.stream.next()? {
            Ok(raw) => raw,
            Err(McapError::UnexpectedEof | McapError::UnexpectedEoc) => return None,
            Err(error) => return Some(Err(Error::damaged(error))),
        };
        let header = raw.header;
        let Some(channel) = self.channel(header.channel_id) else {
            return Some(Err(Error::damaged(McapError::UnknownChannel(header.sequence, header.channel_id))));
        };
        Some(Ok(Message {
            channel,
            sequence: header.sequence,
            published: Moment::from_nanos(header.publish_time),
            received: Moment::from_nanos(header.log_time),
            bytes: raw.data,
        }))
    }
}

impl fmt::Debug for Messages<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Messages")
    }
}

impl Messages<'_> {
    fn channel(&mut self, id: u16) -> Option<Arc<Channel>> {
        let index = usize::from(id);
        if self.channels.len() <= index {
            self.channels.resize(index + 1, None);
        }
        if self.channels[index].is_none() {
            self.channels[index] = Some(Arc::new(Channel::new(&*self.stream.get_channel(id)?)));
        }
        self.channels[index].clone()
    }
}

impl Channel {
    fn new(channel: &mcap::Channel<'_>) -> Channel {
        let of = |key: &str| channel.metadata.get(key).cloned().unwrap_or_default();
        let schema = channel.schema.as_deref();
        Channel {
            host: of("host"),
            publisher: of("publisher"),
            topic: channel.metadata.get("topic").unwrap_or(&channel.topic).clone(),
            kind: of("kind"),
            message_type: schema.map(|schema| schema.name.clone()).unwrap_or_default(),
            schema: schema.map(|schema| schema.data.to_vec()).unwrap_or_default(),
        }
    }
}
