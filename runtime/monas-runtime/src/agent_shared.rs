//! An agent in real time: the state that its threads share with the supervisor.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use narukom::Timestamp;

use super::agent_update::{AgentStatus, AgentUpdate, ChartStatus, STOPPED_BY_REQUEST, ThreadUpdate};
use super::observed_thread::{LastingCall, ObservedThreads};
use super::supervisor_request::SupervisorRequest;
use super::sync::Mailbox;
use super::watchdog::{Watchdog, WatchedCall};
use monas_core::chart_runner::{ChartAspect, FinishedCall};
use monas_core::scheduling::Scheduling;
use monas_core::statistics::AgentStatistics;

/// Minimum interval between two status updates of a thread.
const STATUS_INTERVAL: Duration = Duration::from_millis(50);

/// The shared state of an agent.
pub(crate) struct AgentShared {
    pub(crate) name: String,
    /// Its list, if it has one, and its charts in order.
    parts: Mutex<SharedThreads>,
    stopped: Mutex<Option<String>>,
    has_stopped: AtomicBool,
    pauses: AtomicBool,
    /// Set when the body of the host must enter its safe state.
    safe_state: Arc<AtomicBool>,
    supervisor: Sender<SupervisorRequest>,
    /// A description of the thread that is stuck, if any.
    stuck: Mutex<Option<String>>,
    is_stuck: AtomicBool,
    /// Makes the refused scheduling be reported only once.
    was_reported: AtomicBool,
    /// The threads that call its activities.
    observed: Arc<ObservedThreads>,
    /// Whether the run ends without joining its threads.
    is_abandoned: AtomicBool,
}

#[derive(Clone, Default)]
struct SharedThreads {
    list: Option<Arc<ThreadShared>>,
    charts: Vec<Arc<ThreadShared>>,
}

/// The shared state of a thread of an agent: that of its list, or of a chart.
pub(crate) struct ThreadShared {
    pub(crate) mailbox: Arc<Mailbox<FinishedCall>>,
    pub(crate) watchdog: Watchdog,
    pending: Mutex<VecDeque<PendingCommands>>,
    batches: AtomicU64,
    /// Whether it will not act again by itself.
    is_over: AtomicBool,
    status: Mutex<ThreadStatus>,
}

/// Commands for one thread, applied together between two of its cycles.
pub(crate) struct PendingCommands {
    number: u64,
    pub(crate) update: AgentUpdate,
    answer: SyncSender<UpdateResult>,
}

type UpdateResult = Result<Vec<String>, Vec<String>>;

/// The status that a thread publishes of itself.
#[derive(Clone, Default)]
struct ThreadStatus {
    statistics: AgentStatistics,
    chart: ChartStatus,
    shown: Timestamp,
}

impl PendingCommands {
    /// Sends the result of an update to its requester.
    pub(crate) fn answer(answer: &SyncSender<UpdateResult>, said: UpdateResult) {
        // The requester may have timed out.
        let _ = answer.try_send(said);
    }

    pub(crate) fn open(self) -> (AgentUpdate, SyncSender<UpdateResult>) {
        (self.update, self.answer)
    }
}

impl ThreadShared {
    pub(crate) fn new(topics: usize) -> ThreadShared {
        ThreadShared {
            mailbox: Arc::new(Mailbox::new(topics)),
            watchdog: Watchdog::default(),
            pending: Mutex::default(),
            batches: AtomicU64::new(0),
            is_over: AtomicBool::new(false),
            status: Mutex::default(),
        }
    }

    /// The oldest pending commands.
    pub(crate) fn next_batch(&self) -> Option<PendingCommands> {
        locked(&self.pending).pop_front()
    }

    /// Publishes its status, unless it did so recently or a reader holds the lock.
    pub(crate) fn publish_status(
        &self,
        now: Timestamp,
        always: bool,
        current: impl FnOnce() -> (AgentStatistics, ChartStatus),
    ) {
        let Ok(mut status) = self.status.try_lock() else { return };
        if always || now >= status.shown + STATUS_INTERVAL {
            (status.statistics, status.chart) = current();
            status.shown = now;
        }
    }

    /// Marks the thread as active again.
    pub(crate) fn mark_active(&self) {
        self.is_over.store(false, Ordering::SeqCst);
    }

    fn enqueue(&self, update: AgentUpdate) -> (u64, Receiver<UpdateResult>) {
        let (answer, answered) = sync_channel(1);
        let number = self.batches.fetch_add(1, Ordering::Relaxed);
        locked(&self.pending).push_back(PendingCommands { number, update, answer });
        self.mailbox.wake();
        (number, answered)
    }

    /// Withdraws commands; returns false if the thread has begun to apply them.
    fn withdraw(&self, number: u64) -> bool {
        let mut pending = locked(&self.pending);
        let index = pending.iter().position(|batch| batch.number == number);
        index.is_some_and(|index| pending.remove(index).is_some())
    }
}

impl AgentShared {
    pub(crate) fn new(
        name: &str,
        list: Option<Arc<ThreadShared>>,
        charts: Vec<Arc<ThreadShared>>,
        rests: Arc<AtomicBool>,
        supervisor: Sender<SupervisorRequest>,
    ) -> AgentShared {
        AgentShared {
            name: name.into(),
            parts: Mutex::new(SharedThreads { list, charts }),
            stopped: Mutex::default(),
            has_stopped: AtomicBool::new(false),
            pauses: AtomicBool::new(false),
            safe_state: rests,
            supervisor,
            stuck: Mutex::default(),
            is_stuck: AtomicBool::new(false),
            was_reported: AtomicBool::new(false),
            observed: Arc::default(),
            is_abandoned: AtomicBool::new(false),
        }
    }

    /// Notifies the supervisor that a thread has nothing left to do. An agent or a chart that was
    /// stopped by command may be started again, so it does not count as finished.
    pub(crate) fn mark_finished(&self, part: &ThreadShared, was_requested: bool) {
        let was_requested = was_requested || self.reason().as_deref() == Some(STOPPED_BY_REQUEST);
        if !part.is_over.swap(true, Ordering::SeqCst) && !was_requested {
            // Without a supervisor the run has ended.
            let _ = self.supervisor.send(SupervisorRequest::ThreadFinished);
        }
    }

    /// Stops the agent because of a failure.
    pub(crate) fn fail(&self, reason: &str, is_safe_state: bool) {
        if is_safe_state {
            self.safe_state.store(true, Ordering::SeqCst);
        }
        if self.stop(reason) {
            tracing::error!(agent = %self.name, "stopped: {reason}");
            let _ = self.supervisor.send(SupervisorRequest::ThreadFinished);
        }
    }

    /// Stops the agent; returns false if it has already stopped.
    pub(crate) fn stop(&self, reason: &str) -> bool {
        let mut stopped = locked(&self.stopped);
        if stopped.is_some() {
            return false;
        }
        *stopped = Some(reason.into());
        self.has_stopped.store(true, Ordering::SeqCst);
        drop(stopped);
        self.for_each_thread(|part| part.mailbox.wake());
        true
    }

    /// Marks the agent as started again.
    pub(crate) fn start(&self) {
        *locked(&self.stopped) = None;
        self.pauses.store(false, Ordering::SeqCst);
        self.for_each_thread(|part| part.is_over.store(false, Ordering::SeqCst));
        self.has_stopped.store(false, Ordering::SeqCst);
    }

    pub(crate) fn set_paused(&self, pauses: bool) {
        self.pauses.store(pauses, Ordering::SeqCst);
    }

    pub(crate) fn has_stopped(&self) -> bool {
        self.has_stopped.load(Ordering::SeqCst)
    }

    pub(crate) fn is_paused(&self) -> bool {
        self.pauses.load(Ordering::SeqCst)
    }

    pub(crate) fn reason(&self) -> Option<String> {
        locked(&self.stopped).clone()
    }

    /// The reason of its stop, if it has stopped.
    pub(crate) fn stop_reason(&self) -> Option<String> {
        locked(&self.stuck).clone().or_else(|| self.reason())
    }

    /// Whether it will not act again by itself.
    pub(crate) fn is_over(&self) -> bool {
        let SharedThreads { list, charts } = locked(&self.parts).clone();
        let is_over = |part: &Arc<ThreadShared>| part.is_over.load(Ordering::SeqCst);
        // A cycle of a list that is stuck is cut off; a call of a chart may take long.
        let is_cut_off = |part: &Arc<ThreadShared>| part.watchdog.is_abandoned();
        self.has_stopped()
            || list.iter().all(|list| is_over(list) || is_cut_off(list)) && charts.iter().all(is_over)
    }

    pub(crate) fn is_stuck(&self) -> bool {
        self.is_stuck.load(Ordering::SeqCst)
    }

    /// Applies the scheduling of a thread of the agent to the calling thread. Returns what the
    /// system does not grant.
    pub(crate) fn schedule(&self, wanted: &Scheduling, was: &Scheduling) -> Vec<String> {
        let refused = crate::thread_scheduling::apply(wanted, was);
        if !refused.is_empty() && !self.was_reported.swap(true, Ordering::SeqCst) {
            tracing::warn!(agent = %self.name, "{}", refused.join("; "));
        }
        refused
    }

    /// The threads that call its activities.
    pub(crate) fn observed(&self) -> &Arc<ObservedThreads> {
        &self.observed
    }

    /// Abandons threads that do not end, and reports the calls that do not return.
    pub(crate) fn abandon(&self, now: Timestamp) {
        let calls: Vec<String> = self.observed.open_calls(now).iter().map(LastingCall::to_string).collect();
        let reason = match calls.is_empty() {
            true => "its threads have not ended".to_owned(),
            false => calls.join("; "),
        };
        tracing::error!(agent = %self.name, "abandoned at the end of the run: {reason}");
        *locked(&self.stuck) = Some(format!("abandoned at the end of the run: {reason}"));
        self.is_abandoned.store(true, Ordering::SeqCst);
    }

    pub(crate) fn is_abandoned(&self) -> bool {
        self.is_abandoned.load(Ordering::SeqCst)
    }

    /// Checks whether a call or cycle of a thread does not return, and abandons a list that is
    /// stuck. Returns true if this was not known before.
    pub(crate) fn check_watchdog(&self, now: Timestamp, list_limit: Duration, chart_limit: Duration) -> bool {
        // Notes since when calls last.
        self.observed.open_calls(now);
        let SharedThreads { list, charts } = locked(&self.parts).clone();
        let is_stuck = |part: &Arc<ThreadShared>, limit| {
            part.watchdog.current_call(now).filter(|under_way| under_way.since > limit)
        };
        let stuck_list = list.iter().find_map(|part| Some((part, is_stuck(part, list_limit)?)));
        // A cycle that has ended meanwhile is not stuck.
        let stuck_list = stuck_list.filter(|(part, under_way)| part.watchdog.abandon(*under_way));
        let is_cut_off = stuck_list.is_some();
        let stuck =
            stuck_list.or_else(|| charts.iter().find_map(|part| Some((part, is_stuck(part, chart_limit)?))));
        let Some((part, WatchedCall { since, cycle, activity, .. })) = stuck else {
            if self.is_stuck.swap(false, Ordering::SeqCst) {
                *locked(&self.stuck) = None;
                tracing::warn!(agent = %self.name, "is no longer stuck");
            }
            return false;
        };
        if self.is_stuck.swap(true, Ordering::SeqCst) {
            return false;
        }
        let activities = &locked(&part.status).statistics.activities;
        let activity = activities.get(activity).map_or("", |activity| activity.name.as_str());
        let millis = since.as_millis();
        let consequence = if is_cut_off { ", and nothing of its cycle is published" } else { "" };
        tracing::error!(agent = %self.name, %activity, cycle, "stuck: a call has taken {millis} ms{consequence}");
        *locked(&self.stuck) = Some(format!("activity `{activity}` is stuck in cycle {cycle}"));
        true
    }

    pub(crate) fn status(&self) -> AgentStatus {
        match (self.has_stopped(), self.is_paused()) {
            _ if self.is_stuck() => AgentStatus::Stuck,
            (true, _) => AgentStatus::Stopped,
            (false, true) => AgentStatus::Paused,
            (false, false) => AgentStatus::Running,
        }
    }

    pub(crate) fn has_list(&self) -> bool {
        locked(&self.parts).list.is_some()
    }

    pub(crate) fn set_list(&self, part: Arc<ThreadShared>) {
        locked(&self.parts).list = Some(part);
    }

    pub(crate) fn for_each_thread(&self, mut act: impl FnMut(&ThreadShared)) {
        let SharedThreads { list, charts } = locked(&self.parts).clone();
        list.iter().chain(&charts).for_each(|part| act(part));
    }

    /// The most recent statistics of all its threads, and the status of its charts.
    pub(crate) fn statuses(&self) -> (AgentStatistics, Vec<ChartStatus>) {
        let SharedThreads { list, charts } = locked(&self.parts).clone();
        let mut all = AgentStatistics::default();
        for part in list.iter().chain(&charts) {
            let status = locked(&part.status).clone();
            (all.host, all.agent) = (status.statistics.host.clone(), status.statistics.agent.clone());
            all.add(status.statistics);
        }
        all.stopped = self.stop_reason();
        (all, charts.iter().map(|part| locked(&part.status).chart.clone()).collect())
    }

    /// The state of the chart at an index, see
    /// [`ChartRunner::inspect`](monas_core::chart_runner::ChartRunner::inspect).
    pub(crate) fn inspect_chart(
        &self,
        index: usize,
        aspect: ChartAspect,
        timeout: Duration,
    ) -> Result<Vec<String>, String> {
        let part = locked(&self.parts).charts.get(index).cloned();
        let part = part.ok_or_else(|| format!("`{}` has no such statechart", self.name))?;
        let (_, answered) = part.enqueue(AgentUpdate { inspection: Some(aspect), ..AgentUpdate::default() });
        let answer =
            answered.recv_timeout(timeout).map_err(|_| format!("`{}` does not answer", self.name))?;
        answer.map_err(|reasons| reasons.join("; "))
    }

    /// Sends every thread its share of the update, and waits until all have applied it.
    ///
    /// # Errors
    /// The reasons against it. Nothing has changed then.
    pub(crate) fn apply(&self, update: AgentUpdate, timeout: Duration) -> UpdateResult {
        let SharedThreads { list, charts } = locked(&self.parts).clone();
        let shares = update.shares(list.is_some(), charts.len());
        let given: Vec<_> = shares
            .into_iter()
            .filter_map(|ThreadUpdate { chart: index, update, is_own }| {
                let part = index.map_or(list.as_ref(), |index| charts.get(index))?;
                let (number, answered) = part.enqueue(update);
                Some((part, number, answered, is_own))
            })
            .collect();
        let mut said = Vec::new();
        for (part, number, answered, is_own) in given {
            match answered.recv_timeout(timeout) {
                Ok(answer) => said.extend(answer?),
                Err(RecvTimeoutError::Disconnected) => return Err(vec!["the run has ended".into()]),
                Err(RecvTimeoutError::Timeout) if is_own && part.withdraw(number) => {
                    return Err(vec![format!("`{}` is in a cycle that does not end", self.name)]);
                }
                Err(RecvTimeoutError::Timeout) => {
                    said.push(format!(
                        "`{}` applies the change after its current cycle, which takes long",
                        self.name
                    ));
                }
            }
        }
        Ok(said)
    }
}

pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
