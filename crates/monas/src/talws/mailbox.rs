//! What wakes the thread of a chart: messages, and activities that have returned.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use narukom::{Moment, TopicSlot};

use super::clock::Clock;
use crate::chart::{Assignment, Returned};
use crate::origin::{self, Origin};

/// Filled from any thread, emptied by one. Whatever is put in before it is looked into is found, so that no wake-up is lost.
pub(super) struct Mailbox {
    mail: Mutex<Mail>,
    filled: Condvar,
    /// By topic: whether a message on it may concern the chart.
    of_interest: Box<[AtomicBool]>,
}

/// What has come.
#[derive(Default)]
pub(super) struct Mail {
    pub(super) messages: Vec<(TopicSlot, Option<Origin>)>,
    pub(super) returned: VecDeque<(Assignment, Returned)>,
    pub(super) stop: bool,
}

impl Mail {
    fn is_empty(&self) -> bool {
        self.messages.is_empty() && self.returned.is_empty() && !self.stop
    }
}

impl Mailbox {
    /// A mailbox for a hub with so many topics.
    pub(super) fn new(topics: usize) -> Mailbox {
        let of_interest = std::iter::repeat_with(|| AtomicBool::new(false)).take(topics).collect();
        Mailbox { mail: Mutex::default(), filled: Condvar::new(), of_interest }
    }

    /// From now on messages on this topic are of interest. Says whether they were not before: then one may have come unnoticed.
    pub(super) fn follow(&self, topic: TopicSlot) -> bool {
        let interest = self.of_interest.get(topic.number() as usize);
        interest.is_some_and(|interest| !interest.swap(true, Ordering::SeqCst))
    }

    /// A message was published.
    pub(super) fn message(&self, topic: TopicSlot) {
        let interest = self.of_interest.get(topic.number() as usize);
        if interest.is_some_and(|interest| interest.load(Ordering::SeqCst)) {
            self.lock().messages.push((topic, origin::publishing()));
            self.filled.notify_one();
        }
    }

    /// An activity has returned.
    pub(super) fn returned(&self, assignment: Assignment, returned: Returned) {
        self.lock().returned.push_back((assignment, returned));
        self.filled.notify_one();
    }

    /// The chart is to end.
    pub(super) fn stop(&self) {
        self.lock().stop = true;
        self.filled.notify_one();
    }

    /// Swaps the mail for `into`, whose lists are empty, when there is some or the moment has come.
    pub(super) fn wait(&self, until: Moment, clock: &Clock, into: &mut Mail) {
        into.stop = false;
        let mut mail = self.lock();
        while mail.is_empty() {
            let now = clock.now();
            if now >= until {
                break;
            }
            let waited = self.filled.wait_timeout(mail, until.since(now));
            mail = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        std::mem::swap(&mut *mail, into);
    }

    fn lock(&self) -> MutexGuard<'_, Mail> {
        self.mail.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
