//! The cycles of a body in real time.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use narukom::Timestamp;

use super::body::BodyBridge;
use super::clock::RunClock;
use super::setup::{first_tick, tick};
use super::stop_handle::StopHandle;
use monas_core::error::Error;
use monas_core::statistics::{BodyStatistics, Timing};

/// The number of past sensings that are known. A command that was published longer ago than this
/// many cycles has no measured latency.
const KEPT_SENSINGS: usize = 64;

/// A body that, in each of its cycles, receives the newest commands and publishes what it senses.
pub(crate) struct BodyThread {
    body: BodyBridge,
    stopper: StopHandle,
    clock: RunClock,
    /// Whether the body is to be in its safe state.
    rests: Arc<AtomicBool>,
    statistics: BodyStatistics,
    lateness: Timing,
    latency: Timing,
    /// The times of the last sensings, by their number.
    sensed: [Timestamp; KEPT_SENSINGS],
    sensings: usize,
}

impl BodyThread {
    pub(crate) fn new(
        body: BodyBridge,
        host: String,
        stopper: StopHandle,
        clock: RunClock,
        rests: Arc<AtomicBool>,
    ) -> BodyThread {
        let statistics = BodyStatistics { host, period: body.period(), ..BodyStatistics::default() };
        BodyThread {
            body,
            stopper,
            clock,
            rests,
            statistics,
            lateness: Timing::default(),
            latency: Timing::default(),
            sensed: [Timestamp::ZERO; KEPT_SENSINGS],
            sensings: 0,
        }
    }

    /// Makes the cycles until the run is stopped.
    pub(crate) fn run(mut self) -> BodyStatistics {
        let period = self.body.period();
        let mut next = first_tick(period, self.clock.begin());
        while self.stopper.wait_until(tick(period, next), &self.clock) {
            self.make_cycle(tick(period, next));
            next += 1;
        }
        // A run that ends because all agents have ended leaves the body in its safe state.
        if self.rests.load(Ordering::SeqCst) {
            let entered = self.body.enter_safe_state(self.clock.now());
            self.report(entered);
        }
        self.statistics.lateness = self.lateness.percentiles();
        self.statistics.latency = self.latency.percentiles();
        self.statistics
    }

    fn make_cycle(&mut self, due: Timestamp) {
        let now = self.clock.now();
        self.statistics.cycles += 1;
        self.lateness.add(now.since(due), None);
        self.statistics.overruns += u64::from(now.since(due) >= self.body.period());
        let acted = match self.rests.load(Ordering::SeqCst) {
            true => self.body.enter_safe_state(now).map(|()| None),
            false => self.body.act(now),
        };
        let done = acted.and_then(|commanded| {
            if let Some(sensed) = commanded.and_then(|commanded| self.sensing_before(commanded)) {
                self.latency.add(now.since(sensed), None);
            }
            self.sensed[self.sensings % KEPT_SENSINGS] = now;
            self.sensings += 1;
            self.body.sense(now)
        });
        self.report(done);
    }

    /// The time of the last sensing until a moment, if it is known.
    fn sensing_before(&self, moment: Timestamp) -> Option<Timestamp> {
        let known = self.sensings.saturating_sub(KEPT_SENSINGS)..self.sensings;
        known.rev().map(|number| self.sensed[number % KEPT_SENSINGS]).find(|sensed| *sensed <= moment)
    }

    fn report(&mut self, done: Result<(), Error>) {
        if let Err(error) = done {
            self.statistics.failures += 1;
            tracing::error!(host = %self.statistics.host, "{error}");
        }
    }
}
