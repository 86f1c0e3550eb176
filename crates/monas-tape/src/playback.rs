//! Reading tapes.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use narukom::{Moment, Publication};

use crate::error::Error;
use crate::records::{
    self, ATTACHMENT, Bytes, CHANNEL, CHUNK, ChannelRecord, Chunk, DATA_END, MAGIC, MESSAGE, METADATA,
    Record, SCHEMA,
};

/// How messages and their schemas are encoded.
pub(crate) const PROTOBUF: &str = "protobuf";

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
        Ok(Messages { contents: self.contents()?, is_over: false })
    }

    /// Everything in the order in which it was written. Of a file that was cut off, what stands before the cut; what is damaged is
    /// an error each, after which it goes on.
    ///
    /// # Errors
    /// The file is no MCAP file.
    pub fn contents(&self) -> Result<Contents<'_>, Error> {
        let rest = self
            .bytes
            .strip_prefix(MAGIC)
            .ok_or_else(|| Error::damaged("it does not begin as an MCAP file"))?;
        let (schemas, channels) = (BTreeMap::new(), BTreeMap::new());
        Ok(Contents { rest: Bytes(rest), chunk: Bytes::default(), schemas, channels })
    }

    /// Whether the recording was finished: whether nothing is missing at its end.
    pub fn is_finished(&self) -> bool {
        self.bytes.len() > MAGIC.len() && self.bytes.ends_with(MAGIC)
    }

    /// How many bytes it has.
    pub fn size(&self) -> usize {
        self.bytes.len()
    }
}

/// What a tape holds.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Content<'a> {
    /// A message.
    Message(Message<'a>),
    /// Facts about the run.
    Facts(Facts),
    /// A file that was put into the tape.
    Attachment(Attachment<'a>),
}

/// A recorded message.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Message<'a> {
    /// Where it was published and what it is.
    pub channel: Arc<Channel>,
    /// Counts the publisher's messages on the topic from 1; the lower 32 bits.
    pub sequence: u32,
    /// When it was published: by the clock of the host that recorded it.
    pub published: Moment,
    /// When it came to the hub that was recorded.
    pub received: Moment,
    /// Its protobuf encoding.
    pub bytes: &'a [u8],
}

/// Facts about a run under a name: version, seed, hash of the configuration.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Facts {
    /// What they are about.
    pub name: String,
    /// The facts.
    pub entries: BTreeMap<String, String>,
}

/// A file in a tape: a configuration, a model.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Attachment<'a> {
    /// Its name, a path with slashes.
    pub name: &'a str,
    /// What it is: `text/xml`.
    pub media_type: &'a str,
    /// Its content.
    pub bytes: &'a [u8],
}

/// What the messages of one host, topic and publisher, or of one of its parts, have in common.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Channel {
    /// The host on which they were published.
    pub host: String,
    /// The host that recorded them, if they came to it from the other one.
    pub received_by: Option<String>,
    /// Who published.
    pub publisher: String,
    /// Which of those who published under that name, from 0: see [`Header::part`](narukom::Header::part).
    pub part: u16,
    /// The topic's path, without the host.
    pub topic: String,
    /// The way of keeping: `state`, `signal` or `data`.
    pub kind: String,
    /// The type of the messages.
    pub schema: Arc<Schema>,
    /// The channel's name in the file, how its messages are encoded, and all facts about it.
    pub(crate) name: String,
    pub(crate) encoding: String,
    pub(crate) facts: BTreeMap<String, String>,
}

/// A message type.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Schema {
    /// Its full name.
    pub name: String,
    /// How it is described: `protobuf`.
    pub encoding: String,
    /// The description: for `protobuf` a serialised `google.protobuf.FileDescriptorSet`.
    pub data: Vec<u8>,
}

/// The messages of a [`Recording`].
#[derive(Debug)]
pub struct Messages<'a> {
    contents: Contents<'a>,
    is_over: bool,
}

impl<'a> Iterator for Messages<'a> {
    type Item = Result<Message<'a>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_over {
            match self.contents.next()? {
                Ok(Content::Message(message)) => return Some(Ok(message)),
                Ok(_) => {}
                Err(error) => {
                    self.is_over = true;
                    return Some(Err(error));
                }
            }
        }
        None
    }
}

/// Everything in a [`Recording`].
pub struct Contents<'a> {
    /// What is left of the file.
    rest: Bytes<'a>,
    /// What is left of the chunk that is being read.
    chunk: Bytes<'a>,
    /// Shared by their channels: what a small file says must not take up much memory.
    schemas: BTreeMap<u16, Arc<Schema>>,
    channels: BTreeMap<u16, Arc<Channel>>,
}

impl<'a> Iterator for Contents<'a> {
    type Item = Result<Content<'a>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_content().transpose()
    }
}

impl<'a> Contents<'a> {
    fn next_content(&mut self) -> Result<Option<Content<'a>>, Error> {
        while let Some(record) = self.chunk.record().or_else(|| self.rest.record()) {
            match record.kind {
                CHUNK => self.chunk = records_of(record.body)?,
                // A record that was cut is the last of its surroundings: nothing else stands after it.
                _ if !record.is_whole => {}
                SCHEMA => self.learn_schema(record.body)?,
                CHANNEL => self.learn_channel(record.body)?,
                MESSAGE => return self.message(&record).map(|message| Some(Content::Message(message))),
                METADATA => return facts(record.body).map(|facts| Some(Content::Facts(facts))),
                ATTACHMENT => return attachment(record.body).map(|file| Some(Content::Attachment(file))),
                DATA_END => {
                    (self.rest, self.chunk) = Default::default();
                    return Ok(None);
                }
                _ => {}
            }
        }
        Ok(None)
    }

    fn learn_schema(&mut self, body: Bytes<'a>) -> Result<(), Error> {
        let schema = body.schema().ok_or_else(|| Error::damaged("a schema is incomplete"))?;
        let records::SchemaRecord { id, name, encoding, data } = schema;
        let schema = Schema { name: name.to_owned(), encoding: encoding.to_owned(), data: data.to_vec() };
        if self.schemas.get(&id).is_none_or(|known| **known != schema) {
            self.schemas.insert(id, Arc::new(schema));
        }
        Ok(())
    }

    fn learn_channel(&mut self, body: Bytes<'a>) -> Result<(), Error> {
        let record = body.channel().ok_or_else(|| Error::damaged("a channel is incomplete"))?;
        let none = || (record.schema == 0).then(Arc::default);
        let schema = self.schemas.get(&record.schema).cloned().or_else(none);
        let schema = schema.ok_or_else(|| Error::damaged("a channel has an unknown schema"))?;
        let channel = Channel::new(&record, schema);
        // A channel may be said again; what was read of it stays the same one.
        if self.channels.get(&record.id).is_none_or(|known| **known != channel) {
            self.channels.insert(record.id, Arc::new(channel));
        }
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

fn facts(body: Bytes<'_>) -> Result<Facts, Error> {
    let (name, entries) = body.metadata().ok_or_else(|| Error::damaged("facts are incomplete"))?;
    Ok(Facts { name: name.to_owned(), entries: owned(entries) })
}

fn attachment(body: Bytes<'_>) -> Result<Attachment<'_>, Error> {
    let file = body.attachment().ok_or_else(|| Error::damaged("an attachment is incomplete"))?;
    Ok(Attachment { name: file.name, media_type: file.media_type, bytes: file.data })
}

fn owned(pairs: Bytes<'_>) -> BTreeMap<String, String> {
    pairs.pairs().map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
}

impl Channel {
    fn new(record: &ChannelRecord<'_>, schema: Arc<Schema>) -> Channel {
        let facts = owned(record.facts);
        let fact = |key: &str| facts.get(key).cloned();
        Channel {
            host: fact("host").unwrap_or_default(),
            received_by: fact("received_by"),
            publisher: fact("publisher").unwrap_or_default(),
            part: fact("part").and_then(|part| part.parse().ok()).unwrap_or_default(),
            // Tapes of others have no such fact; there the channel's name is all there is.
            topic: fact("topic").unwrap_or_else(|| record.topic.to_owned()),
            kind: fact("kind").unwrap_or_default(),
            schema,
            name: record.topic.to_owned(),
            encoding: record.encoding.to_owned(),
            facts,
        }
    }

    /// The channel of what is published on a host, or comes to another one from it.
    pub(crate) fn of(publication: &Publication<'_>, received_by: Option<&str>) -> Channel {
        let Publication { host, publisher, topic, .. } = publication;
        let (descriptor, kind) = (topic.descriptor(), topic.kind().to_string());
        let part = publication.sample.header.part;
        let part_as_text = part.to_string();
        let mut facts =
            vec![("host", *host), ("kind", &kind), ("publisher", publisher), ("topic", topic.path())];
        facts.extend(received_by.map(|name| ("received_by", name)));
        facts.extend((part != 0).then_some(("part", part_as_text.as_str())));
        let name = match received_by {
            Some(name) => format!("{name}/from/{host}/{}", topic.path()),
            None => format!("{host}/{}", topic.path()),
        };
        Channel {
            host: (*host).to_owned(),
            received_by: received_by.map(str::to_owned),
            publisher: (*publisher).to_owned(),
            part,
            topic: topic.path().to_owned(),
            kind: kind.clone(),
            schema: Arc::new(Schema {
                name: descriptor.full_name.to_owned(),
                encoding: PROTOBUF.to_owned(),
                data: descriptor.file_descriptor_set.to_vec(),
            }),
            name,
            encoding: PROTOBUF.to_owned(),
            facts: facts.into_iter().map(|(key, value)| (key.to_owned(), value.to_owned())).collect(),
        }
    }

    /// The full name of the message type.
    pub fn message_type(&self) -> &str {
        &self.schema.name
    }

    /// The host whose hub was recorded.
    pub fn recorded_by(&self) -> &str {
        self.received_by.as_deref().unwrap_or(&self.host)
    }

    /// Whether it can be read by name: its messages are protobuf, and their schema is there.
    pub fn is_protobuf(&self) -> bool {
        self.encoding == PROTOBUF && self.schema.encoding == PROTOBUF
    }
}

impl fmt::Debug for Contents<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Contents({} bytes left)", self.rest.0.len())
    }
}
