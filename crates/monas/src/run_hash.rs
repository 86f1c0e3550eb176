//! The hash of a run: two runs are the same run when it is equal.

use std::sync::{Arc, Mutex, PoisonError};

use narukom::{Observer, Publication};

use crate::records::LOG;

/// Hashes every message published on every host, in order of publication, with BLAKE3.
///
/// Of each message: the moment of publication (nanoseconds, u64), host, publisher and path of the topic (each with its length in
/// front, u32), the sequence number (u64), and the protobuf encoding. Numbers are little endian. Lines of the log are left out: a run is the same whatever is logged of it.
/// Clones share one hash.
///
/// ```
/// use monas::{RunHash, Talws};
///
/// let hash = RunHash::new();
/// let mut talws = Talws::new();
/// talws.observe(Box::new(hash.clone()));
/// let (digits, messages) = hash.finish();
/// assert_eq!((digits.len(), messages), (64, 0));
/// ```
#[derive(Clone, Debug, Default)]
pub struct RunHash {
    shared: Arc<Mutex<State>>,
}

#[derive(Debug, Default)]
struct State {
    hasher: blake3::Hasher,
    messages: u64,
    /// One message as it is hashed; reused.
    record: Vec<u8>,
}

impl RunHash {
    /// The hash of nothing yet.
    pub fn new() -> RunHash {
        RunHash::default()
    }

    /// 64 hexadecimal digits, and how many messages they stand for. More may follow.
    pub fn finish(&self) -> (String, u64) {
        let state = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        (state.hasher.finalize().to_hex().to_string(), state.messages)
    }
}

impl Observer for RunHash {
    fn observe(&mut self, publication: Publication<'_>) {
        if publication.topic.path() == LOG.path() {
            return;
        }
        let mut state = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        state.add(publication);
    }
}

impl State {
    fn add(&mut self, Publication { host, publisher, topic, sample, .. }: Publication<'_>) {
        self.record.clear();
        self.record.extend_from_slice(&sample.header.published.as_nanos().to_le_bytes());
        for text in [host, publisher, topic.path()] {
            self.record.extend_from_slice(&(text.len() as u32).to_le_bytes());
            self.record.extend_from_slice(text.as_bytes());
        }
        self.record.extend_from_slice(&sample.header.sequence.to_le_bytes());
        sample.message.encode_to(&mut self.record);
        self.hasher.update(&self.record);
        self.messages += 1;
    }
}
