//! What waits to be written: publishers leave it here and go on, the writer's thread fetches it.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use narukom::{AnyMessage, Moment};

use crate::playback::{Channel, Facts};

/// So many messages wait at most,
const MOST_MESSAGES: usize = 1 << 16;
/// and about so many bytes of encodings.
const MOST_BYTES: usize = 64 << 20;
/// What a message takes beside its encoding, about.
const OVERHEAD: usize = 64;
/// The writer looks here so often if nobody calls it. To wake it for each message would cost the publisher more than the message.
const LOOK: Duration = Duration::from_millis(10);

/// Something to be written.
pub(crate) enum Entry {
    /// The next channel; channels are numbered from 0.
    Channel(Arc<Channel>, Size),
    Message(Waiting),
    Facts(Facts),
    /// Name, media type and content of a file.
    Attachment(String, String, Vec<u8>),
    /// Everything before it is to be on its way to the disk.
    Flush,
}

/// A message to be written, not yet encoded.
pub(crate) struct Waiting {
    pub(crate) channel: u32,
    pub(crate) sequence: u32,
    pub(crate) published: Moment,
    pub(crate) received: Moment,
    pub(crate) message: Arc<dyn AnyMessage>,
}

/// How many bytes the last message of a channel had: what the next one is taken to have while it is not encoded.
#[derive(Clone, Default)]
pub(crate) struct Size(Arc<AtomicU32>);

impl Size {
    pub(crate) fn note(&self, bytes: usize) {
        self.0.store(u32::try_from(bytes).unwrap_or(u32::MAX), Ordering::Relaxed);
    }

    fn get(&self) -> usize {
        self.0.load(Ordering::Relaxed) as usize
    }
}

/// What becomes of a message for which there is no room.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum WhenFull {
    /// Its publisher waits until there is: nothing is lost.
    Wait,
    /// It is not recorded, and counted: nobody waits.
    Drop,
}

/// The queue.
pub(crate) struct Queue {
    state: Mutex<State>,
    /// Wakes the writer.
    work: Condvar,
    /// Wakes those who wait for room, or for a flush.
    progress: Condvar,
    when_full: WhenFull,
}

#[derive(Default)]
struct State {
    entries: Vec<Entry>,
    bytes: usize,
    channels: u32,
    dropped: u64,
    /// Calls of `flush`, and how many of them were answered.
    flushes: u64,
    flushed: u64,
    /// There will be no more entries.
    is_closed: bool,
    /// There is no writer any more.
    is_over: bool,
}

impl State {
    fn is_full(&self) -> bool {
        self.entries.len() >= MOST_MESSAGES || self.bytes >= MOST_BYTES
    }

    /// Whether the writer should not wait for more.
    fn is_worth_a_look(&self) -> bool {
        self.is_closed
            || self.flushes > self.flushed
            || self.entries.len() >= MOST_MESSAGES / 2
            || self.bytes >= MOST_BYTES / 2
    }

    fn takes_more(&self) -> bool {
        !self.is_closed && !self.is_over
    }
}

impl Queue {
    pub(crate) fn new(when_full: WhenFull) -> Queue {
        Queue { state: Mutex::default(), work: Condvar::new(), progress: Condvar::new(), when_full }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens a channel and answers its number; none if nothing is recorded any more.
    pub(crate) fn open(&self, channel: Channel, size: Size) -> Option<u32> {
        let mut state = self.state();
        if !state.takes_more() {
            return None;
        }
        let number = state.channels;
        state.channels += 1;
        state.entries.push(Entry::Channel(Arc::new(channel), size));
        Some(number)
    }

    /// Leaves a message. The last one of its channel had `size`.
    #[inline]
    pub(crate) fn push(&self, message: Waiting, size: &Size) {
        let mut state = self.state();
        if state.is_full() {
            if self.when_full == WhenFull::Drop {
                state.dropped += u64::from(state.takes_more());
                return;
            }
            state = self.wait_for_room(state);
        }
        if !state.takes_more() {
            return;
        }
        state.bytes += size.get() + OVERHEAD;
        state.entries.push(Entry::Message(message));
        let is_worth_a_call = state.entries.len() == MOST_MESSAGES / 2 || state.is_full();
        drop(state);
        if is_worth_a_call {
            self.work.notify_one();
        }
    }

    fn wait_for_room<'a>(&'a self, mut state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        while state.is_full() && state.takes_more() {
            self.work.notify_one();
            state = self.progress.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state
    }

    /// Leaves what is no message. False if nothing is recorded any more.
    pub(crate) fn add(&self, entry: Entry) -> bool {
        let mut state = self.state();
        let takes_more = state.takes_more();
        if takes_more {
            state.entries.push(entry);
        }
        takes_more
    }

    /// Waits until everything that was left so far is on its way to the disk. False if nothing is recorded any more.
    pub(crate) fn flush(&self) -> bool {
        let mut state = self.state();
        if !state.takes_more() {
            return false;
        }
        state.entries.push(Entry::Flush);
        state.flushes += 1;
        let mine = state.flushes;
        self.work.notify_one();
        while state.flushed < mine && !state.is_over {
            state = self.progress.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.flushed >= mine
    }

    /// How many messages found no room.
    pub(crate) fn dropped(&self) -> u64 {
        self.state().dropped
    }

    /// Takes no more. False if that was so before.
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

/// The writer's end.
impl Queue {
    /// Fetches what waits, after a while; false if that is all there will ever be.
    pub(crate) fn fetch(&self, into: &mut Vec<Entry>) -> bool {
        let mut state = self.state();
        if !state.is_worth_a_look() {
            let waited = self.work.wait_timeout(state, LOOK);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        std::mem::swap(&mut state.entries, into);
        state.bytes = 0;
        let goes_on = !(state.is_closed && into.is_empty());
        drop(state);
        self.progress.notify_all();
        goes_on
    }

    /// A flush has been done.
    pub(crate) fn flushed(&self) {
        self.state().flushed += 1;
        self.progress.notify_all();
    }

    /// There is no writer any more.
    pub(crate) fn end(&self) {
        let mut state = self.state();
        state.is_over = true;
        state.entries = Vec::new();
        drop(state);
        self.progress.notify_all();
    }
}
