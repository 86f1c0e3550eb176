//! Contestants measured in alternation, and the table of their times.

use std::hint::black_box;

use rustix::time::{ClockId, clock_gettime};

use crate::allocations;
use crate::counts::{Event, Toggle};

/// A measured contestant.
pub(crate) trait Contestant {
    fn name(&self) -> &str;

    /// Cleans up after the last measurement; not timed.
    fn prepare(&mut self) {}

    /// Does its work this many times.
    fn run(&mut self, times: u64);

    /// Panics if the work was not done.
    fn check(&self) {}
}

/// A machine and the number of its events.
pub(crate) struct Racer<M> {
    name: String,
    side: usize,
    events: u64,
    machine: M,
}

impl<M: Toggle> Racer<M> {
    /// Begins with an event without effect, which must not count.
    pub(crate) fn new(name: &str, side: usize, mut machine: M) -> Racer<M> {
        machine.handle(Event::Other);
        Racer { name: name.to_owned(), side, events: 0, machine }
    }
}

impl<M: Toggle> Contestant for Racer<M> {
    fn name(&self) -> &str {
        &self.name
    }

    fn run(&mut self, times: u64) {
        for _ in 0..times {
            black_box(&mut self.machine).handle(black_box(Event::Toggle));
        }
        self.events += times;
    }

    fn check(&self) {
        self.machine.counts().assert(self.side, self.events, &self.name);
    }
}

/// Duration and number of the measurements.
pub(crate) struct Race {
    rounds: usize,
    /// Duration of one measurement, in nanoseconds.
    turn: u64,
    /// Selects the tables whose title contains this.
    filter: Option<String>,
}

impl Race {
    /// As requested by `cargo bench`; without `--bench` a short run that only checks the results.
    pub(crate) fn from_arguments() -> Race {
        let arguments: Vec<String> = std::env::args().skip(1).collect();
        let filter = arguments.iter().find(|argument| !argument.starts_with("--")).cloned();
        match arguments.iter().any(|argument| argument == "--bench") {
            true => Race { rounds: 15, turn: 10_000_000, filter },
            false => Race { rounds: 1, turn: 10_000, filter },
        }
    }

    pub(crate) fn is_wanted(&self, title: &str) -> bool {
        self.filter.as_ref().is_none_or(|filter| title.contains(filter.as_str()))
    }

    /// Measures the contestants in alternation, and prints each time relative to the first.
    pub(crate) fn run(&self, title: &str, contestants: &mut [Box<dyn Contestant + '_>]) {
        if !self.is_wanted(title) {
            return;
        }
        let times: Vec<u64> =
            contestants.iter_mut().map(|contestant| self.times(contestant.as_mut())).collect();
        let mut rounds: Vec<Vec<f64>> = vec![vec![]; contestants.len()];
        let mut allocations = vec![0; contestants.len()];
        for _ in 0..self.rounds {
            for (index, contestant) in contestants.iter_mut().enumerate() {
                contestant.prepare();
                let before = now();
                allocations[index] += allocations::count(|| contestant.run(times[index]));
                rounds[index].push((now() - before) as f64 / times[index] as f64);
            }
        }
        contestants.iter().for_each(|contestant| contestant.check());
        println!(
            "\n{title:<36} {:>11} {:>21} {:>8} {:>11}  {:>6}",
            "median", "from .. to", "ratio", "more", "allocs"
        );
        let first = rounds[0].clone();
        for (index, contestant) in contestants.iter().enumerate() {
            let done = times[index] * self.rounds as u64;
            let allocated = allocations[index] as f64 / done as f64;
            print_row(contestant.name(), &rounds[index], &first, allocated);
        }
    }

    /// The number of repetitions in one measurement. Also warms up.
    fn times(&self, contestant: &mut dyn Contestant) -> u64 {
        let mut times = 1;
        loop {
            let before = now();
            contestant.run(times);
            let taken = now() - before;
            if taken >= self.turn {
                return times;
            }
            times = (times * 2).max(times * self.turn / taken.max(1));
        }
    }
}

/// Median and spread, and the medians of ratio and difference to the first in the same round.
fn print_row(name: &str, rounds: &[f64], first: &[f64], allocated: f64) {
    let pairs = || rounds.iter().zip(first);
    let ratio = median(pairs().map(|(one, first)| one / first));
    let more = median(pairs().map(|(one, first)| one - first));
    let min = rounds.iter().copied().fold(f64::INFINITY, f64::min);
    let max = rounds.iter().copied().fold(0.0, f64::max);
    let middle = median(rounds.iter().copied());
    let spread = format!("{min:.1} .. {max:.1}");
    println!("  {name:<34} {middle:>11.1} {spread:>21} {ratio:>8.2} {more:>+11.1}  {allocated:>6.2}");
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The processor time of this thread in nanoseconds, which excludes other processes.
fn now() -> u64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}
