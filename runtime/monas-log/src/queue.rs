//! Queue of records from the writing threads to the logger's thread.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering, fence};
use std::thread::Thread;

use crossbeam_queue::ArrayQueue;

use super::record::Record;

/// Capacity in messages.
const CAPACITY: usize = 1024;

/// A record in use. It returns to its queue even if formatting a value panics.
struct RecordGuard<'a> {
    record: Option<Box<Record>>,
    returns_to: &'a ArrayQueue<Box<Record>>,
}

impl Drop for RecordGuard<'_> {
    fn drop(&mut self) {
        // The queue has room for every existing record.
        self.record.take().into_iter().for_each(|record| drop(self.returns_to.push(record)));
    }
}

/// A fixed number of records: a writer takes a free one and returns it filled.
pub(crate) struct RecordQueue {
    free: ArrayQueue<Box<Record>>,
    full: ArrayQueue<Box<Record>>,
    dropped: AtomicU64,
    ends: AtomicBool,
    /// Whether the consumer thread sleeps or is about to.
    is_asleep: AtomicBool,
    thread: OnceLock<Thread>,
}

impl RecordQueue {
    pub(crate) fn new() -> RecordQueue {
        let free = ArrayQueue::new(CAPACITY);
        // they all fit
        (0..CAPACITY).for_each(|_| drop(free.push(Box::new(Record::new()))));
        RecordQueue {
            free,
            full: ArrayQueue::new(CAPACITY),
            dropped: AtomicU64::new(0),
            ends: AtomicBool::new(false),
            is_asleep: AtomicBool::new(false),
            thread: OnceLock::new(),
        }
    }

    /// Makes this thread the consumer.
    pub(crate) fn set_consumer_thread(&self) {
        let _ = self.thread.set(std::thread::current());
    }

    /// Queues a message, if a record is free and `fill` returns true. It neither allocates nor
    /// blocks.
    pub(crate) fn put(&self, fill: impl FnOnce(&mut Record) -> bool) {
        let Some(record) = self.free.pop() else {
            self.dropped.fetch_add(1, Ordering::Relaxed);
            return;
        };
        let mut taken = RecordGuard { record: Some(record), returns_to: &self.free };
        let is_wanted = taken.record.as_mut().is_some_and(|record| fill(record));
        if is_wanted {
            taken.returns_to = &self.full;
        }
        drop(taken);
        if is_wanted {
            self.wake();
        }
    }

    /// Ends the queue.
    pub(crate) fn end(&self) {
        self.ends.store(true, Ordering::SeqCst);
        self.wake();
    }

    fn wake(&self) {
        // Either this thread sees that the consumer is about to sleep, or the consumer sees the
        // message.
        fence(Ordering::SeqCst);
        if self.is_asleep.load(Ordering::Relaxed)
            && self.is_asleep.swap(false, Ordering::SeqCst)
            && let Some(thread) = self.thread.get()
        {
            thread.unpark();
        }
    }

    /// Passes the next message to a function; its record is free afterwards.
    pub(crate) fn next(&self, look: impl FnOnce(&Record)) -> bool {
        let Some(record) = self.full.pop() else { return false };
        look(&record);
        drop(self.free.push(record));
        true
    }

    /// Sleeps until there is a message or the queue ends. Returns whether there may be one.
    pub(crate) fn sleep(&self) -> bool {
        loop {
            self.is_asleep.store(true, Ordering::SeqCst);
            fence(Ordering::SeqCst);
            let (has_more, ends) = (!self.full.is_empty(), self.ends.load(Ordering::SeqCst));
            if has_more || ends {
                self.is_asleep.store(false, Ordering::SeqCst);
                return has_more;
            }
            std::thread::park();
        }
    }

    /// Takes the number of messages dropped since the last call.
    pub(crate) fn take_dropped(&self) -> u64 {
        self.dropped.swap(0, Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_lines_without_a_free_record_are_dropped_and_counted() {
        let queue = RecordQueue::new();
        (0..CAPACITY + 3).for_each(|number| {
            queue.put(|record| {
                record.cycle = Some(number as u64);
                true
            })
        });
        let mut seen = Vec::new();
        while queue.next(|record| seen.extend(record.cycle)) {}
        assert!(seen.into_iter().eq(0..CAPACITY as u64));
        assert_eq!((queue.take_dropped(), queue.take_dropped()), (3, 0));
        queue.put(|_| true);
        assert!(queue.next(|_| {}), "records come back");
        (0..=CAPACITY).for_each(|_| queue.put(|_| false));
        assert_eq!(
            (queue.next(|_| {}), queue.take_dropped()),
            (false, 0),
            "what is not wanted takes no record"
        );
        let fill = || queue.put(|_| panic!("it cannot be shown"));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(fill)).is_err());
        (0..CAPACITY).for_each(|_| queue.put(|_| true));
        assert_eq!(queue.take_dropped(), 0, "nor does what panics");
    }

    #[test]
    fn the_end_follows_all_remaining_messages() {
        let queue = RecordQueue::new();
        queue.put(|_| true);
        queue.end();
        assert!(queue.sleep());
        assert!(queue.next(|_| {}));
        assert!(!queue.sleep());
    }
}
