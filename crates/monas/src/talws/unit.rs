//! An agent in real time: what its threads share with whoever manages it.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use narukom::Moment;

use super::handover::Mailbox;
use super::orders::{Orders, Share, ShownChart, Standing, TOLD};
use super::pool::Called;
use super::pulse::{Pulse, UnderWay};
use super::scheduling::Scheduling;
use super::supervisor::Event;
use crate::statistics::AgentStatistics;

/// How often a thread shows what it has done, at most.
const SHOW: Duration = Duration::from_millis(50);

/// An agent.
pub(super) struct Unit {
    pub(super) name: String,
    /// Its list, if it has one, and its charts in their order.
    parts: Mutex<Parts>,
    stopped: Mutex<Option<String>>,
    has_stopped: AtomicBool,
    pauses: AtomicBool,
    /// Set when the body of the host is to stand still.
    rests: Arc<AtomicBool>,
    supervisor: Sender<Event>,
    /// Where a thread is stuck, if one is.
    stuck: Mutex<Option<String>>,
    is_stuck: AtomicBool,
    /// What the system did not grant is said once.
    is_said: AtomicBool,
}

#[derive(Clone, Default)]
struct Parts {
    list: Option<Arc<Part>>,
    charts: Vec<Arc<Part>>,
}

/// A thread of an agent: that of its list, or of a chart.
pub(super) struct Part {
    pub(super) mailbox: Arc<Mailbox<Called>>,
    pub(super) pulse: Pulse,
    orders: Mutex<VecDeque<Batch>>,
    batches: AtomicU64,
    /// Whether it will do nothing more by itself.
    is_over: AtomicBool,
    board: Mutex<Board>,
}

/// Orders for one thread, followed at one edge of its cycles.
pub(super) struct Batch {
    number: u64,
    pub(super) orders: Orders,
    answer: SyncSender<Answer>,
}

type Answer = Result<Vec<String>, Vec<String>>;

/// What a thread shows of itself.
#[derive(Clone, Default)]
struct Board {
    statistics: AgentStatistics,
    chart: ShownChart,
    shown: Moment,
}

impl Batch {
    /// Tells whoever gave the orders what became of them.
    pub(super) fn answer(answer: &SyncSender<Answer>, said: Answer) {
        // Whoever has given up is not told.
        let _ = answer.try_send(said);
    }

    pub(super) fn open(self) -> (Orders, SyncSender<Answer>) {
        (self.orders, self.answer)
    }
}

impl Part {
    pub(super) fn new(topics: usize) -> Part {
        Part {
            mailbox: Arc::new(Mailbox::new(topics)),
            pulse: Pulse::default(),
            orders: Mutex::default(),
            batches: AtomicU64::new(0),
            is_over: AtomicBool::new(false),
            board: Mutex::default(),
        }
    }

    /// The orders that wait longest.
    pub(super) fn next_batch(&self) -> Option<Batch> {
        locked(&self.orders).pop_front()
    }

    /// Shows what it has done, unless it has just done so or somebody is looking.
    pub(super) fn show(
        &self,
        now: Moment,
        always: bool,
        look: impl FnOnce() -> (AgentStatistics, ShownChart),
    ) {
        let Ok(mut board) = self.board.try_lock() else { return };
        if always || now >= board.shown + SHOW {
            (board.statistics, board.chart) = look();
            board.shown = now;
        }
    }

    /// It has something to do.
    pub(super) fn begins(&self) {
        self.is_over.store(false, Ordering::SeqCst);
    }

    fn give(&self, orders: Orders) -> (u64, Receiver<Answer>) {
        let (answer, answered) = sync_channel(1);
        let number = self.batches.fetch_add(1, Ordering::Relaxed);
        locked(&self.orders).push_back(Batch { number, orders, answer });
        self.mailbox.nudge();
        (number, answered)
    }

    /// Takes orders back; false if the thread has begun to follow them.
    fn withdraw(&self, number: u64) -> bool {
        let mut orders = locked(&self.orders);
        let place = orders.iter().position(|batch| batch.number == number);
        place.is_some_and(|place| orders.remove(place).is_some())
    }
}

impl Unit {
    pub(super) fn new(
        name: &str,
        list: Option<Arc<Part>>,
        charts: Vec<Arc<Part>>,
        rests: Arc<AtomicBool>,
        supervisor: Sender<Event>,
    ) -> Unit {
        Unit {
            name: name.into(),
            parts: Mutex::new(Parts { list, charts }),
            stopped: Mutex::default(),
            has_stopped: AtomicBool::new(false),
            pauses: AtomicBool::new(false),
            rests,
            supervisor,
            stuck: Mutex::default(),
            is_stuck: AtomicBool::new(false),
            is_said: AtomicBool::new(false),
        }
    }

    /// A thread that has nothing to do any more says so. An agent that was told to stop, or a chart that was, may be told to start, so that is
    /// nobody's business.
    pub(super) fn is_over_for(&self, part: &Part, was_told: bool) {
        let was_told = was_told || self.reason().as_deref() == Some(TOLD);
        if !part.is_over.swap(true, Ordering::SeqCst) && !was_told {
            // Without a supervisor the run has ended.
            let _ = self.supervisor.send(Event::Rested);
        }
    }

    /// Ends the agent, for a reason of its own.
    pub(super) fn fail(&self, reason: &str, is_safe_state: bool) {
        if is_safe_state {
            self.rests.store(true, Ordering::SeqCst);
        }
        if self.stop(reason) {
            tracing::error!(agent = %self.name, "stopped: {reason}");
            let _ = self.supervisor.send(Event::Rested);
        }
    }

    /// Ends the agent; false if it has ended.
    pub(super) fn stop(&self, reason: &str) -> bool {
        let mut stopped = locked(&self.stopped);
        if stopped.is_some() {
            return false;
        }
        *stopped = Some(reason.into());
        self.has_stopped.store(true, Ordering::SeqCst);
        drop(stopped);
        self.each_part(|part| part.mailbox.nudge());
        true
    }

    /// It begins anew.
    pub(super) fn start(&self) {
        *locked(&self.stopped) = None;
        self.pauses.store(false, Ordering::SeqCst);
        self.each_part(|part| part.is_over.store(false, Ordering::SeqCst));
        self.has_stopped.store(false, Ordering::SeqCst);
        self.rests.store(false, Ordering::SeqCst);
    }

    pub(super) fn set_pauses(&self, pauses: bool) {
        self.pauses.store(pauses, Ordering::SeqCst);
    }

    pub(super) fn has_stopped(&self) -> bool {
        self.has_stopped.load(Ordering::SeqCst)
    }

    pub(super) fn pauses(&self) -> bool {
        self.pauses.load(Ordering::SeqCst)
    }

    pub(super) fn reason(&self) -> Option<String> {
        locked(&self.stopped).clone()
    }

    /// Why it does nothing, if it does not.
    pub(super) fn trouble(&self) -> Option<String> {
        locked(&self.stuck).clone().or_else(|| self.reason())
    }

    /// Whether it will never do anything again by itself.
    pub(super) fn is_over(&self) -> bool {
        let mut over = true;
        self.each_part(|part| over &= part.is_over.load(Ordering::SeqCst));
        over || self.has_stopped() || self.is_stuck()
    }

    pub(super) fn is_stuck(&self) -> bool {
        self.is_stuck.load(Ordering::SeqCst)
    }

    /// Asks the system for the scheduling that a thread of the agent, which calls this, is to have. Gives what was not granted.
    pub(super) fn schedule(&self, wanted: &Scheduling, was: &Scheduling) -> Vec<String> {
        let refused = wanted.apply(was);
        if !refused.is_empty() && !self.is_said.swap(true, Ordering::SeqCst) {
            tracing::warn!(agent = %self.name, "{}", refused.join("; "));
        }
        refused
    }

    /// Looks whether a thread is in something that does not end, and gives up a list that is. True if that is new.
    pub(super) fn watch(&self, now: Moment, list_limit: Duration, chart_limit: Duration) -> bool {
        let Parts { list, charts } = locked(&self.parts).clone();
        let is_stuck =
            |part: &Arc<Part>, limit| part.pulse.under_way(now).filter(|under_way| under_way.since > limit);
        let stuck_list = list.iter().find_map(|part| Some((part, is_stuck(part, list_limit)?)));
        // one that has ended in this moment is not stuck
        let stuck_list = stuck_list.filter(|(part, under_way)| part.pulse.cut_off(*under_way));
        let is_cut_off = stuck_list.is_some();
        let stuck =
            stuck_list.or_else(|| charts.iter().find_map(|part| Some((part, is_stuck(part, chart_limit)?))));
        let Some((part, UnderWay { since, cycle, activity, .. })) = stuck else {
            if self.is_stuck.swap(false, Ordering::SeqCst) {
                *locked(&self.stuck) = None;
                tracing::warn!(agent = %self.name, "is stuck no more");
            }
            return false;
        };
        if self.is_stuck.swap(true, Ordering::SeqCst) {
            return false;
        }
        let activities = &locked(&part.board).statistics.activities;
        let activity = activities.get(activity).map_or("", |activity| activity.name.as_str());
        let millis = since.as_millis();
        let consequence = if is_cut_off { ", and nothing of its cycle is published" } else { "" };
        tracing::error!(agent = %self.name, %activity, cycle, "stuck: a call has taken {millis} ms{consequence}");
        *locked(&self.stuck) = Some(format!("activity `{activity}` is stuck in cycle {cycle}"));
        true
    }

    pub(super) fn standing(&self) -> Standing {
        match (self.has_stopped(), self.pauses()) {
            _ if self.is_stuck() => Standing::Stuck,
            (true, _) => Standing::Stopped,
            (false, true) => Standing::Pauses,
            (false, false) => Standing::Runs,
        }
    }

    pub(super) fn has_list(&self) -> bool {
        locked(&self.parts).list.is_some()
    }

    pub(super) fn set_list(&self, part: Arc<Part>) {
        locked(&self.parts).list = Some(part);
    }

    pub(super) fn each_part(&self, mut act: impl FnMut(&Part)) {
        let Parts { list, charts } = locked(&self.parts).clone();
        list.iter().chain(&charts).for_each(|part| act(part));
    }

    /// What all its threads have shown last, and its charts.
    pub(super) fn shown(&self) -> (AgentStatistics, Vec<ShownChart>) {
        let Parts { list, charts } = locked(&self.parts).clone();
        let mut all = AgentStatistics::default();
        for part in list.iter().chain(&charts) {
            let board = locked(&part.board).clone();
            (all.host, all.agent) = (board.statistics.host.clone(), board.statistics.agent.clone());
            all.add(board.statistics);
        }
        all.stopped = self.trouble();
        (all, charts.iter().map(|part| locked(&part.board).chart.clone()).collect())
    }

    /// What the chart at a place is doing, see [`Runner::told`](crate::chart::Runner::told).
    pub(super) fn told(&self, place: usize, patience: Duration) -> Result<Vec<String>, String> {
        let part = locked(&self.parts).charts.get(place).cloned();
        let part = part.ok_or_else(|| format!("`{}` has no such statechart", self.name))?;
        let (_, answered) = part.give(Orders { look: true, ..Orders::default() });
        let told = answered.recv_timeout(patience).map_err(|_| format!("`{}` does not answer", self.name))?;
        told.map_err(|reasons| reasons.join("; "))
    }

    /// Gives every thread its part of the orders, and waits until all have followed.
    ///
    /// # Errors
    /// What stands against them. Nothing has changed then.
    pub(super) fn obey(&self, orders: Orders, patience: Duration) -> Answer {
        let Parts { list, charts } = locked(&self.parts).clone();
        let shares = orders.shares(list.is_some(), charts.len());
        let given: Vec<_> = shares
            .into_iter()
            .filter_map(|Share { place, orders, is_own }| {
                let part = place.map_or(list.as_ref(), |place| charts.get(place))?;
                let (number, answered) = part.give(orders);
                Some((part, number, answered, is_own))
            })
            .collect();
        let mut said = Vec::new();
        for (part, number, answered, is_own) in given {
            match answered.recv_timeout(patience) {
                Ok(answer) => said.extend(answer?),
                Err(RecvTimeoutError::Disconnected) => return Err(vec!["the run has ended".into()]),
                Err(RecvTimeoutError::Timeout) if is_own && part.withdraw(number) => {
                    return Err(vec![format!(
                        "`{}` is in the middle of a cycle that does not end",
                        self.name
                    )]);
                }
                Err(RecvTimeoutError::Timeout) => {
                    said.push(format!("`{}` follows when its cycle, which takes long, has ended", self.name));
                }
            }
        }
        Ok(said)
    }
}

pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
