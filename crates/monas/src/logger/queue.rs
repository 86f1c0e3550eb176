//! Records on their way from those who write to the logger's thread.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering, fence};
use std::thread::Thread;

use crossbeam_queue::ArrayQueue;

use super::record::Record;

/// How many messages may be on their way.
const RECORDS: usize = 1024;

/// A record in somebody's hands. It comes back even if those who fill it panic, as values that are to be shown may.
struct Taken<'a> {
    record: Option<Box<Record>>,
    goes_to: &'a ArrayQueue<Box<Record>>,
}

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        // There is room for every record that there is.
        self.record.take().into_iter().for_each(|record| drop(self.goes_to.push(record)));
    }
}

/// A fixed number of records: who writes takes a free one and leaves it full.
pub(super) struct Queue {
    free: ArrayQueue<Box<Record>>,
    full: ArrayQueue<Box<Record>>,
    dropped: AtomicU64,
    ends: AtomicBool,
    /// Whether the thread that empties it sleeps, or is about to.
    asleep: AtomicBool,
    thread: OnceLock<Thread>,
}

impl Queue {
    pub(super) fn new() -> Queue {
        let free = ArrayQueue::new(RECORDS);
        // they all fit
        (0..RECORDS).for_each(|_| drop(free.push(Box::new(Record::new()))));
        Queue {
            free,
            full: ArrayQueue::new(RECORDS),
            dropped: AtomicU64::new(0),
            ends: AtomicBool::new(false),
            asleep: AtomicBool::new(false),
            thread: OnceLock::new(),
        }
    }

    /// This thread is the one that empties it.
    pub(super) fn emptied_here(&self) {
        let _ = self.thread.set(std::thread::current());
    }

    /// Leaves a message, if there is a record for it and `fill` says that it is wanted. It neither allocates nor waits.
    pub(super) fn put(&self, fill: impl FnOnce(&mut Record) -> bool) {
        let Some(record) = self.free.pop() else {
            self.dropped.fetch_add(1, Ordering::Relaxed);
            return;
        };
        let mut taken = Taken { record: Some(record), goes_to: &self.free };
        let is_wanted = taken.record.as_mut().is_some_and(|record| fill(record));
        if is_wanted {
            taken.goes_to = &self.full;
        }
        drop(taken);
        if is_wanted {
            self.wake();
        }
    }

    /// There will be no more.
    pub(super) fn end(&self) {
        self.ends.store(true, Ordering::SeqCst);
        self.wake();
    }

    fn wake(&self) {
        // Either this sees that it is about to sleep, or that one sees what was put in before.
        fence(Ordering::SeqCst);
        if self.asleep.load(Ordering::Relaxed)
            && self.asleep.swap(false, Ordering::SeqCst)
            && let Some(thread) = self.thread.get()
        {
            thread.unpark();
        }
    }

    /// The next message; its record goes back when it has been looked at.
    pub(super) fn next(&self, look: impl FnOnce(&Record)) -> bool {
        let Some(record) = self.full.pop() else { return false };
        look(&record);
        drop(self.free.push(record));
        true
    }

    /// Sleeps until there is a message, or there will be no more. Says whether there may be one.
    pub(super) fn sleep(&self) -> bool {
        loop {
            self.asleep.store(true, Ordering::SeqCst);
            fence(Ordering::SeqCst);
            let (has_more, ends) = (!self.full.is_empty(), self.ends.load(Ordering::SeqCst));
            if has_more || ends {
                self.asleep.store(false, Ordering::SeqCst);
                return has_more;
            }
            std::thread::park();
        }
    }

    /// How many messages there was no record for since the last time this was asked.
    pub(super) fn take_dropped(&self) -> u64 {
        self.dropped.swap(0, Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_there_is_no_record_for_is_dropped_and_counted() {
        let queue = Queue::new();
        (0..RECORDS + 3).for_each(|number| {
            queue.put(|record| {
                record.cycle = Some(number as u64);
                true
            })
        });
        let mut seen = Vec::new();
        while queue.next(|record| seen.extend(record.cycle)) {}
        assert!(seen.into_iter().eq(0..RECORDS as u64));
        assert_eq!((queue.take_dropped(), queue.take_dropped()), (3, 0));
        queue.put(|_| true);
        assert!(queue.next(|_| {}), "records come back");
        (0..=RECORDS).for_each(|_| queue.put(|_| false));
        assert_eq!(
            (queue.next(|_| {}), queue.take_dropped()),
            (false, 0),
            "what is not wanted takes no record"
        );
        let fill = || queue.put(|_| panic!("it cannot be shown"));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(fill)).is_err());
        (0..RECORDS).for_each(|_| queue.put(|_| true));
        assert_eq!(queue.take_dropped(), 0, "nor does what panics");
    }

    #[test]
    fn the_end_comes_after_all_that_was_left() {
        let queue = Queue::new();
        queue.put(|_| true);
        queue.end();
        assert!(queue.sleep());
        assert!(queue.next(|_| {}));
        assert!(!queue.sleep());
    }
}
