//! The threads on which the activities of a statechart agent run.
//!
//! As many as the agent's charts can keep busy at once, at most twelve (the thesis's number); each starts when there is work
//! that no other is free for. Work of higher priority goes first, of equal priority in the order it came.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use super::mailbox::Mailbox;
use crate::chart::Assignment;
use crate::error::{Error, ErrorKind};

/// The largest number of threads of a pool.
const MOST_WORKERS: usize = 12;

/// A fixed number of threads and the work that waits for them.
pub(super) struct Pool {
    name: String,
    limit: usize,
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<State>,
    ready: Condvar,
}

#[derive(Default)]
struct State {
    waiting: BinaryHeap<Waiting<Job>>,
    idle: usize,
    submitted: u64,
    closed: bool,
}

/// An activity to be called, and whom to tell.
struct Job {
    assignment: Box<Assignment>,
    mailbox: Arc<Mailbox>,
}

/// Something that waits for its turn: the greatest comes first.
struct Waiting<T> {
    priority: i32,
    /// The earlier of two of equal priority is the greater.
    number: Reverse<u64>,
    what: T,
}

impl Pool {
    /// A pool without threads yet.
    pub(super) fn new(name: &str, wanted: usize) -> Pool {
        let shared = Shared { state: Mutex::default(), ready: Condvar::new() };
        Pool {
            name: name.into(),
            limit: wanted.clamp(1, MOST_WORKERS),
            shared: Arc::new(shared),
            workers: vec![],
        }
    }

    /// Has an activity called; what it returned goes to the mailbox.
    ///
    /// # Errors
    /// The system gives no thread, and there is none yet.
    pub(super) fn submit(&mut self, assignment: Assignment, mailbox: Arc<Mailbox>) -> Result<(), Error> {
        let all_busy = {
            let mut state = self.shared.lock();
            state.submitted += 1;
            let (priority, number) = (assignment.priority, Reverse(state.submitted));
            let what = Job { assignment: Box::new(assignment), mailbox };
            state.waiting.push(Waiting { priority, number, what });
            state.waiting.len() > state.idle
        };
        self.shared.ready.notify_one();
        match all_busy && self.workers.len() < self.limit {
            true => self.hire(),
            false => Ok(()),
        }
    }

    fn hire(&mut self) -> Result<(), Error> {
        let shared = self.shared.clone();
        let name = format!("{} {}", self.name, self.workers.len() + 1);
        match thread::Builder::new().name(name).spawn(move || shared.work()) {
            Ok(worker) => self.workers.push(worker),
            Err(error) if self.workers.is_empty() => {
                let message = format!("no thread for the activities of `{}`: {error}", self.name);
                return Err(Error::new(ErrorKind::Thread, message).caused_by(error));
            }
            Err(error) => tracing::warn!(agent = %self.name, "no further thread for activities: {error}"),
        }
        Ok(())
    }
}

impl Drop for Pool {
    /// Lets every thread finish the activity it is in; what still waits is not called.
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.ready.notify_all();
        for worker in self.workers.drain(..) {
            if worker.join().is_err() {
                tracing::error!(agent = %self.name, "a thread for activities has panicked");
            }
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self) {
        while let Some(Job { mut assignment, mailbox }) = self.next() {
            let returned = assignment.call();
            mailbox.returned(*assignment, returned);
        }
    }

    /// The most urgent job, waited for; none when the pool is closed.
    fn next(&self) -> Option<Job> {
        let mut state = self.lock();
        loop {
            if state.closed {
                return None;
            }
            if let Some(waiting) = state.waiting.pop() {
                return Some(waiting.what);
            }
            state.idle += 1;
            state = self.ready.wait(state).unwrap_or_else(PoisonError::into_inner);
            state.idle -= 1;
        }
    }
}

impl<T> Waiting<T> {
    fn urgency(&self) -> (i32, Reverse<u64>) {
        (self.priority, self.number)
    }
}

impl<T> PartialEq for Waiting<T> {
    fn eq(&self, other: &Waiting<T>) -> bool {
        self.urgency() == other.urgency()
    }
}

impl<T> Eq for Waiting<T> {}

impl<T> PartialOrd for Waiting<T> {
    fn partial_cmp(&self, other: &Waiting<T>) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Waiting<T> {
    fn cmp(&self, other: &Waiting<T>) -> Ordering {
        self.urgency().cmp(&other.urgency())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_urgent_comes_first_and_of_equals_the_one_that_came_first() {
        let came = [("a", 0), ("b", 5), ("c", 0), ("d", -1), ("e", 5)];
        let mut heap: BinaryHeap<Waiting<&str>> = came
            .into_iter()
            .zip(0..)
            .map(|((what, priority), number)| Waiting { priority, number: Reverse(number), what })
            .collect();
        let order: Vec<&str> = std::iter::from_fn(|| heap.pop()).map(|waiting| waiting.what).collect();
        assert_eq!(order, ["b", "e", "a", "c", "d"]);
    }
}
