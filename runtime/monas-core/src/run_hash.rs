//! The hash of a run: equal hashes mean equal runs.

use std::sync::{Arc, Mutex, PoisonError};

use narukom::{Observer, Publication};

use crate::records::LOG;

/// Hashes every message published on every host, in order of publication, with BLAKE3.
///
/// For each message: the publication time (nanoseconds, u64), host, publisher and path of the topic
/// (each preceded by its length, u32), the sequence number (u64), and the protobuf encoding.
/// Numbers are little endian. Log lines are excluded, so that the hash does not depend on log
/// settings. Clones share one hash.
///
/// ```
/// use monas_core::RunHash;
/// use narukom::Hub;
///
/// let hash = RunHash::new();
/// let hub = Hub::with_linked_topics("local")?;
/// hub.observe(Box::new(hash.clone()));
/// let (digits, messages) = hash.finish();
/// assert_eq!((digits.len(), messages), (64, 0));
/// # Ok::<(), narukom::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct RunHash {
    shared: Arc<Mutex<HashState>>,
}

#[derive(Debug, Default)]
struct HashState {
    hasher: blake3::Hasher,
    messages: u64,
    /// The hashed form of the messages that the hasher does not have yet.
    pending: Vec<u8>,
}

/// The number of bytes hashed at once. BLAKE3 hashes its chunks of 1 KiB side by side if it is
/// given many of them.
const BLOCK_SIZE: usize = 16 * 1024;

impl RunHash {
    /// The hash of no messages.
    pub fn new() -> RunHash {
        RunHash::default()
    }

    /// 64 hexadecimal digits, and the number of hashed messages. More messages may follow.
    pub fn finish(&self) -> (String, u64) {
        let state = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        let hash = state.hasher.clone().update(&state.pending).finalize();
        (hash.to_hex().to_string(), state.messages)
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

impl HashState {
    fn add(&mut self, Publication { host, publisher, topic, sample, .. }: Publication<'_>) {
        let pending = &mut self.pending;
        pending.extend_from_slice(&sample.header.published.as_nanos().to_le_bytes());
        for text in [host, publisher, topic.path()] {
            pending.extend_from_slice(&(text.len() as u32).to_le_bytes());
            pending.extend_from_slice(text.as_bytes());
        }
        pending.extend_from_slice(&sample.header.sequence.to_le_bytes());
        sample.message.encode_to(pending);
        if pending.len() >= BLOCK_SIZE {
            // Whole blocks: part of a chunk would be hashed alone, and so would the rest of it.
            let whole = pending.len() / BLOCK_SIZE * BLOCK_SIZE;
            self.hasher.update(&pending[..whole]);
            pending.drain(..whole);
        }
        self.messages += 1;
    }
}
