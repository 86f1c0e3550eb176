//! The threads on which the activities of a statechart agent run.
//!
//! As many as the agent's charts can keep busy at once, at most twelve (the thesis's number), if the agent does not say how many; each
//! starts when there is work that no other is free for. Work of higher priority goes first, of equal priority in the order it came.

use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use narukom::Narukom;

use super::clock::{CPU_EVERY, Clock, cpu_time};
use super::handover::{Mailbox, Work};
use crate::chart::{Assignment, Returned, Took};
use crate::error::{Error, ErrorKind};
use crate::logger::Hosting;

/// The largest number of threads of a pool whose agent does not say how many there are to be.
const MOST_WORKERS: usize = 12;

/// A fixed number of threads and the work that waits for them.
pub(super) struct Pool {
    name: String,
    clock: Clock,
    hub: Narukom,
    work: Arc<Work<Job>>,
    workers: Mutex<Vec<JoinHandle<()>>>,
}

/// An activity to be called, and whom to tell.
struct Job {
    assignment: Assignment,
    mailbox: Arc<Mailbox<Called>>,
}

/// An activity that was called.
pub(super) struct Called {
    pub(super) assignment: Assignment,
    pub(super) returned: Returned,
    /// How long the call took.
    pub(super) took: Took,
}

/// How many threads a pool has whose charts have so many activities at once, if its agent does not say.
pub(super) fn workers(set: Option<NonZeroUsize>, useful: usize) -> usize {
    set.map_or_else(|| useful.clamp(1, MOST_WORKERS), NonZeroUsize::get)
}

impl Pool {
    /// A pool that will have so many threads, without any yet.
    pub(super) fn new(name: &str, most: usize, clock: Clock, hub: &Narukom) -> Pool {
        let work = Arc::new(Work::new(most));
        Pool { name: name.into(), clock, hub: hub.clone(), work, workers: Mutex::default() }
    }

    /// Has an activity called; what it returned goes to the mailbox.
    ///
    /// # Errors
    /// The system gives no thread, and there is none yet.
    pub(super) fn submit(&self, assignment: Assignment, mailbox: &Arc<Mailbox<Called>>) -> Result<(), Error> {
        let job = Job { mailbox: mailbox.clone(), assignment };
        match self.work.submit(job.assignment.priority, job) {
            true => self.hire(),
            false => Ok(()),
        }
    }

    fn hire(&self) -> Result<(), Error> {
        let mut workers = self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let (work, clock) = (self.work.clone(), self.clock);
        let name = format!("{} {}", self.name, workers.len() + 1);
        let hosting = Hosting::real([&self.hub], clock);
        match thread::Builder::new().name(name).spawn(move || hosting.during(|| run(&work, clock))) {
            Ok(worker) => workers.push(worker),
            Err(error) if self.work.one_less() => {
                tracing::warn!(agent = %self.name, "no further thread for activities: {error}");
            }
            Err(error) => {
                let message = format!("no thread for the activities of `{}`: {error}", self.name);
                return Err(Error::new(ErrorKind::Thread, message).caused_by(error));
            }
        }
        Ok(())
    }
}

/// What a worker does: it calls one activity after the other. A panic of an activity does not get here.
fn run(work: &Work<Job>, clock: Clock) {
    let mut calls = 0_u64;
    while let Some(Job { mut assignment, mailbox }) = work.next() {
        calls += 1;
        let cpu = if calls % CPU_EVERY == 1 { cpu_time() } else { None };
        let began = clock.now();
        let returned = assignment.call_counted();
        let wall = clock.now().since(began);
        let cpu = cpu
            .and_then(|before| Some((before, cpu_time()?)))
            .map(|(before, after)| after.saturating_sub(before));
        let took = Took { wall, cpu };
        mailbox.returned(Called { assignment, returned, took });
    }
}

impl Drop for Pool {
    /// Lets every thread finish the activity it is in; what still waits is not called.
    fn drop(&mut self) {
        self.work.close();
        for worker in self.workers.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
            if worker.join().is_err() {
                tracing::error!(agent = %self.name, "a thread for activities has panicked");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_threads_as_activities_at_once_but_twelve_or_as_many_as_are_set() {
        assert_eq!([0, 1, 3, 12, 40].map(|useful| workers(None, useful)), [1, 1, 3, 12, 12]);
        assert_eq!([1, 20].map(|set| workers(NonZeroUsize::new(set), 3)), [1, 20]);
    }
}
