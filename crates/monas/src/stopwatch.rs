//! Stopwatches: what is kept of the times that are taken is a policy, which is a type.

use std::time::Duration;

use narukom::Moment;

use crate::statistics::Average;

/// What a stopwatch keeps of the times it takes.
///
/// [`Average`] keeps a mean and a variance in which what happened long ago counts less, [`Plain`] a sum and the extremes, [`Histogram`] how often each
/// length occurred. A pair of policies is one that keeps both.
pub trait TimingPolicy: Default {
    /// Takes a time in.
    fn add(&mut self, time: Duration);
}

/// What tells a stopwatch how late it is.
pub trait TimeSource {
    /// How late it is.
    fn now(&self) -> Moment;
}

impl<F: Fn() -> Moment> TimeSource for F {
    fn now(&self) -> Moment {
        self()
    }
}

/// Takes times: told when to start and to stop, or for as long as a [`Lap`] lives.
///
/// ```
/// use std::cell::Cell;
/// use std::time::Duration;
/// use monas::{Moment, Plain, Stopwatch};
///
/// let time = Cell::new(Moment::ZERO);
/// let clock = || time.get();
///
/// let mut walk: Stopwatch<Plain> = Stopwatch::new();
/// walk.start(clock());
/// time.set(time.get() + Duration::from_millis(10));
/// assert_eq!(walk.stop(clock()), Some(Duration::from_millis(10)));
///
/// {
///     let _lap = walk.lap(&clock);
///     time.set(time.get() + Duration::from_millis(30));
/// }
/// assert_eq!(walk.policy().mean(), Duration::from_millis(20));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stopwatch<P = Average> {
    policy: P,
    since: Option<Moment>,
}

/// A time that is being taken; it ends when this is dropped.
#[derive(Debug)]
pub struct Lap<'a, P: TimingPolicy, C: TimeSource> {
    stopwatch: &'a mut Stopwatch<P>,
    clock: &'a C,
    since: Moment,
}

impl<P: TimingPolicy> Stopwatch<P> {
    /// A stopwatch that has taken no time.
    pub fn new() -> Stopwatch<P> {
        Stopwatch { policy: P::default(), since: None }
    }

    /// A time begins.
    pub fn start(&mut self, now: Moment) {
        self.since = Some(now);
    }

    /// The time that has begun ends; none if none has.
    pub fn stop(&mut self, now: Moment) -> Option<Duration> {
        let time = now.since(self.since.take()?);
        self.policy.add(time);
        Some(time)
    }

    /// Takes the time that passes until the lap is dropped.
    pub fn lap<'a, C: TimeSource>(&'a mut self, clock: &'a C) -> Lap<'a, P, C> {
        let since = clock.now();
        Lap { stopwatch: self, clock, since }
    }

    /// Takes a time in that somebody else has taken.
    pub fn add(&mut self, time: Duration) {
        self.policy.add(time);
    }

    /// What was kept.
    pub fn policy(&self) -> &P {
        &self.policy
    }
}

impl<P: TimingPolicy, C: TimeSource> Drop for Lap<'_, P, C> {
    fn drop(&mut self) {
        self.stopwatch.policy.add(self.clock.now().since(self.since));
    }
}

impl TimingPolicy for Average {
    fn add(&mut self, time: Duration) {
        Average::add(self, time);
    }
}

impl<A: TimingPolicy, B: TimingPolicy> TimingPolicy for (A, B) {
    fn add(&mut self, time: Duration) {
        self.0.add(time);
        self.1.add(time);
    }
}

/// Keeps a sum and the extremes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Plain {
    count: u32,
    total: Duration,
    shortest: Duration,
    longest: Duration,
}

impl Plain {
    /// How many times there were.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// All together.
    pub fn total(&self) -> Duration {
        self.total
    }

    /// Their mean; nothing if there was none.
    pub fn mean(&self) -> Duration {
        self.total.checked_div(self.count).unwrap_or_default()
    }

    /// The shortest.
    pub fn shortest(&self) -> Duration {
        self.shortest
    }

    /// The longest.
    pub fn longest(&self) -> Duration {
        self.longest
    }
}

impl TimingPolicy for Plain {
    fn add(&mut self, time: Duration) {
        self.shortest = if self.count == 0 { time } else { self.shortest.min(time) };
        self.longest = self.longest.max(time);
        self.total = self.total.saturating_add(time);
        self.count = self.count.saturating_add(1);
    }
}

/// Each octave of lengths has so many bins: a length is known to within a sixteenth.
const BINS_IN_OCTAVE: u32 = 16;
const OCTAVES: u32 = 60;

/// Keeps how often each length occurred, to within a sixteenth of it: memory does not grow, whatever happens.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Histogram {
    bins: Box<[u64]>,
    count: u64,
}

impl Default for Histogram {
    fn default() -> Histogram {
        Histogram { bins: vec![0; (OCTAVES * BINS_IN_OCTAVE) as usize].into(), count: 0 }
    }
}

impl Histogram {
    /// How many times there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The length that so many of a hundred times do not exceed; nothing if there was none.
    ///
    /// ```
    /// use std::time::Duration;
    /// use monas::{Histogram, TimingPolicy};
    ///
    /// let mut histogram = Histogram::default();
    /// (1..=1000).for_each(|micros| histogram.add(Duration::from_micros(micros)));
    /// let median = histogram.percentile(50.0).as_secs_f64();
    /// assert!((median - 500e-6).abs() < 500e-6 / 16.0);
    /// ```
    pub fn percentile(&self, percent: f64) -> Duration {
        let wanted = (self.count as f64 * percent / 100.0).max(1.0);
        let mut seen = 0;
        for (bin, count) in (0..).zip(&self.bins) {
            seen += count;
            if *count > 0 && seen as f64 >= wanted {
                return Duration::from_nanos(end_of(bin));
            }
        }
        Duration::ZERO
    }
}

impl TimingPolicy for Histogram {
    fn add(&mut self, time: Duration) {
        let nanos = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        let last = self.bins.len() - 1;
        self.bins[(bin_of(nanos) as usize).min(last)] += 1;
        self.count += 1;
    }
}

/// Lengths below one octave have a bin each; from then on the first five bits of a length say its bin.
fn bin_of(nanos: u64) -> u32 {
    let octave = (nanos | 1).ilog2();
    match octave.checked_sub(BINS_IN_OCTAVE.ilog2()) {
        None | Some(0) => nanos as u32,
        Some(shift) => (shift + 1) * BINS_IN_OCTAVE + (nanos >> shift) as u32 % BINS_IN_OCTAVE,
    }
}

/// The greatest length of a bin.
fn end_of(bin: u32) -> u64 {
    match (bin / BINS_IN_OCTAVE).checked_sub(1) {
        None | Some(0) => u64::from(bin),
        Some(shift) => ((u64::from(BINS_IN_OCTAVE + bin % BINS_IN_OCTAVE) + 1) << shift) - 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_length_is_in_a_bin_that_ends_within_a_sixteenth_of_it() {
        for nanos in (0..2000).chain([4095, 4096, 1_000_000, 1_000_001, 3_600_000_000_000]) {
            let end = end_of(bin_of(nanos));
            assert!(end >= nanos && end - nanos <= nanos / 16, "{nanos}: {end}");
            assert_eq!(bin_of(end), bin_of(nanos), "{nanos}");
            assert!(bin_of(end + 1) == bin_of(nanos) + 1, "{nanos}");
        }
    }

    #[test]
    fn percentiles_are_those_of_the_times() {
        let mut histogram = Histogram::default();
        assert_eq!(histogram.percentile(50.0), Duration::ZERO);
        (0..99).for_each(|_| histogram.add(Duration::from_nanos(10)));
        histogram.add(Duration::from_secs(1000));
        assert_eq!(
            [1.0, 50.0, 99.0].map(|percent| histogram.percentile(percent)),
            [Duration::from_nanos(10); 3]
        );
        assert!(histogram.percentile(100.0) >= Duration::from_secs(1000));
        histogram.add(Duration::MAX);
        assert_eq!(histogram.count(), 101);
    }

    #[test]
    fn a_stopwatch_that_was_not_started_takes_nothing() {
        let mut stopwatch: Stopwatch<(Average, Plain)> = Stopwatch::new();
        assert_eq!(stopwatch.stop(Moment::ZERO), None);
        stopwatch.start(Moment::ZERO);
        stopwatch.start(Moment::from_nanos(5));
        assert_eq!(stopwatch.stop(Moment::from_nanos(7)), Some(Duration::from_nanos(2)));
        let (average, plain) = stopwatch.policy();
        assert_eq!(
            (average.count(), plain.count(), plain.shortest(), plain.longest()),
            (1, 1, plain.total(), plain.mean())
        );
    }
}
