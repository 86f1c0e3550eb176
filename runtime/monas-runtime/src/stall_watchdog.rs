//! Watches a run in simulated time, whose agents share one thread: a call that does not return
//! blocks the whole run. A second thread reports the call. It only reads, so that the run is not
//! affected.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use monas_core::activity_name::ActivityName;
use monas_core::call_slot::OpenCall;
use monas_core::records::AgentEntry;
use narukom::Timestamp;

use crate::agent_update::AgentStatus;
use crate::clock::{RunClock, SimulatedClock};
use crate::observed_thread::{LastingCall, ObservedThread};
use crate::real_time_host::spawn;
use crate::stop_handle::StopHandle;

/// Interval of the observations.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// A call is reported after this real time, unless its agent sets another.
const STALL_TIMEOUT: Duration = Duration::from_secs(2);

/// The watchdog of a simulation. Its thread starts with the run and ends when this value is
/// dropped.
pub(crate) struct StallWatchdog {
    watched: Arc<WatchedRun>,
    stopper: StopHandle,
    thread: Option<JoinHandle<()>>,
}

/// The part of a simulated run that its watchdog observes.
#[derive(Default)]
pub(crate) struct WatchedRun {
    /// The thread that advances the run.
    thread: Mutex<Option<ObservedThread>>,
    stalled: Mutex<Option<LastingCall>>,
    /// The limits of agents that set one, by host and agent.
    limits: BTreeMap<(String, String), Duration>,
}

impl StallWatchdog {
    pub(crate) fn new(limits: BTreeMap<(String, String), Duration>) -> StallWatchdog {
        let watched = Arc::new(WatchedRun { limits, ..WatchedRun::default() });
        StallWatchdog { watched, stopper: StopHandle::new(), thread: None }
    }

    /// The run that it watches.
    pub(crate) fn watched(&self) -> &Arc<WatchedRun> {
        &self.watched
    }

    /// Watches the calling thread from now on.
    pub(crate) fn watch_this_thread(&mut self, time: &Arc<SimulatedClock>) {
        let mut thread = locked(&self.watched.thread);
        if thread.as_ref().is_none_or(|thread| !thread.is_this_thread()) {
            *thread = Some(ObservedThread::of_this_thread());
        }
        drop(thread);
        if self.thread.is_some() {
            return;
        }
        let (watched, stopper, time) = (self.watched.clone(), self.stopper.clone(), time.clone());
        let watch = move || {
            let clock = RunClock::start();
            while stopper.wait_until(clock.now() + CHECK_INTERVAL, &clock) {
                watched.observe(clock.now(), &time);
            }
        };
        match spawn("watchdog", watch) {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => tracing::warn!("calls that do not return are not reported: {error}"),
        }
    }
}

impl Drop for StallWatchdog {
    fn drop(&mut self) {
        self.stopper.stop();
        if self.thread.take().is_some_and(|thread| thread.join().is_err()) {
            tracing::error!("the thread of the watchdog has panicked");
        }
    }
}

impl WatchedRun {
    fn observe(&self, now: Timestamp, time: &SimulatedClock) {
        let call = locked(&self.thread).as_mut().and_then(|thread| thread.observe(now));
        let mut stalled = locked(&self.stalled);
        let was_reported =
            |call: &LastingCall| stalled.as_ref().is_some_and(|known| known.call.number == call.call.number);
        match call.filter(|call| call.lasts >= self.limit(call)) {
            Some(call) if was_reported(&call) => *stalled = Some(call),
            Some(call) => {
                let (ActivityName { robot, agent, activity }, time) = (call.call.name, time.get());
                tracing::error!(%robot, %agent, %activity, "stuck: {call}; the whole run stands still at {time}");
                *stalled = Some(call);
            }
            None => {
                if let Some(call) = stalled.take() {
                    let ActivityName { robot, agent, activity } = call.call.name;
                    tracing::warn!(%robot, %agent, %activity, "is stuck no more: the run goes on");
                }
            }
        }
    }

    fn limit(&self, call: &LastingCall) -> Duration {
        let name = call.call.name;
        let key = (name.robot.clone(), name.agent.clone());
        self.limits.get(&key).copied().unwrap_or(STALL_TIMEOUT)
    }

    /// The call in progress.
    pub(crate) fn open_call(&self) -> Option<OpenCall> {
        locked(&self.thread).as_ref().and_then(ObservedThread::open_call)
    }

    /// The call that blocks the run, if any.
    pub(crate) fn stalled(&self) -> Option<LastingCall> {
        locked(&self.stalled).clone()
    }

    /// The entry of the agent that blocks the run.
    pub(crate) fn stuck_agent(&self) -> Option<AgentEntry> {
        let stalled = self.stalled()?;
        let name = stalled.call.name;
        Some(AgentEntry {
            host: name.robot.clone(),
            name: name.agent.clone(),
            state: AgentStatus::Stuck.word().into(),
            reason: stalled.to_string(),
            activities: vec![monas_core::records::ActivityEntry {
                name: name.activity.clone(),
                ..monas_core::records::ActivityEntry::default()
            }],
            open_calls: vec![stalled.entry()],
            ..AgentEntry::default()
        })
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
