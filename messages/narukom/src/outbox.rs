//! The messages that one blackboard has written on one topic, until the hub delivers them.

use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::Arc;

use crate::error::Error;
use crate::message::AnyMessage;
use crate::pool::MessagePool;
use crate::sample::{AnySample, Header};
use crate::topic::{RetentionKind, TopicDeclaration};

/// A blackboard's own messages of a topic, oldest first: the published ones first, then the
/// unpublished ones.
pub(crate) struct Outbox {
    topic: TopicDeclaration,
    messages: VecDeque<PendingMessage>,
    published: usize,
    /// Whether the newest message is a draft, which edits change in place.
    draft: bool,
    /// The number of messages ever written.
    written: u64,
    /// The number of these that were read here before the hub delivered them.
    seen: Cell<u64>,
    /// Own messages up to this number are not read: the values of another blackboard replaced them.
    hidden: u64,
    /// Unpublished messages of the blackboard whose values were taken over.
    inherited: Vec<AnySample>,
    pool: MessagePool,
}

struct PendingMessage {
    sample: AnySample,
    nth: u64,
}

impl Outbox {
    pub(crate) fn new(topic: &TopicDeclaration) -> Outbox {
        Outbox {
            topic: *topic,
            messages: VecDeque::new(),
            published: 0,
            draft: false,
            written: 0,
            seen: Cell::new(0),
            hidden: 0,
            inherited: Vec::new(),
            pool: MessagePool::default(),
        }
    }

    pub(crate) fn pool(&mut self) -> &mut MessagePool {
        &mut self.pool
    }

    /// Decodes a message of the topic, to be written.
    pub(crate) fn decoded(&mut self, bytes: &[u8]) -> Result<Arc<dyn AnyMessage>, Error> {
        self.pool.decoded(&self.topic, bytes)
    }

    /// The number of own messages that were read before the hub delivered them.
    #[inline]
    pub(crate) fn seen(&self) -> u64 {
        self.seen.get()
    }

    /// Records that the own messages are being read.
    #[inline]
    pub(crate) fn mark_seen(&self) {
        self.seen.set(self.written);
    }

    /// The readable own and inherited messages, oldest first.
    #[inline]
    pub(crate) fn visible(&self) -> impl DoubleEndedIterator<Item = &AnySample> {
        self.visible_from(0)
    }

    /// The readable own and inherited messages without the `first` oldest, oldest first.
    #[inline]
    pub(crate) fn visible_from(&self, first: usize) -> impl DoubleEndedIterator<Item = &AnySample> {
        let inherited = self.inherited.get(first..).unwrap_or_default();
        let index = self.hidden_count() + first.saturating_sub(self.inherited.len());
        let own = self.messages.range(index.min(self.messages.len())..);
        inherited.iter().chain(own.map(|own| &own.sample))
    }

    /// The number of readable messages.
    #[inline]
    pub(crate) fn visible_count(&self) -> usize {
        self.inherited.len() + self.messages.len() - self.hidden_count()
    }

    /// The number of own messages that are not read. Own messages are numbered without gaps up to
    /// the last one written.
    #[inline]
    fn hidden_count(&self) -> usize {
        let before = self.written - self.messages.len() as u64;
        (self.hidden.saturating_sub(before) as usize).min(self.messages.len())
    }

    /// Whether the end of the cycle has work to do here.
    #[inline]
    pub(crate) fn is_open(&self) -> bool {
        !self.messages.is_empty() || !self.inherited.is_empty()
    }

    /// Adds a message to be published.
    pub(crate) fn write(&mut self, sample: AnySample) {
        self.written += 1;
        self.messages.push_back(PendingMessage { sample, nth: self.written });
        self.draft = false;
    }

    /// Whether the newest message is a draft.
    pub(crate) fn has_draft(&self) -> bool {
        self.draft && self.messages.back().is_some_and(|own| own.nth > self.hidden)
    }

    /// Adds a draft to be published: a copy of `source`, or a default message.
    pub(crate) fn begin_draft(&mut self, source: Option<&AnySample>, header: Header) {
        let message = self.pool.copied(&self.topic, source.map(|sample| &*sample.message));
        self.write(AnySample { message, header });
        self.draft = true;
    }

    /// Changes the draft in place, or in a copy if it has other readers.
    pub(crate) fn change_draft(&mut self, change: impl FnOnce(&mut dyn AnyMessage)) {
        let Some(mut own) = self.messages.pop_back() else { return };
        if Arc::get_mut(&mut own.sample.message).is_none() {
            own.sample.message = self.pool.copied(&self.topic, Some(&*own.sample.message));
        }
        if let Some(message) = Arc::get_mut(&mut own.sample.message) {
            change(message);
        }
        self.messages.push_back(own);
    }

    /// The next message to be published, and its number.
    pub(crate) fn take_next(&mut self) -> Option<(Arc<dyn AnyMessage>, u64)> {
        let own = self.messages.get(self.published)?;
        self.published += 1;
        self.draft &= self.published < self.messages.len();
        Some((own.sample.message.clone(), own.nth))
    }

    /// Stores the header with which a message was published, and reuses the message that left the
    /// hub's ring in exchange.
    pub(crate) fn complete(&mut self, nth: u64, header: Header, left: Option<Arc<dyn AnyMessage>>) {
        self.pool.take_back(left);
        if let Some(own) = self.messages.iter_mut().rev().find(|own| own.nth == nth) {
            own.sample.header = header;
        }
        self.trim();
    }

    /// Drops published messages that no read would return.
    fn trim(&mut self) {
        let kept = if self.topic.kind() == RetentionKind::State { 1 } else { self.topic.depth() };
        while self.published > 0 && self.messages.len() > kept {
            self.messages.pop_front();
            self.published -= 1;
        }
    }

    /// Ends a cycle: published messages are from now on delivered by the hub.
    pub(crate) fn close(&mut self) {
        // One by one: most cycles publish one message, and the setup of a batch operation costs
        // more than that.
        (0..std::mem::take(&mut self.published)).for_each(|_| drop(self.messages.pop_front()));
        self.inherited.clear();
    }

    /// Hides what was written so far and shows `inherited` instead; unpublished messages are still
    /// published.
    pub(crate) fn inherit<'a>(&mut self, inherited: impl Iterator<Item = &'a AnySample>) {
        self.hidden = self.written;
        self.inherited.clear();
        self.inherited.extend(inherited.cloned());
    }
}
