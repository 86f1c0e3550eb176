//! What wakes the thread of a chart: messages, and activities that have returned.

use std::collections::VecDeque;
use std::time::Duration;

use narukom::{HostId, TopicSlot};

use super::habit::Habit;
use super::primitives::{Flag, Monitor, Primitives, Threads};
use crate::origin::{self, Origin};

/// Filled from any thread, emptied by one. Whatever is put in before it is looked into is found, so that no wake-up is lost.
///
/// `R` is what comes back from an activity.
pub(in crate::talws) struct Mailbox<R: Send + 'static, P: Primitives = Threads> {
    state: P::Monitor<State<R>>,
    /// Whether there is mail, for the owner who lingers.
    filled: P::Flag,
    habit: Habit,
    /// By topic: whether a message on it may concern the chart.
    of_interest: Box<[P::Flag]>,
}

struct State<R> {
    mail: Mail<R>,
    /// Whether the owner sleeps.
    asleep: bool,
}

/// What has come.
pub(in crate::talws) struct Mail<R> {
    pub(in crate::talws) messages: Vec<(TopicSlot, HostId, Option<Origin>)>,
    pub(in crate::talws) returned: VecDeque<R>,
    pub(in crate::talws) stop: bool,
    /// The owner is to look up.
    pub(in crate::talws) nudge: bool,
}

impl<R> Default for Mail<R> {
    fn default() -> Mail<R> {
        Mail { messages: Vec::new(), returned: VecDeque::new(), stop: false, nudge: false }
    }
}

impl<R> Mail<R> {
    fn is_empty(&self) -> bool {
        self.messages.is_empty() && self.returned.is_empty() && !self.stop && !self.nudge
    }
}

impl<R: Send + 'static, P: Primitives> Mailbox<R, P> {
    /// A mailbox for a hub with so many topics.
    pub(in crate::talws) fn new(topics: usize) -> Mailbox<R, P> {
        let of_interest = std::iter::repeat_with(P::Flag::new).take(topics).collect();
        let state = State { mail: Mail::default(), asleep: false };
        Mailbox { state: P::Monitor::new(state), filled: P::Flag::new(), habit: Habit::new(), of_interest }
    }

    /// From now on messages on this topic are of interest. Says whether they were not before: then one may have come unnoticed.
    pub(in crate::talws) fn follow(&self, topic: TopicSlot) -> bool {
        let interest = self.of_interest.get(topic.number() as usize);
        interest.is_some_and(|interest| !interest.raise())
    }

    /// A message was published.
    pub(in crate::talws) fn message(&self, topic: TopicSlot, host: HostId) {
        let interest = self.of_interest.get(topic.number() as usize);
        if interest.is_some_and(Flag::is_set) {
            self.put(|mail| mail.messages.push((topic, host, origin::publishing())));
        }
    }

    /// An activity has returned.
    pub(in crate::talws) fn returned(&self, returned: R) {
        self.put(|mail| mail.returned.push_back(returned));
    }

    /// The chart is to end.
    pub(in crate::talws) fn stop(&self) {
        self.put(|mail| mail.stop = true);
    }

    /// The owner is to look up: there are orders.
    pub(in crate::talws) fn nudge(&self) {
        self.put(|mail| mail.nudge = true);
    }

    fn put(&self, put: impl FnOnce(&mut Mail<R>)) {
        let mut state = self.state.lock();
        put(&mut state.mail);
        self.filled.set(true);
        let wakes = state.asleep;
        drop(state);
        if wakes {
            self.state.wake_one();
        }
    }

    /// Swaps the mail for `into`, whose lists are empty, when there is some, or when `patience`, which says how long to wait at most from
    /// now on, has none left.
    pub(in crate::talws) fn wait(&self, mut patience: impl FnMut() -> Option<Duration>, into: &mut Mail<R>) {
        (into.stop, into.nudge) = (false, false);
        let mut wait = None;
        if !self.filled.is_set()
            && let Some(limit) = patience()
        {
            let limit = u64::try_from(limit.as_nanos()).unwrap_or(u64::MAX);
            wait = Some(self.habit.linger::<P>(limit, || self.filled.is_set()));
        }
        let mut state = self.state.lock();
        while state.mail.is_empty() {
            let Some(limit) = patience() else { break };
            state.asleep = true;
            state = self.state.sleep(state, Some(limit));
            state.asleep = false;
        }
        std::mem::swap(&mut state.mail, into);
        self.filled.set(false);
        drop(state);
        if let Some(wait) = wait {
            self.habit.waited::<P>(&wait);
        }
    }
}
