//! Writing on a blackboard.

use std::sync::Arc;

use super::{Blackboard, OUTBOX_LIMIT};
use crate::catalogue;
use crate::error::{Error, ErrorKind};
use crate::message::AnyMessage;
use crate::sample::{AnySample, Header, HostId, TopicSlot};
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

    /// As [`publish`](Blackboard::publish), for a topic known at run time.
    ///
    /// # Errors
    /// As there; and the message is not of the topic's type.
    pub fn publish_by_name(&mut self, path: &str, message: Box<dyn AnyMessage>) -> Result<(), Error> {
        let slot = self.hub.topic(path).ok_or_else(|| self.hub.catalogue().undeclared(path))?;
        self.room()?;
        if let Some(topic) = self.hub.declaration(slot)
            && topic.message_type() != message.as_any().type_id()
        {
            return Err(catalogue::wrong_type(topic, message.descriptor().full_name));
        }
        self.queue(slot, |writing, header| writing.write(AnySample { message: Arc::from(message), header }));
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
            let source = self.attach(slot).and_then(|reading| self.peek(slot, reading)).cloned();
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

    fn header(&self, topic: TopicSlot) -> Header {
        let publisher = self.sender.publisher;
        Header { host: HostId::LOCAL, publisher, topic, sequence: 0, published: self.now, received: self.now }
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
        let header = self.header(slot);
        let Some(writing) = self.writing(slot) else { return };
        let was_open = writing.is_open();
        write(writing, header);
        self.outbox.push(slot);
        if !was_open {
            self.open.get_mut().push(slot);
        }
    }
}
