//! The queue between publishers and the writer's thread.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use narukom::{AnyMessage, Timestamp};

use crate::recording::{Channel, MetadataEntry};

/// The most messages that wait,
const MOST_MESSAGES: usize = 1 << 16;
/// and approximately the most bytes of encodings.
const MOST_BYTES: usize = 64 << 20;
/// Approximate memory of a message besides its encoding.
const OVERHEAD: usize = 64;
/// Polling interval of the writer. Waking it for each message would cost the publisher more than
/// the message.
const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// An entry to be written.
pub(crate) enum QueueEntry {
    /// The next channel; channels are numbered from 0.
    Channel(Arc<Channel>, SizeHint),
    Message(QueuedMessage),
    Facts(MetadataEntry),
    /// Name, media type and content of an attachment.
    Attachment(String, String, Vec<u8>),
    /// A request to flush all entries before it to the operating system.
    Flush,
}

/// A message to be written, not yet encoded.
pub(crate) struct QueuedMessage {
    pub(crate) channel: u32,
    pub(crate) sequence: u32,
    pub(crate) published: Timestamp,
    pub(crate) received: Timestamp,
    pub(crate) message: Arc<dyn AnyMessage>,
}

/// The size of the last message of a channel, used as an estimate for the next one until it is
/// encoded.
#[derive(Clone, Default)]
pub(crate) struct SizeHint(Arc<AtomicU32>);

impl SizeHint {
    pub(crate) fn note(&self, bytes: usize) {
        self.0.store(u32::try_from(bytes).unwrap_or(u32::MAX), Ordering::Relaxed);
    }

    fn get(&self) -> usize {
        self.0.load(Ordering::Relaxed) as usize
    }
}

/// The handling of messages when the queue is full.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum OverflowPolicy {
    /// The publisher blocks until there is room: no message is lost.
    Wait,
    /// The message is dropped and counted: no publisher blocks.
    Drop,
}

/// The queue.
pub(crate) struct WriteQueue {
    state: Mutex<WriteQueueState>,
    /// Wakes the writer.
    work: Condvar,
    /// Wakes threads that wait for room, or for a flush.
    progress: Condvar,
    when_full: OverflowPolicy,
}

#[derive(Default)]
struct WriteQueueState {
    entries: Vec<QueueEntry>,
    bytes: usize,
    channels: u32,
    dropped: u64,
    /// The numbers of requested and of completed flushes.
    flushes: u64,
    flushed: u64,
    /// Whether the queue is closed to new entries.
    is_closed: bool,
    /// Whether the writer has ended.
    is_over: bool,
}

impl WriteQueueState {
    fn is_full(&self) -> bool {
        self.entries.len() >= MOST_MESSAGES || self.bytes >= MOST_BYTES
    }

    /// Whether the writer should not wait for more entries.
    fn should_flush(&self) -> bool {
        self.is_closed
            || self.flushes > self.flushed
            || self.entries.len() >= MOST_MESSAGES / 2
            || self.bytes >= MOST_BYTES / 2
    }

    fn has_room(&self) -> bool {
        !self.is_closed && !self.is_over
    }
}

impl WriteQueue {
    pub(crate) fn new(when_full: OverflowPolicy) -> WriteQueue {
        WriteQueue { state: Mutex::default(), work: Condvar::new(), progress: Condvar::new(), when_full }
    }

    fn state(&self) -> MutexGuard<'_, WriteQueueState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens a channel and returns its number; `None` if the recording has ended.
    pub(crate) fn open(&self, channel: Channel, size: SizeHint) -> Option<u32> {
        let mut state = self.state();
        if !state.has_room() {
            return None;
        }
        let number = state.channels;
        state.channels += 1;
        state.entries.push(QueueEntry::Channel(Arc::new(channel), size));
        Some(number)
    }

    /// Enqueues a message. `size` is the size hint of its channel.
    #[inline]
    pub(crate) fn push(&self, message: QueuedMessage, size: &SizeHint) {
        let mut state = self.state();
        if state.is_full() {
            if self.when_full == OverflowPolicy::Drop {
                state.dropped += u64::from(state.has_room());
                return;
            }
            state = self.wait_for_room(state);
        }
        if !state.has_room() {
            return;
        }
        state.bytes += size.get() + OVERHEAD;
        state.entries.push(QueueEntry::Message(message));
        let is_worth_a_call = state.entries.len() == MOST_MESSAGES / 2 || state.is_full();
        drop(state);
        if is_worth_a_call {
            self.work.notify_one();
        }
    }

    fn wait_for_room<'a>(
        &'a self,
        mut state: MutexGuard<'a, WriteQueueState>,
    ) -> MutexGuard<'a, WriteQueueState> {
        while state.is_full() && state.has_room() {
            self.work.notify_one();
            state = self.progress.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state
    }

    /// Enqueues an entry that is not a message. Returns `false` if the recording has ended.
    pub(crate) fn add(&self, entry: QueueEntry) -> bool {
        let mut state = self.state();
        let takes_more = state.has_room();
        if takes_more {
            state.entries.push(entry);
        }
        takes_more
    }

    /// Waits until all entries so far are passed to the operating system. Returns `false` if the
    /// recording has ended.
    pub(crate) fn flush(&self) -> bool {
        let mut state = self.state();
        if !state.has_room() {
            return false;
        }
        state.entries.push(QueueEntry::Flush);
        state.flushes += 1;
        let mine = state.flushes;
        self.work.notify_one();
        while state.flushed < mine && !state.is_over {
            state = self.progress.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.flushed >= mine
    }

    /// The number of dropped messages.
    pub(crate) fn dropped(&self) -> u64 {
        self.state().dropped
    }

    /// Closes the queue to new entries. Returns `false` if it was closed before.
    pub(crate) fn close(&self) -> bool {
        let mut state = self.state();
        let was_open = !state.is_closed;
        state.is_closed = true;
        drop(state);
        self.work.notify_one();
        self.progress.notify_all();
        was_open
    }
}

/// The writer's side.
impl WriteQueue {
    /// Fetches the waiting entries, after a while; returns `false` once the queue is closed and
    /// empty.
    pub(crate) fn fetch(&self, into: &mut Vec<QueueEntry>) -> bool {
        let mut state = self.state();
        if !state.should_flush() {
            let waited = self.work.wait_timeout(state, POLL_INTERVAL);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        std::mem::swap(&mut state.entries, into);
        state.bytes = 0;
        let goes_on = !(state.is_closed && into.is_empty());
        drop(state);
        self.progress.notify_all();
        goes_on
    }

    /// Marks a flush as completed.
    pub(crate) fn flushed(&self) {
        self.state().flushed += 1;
        self.progress.notify_all();
    }

    /// Marks the writer as ended.
    pub(crate) fn end(&self) {
        let mut state = self.state();
        state.is_over = true;
        state.entries = Vec::new();
        drop(state);
        self.progress.notify_all();
    }
}
