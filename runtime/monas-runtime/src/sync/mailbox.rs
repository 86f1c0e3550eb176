//! Wakes the thread of a chart: messages, and activities that have returned.

use std::collections::VecDeque;
use std::time::Duration;

use narukom::{HostId, TopicSlot};

use super::adaptive_spin::AdaptiveSpin;
use super::primitives::{Flag, Monitor, Primitives, Threads};
use monas_core::publishing_activity::{self, PublishingActivity};

/// A mailbox filled by any thread and emptied by one. Everything added before a check is found by
/// it, so no wake-up is lost.
///
/// `R` is the type of a returned activity.
pub(crate) struct Mailbox<R: Send + 'static, P: Primitives = Threads> {
    state: P::Monitor<MailboxState<R>>,
    /// Whether it has content, for a spinning owner.
    filled: P::Flag,
    spin: AdaptiveSpin,
    /// By topic: whether its messages wake the owner.
    of_interest: Box<[P::Flag]>,
}

struct MailboxState<R> {
    wakeups: Wakeups<R>,
    /// Whether the owner sleeps.
    is_asleep: bool,
}

/// The content of a mailbox.
pub(crate) struct Wakeups<R> {
    pub(crate) messages: Vec<(TopicSlot, HostId, Option<PublishingActivity>)>,
    pub(crate) returned: VecDeque<R>,
    pub(crate) stop: bool,
    /// Whether the owner was woken to check its commands.
    pub(crate) check_commands: bool,
}

impl<R> Default for Wakeups<R> {
    fn default() -> Wakeups<R> {
        Wakeups { messages: Vec::new(), returned: VecDeque::new(), stop: false, check_commands: false }
    }
}

impl<R> Wakeups<R> {
    fn is_empty(&self) -> bool {
        self.messages.is_empty() && self.returned.is_empty() && !self.stop && !self.check_commands
    }
}

impl<R: Send + 'static, P: Primitives> Mailbox<R, P> {
    /// A mailbox for a hub with the given number of topics.
    pub(crate) fn new(topics: usize) -> Mailbox<R, P> {
        let of_interest = std::iter::repeat_with(P::Flag::new).take(topics).collect();
        let state = MailboxState { wakeups: Wakeups::default(), is_asleep: false };
        Mailbox {
            state: P::Monitor::new(state),
            filled: P::Flag::new(),
            spin: AdaptiveSpin::new(),
            of_interest,
        }
    }

    /// Wakes the owner for messages on this topic from now on. Returns true if it was not followed
    /// before: a message may have been missed.
    pub(crate) fn follow(&self, topic: TopicSlot) -> bool {
        let interest = self.of_interest.get(topic.number() as usize);
        interest.is_some_and(|interest| !interest.raise())
    }

    /// Adds a published message.
    pub(crate) fn message(&self, topic: TopicSlot, host: HostId) {
        let interest = self.of_interest.get(topic.number() as usize);
        if interest.is_some_and(Flag::is_set) {
            self.put(|mail| mail.messages.push((topic, host, publishing_activity::publishing())));
        }
    }

    /// Adds a returned activity.
    pub(crate) fn returned(&self, returned: R) {
        self.put(|mail| mail.returned.push_back(returned));
    }

    /// Requests the end of the chart.
    pub(crate) fn stop(&self) {
        self.put(|mail| mail.stop = true);
    }

    /// Wakes the owner to check its commands.
    pub(crate) fn wake(&self) {
        self.put(|mail| mail.check_commands = true);
    }

    fn put(&self, put: impl FnOnce(&mut Wakeups<R>)) {
        let mut state = self.state.lock();
        put(&mut state.wakeups);
        self.filled.set(true);
        let wakes = state.is_asleep;
        drop(state);
        if wakes {
            self.state.wake_one();
        }
    }

    /// Swaps the content for `into`, whose lists are empty, when there is some, or when no wait
    /// remains. `timeout` returns the maximum wait from now on.
    pub(crate) fn wait(&self, mut timeout: impl FnMut() -> Option<Duration>, into: &mut Wakeups<R>) {
        (into.stop, into.check_commands) = (false, false);
        let mut wait = None;
        if !self.filled.is_set()
            && let Some(limit) = timeout()
        {
            let limit = u64::try_from(limit.as_nanos()).unwrap_or(u64::MAX);
            wait = Some(self.spin.spin_then_park::<P>(limit, || self.filled.is_set()));
        }
        let mut state = self.state.lock();
        while state.wakeups.is_empty() {
            let Some(limit) = timeout() else { break };
            state.is_asleep = true;
            state = self.state.sleep(state, Some(limit));
            state.is_asleep = false;
        }
        std::mem::swap(&mut state.wakeups, into);
        self.filled.set(false);
        drop(state);
        if let Some(wait) = wait {
            self.spin.waited::<P>(&wait);
        }
    }
}
