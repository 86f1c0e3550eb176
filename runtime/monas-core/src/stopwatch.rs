//! Stopwatches. A policy type determines which statistics of the measured durations are kept.

use std::time::Duration;

use narukom::Timestamp;

use crate::statistics::MovingAverage;

/// Statistics kept of measured durations.
///
/// [`MovingAverage`] keeps an exponentially weighted mean and variance,
/// [`Totals`] a sum and the extremes, [`Histogram`] the distribution of durations. A pair of
/// policies keeps both.
pub trait TimingPolicy: Default {
    /// Adds a duration.
    fn add(&mut self, time: Duration);
}

/// A source of time for a stopwatch.
pub trait TimeSource {
    /// The current time.
    fn now(&self) -> Timestamp;
}

impl<F: Fn() -> Timestamp> TimeSource for F {
    fn now(&self) -> Timestamp {
        self()
    }
}

/// Measures durations between start and stop, or over the lifetime of a [`TimingGuard`].
///
/// ```
/// use std::cell::Cell;
/// use std::time::Duration;
/// use monas_core::{Stopwatch, Timestamp, Totals};
///
/// let time = Cell::new(Timestamp::ZERO);
/// let clock = || time.get();
///
/// let mut walk: Stopwatch<Totals> = Stopwatch::new();
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
pub struct Stopwatch<P = MovingAverage> {
    policy: P,
    since: Option<Timestamp>,
}

/// A measurement that ends when this guard is dropped.
#[derive(Debug)]
pub struct TimingGuard<'a, P: TimingPolicy, C: TimeSource> {
    stopwatch: &'a mut Stopwatch<P>,
    clock: &'a C,
    since: Timestamp,
}

impl<P: TimingPolicy> Stopwatch<P> {
    /// A stopwatch without measurements.
    pub fn new() -> Stopwatch<P> {
        Stopwatch { policy: P::default(), since: None }
    }

    /// Starts a measurement.
    pub fn start(&mut self, now: Timestamp) {
        self.since = Some(now);
    }

    /// Ends the measurement and returns its duration; none if none was started.
    pub fn stop(&mut self, now: Timestamp) -> Option<Duration> {
        let time = now.since(self.since.take()?);
        self.policy.add(time);
        Some(time)
    }

    /// Measures the time until the guard is dropped.
    pub fn lap<'a, C: TimeSource>(&'a mut self, clock: &'a C) -> TimingGuard<'a, P, C> {
        let since = clock.now();
        TimingGuard { stopwatch: self, clock, since }
    }

    /// Adds a duration measured elsewhere.
    pub fn add(&mut self, time: Duration) {
        self.policy.add(time);
    }

    /// The statistics.
    pub fn policy(&self) -> &P {
        &self.policy
    }
}

impl<P: TimingPolicy, C: TimeSource> Drop for TimingGuard<'_, P, C> {
    fn drop(&mut self) {
        self.stopwatch.policy.add(self.clock.now().since(self.since));
    }
}

impl TimingPolicy for MovingAverage {
    fn add(&mut self, time: Duration) {
        MovingAverage::add(self, time);
    }
}

impl<A: TimingPolicy, B: TimingPolicy> TimingPolicy for (A, B) {
    fn add(&mut self, time: Duration) {
        self.0.add(time);
        self.1.add(time);
    }
}

/// Keeps the sum and the extremes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Totals {
    count: u32,
    total: Duration,
    shortest: Duration,
    longest: Duration,
}

impl Totals {
    /// The number of durations.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The sum.
    pub fn total(&self) -> Duration {
        self.total
    }

    /// The mean; zero if there are no durations.
    pub fn mean(&self) -> Duration {
        self.total.checked_div(self.count).unwrap_or_default()
    }

    /// The minimum.
    pub fn shortest(&self) -> Duration {
        self.shortest
    }

    /// The maximum.
    pub fn longest(&self) -> Duration {
        self.longest
    }
}

impl TimingPolicy for Totals {
    fn add(&mut self, time: Duration) {
        self.shortest = if self.count == 0 { time } else { self.shortest.min(time) };
        self.longest = self.longest.max(time);
        self.total = self.total.saturating_add(time);
        self.count = self.count.saturating_add(1);
    }
}

/// Number of bins per octave of durations: durations are known to within 1/16.
const BINS_IN_OCTAVE: u32 = 16;
const OCTAVES: u32 = 60;

/// Counts durations in bins with a relative width of 1/16, in constant memory.
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
    /// The number of durations.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The duration that the given percentage of the values does not exceed; zero if there are no
    /// values.
    ///
    /// ```
    /// use std::time::Duration;
    /// use monas_core::{Histogram, TimingPolicy};
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

/// Durations below one octave have a bin each; above, the five leading bits select the bin.
fn bin_of(nanos: u64) -> u32 {
    let octave = (nanos | 1).ilog2();
    match octave.checked_sub(BINS_IN_OCTAVE.ilog2()) {
        None | Some(0) => nanos as u32,
        Some(shift) => (shift + 1) * BINS_IN_OCTAVE + (nanos >> shift) as u32 % BINS_IN_OCTAVE,
    }
}

/// The upper bound of a bin.
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
        let mut stopwatch: Stopwatch<(MovingAverage, Totals)> = Stopwatch::new();
        assert_eq!(stopwatch.stop(Timestamp::ZERO), None);
        stopwatch.start(Timestamp::ZERO);
        stopwatch.start(Timestamp::from_nanos(5));
        assert_eq!(stopwatch.stop(Timestamp::from_nanos(7)), Some(Duration::from_nanos(2)));
        let (average, plain) = stopwatch.policy();
        assert_eq!(
            (average.count(), plain.count(), plain.shortest(), plain.longest()),
            (1, 1, plain.total(), plain.mean())
        );
    }
}
