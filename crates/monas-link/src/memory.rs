//! Memory for large payloads, used again.
//!
//! The system gives memory for a picture page by page, and takes it back when the picture goes: that takes longer than copying it.

use bytes::{Bytes, BytesMut};

/// What is shorter is not worth looking for.
const SHORTEST: usize = 64 << 10;

/// What is longer is not kept,
const LONGEST: usize = 4 << 20;

/// and not more than so many.
const KEPT: usize = 4;

/// Copies payloads into memory of earlier ones that nobody else holds any more.
#[derive(Default, Debug)]
pub(crate) struct Memory {
    /// What was handed out; whoever has it shares it.
    lent: Vec<Bytes>,
    /// Whose turn it is to go when there are too many.
    turn: usize,
}

impl Memory {
    /// A copy.
    pub(crate) fn copy(&mut self, payload: &[u8]) -> Bytes {
        if !(SHORTEST..=LONGEST).contains(&payload.len()) {
            return Bytes::copy_from_slice(payload);
        }
        let mut memory = self.free().unwrap_or_default();
        memory.clear();
        memory.extend_from_slice(payload);
        let copy = memory.freeze();
        self.keep(copy.clone());
        copy
    }

    fn free(&mut self) -> Option<BytesMut> {
        let place = self.lent.iter().position(Bytes::is_unique)?;
        self.lent.swap_remove(place).try_into_mut().ok()
    }

    fn keep(&mut self, copy: Bytes) {
        if self.lent.len() < KEPT {
            self.lent.push(copy);
        } else {
            self.turn = (self.turn + 1) % KEPT;
            self.lent[self.turn] = copy;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_used_again_when_nobody_holds_it() {
        let mut memory = Memory::default();
        let first = memory.copy(&vec![1; 1 << 20]);
        let (place, kept) = (first.as_ptr(), first.clone());
        drop(first);
        let second = memory.copy(&vec![2; 1 << 20]);
        assert!(kept.iter().all(|byte| *byte == 1), "what somebody holds does not change");
        assert_ne!(second.as_ptr(), place);
        drop(kept);
        let third = memory.copy(&vec![3; (1 << 20) - 7]);
        assert_eq!((third.as_ptr(), third.len()), (place, (1 << 20) - 7));
        assert!(third.iter().all(|byte| *byte == 3) && second.iter().all(|byte| *byte == 2));
    }

    #[test]
    fn no_more_is_kept_than_fits() {
        let mut memory = Memory::default();
        let held: Vec<Bytes> = (0..10).map(|byte| memory.copy(&vec![byte; SHORTEST])).collect();
        assert_eq!((memory.lent.len(), held.iter().filter(|one| one.is_unique()).count()), (KEPT, 10 - KEPT));
        drop(memory.copy(&vec![0; LONGEST + 1]));
        drop(memory.copy(&[0; 10]));
        assert!(memory.lent.iter().all(|one| one.len() == SHORTEST));
    }
}
