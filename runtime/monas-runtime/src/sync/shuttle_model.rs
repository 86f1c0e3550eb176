//! Model of the hand-over for a checker of interleavings: the threads of a chart, of its pool and
//! of a publisher run one at a time and are switched at each access to shared state. A thread that
//! sleeps forever is reported as a deadlock.

use std::sync::Arc;
use std::time::Duration;

use narukom::{HostId, TopicSlot};
use shuttle::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use shuttle::sync::{Condvar, Mutex, MutexGuard};
use shuttle::thread::{self, JoinHandle};

use super::primitives::{Flag, Monitor, Primitives};
use super::{Mailbox, Wakeups, WorkQueue};

/// The primitives of the checker. `WAKES` is false in a model without wake-ups, which verifies that
/// the checker detects missing ones.
struct ModelPrimitives<const WAKES: bool>;

struct CheckedMonitor<T, const WAKES: bool> {
    value: Mutex<T>,
    changed: Condvar,
}

impl<const WAKES: bool> Primitives for ModelPrimitives<WAKES> {
    type Monitor<T: Send + 'static> = CheckedMonitor<T, WAKES>;
    type Flag = AtomicBool;

    fn nanos() -> u64 {
        0
    }

    fn spin(_: u64, worth: impl Fn() -> bool) {
        worth();
    }
}

impl<T: Send, const WAKES: bool> Monitor<T> for CheckedMonitor<T, WAKES> {
    type Guard<'a>
        = MutexGuard<'a, T>
    where
        Self: 'a;

    fn new(value: T) -> Self {
        CheckedMonitor { value: Mutex::new(value), changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, T> {
        self.value.lock().unwrap()
    }

    /// The checker has no time, so timeouts do not occur.
    fn sleep<'a>(&'a self, guard: MutexGuard<'a, T>, _: Option<Duration>) -> MutexGuard<'a, T> {
        self.changed.wait(guard).unwrap()
    }

    fn wake_one(&self) {
        if WAKES {
            self.changed.notify_one();
        }
    }

    fn wake_all(&self) {
        self.changed.notify_all();
    }
}

impl Flag for AtomicBool {
    fn new() -> AtomicBool {
        AtomicBool::new(false)
    }

    fn is_set(&self) -> bool {
        self.load(Ordering::Acquire)
    }

    fn set(&self, value: bool) {
        self.store(value, Ordering::Release);
    }

    fn raise(&self) -> bool {
        self.swap(true, Ordering::SeqCst)
    }
}

/// The topic that the chart reads.
const TOPIC: TopicSlot = TopicSlot::new(0);

/// A configuration of the model: the number of regions, of calls per region, and of workers, while
/// another thread publishes.
#[derive(Clone, Copy)]
struct ModelScenario {
    regions: usize,
    calls: usize,
    workers: usize,
    messages: usize,
}

/// A call of an activity: its region, and the number of concurrent calls of that region.
struct ModelCall {
    region: usize,
    running: Arc<AtomicUsize>,
}

/// State shared by the threads.
struct ModelState<const WAKES: bool> {
    work: WorkQueue<ModelCall, ModelPrimitives<WAKES>>,
    mailbox: Mailbox<ModelCall, ModelPrimitives<WAKES>>,
    /// The newest message of the topic.
    published: Mutex<usize>,
}

impl ModelScenario {
    /// Executes the model to its end, which a thread that waits forever does not reach.
    fn play<const WAKES: bool>(self) {
        let stage = Arc::new(ModelState::<WAKES> {
            work: WorkQueue::new(self.workers),
            mailbox: Mailbox::new(1),
            published: Mutex::new(0),
        });
        let publisher = {
            let stage = stage.clone();
            thread::spawn(move || stage.publish(self.messages))
        };
        let mut workers = Vec::new();
        self.step_the_chart(&stage, &mut workers);
        stage.work.close();
        workers.into_iter().for_each(|worker| worker.join().unwrap());
        publisher.join().unwrap();
    }

    /// The chart: each return starts the next call of its region; at the end all calls have been
    /// made, and the last message has been seen.
    fn step_the_chart<const WAKES: bool>(
        self,
        stage: &Arc<ModelState<WAKES>>,
        workers: &mut Vec<JoinHandle<()>>,
    ) {
        // Messages published before the topic was followed must be checked for.
        let mut seen = if stage.mailbox.follow(TOPIC) { *stage.published.lock().unwrap() } else { 0 };
        let mut left = vec![self.calls; self.regions];
        for region in 0..self.regions {
            stage.submit(ModelCall { region, running: Arc::default() }, workers);
        }
        let mut mail = Wakeups::default();
        while seen < self.messages || left.iter().any(|left| *left > 0) {
            stage.mailbox.wait(|| Some(Duration::MAX), &mut mail);
            if mail.messages.drain(..).count() > 0 {
                seen = *stage.published.lock().unwrap();
            }
            for call in mail.returned.drain(..) {
                left[call.region] -= 1;
                if left[call.region] > 0 {
                    stage.submit(call, workers);
                }
            }
        }
    }
}

impl<const WAKES: bool> ModelState<WAKES> {
    fn publish(&self, messages: usize) {
        for message in 1..=messages {
            *self.published.lock().unwrap() = message;
            self.mailbox.message(TOPIC, HostId::LOCAL);
        }
    }

    fn submit(self: &Arc<Self>, call: ModelCall, workers: &mut Vec<JoinHandle<()>>) {
        let priority = call.region as i32;
        if self.work.submit(priority, call) {
            let stage = self.clone();
            workers.push(thread::spawn(move || stage.run()));
        }
    }

    fn run(&self) {
        while let Some(call) = self.work.next() {
            assert_eq!(call.running.fetch_add(1, Ordering::SeqCst), 0, "two at once in one region");
            thread::yield_now();
            call.running.fetch_sub(1, Ordering::SeqCst);
            self.mailbox.returned(call);
        }
    }
}

#[test]
fn every_activity_returns_and_every_message_wakes_in_ten_thousand_interleavings() {
    let scenario = ModelScenario { regions: 3, calls: 3, workers: 2, messages: 2 };
    shuttle::check_random(move || scenario.play::<true>(), 6_000);
    shuttle::check_pct(move || scenario.play::<true>(), 4_000, 3);
}

#[test]
fn no_wake_up_is_lost_in_any_interleaving_of_a_chart_and_a_message() {
    let scenario = ModelScenario { regions: 0, calls: 0, workers: 0, messages: 1 };
    shuttle::check_dfs(move || scenario.play::<true>(), None);
}

#[test]
fn surplus_workers_end() {
    let scenario = ModelScenario { regions: 2, calls: 1, workers: 4, messages: 0 };
    shuttle::check_random(move || scenario.play::<true>(), 2_000);
}

#[test]
#[should_panic(expected = "deadlock")]
fn a_lost_wake_up_of_a_chart_would_be_found() {
    let scenario = ModelScenario { regions: 0, calls: 0, workers: 0, messages: 1 };
    shuttle::check_dfs(move || scenario.play::<false>(), None);
}

#[test]
#[should_panic(expected = "deadlock")]
fn a_lost_wake_up_of_a_worker_would_be_found() {
    let scenario = ModelScenario { regions: 1, calls: 2, workers: 1, messages: 0 };
    shuttle::check_random(move || scenario.play::<false>(), 2_000);
}
