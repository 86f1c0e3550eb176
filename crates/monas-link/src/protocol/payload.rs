//! The bytes of a message on their way.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use bytes::Bytes;
use narukom::Encoded;

/// What is shorter is copied: it is less than what it takes to keep the memory of somebody else.
const SHORTEST: usize = 64 << 10;

/// The bytes of a message, shared by all who hold them.
///
/// Those that a transport has lent may lie in memory of another process, which can have them back when this one stands still for long: see
/// [`is_whole`](MessageBytes::is_whole).
#[derive(Clone, Default)]
pub struct MessageBytes {
    bytes: Bytes,
    loan: Option<Arc<Loan>>,
}

/// Whether what was lent is still there.
type Loan = dyn Fn() -> bool + Send + Sync;

impl MessageBytes {
    /// Bytes of which `is_there` says whether they are still what they were.
    pub fn lent(
        bytes: impl AsRef<[u8]> + Send + 'static,
        is_there: impl Fn() -> bool + Send + Sync + 'static,
    ) -> MessageBytes {
        MessageBytes { bytes: Bytes::from_owner(bytes), loan: Some(Arc::new(is_there)) }
    }

    /// The encoding of a message that was published. A large one stays where it is.
    pub(crate) fn of(encoded: Encoded) -> MessageBytes {
        let bytes = match encoded.bytes() {
            short if short.len() < SHORTEST => Bytes::copy_from_slice(short),
            _ => Bytes::from_owner(encoded.into_shared()),
        };
        bytes.into()
    }

    /// Whether they are what was sent. To be asked when they are about to be read.
    pub fn is_whole(&self) -> bool {
        self.loan.as_ref().is_none_or(|is_there| is_there())
    }

    /// The bytes, for a transport that takes such.
    pub fn bytes(&self) -> &Bytes {
        &self.bytes
    }
}

impl From<Bytes> for MessageBytes {
    fn from(bytes: Bytes) -> MessageBytes {
        MessageBytes { bytes, loan: None }
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
