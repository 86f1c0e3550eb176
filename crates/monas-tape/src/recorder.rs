//! The file behind a tape: schemas, channels, chunks.

use std::collections::BTreeMap;
use std::io::Write;

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, McapResult, WriteOptions, Writer};
use narukom::Publication;

/// A chunk is closed when its messages span this much time, in nanoseconds: what a killed process loses.
const CHUNK_SPAN: u64 = 1_000_000_000;

/// Where a recorder writes.
type Output = NoSeek<Box<dyn Write + Send>>;

/// Writes one MCAP file.
pub(crate) struct Recorder {
    writer: Writer<Output>,
    /// The moment of the first message of the chunk that is being filled.
    chunk_begins: Option<u64>,
    /// The encoding of the message that is being written; kept for its memory.
    bytes: Vec<u8>,
    messages: u64,
}

impl Recorder {
    pub(crate) fn new(output: Box<dyn Write + Send>) -> McapResult<Recorder> {
        let library = concat!("monas-tape/", env!("CARGO_PKG_VERSION"));
        let options = WriteOptions::new().compression(None).disable_seeking(true).library(library);
        let writer = options.create(NoSeek::new(output))?;
        Ok(Recorder { writer, chunk_begins: None, bytes: Vec::new(), messages: 0 })
    }

    /// The channel of a publication's host, topic and publisher.
    pub(crate) fn channel(&mut self, publication: Publication<'_>) -> McapResult<u16> {
        let descriptor = publication.topic.descriptor();
        let schema =
            self.writer.add_schema(descriptor.full_name, "protobuf", descriptor.file_descriptor_set)?;
        let topic = format!("{}/{}", publication.host, publication.topic.path());
        let metadata = BTreeMap::from(
            [
                ("host", publication.host),
                ("kind", &publication.topic.kind().to_string()),
                ("publisher", publication.publisher),
                ("topic", publication.topic.path()),
            ]
            .map(|(key, value)| (key.to_owned(), value.to_owned())),
        );
        self.writer.add_channel(schema, &topic, "protobuf", &metadata)
    }

    /// Appends a message to a channel.
    pub(crate) fn write(&mut self, channel: u16, publication: Publication<'_>) -> McapResult<()> {
        let header = &publication.sample.header;
        let time = header.received.as_nanos();
        self.begin(time)?;
        self.bytes.clear();
        publication.sample.message.encode_to(&mut self.bytes);
        let record = MessageHeader {
            channel_id: channel,
            // MCAP has 32 bits for it, which is enough for 49 days at 1000 Hz; the lower half is what is kept.
            sequence: header.sequence as u32,
            log_time: time,
            publish_time: header.published.as_nanos(),
        };
        self.writer.write_to_known_channel(&record, &self.bytes)?;
        self.messages += 1;
        Ok(())
    }

    /// Closes the chunk if the message at `time` is too late for it.
    fn begin(&mut self, time: u64) -> McapResult<()> {
        let begins = *self.chunk_begins.get_or_insert(time);
        if time.saturating_sub(begins) >= CHUNK_SPAN {
            self.writer.flush()?;
            self.chunk_begins = Some(time);
        }
        Ok(())
    }

    pub(crate) fn describe(&mut self, name: &str, entries: &BTreeMap<String, String>) -> McapResult<()> {
        self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata: entries.clone() })
    }

    pub(crate) fn attach(&mut self, name: &str, media_type: &str, content: &[u8]) -> McapResult<()> {
        self.writer.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: content.into(),
        })
    }

    /// Writes the summary; answers how many messages were written.
    pub(crate) fn finish(mut self) -> McapResult<u64> {
        self.writer.finish()?;
        self.writer.into_inner().into_inner().flush().map_err(McapError::Io)?;
        Ok(self.messages)
    }
}
