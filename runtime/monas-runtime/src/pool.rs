//! The threads that execute the activities of a statechart agent.
//!
//! Unless the agent sets their number, there are as many as its charts can use at once, at most
//! twelve (the number in the thesis). A thread starts when there is work and no other thread is
//! idle. Work is executed by priority, and in order of arrival among equal priorities.

use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use narukom::Hub;

use super::call_meter::CallMeter;
use super::clock::RunClock;
use super::observed_thread::ObservedThreads;
use super::sync::{Mailbox, WorkQueue};
use monas_core::chart_runner::{ActivityCall, FinishedCall};
use monas_core::error::{Error, ErrorKind};
use monas_log::LogHosts;

/// Maximum number of threads of a pool whose agent does not set it.
const MOST_WORKERS: usize = 12;

/// A bounded number of threads and the queue of their work.
pub(crate) struct ActivityPool {
    name: String,
    clock: RunClock,
    observed: Arc<ObservedThreads>,
    hub: Hub,
    work: Arc<WorkQueue<CallJob>>,
    workers: Mutex<Vec<JoinHandle<()>>>,
}

/// An activity to call, and the mailbox for the finished call.
struct CallJob {
    call: ActivityCall,
    mailbox: Arc<Mailbox<FinishedCall>>,
}

/// The number of threads of a pool: the one that its agent sets, or one bounded by the number of
/// activities that its charts can run at once.
pub(crate) fn workers(set: Option<NonZeroUsize>, useful: usize) -> usize {
    set.map_or_else(|| useful.clamp(1, MOST_WORKERS), NonZeroUsize::get)
}

impl ActivityPool {
    /// A pool with a maximum number of threads, none of which exists yet.
    pub(crate) fn new(
        name: &str,
        max_threads: usize,
        clock: RunClock,
        observed: Arc<ObservedThreads>,
        hub: &Hub,
    ) -> ActivityPool {
        let work = Arc::new(WorkQueue::new(max_threads));
        ActivityPool { name: name.into(), clock, observed, hub: hub.clone(), work, workers: Mutex::default() }
    }

    /// Submits the call of an activity; its result is sent to the mailbox.
    ///
    /// # Errors
    /// No thread can be created, and none exists.
    pub(crate) fn submit(
        &self,
        call: ActivityCall,
        mailbox: &Arc<Mailbox<FinishedCall>>,
    ) -> Result<(), Error> {
        let job = CallJob { mailbox: mailbox.clone(), call };
        match self.work.submit(job.call.priority, job) {
            true => self.spawn_workers(),
            false => Ok(()),
        }
    }

    fn spawn_workers(&self) -> Result<(), Error> {
        let mut workers = self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let (work, clock, observed) = (self.work.clone(), self.clock, self.observed.clone());
        let name = format!("{} {}", self.name, workers.len() + 1);
        let hosting = LogHosts::real([&self.hub], move || clock.now());
        match thread::Builder::new().name(name).spawn(move || {
            observed.add_this_thread();
            hosting.during(|| run(&work, clock));
        }) {
            Ok(worker) => workers.push(worker),
            Err(error) if self.work.release_worker() => {
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

/// The loop of a worker: calls one activity after the other. Panics of activities are caught before
/// they reach it.
fn run(work: &WorkQueue<CallJob>, clock: RunClock) {
    let mut meter = CallMeter::new(Some(clock));
    while let Some(CallJob { call, mailbox }) = work.next() {
        meter.begin();
        mailbox.returned(meter.call(call));
    }
}

impl Drop for ActivityPool {
    /// Lets every thread finish its present activity; queued calls are dropped.
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
