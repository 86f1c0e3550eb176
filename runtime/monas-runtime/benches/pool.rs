//! The pool of statechart agents, in real time: `cargo bench -p monas-runtime`.
//!
//! First the figures of one interleaved run: a call through the pool compared with a round trip
//! through two channels, activities per second compared with a hand-written pool without charts, on
//! all cores and on one, parallel regions, and the cost of an idle chart. Then each benchmark
//! separately.
//!
//! Two runs on two cores, medians: one region 439,000 and 594,000 activities per second, 24 and 26
//! times the hand-written pool, whose threads sleep between two calls; three regions 752,000 and
//! 544,000, 1.0 and 3.6 times, since the hand-written pool varies from 54,000 to 1,630,000 there,
//! depending on whether its threads sleep. On one core 180,000 and 214,000, 1.0 and 1.1 times:
//! there a call costs two context switches, and the cost of the chart is negligible. The figures
//! vary twofold between runs, so only ratios within one run are meaningful.
#![allow(clippy::unwrap_used, reason = "a bench that cannot go on ends")]
#![allow(clippy::disallowed_methods, reason = "a bench reads the clock and has threads")]

use std::collections::VecDeque;
use std::hint::black_box;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use divan::Bencher;
use divan::counter::ItemsCount;
use monas_core::{Agent, Blackboard, BoxError, Progress, Registry};
use monas_runtime::measured::RoundTrip;
use monas_runtime::{RealTimeRun, Talws};
use yase::Source;

fn main() {
    // Under `cargo test` every benchmark runs once, without output.
    if std::env::args().any(|argument| argument == "--bench") {
        println!("one interleaved run; median (least to most)");
        report_round_trips("at once", None);
        report_round_trips("after a rest of 500 us", Some(Duration::from_micros(500)));
        report_activities("on all cores");
        on_one_core(|| report_activities("on one core"));
        report_regions();
        report_idle();
    }
    divan::main();
}

#[divan::bench]
fn pool_and_back(bencher: Bencher<'_, '_>) {
    let mut pool = RoundTrip::new().unwrap();
    bencher.bench_local(|| pool.call().unwrap());
}

#[divan::bench]
fn channel_and_back(bencher: Bencher<'_, '_>) {
    let mut channels = Channels::new();
    bencher.bench_local(|| channels.call());
}

#[divan::bench(args = [1, 3], sample_count = 20, sample_size = 1)]
fn activities(bencher: Bencher<'_, '_>, regions: usize) {
    let looping = LoopingAgent::new(regions);
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| looping.batch());
}

/// A thread behind two channels.
struct Channels {
    sender: Option<crossbeam_channel::Sender<u64>>,
    receiver: crossbeam_channel::Receiver<u64>,
    worker: Option<JoinHandle<()>>,
}

impl Channels {
    fn new() -> Channels {
        let (sender, jobs) = crossbeam_channel::unbounded();
        let (done, receiver) = crossbeam_channel::unbounded();
        let worker = thread::spawn(move || jobs.iter().for_each(|job| done.send(job).unwrap()));
        Channels { sender: Some(sender), receiver, worker: Some(worker) }
    }

    fn call(&mut self) {
        self.sender.as_ref().unwrap().send(black_box(1)).unwrap();
        black_box(self.receiver.recv().unwrap());
    }
}

impl Drop for Channels {
    fn drop(&mut self) {
        self.sender = None;
        self.worker.take().unwrap().join().unwrap();
    }
}

/// An agent whose regions call an empty activity repeatedly.
struct LoopingAgent {
    /// Receives the time after each batch of calls.
    batches: Receiver<Instant>,
    running: RealTimeRun,
}

/// Calls per batch.
const BATCH: u64 = 10_000;

/// Counts a call and sends the time when a batch is complete.
fn count(calls: &AtomicU64, batches: &Sender<Instant>) {
    if (calls.fetch_add(1, Ordering::Relaxed) + 1).is_multiple_of(BATCH) {
        // The receiver may be gone at the end of the run.
        let _ = batches.send(Instant::now());
    }
}

impl LoopingAgent {
    fn new(regions: usize) -> LoopingAgent {
        let (sender, batches) = channel();
        let calls = Arc::new(AtomicU64::new(0));
        let registry = Registry::empty().with("A", move || {
            let (sender, calls) = (sender.clone(), calls.clone());
            move |_: &mut Blackboard| count(&calls, &sender)
        });
        let looping = LoopingAgent {
            batches,
            running: start(registry, &format!("m = {}", ["A~"].repeat(regions).join(" || "))),
        };
        looping.batch();
        looping
    }

    fn batch(&self) -> Instant {
        self.batches.recv().unwrap()
    }
}

fn start(registry: Registry, formula: &str) -> RealTimeRun {
    let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", formula));
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    Talws::new().registry(registry).agent(Agent::statechart("m", chart)).start().unwrap()
}

/// Samples, in seconds or another unit.
struct Samples(Vec<f64>);

impl Samples {
    fn median(&mut self) -> f64 {
        self.0.sort_by(f64::total_cmp);
        self.0[self.0.len() / 2]
    }

    fn text(&mut self, scale: f64) -> String {
        let median = self.median();
        let (min, max) = (self.0[0], self.0[self.0.len() - 1]);
        format!("{:.2} ({:.2} to {:.2})", median * scale, min * scale, max * scale)
    }
}

/// Seconds per call; before each call there may be a pause in which all threads fall asleep.
fn seconds_a_call(calls: u32, rest: Option<Duration>, mut call: impl FnMut()) -> f64 {
    let mut taken = Duration::ZERO;
    for _ in 0..calls {
        if let Some(rest) = rest {
            let until = Instant::now() + rest;
            while Instant::now() < until {
                std::hint::spin_loop();
            }
        }
        let began = Instant::now();
        call();
        taken += began.elapsed();
    }
    taken.as_secs_f64() / f64::from(calls)
}

fn report_round_trips(when: &str, rest: Option<Duration>) {
    let (mut pool, mut channels) = (RoundTrip::new().unwrap(), Channels::new());
    let calls = if rest.is_some() { 200 } else { 5_000 };
    let (mut ours, mut theirs, mut ratios) = (Samples(vec![]), Samples(vec![]), Samples(vec![]));
    for _ in 0..15 {
        let our = seconds_a_call(calls, rest, || pool.call().unwrap());
        let their = seconds_a_call(calls, rest, || channels.call());
        ours.0.push(our);
        theirs.0.push(their);
        ratios.0.push(our / their);
    }
    println!("round trip {when}, us: pool {}, crossbeam {}", ours.text(1e6), theirs.text(1e6));
    println!("    pool to crossbeam {}", ratios.text(1.0));
}

/// A hand-written pool without a chart: jobs and results behind a mutex and a condition variable
/// each, a thread that calls each region's activity again after it has returned, and a worker per
/// region.
struct ByHand {
    batches: Receiver<Instant>,
    jobs: Arc<Queue>,
    returned: Arc<Queue>,
    threads: Vec<JoinHandle<()>>,
}

/// Numbers of regions; none once the queue is closed.
#[derive(Default)]
struct Queue {
    regions: Mutex<(VecDeque<usize>, bool)>,
    changed: Condvar,
}

impl Queue {
    fn put(&self, region: usize) {
        self.regions.lock().unwrap().0.push_back(region);
        self.changed.notify_one();
    }

    fn take(&self) -> Option<usize> {
        let mut regions = self.regions.lock().unwrap();
        loop {
            match (regions.0.pop_front(), regions.1) {
                (_, true) => return None,
                (Some(region), false) => return Some(region),
                (None, false) => regions = self.changed.wait(regions).unwrap(),
            }
        }
    }

    fn close(&self) {
        self.regions.lock().unwrap().1 = true;
        self.changed.notify_all();
    }
}

impl ByHand {
    fn new(regions: usize) -> ByHand {
        let (sender, batches) = channel();
        let (jobs, returned) = (Arc::new(Queue::default()), Arc::new(Queue::default()));
        let calls = Arc::new(AtomicU64::new(0));
        let mut threads = Vec::new();
        for region in 0..regions {
            jobs.put(region);
            let (jobs, returned, calls, sender) =
                (jobs.clone(), returned.clone(), calls.clone(), sender.clone());
            threads.push(thread::spawn(move || {
                while let Some(region) = jobs.take() {
                    count(&calls, &sender);
                    returned.put(region);
                }
            }));
        }
        let (to, from) = (jobs.clone(), returned.clone());
        threads.push(thread::spawn(move || {
            while let Some(region) = from.take() {
                to.put(region);
            }
        }));
        let pool = ByHand { batches, jobs, returned, threads };
        pool.batches.recv().unwrap();
        pool
    }

    fn stop(self) {
        self.jobs.close();
        self.returned.close();
        self.threads.into_iter().for_each(|thread| thread.join().unwrap());
    }
}

/// Rates of five batches, in activities per second.
fn rates(batches: &Receiver<Instant>) -> Vec<f64> {
    let mut last = batches.recv().unwrap();
    let rate = |_| {
        let now = batches.recv().unwrap();
        BATCH as f64 / (now - std::mem::replace(&mut last, now)).as_secs_f64()
    };
    (0..5).map(rate).collect()
}

fn report_activities(where_: &str) {
    for regions in [1, 3] {
        let (mut ours, mut theirs, mut ratios) = (Samples(vec![]), Samples(vec![]), Samples(vec![]));
        for _ in 0..9 {
            let by_hand = ByHand::new(regions);
            let mut their = Samples(rates(&by_hand.batches));
            by_hand.stop();
            let looping = LoopingAgent::new(regions);
            let mut our = Samples(rates(&looping.batches));
            looping.running.stop();
            ratios.0.push(our.median() / their.median());
            ours.0.append(&mut our.0);
            theirs.0.append(&mut their.0);
        }
        println!("thousands of activities a second in {regions} regions, {where_}: {}", ours.text(1e-3));
        println!("    by hand without a chart {}, pool to it {}", theirs.text(1e-3), ratios.text(1.0));
    }
}

/// Restricts this thread, and threads it starts, to one core, if the system permits it.
#[cfg(target_os = "linux")]
fn on_one_core(then: impl FnOnce()) {
    use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
    let all = sched_getaffinity(None).unwrap();
    let first = (0..CpuSet::MAX_CPU).find(|core| all.is_set(*core)).unwrap();
    let mut one = CpuSet::new();
    one.set(first);
    sched_setaffinity(None, &one).unwrap();
    then();
    sched_setaffinity(None, &all).unwrap();
}

#[cfg(not(target_os = "linux"))]
fn on_one_core(_: impl FnOnce()) {
    println!("threads are bound to a core on Linux only");
}

/// Work for a processor.
fn work(rounds: u64) -> u64 {
    (0..rounds).fold(1, |state: u64, round| {
        black_box(state.rotate_left(5) ^ round).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}

/// The number of rounds that takes about 100 ms.
fn hundred_milliseconds() -> u64 {
    let mut rounds = 1 << 20;
    loop {
        let began = Instant::now();
        black_box(work(rounds));
        let taken = began.elapsed().as_secs_f64();
        if taken > 0.05 {
            return (rounds as f64 * 0.1 / taken) as u64;
        }
        rounds *= 2;
    }
}

/// Start and end of a call.
type CallTimes = (Instant, Instant);

fn report_regions() {
    let rounds = hundred_milliseconds();
    let violations = Arc::new(AtomicU64::new(0));
    let (mut after, mut beside, mut ratios) = (Samples(vec![]), Samples(vec![]), Samples(vec![]));
    for _ in 0..5 {
        let one_by_one = three_works("m = A . B . C", rounds, &violations);
        let together = three_works("m = A || B || C", rounds, &violations);
        after.0.push(one_by_one);
        beside.0.push(together);
        ratios.0.push(together / one_by_one);
    }
    println!(
        "three works of about 100 ms, ms: one after the other {}, in three regions {}",
        after.text(1e3),
        beside.text(1e3)
    );
    println!(
        "    regions to sequence {}, lock violations {}",
        ratios.text(1.0),
        violations.load(Ordering::SeqCst)
    );
}

/// Duration of three units of work, from the start of the first to the end of the last.
fn three_works(formula: &str, rounds: u64, violations: &Arc<AtomicU64>) -> f64 {
    let (sender, times) = channel();
    let registry = ["A", "B", "C"].into_iter().fold(Registry::empty(), |registry, name| {
        let (sender, violations) = (sender.clone(), violations.clone());
        let inside = Arc::new(AtomicBool::new(false));
        registry.with(name, move || worker(rounds, sender.clone(), inside.clone(), violations.clone()))
    });
    let running = start(registry, formula);
    let times: Vec<CallTimes> = (0..3).map(|_| times.recv().unwrap()).collect();
    running.stop();
    let began = times.iter().map(|(began, _)| *began).min().unwrap();
    let ended = times.iter().map(|(_, ended)| *ended).max().unwrap();
    (ended - began).as_secs_f64()
}

fn worker(
    rounds: u64,
    sender: Sender<CallTimes>,
    inside: Arc<AtomicBool>,
    violations: Arc<AtomicU64>,
) -> impl FnMut(&mut Blackboard) -> Result<(), BoxError> + Send {
    move |_: &mut Blackboard| {
        let began = Instant::now();
        violations.fetch_add(u64::from(inside.swap(true, Ordering::SeqCst)), Ordering::SeqCst);
        black_box(work(rounds));
        inside.store(false, Ordering::SeqCst);
        Ok(sender.send((began, Instant::now()))?)
    }
}

/// Prints the CPU time of a chart in which all activities wait, where the system provides it.
fn report_idle() {
    let (sender, called) = channel();
    let registry = Registry::empty().with("A", move || {
        let sender = sender.clone();
        move |_: &mut Blackboard| -> Result<Progress, BoxError> {
            sender.send(())?;
            Ok(Progress::after(Duration::from_secs(3600)))
        }
    });
    let running = start(registry, "m = A || A || A");
    (0..3).for_each(|_| called.recv().unwrap());
    // All threads sleep by then.
    let _ = called.recv_timeout(Duration::from_millis(100));
    let (Some(before), began) = (processor_ticks(), Instant::now()) else {
        return println!("an idle chart: this system does not provide the processor time");
    };
    let _ = called.recv_timeout(Duration::from_secs(3));
    let ticks = processor_ticks().unwrap_or(before) - before;
    println!("an idle chart: {ticks} ticks of 10 ms in {:.1} s", began.elapsed().as_secs_f64());
    running.stop();
}

/// User and system time of this process.
fn processor_ticks() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    Some(fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?)
}
