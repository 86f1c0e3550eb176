//! A queue that is nearly always empty: it costs a step little to put something in and take it out again.

use std::ops::Deref;

/// A queue. What was taken out stays in front until room is wanted or there is nothing behind it: so it is empty if it holds no items.
#[derive(Clone, Debug)]
pub(super) struct Fifo<T> {
    items: Vec<T>,
    /// So many have been taken out.
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

/// What waits, the first first.
impl<T> Deref for Fifo<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        self.items.get(self.taken..).unwrap_or_default()
    }
}

impl<T: Copy> Fifo<T> {
    #[inline]
    pub(super) fn push(&mut self, item: T) {
        if self.items.len() == self.items.capacity() {
            self.make_room();
        }
        self.items.push(item);
    }

    /// Moves what waits to the front, unless that is more than what was taken out: then the queue grows.
    #[cold]
    fn make_room(&mut self) {
        if self.taken > self.items.len() / 2 {
            self.close_up();
        }
    }

    fn close_up(&mut self) {
        self.items.drain(..self.taken);
        self.taken = 0;
    }

    #[inline(always)]
    pub(super) fn has_none(&self) -> bool {
        self.items.is_empty()
    }

    #[inline]
    pub(super) fn front(&self) -> Option<&T> {
        self.items.get(self.taken)
    }

    /// Forgets the first, without looking at it.
    #[inline]
    pub(super) fn drop_front(&mut self) {
        self.taken += 1;
        if self.taken >= self.items.len() {
            self.clear();
        }
    }

    pub(super) fn pop(&mut self) -> Option<T> {
        let first = self.front().copied()?;
        self.drop_front();
        Some(first)
    }

    #[inline]
    pub(super) fn clear(&mut self) {
        self.items.clear();
        self.taken = 0;
    }

    pub(super) fn insert(&mut self, index: usize, item: T) {
        self.items.insert(self.taken + index, item);
    }

    pub(super) fn remove(&mut self, index: usize) -> T {
        let item = self.items.remove(self.taken + index);
        if self.taken >= self.items.len() {
            self.clear();
        }
        item
    }

    pub(super) fn retain(&mut self, keep: impl Fn(&T) -> bool) {
        self.close_up();
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
                prop_assert_eq!(ours.has_none(), theirs.is_empty());
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
