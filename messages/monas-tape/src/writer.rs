//! The thread that writes a tape: it encodes messages, so that publishers need not.

use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use mcap::{McapError, McapResult};

use crate::queue::{OverflowPolicy, QueueEntry, QueuedMessage, SizeHint, WriteQueue};
use crate::recorder::Recorder;
use crate::recording::{Attachment, Channel, RecordedSample};

/// Number of polls without entries after which a chunk is flushed: about a second.
const SILENCE: u32 = 100;

/// The running thread.
pub(crate) struct WriterThread(JoinHandle<McapResult<u64>>);

impl WriterThread {
    /// Joins the thread, and returns the number of messages written.
    pub(crate) fn join(self) -> McapResult<u64> {
        let panicked = |_| Err(McapError::Io(io::Error::other("the thread that writes it panicked")));
        self.0.join().unwrap_or_else(panicked)
    }
}

/// Writes the entries of a queue.
struct TapeWriter {
    queue: Arc<WriteQueue>,
    recorder: Recorder,
    channels: Vec<(u16, Arc<Channel>, SizeHint)>,
    /// Buffer for encodings, kept to reuse its memory.
    bytes: Vec<u8>,
    is_real_time: bool,
    /// Whether anything was written since the last flush.
    is_dirty: bool,
    silent_looks: u32,
}

/// Starts the thread. It ends, with the number of messages, when the queue is closed, or when the
/// file cannot be written any more.
pub(crate) fn start(
    queue: Arc<WriteQueue>,
    recorder: Recorder,
    when_full: OverflowPolicy,
) -> io::Result<WriterThread> {
    let mut writer = TapeWriter {
        queue,
        recorder,
        channels: Vec::new(),
        bytes: Vec::new(),
        is_real_time: when_full == OverflowPolicy::Drop,
        is_dirty: false,
        silent_looks: 0,
    };
    let work = move || {
        let written = writer.run();
        writer.queue.end();
        written?;
        writer.recorder.finish()
    };
    thread::Builder::new().name("tape".into()).spawn(work).map(WriterThread)
}

impl TapeWriter {
    fn run(&mut self) -> McapResult<()> {
        let mut entries = Vec::new();
        while self.queue.fetch(&mut entries) {
            self.silent_looks = if entries.is_empty() { self.silent_looks + 1 } else { 0 };
            entries.drain(..).try_for_each(|entry| self.write(entry))?;
            // In simulated time chunks end by that time alone, so that two tapes of one run are
            // equal.
            if self.is_real_time && self.is_dirty && self.silent_looks >= SILENCE {
                self.flush()?;
            }
        }
        Ok(())
    }

    fn write(&mut self, entry: QueueEntry) -> McapResult<()> {
        match entry {
            QueueEntry::Channel(channel, size) => {
                let number = self.recorder.channel(&channel)?;
                self.channels.push((number, channel, size));
            }
            QueueEntry::Message(waiting) => self.message(&waiting)?,
            QueueEntry::Facts(facts) => self.recorder.describe(&facts)?,
            QueueEntry::Attachment(name, media_type, content) => {
                self.recorder.attach(&Attachment {
                    name: &name,
                    media_type: &media_type,
                    bytes: &content,
                })?;
            }
            QueueEntry::Flush => {
                self.flush()?;
                self.queue.flushed();
            }
        }
        Ok(())
    }

    fn message(&mut self, waiting: &QueuedMessage) -> McapResult<()> {
        let Some((number, channel, size)) = self.channels.get(waiting.channel as usize) else {
            return Ok(());
        };
        self.bytes.clear();
        waiting.message.encode_to(&mut self.bytes);
        size.note(self.bytes.len());
        self.is_dirty = true;
        let message = RecordedSample {
            channel: channel.clone(),
            sequence: waiting.sequence,
            published: waiting.published,
            received: waiting.received,
            bytes: &self.bytes,
        };
        self.recorder.write(*number, &message)
    }

    fn flush(&mut self) -> McapResult<()> {
        self.is_dirty = false;
        self.recorder.flush()
    }
}
