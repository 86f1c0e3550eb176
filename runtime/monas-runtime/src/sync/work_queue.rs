//! A queue of jobs and the workers that wait for them.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::adaptive_spin::AdaptiveSpin;
use super::primitives::{Flag, Monitor, Primitives, Threads};

/// Jobs for a bounded number of workers, by priority; jobs of equal priority in order of arrival.
pub(crate) struct WorkQueue<J: Send + 'static, P: Primitives = Threads> {
    state: P::Monitor<WorkQueueState<J>>,
    /// Whether jobs wait, for spinning workers.
    waiting: P::Flag,
    spin: AdaptiveSpin,
}

struct WorkQueueState<J> {
    jobs: BinaryHeap<QueuedJob<J>>,
    /// Number of jobs submitted so far.
    submitted: u64,
    /// Present and maximum number of workers.
    workers: usize,
    max_workers: usize,
    /// Number of idle workers. Those that are not asleep check for jobs before they sleep.
    idle: usize,
    sleeping: usize,
    closed: bool,
}

/// A job in the queue: the greatest comes first.
struct QueuedJob<J> {
    priority: i32,
    /// Of two jobs with equal priority the earlier one is greater.
    number: Reverse<u64>,
    job: J,
}

impl<J: Send + 'static, P: Primitives> WorkQueue<J, P> {
    /// An empty queue for a maximum number of workers.
    pub(crate) fn new(max: usize) -> WorkQueue<J, P> {
        let state = WorkQueueState {
            jobs: BinaryHeap::new(),
            submitted: 0,
            workers: 0,
            max_workers: max,
            idle: 0,
            sleeping: 0,
            closed: false,
        };
        WorkQueue { state: P::Monitor::new(state), waiting: P::Flag::new(), spin: AdaptiveSpin::new() }
    }

    /// Adds a job. Returns true if another worker is useful: it counts as present from now on.
    pub(crate) fn submit(&self, priority: i32, job: J) -> bool {
        let mut state = self.state.lock();
        state.submitted += 1;
        let number = Reverse(state.submitted);
        state.jobs.push(QueuedJob { priority, number, job });
        self.waiting.set(true);
        let (jobs, lingering) = (state.jobs.len(), state.idle - state.sleeping);
        let wakes = state.sleeping > 0 && jobs > lingering;
        let starts_worker = state.workers < state.max_workers && jobs > state.idle;
        state.workers += usize::from(starts_worker);
        drop(state);
        if wakes {
            self.state.wake_one();
        }
        starts_worker
    }

    /// Unregisters a worker that could not be started. Returns whether others exist.
    pub(crate) fn release_worker(&self) -> bool {
        let mut state = self.state.lock();
        state.workers -= 1;
        state.workers > 0
    }

    /// Waits for the most urgent job; `None` after the queue was closed.
    pub(crate) fn next(&self) -> Option<J> {
        let mut state = self.state.lock();
        if state.jobs.is_empty() && !state.closed {
            state.idle += 1;
            drop(state);
            let wait = self.spin.spin_then_park::<P>(u64::MAX, || self.waiting.is_set());
            state = self.state.lock();
            while state.jobs.is_empty() && !state.closed {
                state.sleeping += 1;
                state = self.state.sleep(state, None);
                state.sleeping -= 1;
            }
            state.idle -= 1;
            self.spin.waited::<P>(&wait);
        }
        if state.closed {
            return None;
        }
        let next = state.jobs.pop();
        self.waiting.set(!state.jobs.is_empty());
        next.map(|waiting| waiting.job)
    }

    /// Closes the queue and ends all workers. Queued jobs are dropped.
    pub(crate) fn close(&self) {
        self.state.lock().closed = true;
        self.waiting.set(true);
        self.state.wake_all();
    }
}

impl<J> QueuedJob<J> {
    fn urgency(&self) -> (i32, Reverse<u64>) {
        (self.priority, self.number)
    }
}

impl<J> PartialEq for QueuedJob<J> {
    fn eq(&self, other: &QueuedJob<J>) -> bool {
        self.urgency() == other.urgency()
    }
}

impl<J> Eq for QueuedJob<J> {}

impl<J> PartialOrd for QueuedJob<J> {
    fn partial_cmp(&self, other: &QueuedJob<J>) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<J> Ord for QueuedJob<J> {
    fn cmp(&self, other: &QueuedJob<J>) -> Ordering {
        self.urgency().cmp(&other.urgency())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_urgent_is_first_and_equals_are_fifo() {
        let work: WorkQueue<&str> = WorkQueue::new(1);
        for (job, priority) in [("a", 0), ("b", 5), ("c", 0), ("d", -1), ("e", 5)] {
            work.submit(priority, job);
        }
        let order: Vec<&str> = (0..5).filter_map(|_| work.next()).collect();
        assert_eq!(order, ["b", "e", "a", "c", "d"]);
    }

    #[test]
    fn workers_are_added_while_jobs_wait_up_to_the_limit() {
        let work: WorkQueue<u32> = WorkQueue::new(2);
        assert!(work.submit(0, 1), "there is no worker");
        assert!(work.submit(0, 2), "the first has something to do");
        assert!(!work.submit(0, 3), "there may be two");
        assert!(work.release_worker(), "one is left");
        assert!(work.submit(0, 4), "one has not come");
    }

    #[test]
    fn nothing_is_done_after_the_close() {
        let work: WorkQueue<u32> = WorkQueue::new(1);
        work.submit(0, 1);
        work.close();
        assert_eq!(work.next(), None);
    }
}
