//! Who is at work on this thread, and at which simulated time, for the lines that are written meanwhile.

use std::cell::{Cell, RefCell};
use std::marker::PhantomData;
use std::sync::Arc;

use narukom::Moment;

use crate::memory::{Account, Growth};

/// An activity, as log lines name it.
#[derive(Debug)]
pub(crate) struct Caller {
    pub(super) robot: String,
    pub(super) agent: String,
    pub(super) activity: String,
    /// What it holds of the memory, in real time.
    pub(crate) account: Account,
}

impl Caller {
    pub(crate) fn new(robot: &str, agent: &str, activity: &str) -> Arc<Caller> {
        let (robot, agent, activity) = (robot.into(), agent.into(), activity.into());
        Arc::new(Caller { robot, agent, activity, account: Account::default() })
    }
}

thread_local! {
    static CALLED: RefCell<Option<Called>> = const { RefCell::new(None) };
    static SIMULATED: Cell<Option<Moment>> = const { Cell::new(None) };
}

/// An activity that is being called.
struct Called {
    caller: Arc<Caller>,
    cycle: u64,
}

impl Caller {
    /// An activity was called: says so when it is found to hold more and more.
    pub(crate) fn has_called(&self, growth: &mut Growth) {
        let held = self.account.held();
        if growth.add(held) {
            let Caller { robot, agent, activity, .. } = self;
            let kilobytes = held.unwrap_or_default() / 1024;
            tracing::warn!(%robot, %agent, %activity, kilobytes, "holds more memory after each round of calls");
        }
    }
}

/// Calls an activity; what is written meanwhile is its own.
pub(crate) fn calling<T>(caller: &Arc<Caller>, cycle: u64, call: impl FnOnce() -> T) -> T {
    let _before = Restored(CALLED.replace(Some(Called { caller: caller.clone(), cycle })));
    call()
}

/// Puts back what was before, also when a panic goes by.
struct Restored(Option<Called>);

impl Drop for Restored {
    fn drop(&mut self) {
        CALLED.replace(self.0.take());
    }
}

/// Shows the activity that is being called, with its cycle.
pub(super) fn called(look: impl FnOnce(&Caller, u64)) {
    // A thread that ends has lost the names already.
    let _ = CALLED.try_with(|called| {
        if let Ok(called) = called.try_borrow()
            && let Some(Called { caller, cycle }) = &*called
        {
            look(caller, *cycle);
        }
    });
}

/// Simulated time goes on on this thread, until it is dropped.
pub(crate) struct Simulating(Option<Moment>, PhantomData<*const ()>);

impl Simulating {
    pub(crate) fn begin(now: Moment) -> Simulating {
        Simulating(SIMULATED.replace(Some(now)), PhantomData)
    }

    /// It is later now.
    pub(crate) fn pass(now: Moment) {
        SIMULATED.set(Some(now));
    }
}

impl Drop for Simulating {
    fn drop(&mut self) {
        // Who is called within a moment comes back to that moment.
        SIMULATED.set(self.0);
    }
}

/// The simulated time on this thread, if it is one.
pub(super) fn simulated() -> Option<Moment> {
    SIMULATED.try_with(Cell::get).ok().flatten()
}
