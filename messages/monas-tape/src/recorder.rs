//! Writes the MCAP file of a tape: schemas, channels, chunks.

use std::io::Write;

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{McapError, McapResult, WriteOptions, Writer};

use crate::recording::{Attachment, Channel, MetadataEntry, RecordedSample, Schema};
use crate::tape_file::Output;

/// A chunk is closed when its messages span this many nanoseconds: the most that a killed process
/// loses.
const CHUNK_SPAN: u64 = 1_000_000_000;

/// The span of the first chunk; each one is twice as long as the one before, so that a process that
/// is killed early leaves about half of its messages.
const FIRST_SPAN: u64 = 20_000_000;

/// Writes one MCAP file.
pub(crate) struct Recorder<W: Write = Output> {
    writer: Writer<NoSeek<W>>,
    /// The time of the first message of the current chunk.
    chunk_begins: Option<u64>,
    chunk_span: u64,
    messages: u64,
    /// The number of them that are passed to the operating system.
    flushed: u64,
}

impl<W: Write> Recorder<W> {
    pub(crate) fn new(output: W) -> McapResult<Recorder<W>> {
        let library = concat!("monas-tape/", env!("CARGO_PKG_VERSION"));
        let options = WriteOptions::new().compression(None).disable_seeking(true).library(library);
        let writer = options.create(NoSeek::new(output))?;
        Ok(Recorder { writer, chunk_begins: None, chunk_span: FIRST_SPAN, messages: 0, flushed: 0 })
    }

    /// The number of a channel in the file.
    pub(crate) fn channel(&mut self, channel: &Channel) -> McapResult<u16> {
        let Channel { name, schema, encoding, facts, .. } = channel;
        // MCAP numbers schemas from 1; 0 means no schema.
        let schema = match **schema == Schema::default() {
            true => 0,
            false => self.writer.add_schema(&schema.name, &schema.encoding, &schema.data)?,
        };
        self.writer.add_channel(schema, name, encoding, facts)
    }

    /// Appends a message to a channel.
    pub(crate) fn write(&mut self, channel: u16, message: &RecordedSample<'_>) -> McapResult<()> {
        let time = message.received.as_nanos();
        self.begin(time)?;
        let header = MessageHeader {
            channel_id: channel,
            sequence: message.sequence,
            log_time: time,
            publish_time: message.published.as_nanos(),
        };
        self.writer.write_to_known_channel(&header, message.bytes)?;
        self.messages += 1;
        Ok(())
    }

    /// Closes the chunk if the message at `time` is too late for it.
    fn begin(&mut self, time: u64) -> McapResult<()> {
        let begins = *self.chunk_begins.get_or_insert(time);
        if time.saturating_sub(begins) >= self.chunk_span {
            self.flush()?;
            self.chunk_begins = Some(time);
            self.chunk_span = CHUNK_SPAN.min(self.chunk_span * 2);
        }
        Ok(())
    }

    /// Closes the chunk: everything written so far survives this process.
    pub(crate) fn flush(&mut self) -> McapResult<()> {
        self.chunk_begins = None;
        self.writer.flush()?;
        self.flushed = self.messages;
        Ok(())
    }

    pub(crate) fn describe(&mut self, facts: &MetadataEntry) -> McapResult<()> {
        self.chunk_begins = None;
        self.writer.write_metadata(&Metadata { name: facts.name.clone(), metadata: facts.entries.clone() })
    }

    pub(crate) fn attach(&mut self, file: &Attachment<'_>) -> McapResult<()> {
        self.chunk_begins = None;
        self.writer.attach(&mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: file.name.to_owned(),
            media_type: file.media_type.to_owned(),
            data: file.bytes.into(),
        })
    }

    /// The number of messages written.
    pub(crate) fn messages(&self) -> u64 {
        self.messages
    }

    /// Abandons the file after a failure: nothing more is written. Returns the number of messages
    /// that the file certainly has, and of those that it may lack.
    pub(crate) fn abandon(self) -> (u64, u64) {
        // Dropping the writer would write the summary.
        drop(self.writer.into_inner());
        (self.flushed, self.messages - self.flushed)
    }

    /// Writes the summary; returns the number of messages written, and the output.
    pub(crate) fn finish(mut self) -> McapResult<(u64, W)> {
        self.writer.finish()?;
        let mut output = self.writer.into_inner().into_inner();
        output.flush().map_err(McapError::Io)?;
        Ok((self.messages, output))
    }
}
