//! The bytes of a message in transit.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use bytes::Bytes;
use narukom::EncodedMessage;

/// Shorter messages are copied, which costs less than keeping foreign memory alive.
const MIN_SHARED_SIZE: usize = 64 << 10;

/// The bytes of a message, shared by all holders.
///
/// Bytes lent by a transport may be in memory of another process, which can reclaim it if this
/// process stalls for long: see [`is_whole`](MessageBytes::is_whole).
#[derive(Clone, Default)]
pub struct MessageBytes {
    bytes: Bytes,
    shared_memory: Option<Arc<SharedMemoryGuard>>,
}

/// Returns whether lent memory is still valid.
type SharedMemoryGuard = dyn Fn() -> bool + Send + Sync;

impl MessageBytes {
    /// Bytes in shared memory; `is_there` returns whether they are still valid.
    pub fn from_shared_memory(
        bytes: impl AsRef<[u8]> + Send + 'static,
        is_there: impl Fn() -> bool + Send + Sync + 'static,
    ) -> MessageBytes {
        MessageBytes { bytes: Bytes::from_owner(bytes), shared_memory: Some(Arc::new(is_there)) }
    }

    /// The encoding of a published message. A large one is not copied.
    pub(crate) fn of(encoded: EncodedMessage) -> MessageBytes {
        let bytes = match encoded.bytes() {
            short if short.len() < MIN_SHARED_SIZE => Bytes::copy_from_slice(short),
            _ => Bytes::from_owner(encoded.into_shared()),
        };
        bytes.into()
    }

    /// Whether the bytes are still those that were sent. To be checked just before they are read.
    pub fn is_whole(&self) -> bool {
        self.shared_memory.as_ref().is_none_or(|is_there| is_there())
    }

    /// The bytes, for transports that accept this type.
    pub fn bytes(&self) -> &Bytes {
        &self.bytes
    }
}

impl From<Bytes> for MessageBytes {
    fn from(bytes: Bytes) -> MessageBytes {
        MessageBytes { bytes, shared_memory: None }
    }
}

impl From<Vec<u8>> for MessageBytes {
    fn from(bytes: Vec<u8>) -> MessageBytes {
        Bytes::from(bytes).into()
    }
}

impl Deref for MessageBytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes
    }
}

impl PartialEq for MessageBytes {
    fn eq(&self, other: &MessageBytes) -> bool {
        self.bytes == other.bytes
    }
}

impl Eq for MessageBytes {}

impl fmt::Debug for MessageBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.bytes.fmt(f)
    }
}
