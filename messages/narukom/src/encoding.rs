//! The protobuf encoding of a publication, created on first use and shared by all readers.

use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::error::{Error, ErrorKind};
use crate::message::AnyMessage;
use crate::sample::{AnySample, Header};
use crate::topic::TopicDeclaration;
use crate::topic_table;

/// Longest encoding that is accepted as a message: 64 MiB.
pub const ENCODED_LIMIT: usize = 64 << 20;

/// A reusable slot for the encoding of one message at a time.
#[derive(Default)]
pub(crate) struct EncodingSlot {
    bytes: OnceLock<Vec<u8>>,
    /// Memory of an earlier encoding.
    spare: Mutex<Vec<u8>>,
}

impl EncodingSlot {
    /// The encoding of `message`, which must be the same until the next
    /// [`clear`](EncodingSlot::clear).
    pub(crate) fn bytes(&self, message: &dyn AnyMessage) -> &[u8] {
        self.bytes.get_or_init(|| {
            let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
            let mut bytes = std::mem::take(&mut *spare);
            bytes.clear();
            message.encode_to(&mut bytes);
            bytes
        })
    }

    /// Drops the encoding and keeps the memory.
    pub(crate) fn clear(&mut self) {
        if let Some(bytes) = self.bytes.take() {
            *self.spare.get_mut().unwrap_or_else(PoisonError::into_inner) = bytes;
        }
    }
}

impl fmt::Debug for EncodingSlot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "EncodingSlot({:?} bytes)", self.bytes.get().map(Vec::len))
    }
}

/// An encoded message with its header, as returned by an
/// [`EncodedSubscriber`](crate::EncodedSubscriber).
#[derive(Clone, Debug)]
pub struct EncodedMessage {
    /// Its origin.
    pub header: Header,
    message: Arc<dyn AnyMessage>,
    encoding: Arc<EncodingSlot>,
}

impl EncodedMessage {
    pub(crate) fn new(sample: AnySample, encoding: Arc<EncodingSlot>) -> EncodedMessage {
        EncodedMessage { header: sample.header, message: sample.message, encoding }
    }

    /// The protobuf encoding. It is computed once, on the first call, however many subscribers
    /// there are.
    pub fn bytes(&self) -> &[u8] {
        self.encoding.bytes(&*self.message)
    }

    /// The message itself.
    pub fn message(&self) -> &dyn AnyMessage {
        &*self.message
    }

    /// The encoding alone, without a reference to the message, whose memory can then be reused.
    pub fn into_shared(self) -> SharedEncoding {
        self.encoding.bytes(&*self.message);
        SharedEncoding(self.encoding)
    }
}

/// The protobuf encoding of a message, shared with its other readers. Its memory is reused after
/// the last reader drops it.
#[derive(Clone, Debug)]
pub struct SharedEncoding(Arc<EncodingSlot>);

impl AsRef<[u8]> for SharedEncoding {
    fn as_ref(&self) -> &[u8] {
        self.0.bytes.get().map_or(&[], Vec::as_slice)
    }
}

/// Decodes `bytes` into `message`.
///
/// A length claimed by a hostile sender reserves no memory: only bytes that are present are copied.
pub(crate) fn decode(
    topic: &TopicDeclaration,
    message: &mut dyn AnyMessage,
    bytes: &[u8],
) -> Result<(), Error> {
    let given = bytes.len();
    if given > ENCODED_LIMIT {
        let text =
            format!("{given} bytes for the topic `{}` are more than the {ENCODED_LIMIT} taken", topic.path());
        return Err(Error::new(ErrorKind::Malformed, text));
    }
    message.decode_from(bytes).map_err(|cause| {
        let text = format!(
            "{given} bytes for the topic `{}` are no `{}`: {cause}",
            topic.path(),
            topic.descriptor().full_name
        );
        Error::new(ErrorKind::Malformed, text)
    })
}

/// Rejects a message that does not have the topic's type.
pub(crate) fn check_type(topic: &TopicDeclaration, message: &dyn AnyMessage) -> Result<(), Error> {
    if topic.message_type() == message.as_any().type_id() {
        return Ok(());
    }
    Err(topic_table::wrong_type(topic, message.descriptor().full_name))
}
