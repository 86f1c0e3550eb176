//! Reuse of the memory of messages after their last reader has dropped them.

use std::sync::Arc;

use crate::encoding::decode;
use crate::error::Error;
use crate::message::{AnyMessage, Message};
use crate::topic::TopicDeclaration;

/// The most messages that wait for their last reader. A reader that keeps pace has dropped the
/// messages returned by the hub's ring by the time the next message is created; the others serve
/// readers that are a few cycles behind.
const MAX_SPARE_MESSAGES: usize = 4;

/// Messages that left the hub's ring when this writer published.
#[derive(Default)]
pub(crate) struct MessagePool {
    spares: Vec<Arc<dyn AnyMessage>>,
    /// Index of the next message to discard when there are too many.
    turn: usize,
}

impl MessagePool {
    /// Puts `message` behind a reference count.
    pub(crate) fn wrap<M: Message>(&mut self, message: M) -> Arc<dyn AnyMessage> {
        for spare in 0..self.spares.len() {
            if let Some(slot) = exclusive(&mut self.spares[spare]) {
                *slot = message;
                return self.spares.swap_remove(spare);
            }
        }
        Arc::new(message)
    }

    /// Builds a message in slot: `make` receives a default message, whose strings, bytes and lists
    /// may have capacity.
    pub(crate) fn build<M: Message>(&mut self, make: impl FnOnce(&mut M)) -> Arc<dyn AnyMessage> {
        for spare in 0..self.spares.len() {
            if let Some(slot) = exclusive::<M>(&mut self.spares[spare]) {
                slot.clear();
                make(slot);
                return self.spares.swap_remove(spare);
            }
        }
        let mut message = M::default();
        make(&mut message);
        Arc::new(message)
    }

    /// Decodes a message of a topic.
    pub(crate) fn decoded(
        &mut self,
        topic: &TopicDeclaration,
        bytes: &[u8],
    ) -> Result<Arc<dyn AnyMessage>, Error> {
        let mut message = self.vacant().unwrap_or_else(|| topic.default_message());
        if let Some(slot) = Arc::get_mut(&mut message)
            && let Err(error) = decode(topic, slot, bytes)
        {
            self.keep(message);
            return Err(error);
        }
        Ok(message)
    }

    /// A message without other references, equal to `source` or with default content.
    pub(crate) fn copied(
        &mut self,
        topic: &TopicDeclaration,
        source: Option<&dyn AnyMessage>,
    ) -> Arc<dyn AnyMessage> {
        let Some(source) = source else { return topic.default_message() };
        let mut message = self.vacant().unwrap_or_else(|| topic.default_message());
        if let Some(slot) = Arc::get_mut(&mut message) {
            slot.copy_from(source);
        }
        message
    }

    /// A message without other references, with arbitrary content.
    fn vacant(&mut self) -> Option<Arc<dyn AnyMessage>> {
        let index = self.spares.iter_mut().position(|spare| Arc::get_mut(spare).is_some())?;
        Some(self.spares.swap_remove(index))
    }

    /// Adds a message that left the hub's ring.
    pub(crate) fn take_back(&mut self, message: Option<Arc<dyn AnyMessage>>) {
        let Some(mut message) = message else { return };
        // The cache line of its counts is owned by the core that dropped it last. Prefetch it now
        // rather than delay the next message.
        std::hint::black_box(Arc::get_mut(&mut message).is_some());
        self.keep(message);
    }

    /// Keeps `message` until its last reader has dropped it.
    #[inline]
    fn keep(&mut self, message: Arc<dyn AnyMessage>) {
        if self.spares.len() < MAX_SPARE_MESSAGES {
            self.spares.push(message);
        } else {
            self.turn = (self.turn + 1) % MAX_SPARE_MESSAGES;
            self.spares[self.turn] = message;
        }
    }
}

fn exclusive<M: Message>(message: &mut Arc<dyn AnyMessage>) -> Option<&mut M> {
    Arc::get_mut(message)?.as_any_mut().downcast_mut()
}
