//! Writing on a blackboard.

use std::sync::Arc;

use super::{Blackboard, OUTBOX_LIMIT};
use crate::encoding::check_type;
use crate::error::{Error, ErrorKind};
use crate::message::AnyMessage;
use crate::sample::{AnySample, Channel, Header, HostId, TopicSlot};
use crate::topic::{Keep, Topic};
use crate::writing::Writing;

/// Writing.
impl Blackboard {
    /// Writes a message, to be published by [`publish_all`](Blackboard::publish_all) and readable here at once.
    ///
    /// # Errors
    /// The hub was made without the topic, or more than [`OUTBOX_LIMIT`] messages wait.
    pub fn publish<K: Keep>(&mut self, topic: Topic<K>, message: K::Message) -> Result<(), Error> {
        let slot = self.hub.catalogue().checked(topic)?;
        self.room()?;
        self.queue(slot, |writing, header| {
            let message = writing.pool().wrap(message);
            writing.write(AnySample { message, header });
        });
        Ok(())
    }

    /// As [`publish`](Blackboard::publish), for a message that `make` builds in place, beginning with nothing set: large ones need not
    /// be moved, and their texts, bytes and lists use the memory of earlier ones.
    ///
    /// # Errors
    /// As there.
    pub fn publish_with<K: Keep>(
        &mut self,
        topic: Topic<K>,
        make: impl FnOnce(&mut K::Message),
    ) -> Result<(), Error> {
        let slot = self.hub.catalogue().checked(topic)?;
        self.room()?;
        self.queue(slot, |writing, header| {
            let message = writing.pool().build(make);
            writing.write(AnySample { message, header });
        });
        Ok(())
    }

    /// As [`publish`](Blackboard::publish), for a topic known at run time.
    ///
    /// # Errors
    /// As there; and the message is not of the topic's type.
    pub fn publish_by_name(&mut self, path: &str, message: Box<dyn AnyMessage>) -> Result<(), Error> {
        let slot = self.hub.catalogue().declared(path)?;
        self.room()?;
        self.hub.declaration(slot).map_or(Ok(()), |topic| check_type(topic, &*message))?;
        self.queue(slot, |writing, header| writing.write(AnySample { message: Arc::from(message), header }));
        Ok(())
    }

    /// As [`publish_by_name`](Blackboard::publish_by_name), for a message that `bytes` encode; they are decoded once, here.
    ///
    /// # Errors
    /// As there; and the bytes encode no message of the topic's type, or are more than
    /// [`ENCODED_LIMIT`](crate::ENCODED_LIMIT).
    pub fn publish_bytes(&mut self, path: &str, bytes: &[u8]) -> Result<(), Error> {
        let slot = self.hub.catalogue().declared(path)?;
        self.room()?;
        let Some(writing) = self.writing(slot) else { return Ok(()) };
        let message = writing.decoded(bytes)?;
        self.queue(slot, |writing, header| writing.write(AnySample { message, header }));
        Ok(())
    }

    /// Changes a topic's message: the newest is copied (or one with nothing set) and handed to `change`; more changes of the topic
    /// before [`publish_all`](Blackboard::publish_all) go into the same copy, which is published once.
    ///
    /// # Errors
    /// There is no such topic, or more than [`OUTBOX_LIMIT`] messages wait.
    pub fn edit(&mut self, slot: TopicSlot, change: impl FnOnce(&mut dyn AnyMessage)) -> Result<(), Error> {
        if self.hub.declaration(slot).is_none() {
            let text = format!("there is no topic of number {}", slot.number());
            return Err(Error::new(ErrorKind::UndeclaredTopic, text));
        }
        if !self.writing(slot).is_some_and(|writing| writing.has_draft()) {
            self.room()?;
            let local = self.from(HostId::LOCAL);
            let reading = self.attach(Channel::local(slot));
            let source = reading.and_then(|reading| local.newest(slot, reading)).cloned();
            self.queue(slot, |writing, header| writing.begin_draft(source.as_ref(), header));
        }
        if let Some(writing) = self.writing(slot) {
            writing.change_draft(change);
        }
        Ok(())
    }

    /// Whether one more message may wait.
    fn room(&self) -> Result<(), Error> {
        if self.outbox.len() < OUTBOX_LIMIT {
            return Ok(());
        }
        let text = format!("`{}` has {OUTBOX_LIMIT} messages that wait for `publish_all`", self.sender.name);
        Err(Error::new(ErrorKind::OutboxFull, text))
    }

    pub(super) fn writing(&mut self, slot: TopicSlot) -> Option<&mut Writing> {
        let topic = self.hub.declaration(slot)?;
        let writing = &mut self.places.get_mut(slot.index())?.writing;
        if writing.is_none() {
            self.written.push(slot);
        }
        Some(writing.get_or_insert_with(|| Box::new(Writing::new(topic))))
    }

    /// Writes a message that will be published in its turn.
    fn queue(&mut self, slot: TopicSlot, write: impl FnOnce(&mut Writing, Header)) {
        let header = Header::local(&self.sender, slot, self.now);
        let Some(writing) = self.writing(slot) else { return };
        let was_open = writing.is_open();
        write(writing, header);
        self.outbox.push(slot);
        if !was_open {
            self.open.get_mut().push(Channel::local(slot));
        }
    }
}
