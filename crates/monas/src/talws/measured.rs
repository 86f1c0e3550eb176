//! What the benches of this crate measure from inside.

use std::sync::Arc;
use std::time::Duration;

use narukom::{Blackboard, Moment, Narukom};
use yase::{Semantics, Source};

use super::clock::Clock;
use super::handover::{Mail, Mailbox};
use super::pool::{Called, Pool};
use crate::agent::ChartSettings;
use crate::binder::Binder;
use crate::chart::{Assignment, Home, Runner};
use crate::error::Error;
use crate::listener::Listeners;
use crate::registry::Registry;

/// An activity that does nothing, called through a pool and back: what a chart's thread does without the chart.
pub struct RoundTrip {
    pool: Pool,
    mailbox: Arc<Mailbox<Called>>,
    mail: Mail<Called>,
    assignment: Option<Assignment>,
    calls: u64,
}

impl RoundTrip {
    /// A pool with one worker.
    ///
    /// # Errors
    /// As when a chart is started.
    pub fn new() -> Result<RoundTrip, Error> {
        let registry = Registry::empty().with("Nothing", || |_: &mut Blackboard| {});
        let (chart, _) = aseme::statechart_of(&Source::new("nothing.srm", "nothing = Nothing"));
        let bound = Binder::new(&registry)?.bind(&chart, Semantics::yase(), None).map_err(Error::invalid)?;
        let hub = Narukom::with_linked_topics("bench").map_err(Error::hub)?;
        let listeners = Listeners::default();
        let (number, seed, now) = (0, 0, Moment::ZERO);
        let home = Home { hub: &hub, agent: "bench", number, seed, listeners: &listeners, now };
        let mut runner = Runner::new(bound, ChartSettings::new(), home)?;
        runner.start(Moment::ZERO);
        // The chart does not come into this: whatever its limits are, the first step is within them.
        let assignment = runner.step(Moment::ZERO).ok().and_then(|()| runner.next_started());
        let pool = Pool::new("bench", 1, Clock::start(), &hub);
        Ok(RoundTrip {
            pool,
            mailbox: Arc::new(Mailbox::new(0)),
            mail: Mail::default(),
            assignment,
            calls: 0,
        })
    }

    /// Has the activity called, and waits for it.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn call(&mut self) -> Result<(), Error> {
        let Some(assignment) = self.assignment.take() else { return Ok(()) };
        self.pool.submit(assignment, &self.mailbox)?;
        while self.assignment.is_none() {
            self.mailbox.wait(|| Some(Duration::MAX), &mut self.mail);
            for called in self.mail.returned.drain(..) {
                self.calls += u64::from(called.returned.is_ok());
                self.assignment = Some(called.assignment);
            }
        }
        Ok(())
    }

    /// How often the activity was called.
    pub fn calls(&self) -> u64 {
        self.calls
    }
}

impl std::fmt::Debug for RoundTrip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RoundTrip").field("calls", &self.calls).finish_non_exhaustive()
    }
}
