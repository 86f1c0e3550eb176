//! A queue optimized for being empty: adding and removing an item is cheap.

use std::ops::Deref;

/// A queue. Removed items stay in front until space is needed or no items remain: it is empty if it
/// holds no items.
#[derive(Clone, Debug)]
pub(crate) struct Fifo<T> {
    items: Vec<T>,
    /// The number of removed items.
    taken: usize,
}

impl<T> Default for Fifo<T> {
    fn default() -> Fifo<T> {
        Fifo { items: Vec::new(), taken: 0 }
    }
}

impl<T> From<Vec<T>> for Fifo<T> {
    fn from(items: Vec<T>) -> Fifo<T> {
        Fifo { items, taken: 0 }
    }
}

/// The queued items, oldest first.
impl<T> Deref for Fifo<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        self.items.get(self.taken..).unwrap_or_default()
    }
}

impl<T: Copy> Fifo<T> {
    #[inline]
    pub(crate) fn push(&mut self, item: T) {
        if self.items.len() == self.items.capacity() {
            self.make_room();
        }
        self.items.push(item);
    }

    /// Moves the queued items to the front, unless they outnumber the removed ones: then the queue
    /// grows.
    #[cold]
    fn make_room(&mut self) {
        if self.taken > self.items.len() / 2 {
            self.compact();
        }
    }

    fn compact(&mut self) {
        self.items.drain(..self.taken);
        self.taken = 0;
    }

    #[inline]
    pub(crate) fn front(&self) -> Option<&T> {
        self.items.get(self.taken)
    }

    /// Removes the first item without returning it.
    #[inline]
    fn drop_front(&mut self) {
        self.taken += 1;
        if self.taken >= self.items.len() {
            self.clear();
        }
    }

    pub(crate) fn pop(&mut self) -> Option<T> {
        let first = self.front().copied()?;
        self.drop_front();
        Some(first)
    }

    #[inline]
    pub(crate) fn clear(&mut self) {
        self.items.clear();
        self.taken = 0;
    }

    pub(crate) fn insert(&mut self, index: usize, item: T) {
        self.items.insert(self.taken + index, item);
    }

    pub(crate) fn remove(&mut self, index: usize) -> T {
        let item = self.items.remove(self.taken + index);
        if self.taken >= self.items.len() {
            self.clear();
        }
        item
    }

    pub(crate) fn retain(&mut self, keep: impl Fn(&T) -> bool) {
        self.compact();
        self.items.retain(keep);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn it_is_what_a_queue_of_the_standard_library_is(acts in proptest::collection::vec((0..8u8, 0..8usize), 0..200)) {
            let (mut ours, mut theirs) = (Fifo::default(), VecDeque::new());
            for (number, (act, index)) in acts.into_iter().enumerate() {
                match act {
                    0..4 => {
                        ours.push(number);
                        theirs.push_back(number);
                    }
                    4 => prop_assert_eq!(ours.pop(), theirs.pop_front()),
                    5 => {
                        let index = index.min(theirs.len());
                        ours.insert(index, number);
                        theirs.insert(index, number);
                    }
                    6 if index < theirs.len() => prop_assert_eq!(Some(ours.remove(index)), theirs.remove(index)),
                    7 if index == 0 => {
                        ours.retain(|item| item % 3 != 0);
                        theirs.retain(|item| item % 3 != 0);
                    }
                    _ if ours.front().is_some() => {
                        ours.drop_front();
                        theirs.pop_front();
                    }
                    _ => {}
                }
                prop_assert!(ours.iter().eq(theirs.iter()));
                prop_assert_eq!(ours.front(), theirs.front());
            }
        }
    }

    #[test]
    fn it_does_not_grow_while_little_waits() {
        let mut queue = Fifo::default();
        queue.push(0);
        for number in 1..10_000 {
            queue.push(number);
            assert_eq!(queue.pop(), Some(number - 1));
        }
        assert!(queue.items.capacity() <= 16);
    }
}
