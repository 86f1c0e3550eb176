//! The protobuf encoding of a publication: made by whoever asks for it first, and shared by all others.

use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::catalogue;
use crate::error::{Error, ErrorKind};
use crate::message::AnyMessage;
use crate::sample::{AnySample, Header};
use crate::topic::TopicDeclaration;

/// More bytes than this are not taken for a message: 64 MiB.
pub const ENCODED_LIMIT: usize = 64 << 20;

/// A place for the encoding of one message after the other.
#[derive(Default)]
pub(crate) struct Encoding {
    bytes: OnceLock<Vec<u8>>,
    /// Memory of an earlier encoding.
    spare: Mutex<Vec<u8>>,
}

impl Encoding {
    /// The encoding of `message`, which is the same until the next [`clear`](Encoding::clear).
    pub(crate) fn bytes(&self, message: &dyn AnyMessage) -> &[u8] {
        self.bytes.get_or_init(|| {
            let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
            let mut bytes = std::mem::take(&mut *spare);
            bytes.clear();
            message.encode_to(&mut bytes);
            bytes
        })
    }

    /// Forgets the message, and keeps the memory.
    pub(crate) fn clear(&mut self) {
        if let Some(bytes) = self.bytes.take() {
            *self.spare.get_mut().unwrap_or_else(PoisonError::into_inner) = bytes;
        }
    }
}

impl fmt::Debug for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Encoding({:?} bytes)", self.bytes.get().map(Vec::len))
    }
}

/// A published message as bytes, with its header. What a [`Tap`](crate::Tap) gives.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// Where it comes from.
    pub header: Header,
    message: Arc<dyn AnyMessage>,
    encoding: Arc<Encoding>,
}

impl Encoded {
    pub(crate) fn new(sample: AnySample, encoding: Arc<Encoding>) -> Encoded {
        Encoded { header: sample.header, message: sample.message, encoding }
    }

    /// The protobuf encoding. However many taps a message passes, it is encoded once, on the thread of whoever asks first.
    pub fn bytes(&self) -> &[u8] {
        self.encoding.bytes(&*self.message)
    }

    /// The message itself.
    pub fn message(&self) -> &dyn AnyMessage {
        &*self.message
    }

    /// The encoding alone: whoever keeps it keeps the message's own memory from nobody.
    pub fn into_shared(self) -> SharedEncoding {
        self.encoding.bytes(&*self.message);
        SharedEncoding(self.encoding)
    }
}

/// The protobuf encoding of a message, shared with all others who look at it. Its memory serves later messages when the last has let go.
#[derive(Clone, Debug)]
pub struct SharedEncoding(Arc<Encoding>);

impl AsRef<[u8]> for SharedEncoding {
    fn as_ref(&self) -> &[u8] {
        self.0.bytes.get().map_or(&[], Vec::as_slice)
    }
}

/// Makes `message` what `bytes` encode.
///
/// A length that a hostile sender claims reserves nothing: only bytes that are there are copied.
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

/// Refuses a message that is not of the topic's type.
pub(crate) fn check_type(topic: &TopicDeclaration, message: &dyn AnyMessage) -> Result<(), Error> {
    if topic.message_type() == message.as_any().type_id() {
        return Ok(());
    }
    Err(catalogue::wrong_type(topic, message.descriptor().full_name))
}
