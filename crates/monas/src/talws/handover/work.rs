//! What waits to be done, and those who wait for something to do.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::habit::Habit;
use super::primitives::{Flag, Monitor, Primitives, Threads};

/// Jobs for a fixed number of workers: the most urgent goes first, of equally urgent ones the one that came first.
pub(in crate::talws) struct Work<J: Send + 'static, P: Primitives = Threads> {
    state: P::Monitor<State<J>>,
    /// Whether jobs wait, for those who linger.
    waiting: P::Flag,
    habit: Habit,
}

struct State<J> {
    jobs: BinaryHeap<Waiting<J>>,
    /// How many jobs there ever were.
    submitted: u64,
    /// How many workers there are, and may be.
    workers: usize,
    most: usize,
    /// Of the workers those who have nothing to do. Whoever of them does not sleep looks for jobs before he does.
    idle: usize,
    asleep: usize,
    closed: bool,
}

/// Something that waits for its turn: the greatest comes first.
struct Waiting<J> {
    priority: i32,
    /// The earlier of two of equal priority is the greater.
    number: Reverse<u64>,
    job: J,
}

impl<J: Send + 'static, P: Primitives> Work<J, P> {
    /// Nothing to do, for at most so many workers.
    pub(in crate::talws) fn new(most: usize) -> Work<J, P> {
        let state = State {
            jobs: BinaryHeap::new(),
            submitted: 0,
            workers: 0,
            most,
            idle: 0,
            asleep: 0,
            closed: false,
        };
        Work { state: P::Monitor::new(state), waiting: P::Flag::new(), habit: Habit::new() }
    }

    /// Adds a job. Says whether one more worker is of use: it is counted as there from now on.
    pub(in crate::talws) fn submit(&self, priority: i32, job: J) -> bool {
        let mut state = self.state.lock();
        state.submitted += 1;
        let number = Reverse(state.submitted);
        state.jobs.push(Waiting { priority, number, job });
        self.waiting.set(true);
        let (jobs, lingering) = (state.jobs.len(), state.idle - state.asleep);
        let wakes = state.asleep > 0 && jobs > lingering;
        let hires = state.workers < state.most && jobs > state.idle;
        state.workers += usize::from(hires);
        drop(state);
        if wakes {
            self.state.wake_one();
        }
        hires
    }

    /// A worker that was to come does not. Says whether there are others.
    pub(in crate::talws) fn one_less(&self) -> bool {
        let mut state = self.state.lock();
        state.workers -= 1;
        state.workers > 0
    }

    /// The most urgent job, waited for by a worker; none when there will be no more.
    pub(in crate::talws) fn next(&self) -> Option<J> {
        let mut state = self.state.lock();
        if state.jobs.is_empty() && !state.closed {
            state.idle += 1;
            drop(state);
            let wait = self.habit.linger::<P>(u64::MAX, || self.waiting.is_set());
            state = self.state.lock();
            while state.jobs.is_empty() && !state.closed {
                state.asleep += 1;
                state = self.state.sleep(state, None);
                state.asleep -= 1;
            }
            state.idle -= 1;
            self.habit.waited::<P>(&wait);
        }
        if state.closed {
            return None;
        }
        let next = state.jobs.pop();
        self.waiting.set(!state.jobs.is_empty());
        next.map(|waiting| waiting.job)
    }

    /// Sends every worker home. What still waits is not done.
    pub(in crate::talws) fn close(&self) {
        self.state.lock().closed = true;
        self.waiting.set(true);
        self.state.wake_all();
    }
}

impl<J> Waiting<J> {
    fn urgency(&self) -> (i32, Reverse<u64>) {
        (self.priority, self.number)
    }
}

impl<J> PartialEq for Waiting<J> {
    fn eq(&self, other: &Waiting<J>) -> bool {
        self.urgency() == other.urgency()
    }
}

impl<J> Eq for Waiting<J> {}

impl<J> PartialOrd for Waiting<J> {
    fn partial_cmp(&self, other: &Waiting<J>) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<J> Ord for Waiting<J> {
    fn cmp(&self, other: &Waiting<J>) -> Ordering {
        self.urgency().cmp(&other.urgency())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_urgent_comes_first_and_of_equals_the_one_that_came_first() {
        let work: Work<&str> = Work::new(1);
        for (job, priority) in [("a", 0), ("b", 5), ("c", 0), ("d", -1), ("e", 5)] {
            work.submit(priority, job);
        }
        let order: Vec<&str> = (0..5).filter_map(|_| work.next()).collect();
        assert_eq!(order, ["b", "e", "a", "c", "d"]);
    }

    #[test]
    fn workers_are_hired_while_jobs_wait_and_there_may_be_more() {
        let work: Work<u32> = Work::new(2);
        assert!(work.submit(0, 1), "nobody is there");
        assert!(work.submit(0, 2), "the first has something to do");
        assert!(!work.submit(0, 3), "there may be two");
        assert!(work.one_less(), "one is left");
        assert!(work.submit(0, 4), "one has not come");
    }

    #[test]
    fn nothing_is_done_after_the_close() {
        let work: Work<u32> = Work::new(1);
        work.submit(0, 1);
        work.close();
        assert_eq!(work.next(), None);
    }
}
