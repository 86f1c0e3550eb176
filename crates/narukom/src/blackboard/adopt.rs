//! Taking over another blackboard's values: what a region of a statechart does when it is entered.

use super::Blackboard;
use crate::sample::{Channel, TopicSlot};
use crate::topic::Kind;

/// Taking over.
impl Blackboard {
    /// Takes over what `other` reads at this point: what was delivered to it, and its own unpublished states and data (its
    /// unpublished signals come as to everybody, when they are published). What is written here and unpublished remains to be
    /// published, but is no longer read. Both must be of one hub; else nothing happens.
    pub fn adopt(&mut self, other: &Blackboard) {
        if !self.hub.is(&other.hub) {
            return;
        }
        self.now = other.now;
        self.window = other.window;
        for place in 0..self.attached.get_mut().len() {
            let channel = self.attached.get_mut()[place];
            self.adopt_reading(channel, other);
        }
        for channel in other.attached.borrow().iter() {
            self.inherit_reading(*channel, other);
        }
        for place in 0..self.written.len() {
            self.hide(self.written[place]);
        }
        for slot in &other.written {
            self.adopt_writing(*slot, other);
        }
        self.reopen();
    }

    /// What is read here becomes what `other` reads, or would read.
    fn adopt_reading(&mut self, channel: Channel, other: &Blackboard) {
        let theirs = other.places[channel.topic.index()].reading(channel.host);
        let anew = if theirs.is_none() { self.attached_reading(channel) } else { None };
        let mine = self.places[channel.topic.index()].reading_mut(channel.host);
        if let (Some(mine), Some(theirs)) = (mine, theirs.or(anew.as_ref())) {
            mine.take_over(theirs);
        }
    }

    /// What `other` reads and nobody here has read yet is known here too.
    fn inherit_reading(&mut self, channel: Channel, other: &Blackboard) {
        let mine = self.places[channel.topic.index()].reading(channel.host);
        let theirs = other.places[channel.topic.index()].reading(channel.host);
        if let (None, Some(theirs)) = (mine, theirs) {
            let inherited = theirs.clone();
            inherited.set_interest(false);
            self.keep(channel, inherited);
        }
    }

    fn hide(&mut self, slot: TopicSlot) {
        if let Some(writing) = self.places[slot.index()].writing.as_mut() {
            writing.inherit(std::iter::empty());
        }
    }

    fn adopt_writing(&mut self, slot: TopicSlot, other: &Blackboard) {
        let is_signal = self.hub.declaration(slot).is_some_and(|topic| topic.kind() == Kind::Signal);
        let Some(theirs) = other.places[slot.index()].writing.as_ref() else { return };
        if is_signal || theirs.visible().next().is_none() {
            return;
        }
        if let Some(writing) = self.writing(slot) {
            writing.inherit(theirs.visible());
        }
    }

    /// Finds anew what ends with the cycle.
    fn reopen(&mut self) {
        let written = self.written.iter().map(|slot| Channel::local(*slot));
        let channels = self.attached.get_mut().iter().copied().chain(written);
        let open = self.open.get_mut();
        open.clear();
        open.extend(channels.filter(|channel| self.places[channel.topic.index()].is_open(channel.host)));
    }
}
