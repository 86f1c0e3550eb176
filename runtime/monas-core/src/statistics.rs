//! Counters and timing of running agents.

use std::time::Duration;

use crate::stopwatch::{Histogram, Stopwatch};
use monas_link::LinkStatistics;

/// Statistics of a run so far, by agent in the order of execution.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Statistics {
    /// One entry for each agent.
    pub agents: Vec<AgentStatistics>,
    /// One entry for each body at the end of a run in real time; none before, nor in simulated
    /// time.
    pub bodies: Vec<BodyStatistics>,
    /// One entry for each link.
    pub links: Vec<LinkStatistics>,
    /// The failure of the world that has ended a run in real time.
    pub failure: Option<String>,
}

/// Statistics of one agent so far.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct AgentStatistics {
    /// Its host.
    pub host: String,
    /// Its name.
    pub agent: String,
    /// Passes through its list and run-to-completion steps of its charts.
    pub cycles: u64,
    /// Cycles that ended after the next was due. In simulated time there are none.
    pub overruns: u64,
    /// Cycles skipped because of overruns.
    pub missed: u64,
    /// Micro-steps of its charts.
    pub micro_steps: u64,
    /// Each of its activities.
    pub activities: Vec<ActivityStatistics>,
    /// Duration of a cycle; in simulated time measured on request only.
    pub cycle_time: Option<MovingAverage>,
    /// CPU time of a cycle, measured for one cycle in 64 and for the cycle after each overrun.
    pub cycle_cpu: Option<MovingAverage>,
    /// Percentiles of cycle durations. With several threads, those of the thread with the longest
    /// cycles.
    pub cycle_percentiles: Option<Percentiles>,
    /// Why it has stopped, if it has.
    pub stopped: Option<String>,
}

/// Statistics of the cycles of a body in real time: it forwards commands, then senses.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct BodyStatistics {
    /// Its host.
    pub host: String,
    /// The period of its cycles.
    pub period: Duration,
    /// Its cycles.
    pub cycles: u64,
    /// Cycles that began when the next was due, or later. They are made up for.
    pub overruns: u64,
    /// Cycles that failed.
    pub failures: u64,
    /// The delays of the cycles after their due times.
    pub lateness: Option<Percentiles>,
    /// From sensing to acting: the time between the last sensing before a command was published and
    /// the moment at which the body received the command.
    pub latency: Option<Percentiles>,
}

/// Statistics of one activity so far.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ActivityStatistics {
    /// The name it is registered under.
    pub name: String,
    /// The path of the state that runs it; none in a list.
    pub state: Option<String>,
    /// The number of calls.
    pub calls: u64,
    /// The number of failures and panics.
    pub failures: u64,
    /// Duration of a call; measured as that of a cycle.
    pub call_time: Option<MovingAverage>,
    /// CPU time of a call, measured as often as for cycles.
    pub call_cpu: Option<MovingAverage>,
    /// Percentiles of call durations.
    pub call_percentiles: Option<Percentiles>,
    /// Bytes allocated by it and not yet freed; where calls are measured, in programs that
    /// [count](crate::memory).
    pub held: Option<u64>,
    /// Whether this number grows from call to call.
    pub grows: bool,
    /// Whether it is part of a loop of its chart in which nothing waits; in real time.
    pub loops: bool,
}

/// Percentiles of durations, to within 1/16.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub struct Percentiles {
    /// 99.9 %.
    pub p999: Duration,
    /// 99 %.
    pub p99: Duration,
    /// 90 %.
    pub p90: Duration,
    /// 50 %.
    pub p50: Duration,
}

/// Measurements of a repeated operation.
#[derive(Clone, Debug, Default)]
pub struct Timing {
    wall: Stopwatch<(MovingAverage, Histogram)>,
    cpu: Stopwatch<MovingAverage>,
}

impl Timing {
    /// Adds a duration, and the CPU time if it was measured.
    pub fn add(&mut self, wall: Duration, cpu: Option<Duration>) {
        self.wall.add(wall);
        cpu.into_iter().for_each(|cpu| self.cpu.add(cpu));
    }

    /// Durations of calls; `None` before the first.
    pub fn wall(&self) -> Option<MovingAverage> {
        let (average, _) = self.wall.policy();
        (average.count() > 0).then_some(*average)
    }

    /// CPU times of calls; `None` if none was measured.
    pub fn cpu(&self) -> Option<MovingAverage> {
        (self.cpu.policy().count() > 0).then(|| *self.cpu.policy())
    }

    /// Percentiles of the durations; `None` before the first call.
    pub fn percentiles(&self) -> Option<Percentiles> {
        let (_, histogram) = self.wall.policy();
        (histogram.count() > 0).then(|| Percentiles {
            p50: histogram.percentile(50.0),
            p90: histogram.percentile(90.0),
            p99: histogram.percentile(99.0),
            p999: histogram.percentile(99.9),
        })
    }
}

impl AgentStatistics {
    /// Adds the statistics of another thread of the same agent.
    pub fn add(&mut self, part: AgentStatistics) {
        self.cycles += part.cycles;
        self.overruns += part.overruns;
        self.missed += part.missed;
        self.micro_steps += part.micro_steps;
        self.activities.extend(part.activities);
        self.cycle_time = match (self.cycle_time, part.cycle_time) {
            (Some(one), Some(other)) => Some(one.together(other)),
            (one, other) => one.or(other),
        };
        self.cycle_cpu = match (self.cycle_cpu, part.cycle_cpu) {
            (Some(one), Some(other)) => Some(one.together(other)),
            (one, other) => one.or(other),
        };
        self.cycle_percentiles = self.cycle_percentiles.max(part.cycle_percentiles);
        self.stopped = self.stopped.take().or(part.stopped);
    }
}

impl Statistics {
    /// The sum of the cycles of all agents.
    pub fn cycles(&self) -> u64 {
        self.agents.iter().map(|agent| agent.cycles).sum()
    }

    /// The sum of the overruns of all agents.
    pub fn overruns(&self) -> u64 {
        self.agents.iter().map(|agent| agent.overruns).sum()
    }

    /// The sum of the micro-steps of all charts.
    pub fn micro_steps(&self) -> u64 {
        self.agents.iter().map(|agent| agent.micro_steps).sum()
    }

    /// The number of calls of activities of that name on a host.
    pub fn calls(&self, host: &str, activity: &str) -> u64 {
        let agents = self.agents.iter().filter(|agent| agent.host == host);
        let activities = agents.flat_map(|agent| &agent.activities);
        activities.filter(|known| known.name == activity).map(|known| known.calls).sum()
    }
}

/// Exponential moving averages of mean and variance of durations, in which old values count less.
///
/// With factor a, a new value x moves the mean m by a (x - m) and makes the variance (1 - a) (v + a
/// (x - m)²), the incremental form of T. Finch, "Incremental calculation of weighted mean and
/// variance", 2009.
///
/// ```
/// use std::time::Duration;
/// use monas_core::MovingAverage;
///
/// let mut average = MovingAverage::default();
/// average.add(Duration::from_millis(10));
/// average.add(Duration::from_millis(20));
/// assert_eq!(average.mean(), Duration::from_millis(11));
/// assert_eq!(average.deviation(), Duration::from_millis(3));
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct MovingAverage {
    /// The number of values.
    count: u64,
    /// Seconds.
    mean: f64,
    /// Seconds squared.
    variance: f64,
    longest: Duration,
}

impl MovingAverage {
    /// Weight of a new value.
    const NEW_VALUE_WEIGHT: f64 = 0.1;

    /// Adds a value. The first value becomes the mean.
    pub fn add(&mut self, value: Duration) {
        self.longest = self.longest.max(value);
        self.count += 1;
        if self.count == 1 {
            self.mean = value.as_secs_f64();
            return;
        }
        let difference = value.as_secs_f64() - self.mean;
        let step = MovingAverage::NEW_VALUE_WEIGHT * difference;
        self.mean += step;
        self.variance = (1.0 - MovingAverage::NEW_VALUE_WEIGHT) * (self.variance + difference * step);
    }

    /// The averages of two stopwatches combined, weighted by their numbers of values.
    fn together(self, other: MovingAverage) -> MovingAverage {
        let count = self.count + other.count;
        if count == 0 {
            return self;
        }
        let share = other.count as f64 / count as f64;
        let difference = other.mean - self.mean;
        let within = (1.0 - share) * self.variance + share * other.variance;
        MovingAverage {
            count,
            mean: self.mean + share * difference,
            variance: within + share * (1.0 - share) * difference * difference,
            longest: self.longest.max(other.longest),
        }
    }

    /// The number of values.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The average.
    pub fn mean(&self) -> Duration {
        rounded(self.mean)
    }

    /// The square root of the variance.
    pub fn deviation(&self) -> Duration {
        rounded(libm::sqrt(self.variance))
    }

    /// The maximum of all values.
    pub fn longest(&self) -> Duration {
        self.longest
    }
}

/// To the nearest nanosecond.
fn rounded(seconds: f64) -> Duration {
    Duration::from_nanos(libm::round(seconds * 1e9) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_have_no_deviation() {
        let mut average = MovingAverage::default();
        (0..100).for_each(|_| average.add(Duration::from_micros(250)));
        assert_eq!(average.mean(), Duration::from_micros(250));
        assert_eq!(average.deviation(), Duration::ZERO);
        assert_eq!(average.count(), 100);
    }

    #[test]
    fn two_stopwatches_together_weigh_as_much_as_they_have_values() {
        let of = |count: usize, millis: u64| {
            let mut average = MovingAverage::default();
            (0..count).for_each(|_| average.add(Duration::from_millis(millis)));
            average
        };
        let both = of(3, 10).together(of(1, 30));
        assert_eq!((both.count(), both.mean()), (4, Duration::from_millis(15)));
        // Three values 5 ms below the mean and one 15 ms above it: 75 ms².
        assert_eq!(both.deviation(), rounded(libm::sqrt(75e-6)));
        assert_eq!(both.longest(), Duration::from_millis(30));
        assert_eq!(of(0, 0).together(of(0, 0)), MovingAverage::default());
    }

    #[test]
    fn old_values_fade() {
        let mut average = MovingAverage::default();
        average.add(Duration::from_secs(1));
        (0..400).for_each(|_| average.add(Duration::from_millis(1)));
        assert_eq!(average.mean(), Duration::from_millis(1));
        assert_eq!(average.longest(), Duration::from_secs(1));
    }

    #[test]
    fn variance_of_alternating_values_approaches_its_limit() {
        let mut average = MovingAverage::default();
        for index in 0..2000 {
            average.add(Duration::from_millis(if index % 2 == 0 { 10 } else { 20 }));
        }
        // Values 15 +- 5: the weighted variance lies near 25 ms², the mean near 15 ms.
        let (mean, deviation) = (average.mean().as_secs_f64(), average.deviation().as_secs_f64());
        assert!((mean - 0.015).abs() < 0.0005, "{mean}");
        assert!((deviation - 0.005).abs() < 0.0005, "{deviation}");
    }
}
