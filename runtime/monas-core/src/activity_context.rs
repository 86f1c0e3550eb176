//! The activity called on this thread, and the simulated time, for log lines.

use std::cell::{Cell, RefCell};
use std::marker::PhantomData;
use std::sync::Arc;

use narukom::Timestamp;

use crate::call_slot::CallMark;
use crate::memory::{Account, LeakDetector};
use crate::thread_activities::{self, InternedText};

/// An activity, as log lines name it.
#[derive(Debug)]
pub struct ActivityContext {
    /// The host.
    pub robot: String,
    /// The agent.
    pub agent: String,
    /// The name of the activity.
    pub activity: String,
    /// The memory it holds, in real time.
    pub account: Account,
    /// All names, for a report of a crash.
    label: &'static InternedText,
}

impl ActivityContext {
    /// The name of the activity.
    pub(crate) fn name(&self) -> &str {
        &self.activity
    }

    /// An activity of an agent of a host.
    pub fn new(robot: &str, agent: &str, activity: &str) -> Arc<ActivityContext> {
        let (robot, agent, activity) = (robot.into(), agent.into(), activity.into());
        let label = InternedText::of(format!("{robot}/{agent}/{activity}"));
        Arc::new(ActivityContext { robot, agent, activity, account: Account::default(), label })
    }
}

thread_local! {
    static CALLED: RefCell<Option<CalledActivity>> = const { RefCell::new(None) };
    static SIMULATED: Cell<Option<Timestamp>> = const { Cell::new(None) };
}

/// An activity that is being called.
struct CalledActivity {
    caller: Arc<ActivityContext>,
    cycle: u64,
}

impl ActivityContext {
    /// After a call of an activity: logs a warning if its memory is found to grow.
    pub fn check_memory_growth(&self, growth: &mut LeakDetector) {
        let held = self.account.held();
        if growth.add(held) {
            let ActivityContext { robot, agent, activity, .. } = self;
            let kilobytes = held.unwrap_or_default() / 1024;
            tracing::warn!(%robot, %agent, %activity, kilobytes, "holds more memory after each round of calls");
        }
    }
}

/// Calls an activity; lines written meanwhile are attributed to it.
pub fn calling<T>(caller: &Arc<ActivityContext>, cycle: u64, call: impl FnOnce() -> T) -> T {
    let _mark = CallMark::begin(caller);
    thread_activities::begin(caller.label);
    let _before = ContextGuard(CALLED.replace(Some(CalledActivity { caller: caller.clone(), cycle })));
    call()
}

/// Restores the previous context, also when unwinding.
struct ContextGuard(Option<CalledActivity>);

impl Drop for ContextGuard {
    fn drop(&mut self) {
        thread_activities::end(self.0.as_ref().map(|outer| outer.caller.label));
        CALLED.replace(self.0.take());
    }
}

/// Passes the activity being called and its cycle to a function.
pub fn called(look: impl FnOnce(&ActivityContext, u64)) {
    // The thread-local is destroyed already when the thread ends.
    let _ = CALLED.try_with(|called| {
        if let Ok(called) = called.try_borrow()
            && let Some(CalledActivity { caller, cycle }) = &*called
        {
            look(caller, *cycle);
        }
    });
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
