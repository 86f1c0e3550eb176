//! What one blackboard has written on one topic, from then until it comes back from the hub.

use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::Arc;

use crate::error::Error;
use crate::message::AnyMessage;
use crate::pool::Pool;
use crate::sample::{AnySample, Header};
use crate::topic::{Kind, TopicDeclaration};

/// A blackboard's own messages of a topic, oldest first: those in front were published, the others wait for it.
pub(crate) struct Writing {
    topic: TopicDeclaration,
    own: VecDeque<Own>,
    published: usize,
    /// Whether the newest is a draft, which edits change in place.
    draft: bool,
    /// How many were ever written.
    written: u64,
    /// How many of these were read here before they came back.
    seen: Cell<u64>,
    /// Own messages up to this number are not read: another blackboard's values took their place.
    hidden: u64,
    /// Unpublished messages of the blackboard whose values were taken over.
    inherited: Vec<AnySample>,
    pool: Pool,
}

struct Own {
    sample: AnySample,
    nth: u64,
}

impl Writing {
    pub(crate) fn new(topic: &TopicDeclaration) -> Writing {
        Writing {
            topic: *topic,
            own: VecDeque::new(),
            published: 0,
            draft: false,
            written: 0,
            seen: Cell::new(0),
            hidden: 0,
            inherited: Vec::new(),
            pool: Pool::default(),
        }
    }

    pub(crate) fn pool(&mut self) -> &mut Pool {
        &mut self.pool
    }

    /// The message of the topic that `bytes` encode, to be written.
    pub(crate) fn decoded(&mut self, bytes: &[u8]) -> Result<Arc<dyn AnyMessage>, Error> {
        self.pool.decoded(&self.topic, bytes)
    }

    /// How many own messages were read before they came back.
    #[inline]
    pub(crate) fn seen(&self) -> u64 {
        self.seen.get()
    }

    /// Notes that the own messages are being read.
    #[inline]
    pub(crate) fn mark_seen(&self) {
        self.seen.set(self.written);
    }

    /// Own and inherited messages as they are read, oldest first.
    #[inline]
    pub(crate) fn visible(&self) -> impl DoubleEndedIterator<Item = &AnySample> {
        let own = self.own.iter().filter(|own| own.nth > self.hidden).map(|own| &own.sample);
        self.inherited.iter().chain(own)
    }

    /// Whether the end of the cycle has something to do here.
    #[inline]
    pub(crate) fn is_open(&self) -> bool {
        !self.own.is_empty() || !self.inherited.is_empty()
    }

    /// Adds a message to be published.
    pub(crate) fn write(&mut self, sample: AnySample) {
        self.written += 1;
        self.own.push_back(Own { sample, nth: self.written });
        self.draft = false;
    }

    /// Whether the newest message is a draft.
    pub(crate) fn has_draft(&self) -> bool {
        self.draft && self.own.back().is_some_and(|own| own.nth > self.hidden)
    }

    /// Adds a draft to be published: a copy of `source`, or a message with nothing set.
    pub(crate) fn begin_draft(&mut self, source: Option<&AnySample>, header: Header) {
        let message = self.pool.copied(&self.topic, source.map(|sample| &*sample.message));
        self.write(AnySample { message, header });
        self.draft = true;
    }

    /// Changes the draft in place, or in a copy if somebody else reads it.
    pub(crate) fn change_draft(&mut self, change: impl FnOnce(&mut dyn AnyMessage)) {
        let Some(mut own) = self.own.pop_back() else { return };
        if Arc::get_mut(&mut own.sample.message).is_none() {
            own.sample.message = self.pool.copied(&self.topic, Some(&*own.sample.message));
        }
        if let Some(message) = Arc::get_mut(&mut own.sample.message) {
            change(message);
        }
        self.own.push_back(own);
    }

    /// The next message to be published, and its number.
    pub(crate) fn take_next(&mut self) -> Option<(Arc<dyn AnyMessage>, u64)> {
        let own = self.own.get(self.published)?;
        self.published += 1;
        self.draft &= self.published < self.own.len();
        Some((own.sample.message.clone(), own.nth))
    }

    /// Notes the header with which a message was published, and takes back what left the hub's ring in its place.
    pub(crate) fn complete(&mut self, nth: u64, header: Header, left: Option<Arc<dyn AnyMessage>>) {
        self.pool.take_back(left);
        if let Some(own) = self.own.iter_mut().rev().find(|own| own.nth == nth) {
            own.sample.header = header;
        }
        self.trim();
    }

    /// Lets go of published messages that no read would give.
    fn trim(&mut self) {
        let kept = if self.topic.kind() == Kind::State { 1 } else { self.topic.depth() };
        while self.published > 0 && self.own.len() > kept {
            self.own.pop_front();
            self.published -= 1;
        }
    }

    /// Ends a cycle: what was published comes back from the hub.
    pub(crate) fn close(&mut self) {
        // One by one: most cycles publish one, and what is made ready for many costs more than that.
        (0..std::mem::take(&mut self.published)).for_each(|_| drop(self.own.pop_front()));
        self.inherited.clear();
    }

    /// Hides what was written so far and shows `inherited` in its place; what waits is published all the same.
    pub(crate) fn inherit<'a>(&mut self, inherited: impl Iterator<Item = &'a AnySample>) {
        self.hidden = self.written;
        self.inherited.clear();
        self.inherited.extend(inherited.cloned());
    }
}
