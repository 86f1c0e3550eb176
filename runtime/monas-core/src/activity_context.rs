//! The activity called on this thread, and the simulated time, for log lines.

use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::Arc;

use narukom::Timestamp;

use crate::activity_name::ActivityName;
use crate::call_slot::CallMark;
use crate::memory::{Account, LeakDetector};

/// An activity of an agent, as log lines name it.
#[derive(Debug)]
pub struct ActivityContext {
    /// Its full name.
    pub name: &'static ActivityName,
    /// The memory it holds, in real time.
    pub account: Account,
}

thread_local! {
    static SIMULATED: Cell<Option<Timestamp>> = const { Cell::new(None) };
}

impl ActivityContext {
    /// An activity of an agent of a host.
    pub fn new(robot: &str, agent: &str, activity: &str) -> Arc<ActivityContext> {
        let name = ActivityName::of(robot, agent, activity);
        Arc::new(ActivityContext { name, account: Account::default() })
    }

    /// After a call of the activity: logs a warning if its memory is found to grow.
    pub fn check_memory_growth(&self, growth: &mut LeakDetector) {
        let held = self.account.held();
        if growth.add(held) {
            let ActivityName { robot, agent, activity } = self.name;
            let kilobytes = held.unwrap_or_default() / 1024;
            tracing::warn!(%robot, %agent, %activity, kilobytes, "holds more memory after each round of calls");
        }
    }
}

/// Calls an activity; lines written meanwhile are attributed to it.
pub fn calling<T>(caller: &ActivityContext, cycle: u64, call: impl FnOnce() -> T) -> T {
    let _mark = CallMark::begin(caller.name, cycle);
    call()
}

/// While it exists, this thread runs in simulated time.
pub struct SimulatedTimeGuard(Option<Timestamp>, PhantomData<*const ()>);

impl SimulatedTimeGuard {
    /// Runs this thread in simulated time, beginning at `now`.
    pub fn begin(now: Timestamp) -> SimulatedTimeGuard {
        SimulatedTimeGuard(SIMULATED.replace(Some(now)), PhantomData)
    }

    /// Advances the simulated time.
    pub fn pass(now: Timestamp) {
        SIMULATED.set(Some(now));
    }
}

impl Drop for SimulatedTimeGuard {
    fn drop(&mut self) {
        // A nested call restores the time of its caller.
        SIMULATED.set(self.0);
    }
}

/// The simulated time of this thread, if it runs in simulated time.
pub fn simulated() -> Option<Timestamp> {
    SIMULATED.try_with(Cell::get).ok().flatten()
}
