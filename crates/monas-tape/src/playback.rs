//! Reading tapes.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use narukom::Moment;

use crate::error::Error;
use crate::records::{
    self, Bytes, CHANNEL, CHUNK, ChannelRecord, Chunk, DATA_END, MAGIC, MESSAGE, Record, SCHEMA,
};

/// Reads the tape at `path`; the short form of [`Recording::open`].
///
/// # Errors
/// The file cannot be read.
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
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn open(path: impl AsRef<Path>) -> Result<Recording, Error> {
        let bytes = fs::read(path.as_ref()).map_err(|error| Error::file(path.as_ref(), error))?;
        Ok(Recording::from_bytes(bytes))
    }

    /// Takes the content of a file.
    pub fn from_bytes(bytes: Vec<u8>) -> Recording {
        Recording { bytes }
    }

    /// The messages in the order of publication. Of a file that was cut off, those before the cut; where a file is damaged, an
    /// error ends them.
    ///
    /// # Errors
    /// The file is no MCAP file.
    pub fn messages(&self) -> Result<Messages<'_>, Error> {
        let rest = self
            .bytes
            .strip_prefix(MAGIC)
            .ok_or_else(|| Error::damaged("it does not begin as an MCAP file"))?;
        let (schemas, channels) = (BTreeMap::new(), BTreeMap::new());
        Ok(Messages { rest: Bytes(rest), chunk: Bytes::default(), schemas, channels })
    }

    /// Whether the recording was finished: whether nothing is missing at its end.
    pub fn is_finished(&self) -> bool {
        self.bytes.len() > MAGIC.len() && self.bytes.ends_with(MAGIC)
    }
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
    pub bytes: &'a [u8],
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

/// The messages of a [`Recording`].
pub struct Messages<'a> {
    /// What is left of the file.
    rest: Bytes<'a>,
    /// What is left of the chunk that is being read.
    chunk: Bytes<'a>,
    schemas: BTreeMap<u16, records::Schema<'a>>,
    channels: BTreeMap<u16, Arc<Channel>>,
}

impl<'a> Iterator for Messages<'a> {
    type Item = Result<Message<'a>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let next = self.next_message().transpose()?;
        if next.is_err() {
            (self.rest, self.chunk) = Default::default();
        }
        Some(next)
    }
}

impl<'a> Messages<'a> {
    fn next_message(&mut self) -> Result<Option<Message<'a>>, Error> {
        while let Some(record) = self.chunk.record().or_else(|| self.rest.record()) {
            match record.kind {
                CHUNK => self.chunk = records_of(record.body)?,
                // A record that was cut is the last of its surroundings: nothing else stands after it.
                _ if !record.is_whole => {}
                SCHEMA => self.learn_schema(record.body)?,
                CHANNEL => self.learn_channel(record.body)?,
                MESSAGE => return self.message(&record).map(Some),
                DATA_END => return Ok(None),
                _ => {}
            }
        }
        Ok(None)
    }

    fn learn_schema(&mut self, body: Bytes<'a>) -> Result<(), Error> {
        let schema = body.schema().ok_or_else(|| Error::damaged("a schema is incomplete"))?;
        self.schemas.insert(schema.id, schema);
        Ok(())
    }

    fn learn_channel(&mut self, body: Bytes<'a>) -> Result<(), Error> {
        let record = body.channel().ok_or_else(|| Error::damaged("a channel is incomplete"))?;
        let schema = self.schemas.get(&record.schema);
        let schema = schema.ok_or_else(|| Error::damaged("a channel has an unknown schema"))?;
        self.channels.insert(record.id, Arc::new(Channel::new(&record, schema)));
        Ok(())
    }

    fn message(&self, record: &Record<'a>) -> Result<Message<'a>, Error> {
        let message = record.body.message().ok_or_else(|| Error::damaged("a message is incomplete"))?;
        let channel = self.channels.get(&message.channel);
        let channel = channel.ok_or_else(|| Error::damaged("a message has an unknown channel"))?;
        Ok(Message {
            channel: channel.clone(),
            sequence: message.sequence,
            published: Moment::from_nanos(message.publish_time),
            received: Moment::from_nanos(message.log_time),
            bytes: message.data,
        })
    }
}

/// The records of a chunk; of one that was cut off, those that are there.
fn records_of(body: Bytes<'_>) -> Result<Bytes<'_>, Error> {
    let Some(Chunk { crc, compression, records, is_whole }) = body.chunk() else {
        return Ok(Bytes::default());
    };
    if !compression.is_empty() {
        return Err(Error::compressed(compression));
    }
    if is_whole && crc != 0 && records::crc32(records) != crc {
        return Err(Error::damaged("the checksum of a chunk is wrong"));
    }
    Ok(Bytes(records))
}

impl Channel {
    fn new(record: &ChannelRecord<'_>, schema: &records::Schema<'_>) -> Channel {
        let fact = |key| record.fact(key).unwrap_or_default().to_owned();
        Channel {
            host: fact("host"),
            publisher: fact("publisher"),
            // Tapes of others have no such fact; there the channel's name is all there is.
            topic: record.fact("topic").unwrap_or(record.topic).to_owned(),
            kind: fact("kind"),
            message_type: schema.name.to_owned(),
            schema: schema.data.to_vec(),
        }
    }
}

impl fmt::Debug for Messages<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Messages({} bytes left)", self.rest.0.len())
    }
}
