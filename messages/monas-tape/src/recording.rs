//! Reading tapes.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use narukom::{Publication, Timestamp};

use crate::error::Error;
use crate::records::{
    self, ATTACHMENT, Bytes, CHANNEL, CHUNK, ChannelRecord, Chunk, DATA_END, MAGIC, MESSAGE, METADATA,
    Record, SCHEMA,
};

/// The encoding of messages and their schemas.
pub(crate) const PROTOBUF: &str = "protobuf";

/// Reads the tape at `path`; the short form of [`Recording::open`].
///
/// # Errors
/// The file cannot be read.
pub fn read(path: impl AsRef<Path>) -> Result<Recording, Error> {
    Recording::open(path)
}

/// A recorded tape, in memory.
#[derive(Clone, Debug)]
pub struct Recording {
    bytes: Vec<u8>,
    /// Its file, if it has one, for errors.
    path: Option<PathBuf>,
}

impl Recording {
    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn open(path: impl AsRef<Path>) -> Result<Recording, Error> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|error| Error::file(path, error))?;
        Ok(Recording { bytes, path: Some(path.to_owned()) })
    }

    /// Uses the content of a file.
    pub fn from_bytes(bytes: Vec<u8>) -> Recording {
        Recording { bytes, path: None }
    }

    /// The messages in order of publication. Of a truncated file, those before the truncation; in a
    /// damaged file, an error ends the iteration.
    ///
    /// # Errors
    /// The file is not an MCAP file.
    pub fn messages(&self) -> Result<Messages<'_>, Error> {
        Ok(Messages { contents: self.contents()?, is_over: false })
    }

    /// All items in the order in which they were written. Of a truncated file, those before the
    /// truncation; each damaged part yields an error, and the iteration continues.
    ///
    /// # Errors
    /// The file is not an MCAP file.
    pub fn contents(&self) -> Result<RecordingItems<'_>, Error> {
        let path = self.path.as_deref();
        let rest = self
            .bytes
            .strip_prefix(MAGIC)
            .ok_or_else(|| Error::damaged("it does not begin as an MCAP file").of_file(path))?;
        let (schemas, channels, is_finished) = (BTreeMap::new(), BTreeMap::new(), self.is_finished());
        let rest = Bytes(rest);
        let chunk = Bytes::default();
        let mut items = RecordingItems { path, rest, chunk, schemas, channels, is_finished };
        // A finished tape repeats them, so that messages behind a damaged chunk are known.
        let mut summary = Bytes(self.summary().unwrap_or_default());
        while let Some(record) = summary.record() {
            let learned = match record.kind {
                SCHEMA => items.learn_schema(record.body),
                CHANNEL => items.learn_channel(record.body),
                _ => Ok(()),
            };
            if learned.is_err() {
                break;
            }
        }
        Ok(items)
    }

    /// The summary section of a finished tape: from the offset that begins the footer, 20 bytes.
    fn summary(&self) -> Option<&[u8]> {
        let end = self.bytes.strip_suffix(MAGIC)?;
        let footer = end.len().checked_sub(20)?;
        let start = u64::from_le_bytes(*end.get(footer..)?.first_chunk()?);
        let start = usize::try_from(start).ok().filter(|&start| start >= MAGIC.len())?;
        end.get(start..footer)
    }

    /// Whether the recording was finished, so that nothing is missing at its end.
    pub fn is_finished(&self) -> bool {
        self.bytes.len() > MAGIC.len() && self.bytes.ends_with(MAGIC)
    }

    /// The position of a message's bytes, to find them again with
    /// [`bytes_at`](Recording::bytes_at).
    pub fn range_of(&self, message: &RecordedSample<'_>) -> Range<usize> {
        let begin = (message.bytes.as_ptr() as usize).saturating_sub(self.bytes.as_ptr() as usize);
        begin..begin + message.bytes.len()
    }

    /// The bytes in a range; none if it is not in the file.
    pub fn bytes_at(&self, range: Range<usize>) -> Option<&[u8]> {
        self.bytes.get(range)
    }

    /// The size in bytes.
    pub fn size(&self) -> usize {
        self.bytes.len()
    }
}

/// An item of a tape.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RecordingItem<'a> {
    /// A message.
    Message(RecordedSample<'a>),
    /// A metadata entry about the run.
    Facts(MetadataEntry),
    /// An attachment.
    Attachment(Attachment<'a>),
}

/// A recorded message.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RecordedSample<'a> {
    /// Its origin and type.
    pub channel: Arc<Channel>,
    /// Sequence number among the publisher's messages on the topic, from 1; the lower 32 bits.
    pub sequence: u32,
    /// Time of publication, by the clock of the host that recorded it.
    pub published: Timestamp,
    /// Time of arrival at the recorded hub.
    pub received: Timestamp,
    /// Its protobuf encoding.
    pub bytes: &'a [u8],
}

/// Named metadata about a run: version, seed, hash of the configuration.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MetadataEntry {
    /// The name of the entry.
    pub name: String,
    /// The keys and values.
    pub entries: BTreeMap<String, String>,
}

/// An attachment of a tape: a configuration, a model.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Attachment<'a> {
    /// Its name, a path with slashes.
    pub name: &'a str,
    /// Its media type: `text/xml`.
    pub media_type: &'a str,
    /// Its content.
    pub bytes: &'a [u8],
}

/// The common metadata of the messages of one host, topic and publisher, or of one part of the
/// publisher.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Channel {
    /// The host on which they were published.
    pub host: String,
    /// The host that recorded them, if it received them from another host.
    pub received_by: Option<String>,
    /// The publisher.
    pub publisher: String,
    /// The part of the publisher, from 0: see [`Header::part`](narukom::Header::part).
    pub part: u16,
    /// The topic's path, without the host.
    pub topic: String,
    /// The retention kind: `state`, `signal` or `data`.
    pub kind: String,
    /// The type of the messages.
    pub schema: Arc<Schema>,
    /// The channel's name in the file, the encoding of its messages, and all its metadata.
    pub(crate) name: String,
    pub(crate) encoding: String,
    pub(crate) facts: BTreeMap<String, String>,
}

/// A message type.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Schema {
    /// Its full name.
    pub name: String,
    /// The encoding of the schema: `protobuf`.
    pub encoding: String,
    /// The schema: for `protobuf` a serialised `google.protobuf.FileDescriptorSet`.
    pub data: Vec<u8>,
}

/// The messages of a [`Recording`].
#[derive(Debug)]
pub struct Messages<'a> {
    contents: RecordingItems<'a>,
    is_over: bool,
}

impl<'a> Iterator for Messages<'a> {
    type Item = Result<RecordedSample<'a>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.is_over {
            match self.contents.next()? {
                Ok(RecordingItem::Message(message)) => return Some(Ok(message)),
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

/// All items of a [`Recording`].
pub struct RecordingItems<'a> {
    /// The file, for errors.
    path: Option<&'a Path>,
    /// The unread part of the file.
    rest: Bytes<'a>,
    /// The unread part of the current chunk.
    chunk: Bytes<'a>,
    /// Shared by their channels, so that a small file cannot use much memory.
    schemas: BTreeMap<u16, Arc<Schema>>,
    channels: BTreeMap<u16, Arc<Channel>>,
    is_finished: bool,
}

impl<'a> Iterator for RecordingItems<'a> {
    type Item = Result<RecordingItem<'a>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_content().map_err(|error| error.of_file(self.path)).transpose()
    }
}

impl<'a> RecordingItems<'a> {
    fn next_content(&mut self) -> Result<Option<RecordingItem<'a>>, Error> {
        while let Some(record) = self.chunk.record().or_else(|| self.rest.record()) {
            match record.kind {
                CHUNK if record.is_whole || !self.is_finished => self.chunk = records_of(record.body)?,
                // A truncated record is the last one of its container: nothing follows it.
                _ if !record.is_whole && !self.is_finished => {}
                _ if !record.is_whole => return Err(Error::damaged("a record is longer than the tape")),
                SCHEMA => self.learn_schema(record.body)?,
                CHANNEL => self.learn_channel(record.body)?,
                MESSAGE => return self.message(&record).map(|message| Some(RecordingItem::Message(message))),
                METADATA => return facts(record.body).map(|facts| Some(RecordingItem::Facts(facts))),
                ATTACHMENT => {
                    return attachment(record.body).map(|file| Some(RecordingItem::Attachment(file)));
                }
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
        // A channel record may be repeated; the first one is kept.
        if self.channels.get(&record.id).is_none_or(|known| **known != channel) {
            self.channels.insert(record.id, Arc::new(channel));
        }
        Ok(())
    }

    fn message(&self, record: &Record<'a>) -> Result<RecordedSample<'a>, Error> {
        let message = record.body.message().ok_or_else(|| Error::damaged("a message is incomplete"))?;
        let channel = self.channels.get(&message.channel);
        let channel = channel.ok_or_else(|| Error::damaged("a message has an unknown channel"))?;
        Ok(RecordedSample {
            channel: channel.clone(),
            sequence: message.sequence,
            published: Timestamp::from_nanos(message.publish_time),
            received: Timestamp::from_nanos(message.log_time),
            bytes: message.data,
        })
    }
}

/// The records of a chunk; of a truncated one, those that are present.
fn records_of(body: Bytes<'_>) -> Result<Bytes<'_>, Error> {
    let Some(Chunk { crc, compression, records, is_whole }) = body.chunk() else {
        return Ok(Bytes::default());
    };
    if !compression.is_empty() {
        return Err(Error::compressed(compression));
    }
    if is_whole && crc != 0 && crc32fast::hash(records) != crc {
        return Err(Error::damaged("the checksum of a chunk is wrong"));
    }
    Ok(Bytes(records))
}

fn facts(body: Bytes<'_>) -> Result<MetadataEntry, Error> {
    let (name, entries) = body.metadata().ok_or_else(|| Error::damaged("facts are incomplete"))?;
    Ok(MetadataEntry { name: name.to_owned(), entries: owned(entries) })
}

fn attachment(body: Bytes<'_>) -> Result<Attachment<'_>, Error> {
    let file = body.attachment().ok_or_else(|| Error::damaged("an attachment is incomplete"))?;
    if file.crc != 0 && crc32fast::hash(file.checked) != file.crc {
        return Err(Error::damaged(format!("the checksum of the attachment `{}` is wrong", file.name)));
    }
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
            // Files of other tools lack these keys; then the channel's name is all there is.
            topic: fact("topic").unwrap_or_else(|| record.topic.to_owned()),
            kind: fact("kind").unwrap_or_default(),
            schema,
            name: record.topic.to_owned(),
            encoding: record.encoding.to_owned(),
            facts,
        }
    }

    /// The channel of what is published on a host, or received by another one from it.
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

    /// Whether messages can be decoded: they are protobuf, and their schema is present.
    pub fn is_protobuf(&self) -> bool {
        self.encoding == PROTOBUF && self.schema.encoding == PROTOBUF
    }
}

impl fmt::Debug for RecordingItems<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RecordingItems({} bytes left)", self.rest.0.len())
    }
}
