//! Internal operations measured by the benches of this crate.

use std::sync::Arc;
use std::time::Duration;

use narukom::{Blackboard, Hub, Timestamp};
use yase::{Semantics, Source};

use super::clock::RunClock;
use super::pool::ActivityPool;
use super::sync::{Mailbox, Wakeups};
use monas_core::agent::ChartSettings;
use monas_core::binder::Binder;
use monas_core::chart_runner::{ActivityCall, ChartContext, ChartRunner, FinishedCall};
use monas_core::error::Error;
use monas_core::listener::ListenerSet;
use monas_core::registry::Registry;

/// An activity without effect that is called through a pool and returned: the work of a chart's
/// thread without the chart.
pub struct RoundTrip {
    pool: ActivityPool,
    mailbox: Arc<Mailbox<FinishedCall>>,
    wakeups: Wakeups<FinishedCall>,
    assignment: Option<ActivityCall>,
    calls: u64,
}

impl RoundTrip {
    /// A pool with one worker.
    ///
    /// # Errors
    /// As at the start of a chart.
    pub fn new() -> Result<RoundTrip, Error> {
        let registry = Registry::empty().with("Nothing", || |_: &mut Blackboard| {});
        let (chart, _) = aseme_models::statechart_of(&Source::new("nothing.srm", "nothing = Nothing"));
        let bound =
            Binder::new(&registry)?.bind(&chart, None, Semantics::yase(), None).map_err(Error::invalid)?;
        let hub = Hub::with_linked_topics("bench").map_err(Error::hub)?;
        let listeners = ListenerSet::default();
        let (number, seed, now) = (0, 0, Timestamp::ZERO);
        let home = ChartContext { hub: &hub, agent: "bench", number, seed, listeners: &listeners, now };
        let mut runner = ChartRunner::new(bound, ChartSettings::new(), home)?;
        runner.start(Timestamp::ZERO);
        // The first step is within any limits of the chart.
        let assignment = runner.step(Timestamp::ZERO).ok().and_then(|()| runner.next_started());
        let pool = ActivityPool::new("bench", 1, RunClock::start(), Arc::default(), &hub);
        Ok(RoundTrip {
            pool,
            mailbox: Arc::new(Mailbox::new(0)),
            wakeups: Wakeups::default(),
            assignment,
            calls: 0,
        })
    }

    /// Calls the activity and waits for its return.
    ///
    /// # Errors
    /// No thread can be created.
    pub fn call(&mut self) -> Result<(), Error> {
        let Some(assignment) = self.assignment.take() else { return Ok(()) };
        self.pool.submit(assignment, &self.mailbox)?;
        while self.assignment.is_none() {
            self.mailbox.wait(|| Some(Duration::MAX), &mut self.wakeups);
            for called in self.wakeups.returned.drain(..) {
                self.calls += u64::from(called.result.is_ok());
                self.assignment = Some(called.call);
            }
        }
        Ok(())
    }

    /// Number of calls so far.
    pub fn calls(&self) -> u64 {
        self.calls
    }
}

impl std::fmt::Debug for RoundTrip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RoundTrip").field("calls", &self.calls).finish_non_exhaustive()
    }
}
