//! Observation of the calls that a thread has in progress, by another thread at intervals.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use monas_core::call_slot::{CallingThread, OpenCall};
use monas_core::records::OpenCallEntry;
use narukom::Timestamp;

/// A thread that calls activities.
pub(crate) struct ObservedThread {
    calls: CallingThread,
    /// Its number in the system, if it has one.
    id: Option<i32>,
    /// The call in progress at the last observation, and the time of the first that saw it.
    last: Option<(OpenCall, Timestamp)>,
}

/// The threads that call the activities of an agent.
#[derive(Default)]
pub(crate) struct ObservedThreads(Mutex<Vec<ObservedThread>>);

impl ObservedThreads {
    /// Observes the calls of the calling thread from now on.
    pub(crate) fn add_this_thread(&self) {
        let mut threads = self.threads();
        threads.retain(|thread| !thread.calls.has_ended());
        threads.push(ObservedThread::of_this_thread());
    }

    /// The calls in progress.
    pub(crate) fn open_calls(&self, now: Timestamp) -> Vec<LastingCall> {
        self.threads().iter_mut().filter_map(|thread| thread.observe(now)).collect()
    }

    fn threads(&self) -> MutexGuard<'_, Vec<ObservedThread>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A call in progress.
#[derive(Clone, Debug)]
pub(crate) struct LastingCall {
    pub(crate) call: OpenCall,
    /// The time since it was first observed.
    pub(crate) lasts: Duration,
    /// Its thread's number in the system.
    thread: Option<i32>,
}

impl ObservedThread {
    /// The calling thread.
    pub(crate) fn of_this_thread() -> ObservedThread {
        ObservedThread { calls: CallingThread::current(), id: system::own_id(), last: None }
    }

    /// Whether it is the calling thread.
    pub(crate) fn is_this_thread(&self) -> bool {
        self.calls.is_current()
    }

    /// The call in progress at present.
    pub(crate) fn open_call(&self) -> Option<OpenCall> {
        self.calls.open_call()
    }

    /// The call in progress, with its duration.
    pub(crate) fn observe(&mut self, now: Timestamp) -> Option<LastingCall> {
        let call = self.calls.open_call();
        let is_same = |call: &OpenCall, (last, _): &(OpenCall, Timestamp)| last.number == call.number;
        self.last = match (call, self.last.take()) {
            (Some(call), Some(last)) if is_same(&call, &last) => Some(last),
            (Some(call), _) => Some((call, now)),
            (None, _) => None,
        };
        let (call, since) = self.last.clone()?;
        Some(LastingCall { call, lasts: now.since(since), thread: self.id })
    }
}

impl LastingCall {
    /// The entry for tools.
    pub(crate) fn entry(&self) -> OpenCallEntry {
        OpenCallEntry {
            activity: self.call.name.activity.clone(),
            function: self.call.function.name().into(),
            number: self.call.number,
            seconds: self.lasts.as_secs_f64(),
            cpu_seconds: self.thread.and_then(system::cpu_time_of).map(|cpu| cpu.as_secs_f64()),
        }
    }
}

impl std::fmt::Display for LastingCall {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (name, function) = (self.call.name, self.call.function.name());
        write!(
            f,
            "activity `{}` of agent `{}` on `{}` has not returned from `{function}` for {:.1} s",
            name.activity,
            name.agent,
            name.robot,
            self.lasts.as_secs_f64()
        )
    }
}

#[cfg(target_os = "linux")]
mod system {
    use std::time::Duration;

    pub(crate) fn own_id() -> Option<i32> {
        Some(rustix::thread::gettid().as_raw_nonzero().get())
    }

    /// CPU time of a thread of this process.
    pub(crate) fn cpu_time_of(id: i32) -> Option<Duration> {
        let text = std::fs::read_to_string(format!("/proc/self/task/{id}/schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use std::time::Duration;

    pub(crate) fn own_id() -> Option<i32> {
        None
    }

    pub(crate) fn cpu_time_of(_: i32) -> Option<Duration> {
        None
    }
}
