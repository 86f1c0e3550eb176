//! Taking over the values of another blackboard, as a region of a statechart does on entry.

use super::Blackboard;
use crate::sample::{Channel, TopicSlot};
use crate::topic::RetentionKind;

/// Taking over values.
impl Blackboard {
    /// Takes over what `other` reads at this point: the messages delivered to it, and its own
    /// unpublished states and data. (Its unpublished signals are delivered normally once
    /// published.) Messages written here and unpublished are still published, but no longer read.
    /// Does nothing if the blackboards are not of the same hub.
    pub fn adopt(&mut self, other: &Blackboard) {
        if !self.hub.is_same_hub(&other.hub) {
            return;
        }
        self.now = other.now;
        self.window = other.window;
        for index in 0..self.attached.get_mut().len() {
            let channel = self.attached.get_mut()[index];
            self.adopt_inbox(channel, other);
        }
        for channel in other.attached.borrow().iter() {
            self.inherit_inbox(*channel, other);
        }
        for position in 0..self.written.len() {
            self.hide(self.written[position]);
        }
        for slot in &other.written {
            self.adopt_outbox(*slot, other);
        }
        self.reopen();
    }

    /// Replaces the inbox by what `other` reads, or would read.
    fn adopt_inbox(&mut self, channel: Channel, other: &Blackboard) {
        let theirs = other.entries[channel.topic.index()].inbox(channel.host);
        let anew = if theirs.is_none() { self.attached_reading(channel) } else { None };
        let mine = self.entries[channel.topic.index()].inbox_mut(channel.host);
        if let (Some(mine), Some(theirs)) = (mine, theirs.or(anew.as_ref())) {
            mine.take_over(theirs);
        }
    }

    /// Copies an inbox of `other` for a topic that has not been read here.
    fn inherit_inbox(&mut self, channel: Channel, other: &Blackboard) {
        let mine = self.entries[channel.topic.index()].inbox(channel.host);
        let theirs = other.entries[channel.topic.index()].inbox(channel.host);
        if let (None, Some(theirs)) = (mine, theirs) {
            let inherited = theirs.clone();
            inherited.set_is_read(false);
            self.keep(channel, inherited);
        }
    }

    fn hide(&mut self, slot: TopicSlot) {
        if let Some(writing) = self.entries[slot.index()].writing.as_mut() {
            writing.inherit(std::iter::empty());
        }
    }

    fn adopt_outbox(&mut self, slot: TopicSlot, other: &Blackboard) {
        let is_signal = self.hub.declaration(slot).is_some_and(|topic| topic.kind() == RetentionKind::Signal);
        let Some(theirs) = other.entries[slot.index()].writing.as_ref() else { return };
        if is_signal || theirs.visible().next().is_none() {
            return;
        }
        if let Some(writing) = self.outbox(slot) {
            writing.inherit(theirs.visible());
        }
    }

    /// Recomputes the topics that have work to do at the end of the cycle.
    fn reopen(&mut self) {
        let written = self.written.iter().map(|slot| Channel::local(*slot));
        let channels = self.attached.get_mut().iter().copied().chain(written);
        let open = self.open.get_mut();
        open.clear();
        open.extend(channels.filter(|channel| self.entries[channel.topic.index()].is_open(channel.host)));
    }
}
