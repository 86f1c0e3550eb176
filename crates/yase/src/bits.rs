//! Sets of small numbers, one bit each.

/// A set of numbers below a capacity that is fixed when it is made. Numbers beyond it are never members.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct BitSet {
    words: Box<[u64]>,
}

const BITS: usize = u64::BITS as usize;

impl BitSet {
    /// The empty set of numbers below `capacity`.
    pub(crate) fn new(capacity: usize) -> BitSet {
        BitSet { words: vec![0; capacity.div_ceil(BITS)].into_boxed_slice() }
    }

    #[inline]
    pub(crate) fn insert(&mut self, number: usize) {
        if let Some(word) = self.words.get_mut(number / BITS) {
            *word |= 1 << (number % BITS);
        }
    }

    #[inline]
    pub(crate) fn remove(&mut self, number: usize) {
        if let Some(word) = self.words.get_mut(number / BITS) {
            *word &= !(1 << (number % BITS));
        }
    }

    #[inline]
    pub(crate) fn contains(&self, number: usize) -> bool {
        self.words.get(number / BITS).is_some_and(|word| word >> (number % BITS) & 1 == 1)
    }

    pub(crate) fn clear(&mut self) {
        self.words.fill(0);
    }

    /// Whether there is no member.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// Whether the sets have a member in common.
    #[inline]
    pub(crate) fn meets(&self, other: &BitSet) -> bool {
        self.words.iter().zip(&other.words).any(|(one, other)| one & other != 0)
    }

    /// The members below 64, as the bits of a word.
    #[inline]
    pub(crate) fn first_word(&self) -> u64 {
        self.words.first().copied().unwrap_or(0)
    }

    /// Replaces the members below 64.
    #[inline]
    pub(crate) fn set_first_word(&mut self, bits: u64) {
        if let Some(word) = self.words.first_mut() {
            *word = bits;
        }
    }

    /// The least member from `from` to `last`, both included.
    pub(crate) fn next(&self, from: usize, last: usize) -> Option<usize> {
        first_bit(from, last, |index| self.words.get(index).copied().unwrap_or(0))
    }

    /// The greatest member from `first` to `last`, both included.
    pub(crate) fn last(&self, first: usize, last: usize) -> Option<usize> {
        if first > last {
            return None;
        }
        let mut index = last / BITS;
        let mut bits = self.words.get(index).copied().unwrap_or(0) & (u64::MAX >> (BITS - 1 - last % BITS));
        while bits == 0 {
            if index <= first / BITS {
                return None;
            }
            index -= 1;
            bits = self.words.get(index).copied().unwrap_or(0);
        }
        let number = index * BITS + BITS - 1 - bits.leading_zeros() as usize;
        (number >= first).then_some(number)
    }

    /// Becomes equal to a set of the same capacity.
    pub(crate) fn copy_from(&mut self, other: &BitSet) {
        self.words.copy_from_slice(&other.words);
    }

    /// The least member from `from` to `last` that is not in `without`.
    pub(crate) fn next_without(&self, without: &BitSet, from: usize, last: usize) -> Option<usize> {
        let word = |set: &BitSet, index: usize| set.words.get(index).copied().unwrap_or(0);
        first_bit(from, last, |index| word(self, index) & !word(without, index))
    }

    /// The least number from `from` to `last` that is in both sets.
    pub(crate) fn next_common(&self, other: &BitSet, from: usize, last: usize) -> Option<usize> {
        let word = |set: &BitSet, index: usize| set.words.get(index).copied().unwrap_or(0);
        first_bit(from, last, |index| word(self, index) & word(other, index))
    }

    /// The least number from `from` to `last` that is in this set and `other`, but not in `without`.
    pub(crate) fn next_common_without(
        &self,
        other: &BitSet,
        without: &BitSet,
        from: usize,
        last: usize,
    ) -> Option<usize> {
        let word = |set: &BitSet, index: usize| set.words.get(index).copied().unwrap_or(0);
        first_bit(from, last, |index| word(self, index) & word(other, index) & !word(without, index))
    }

    /// Whether some member lies from `first` to `last`, both included.
    pub(crate) fn any_in(&self, first: usize, last: usize) -> bool {
        self.next(first, last).is_some()
    }
}

/// The number of the first bit from `from` to `last` that is set in the words that `word` yields.
#[inline]
fn first_bit(from: usize, last: usize, word: impl Fn(usize) -> u64) -> Option<usize> {
    if from > last {
        return None;
    }
    let mut index = from / BITS;
    let mut bits = word(index) & (u64::MAX << (from % BITS));
    while bits == 0 {
        index += 1;
        if index > last / BITS {
            return None;
        }
        bits = word(index);
    }
    let number = index * BITS + bits.trailing_zeros() as usize;
    (number <= last).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn members(set: &BitSet) -> Vec<usize> {
        (0..1000).filter(|&number| set.contains(number)).collect()
    }

    #[test]
    fn next_crosses_words_and_respects_both_ends() {
        let mut set = BitSet::new(200);
        for number in [0, 63, 64, 130, 199] {
            set.insert(number);
        }
        assert_eq!(members(&set), [0, 63, 64, 130, 199]);
        assert_eq!(set.next(65, 129), None);
        assert_eq!(set.next(65, 130), Some(130));
        assert_eq!(set.next(5, 4), None);
        assert!(set.any_in(199, 199) && !set.any_in(131, 198));
        assert_eq!(set.last(0, 198), Some(130));
        assert_eq!(set.last(64, 129), Some(64));
        assert_eq!(set.last(65, 129), None);
        assert_eq!((set.last(0, 199), set.last(0, 0), set.last(1, 62)), (Some(199), Some(0), None));
    }

    #[test]
    fn numbers_beyond_the_capacity_are_no_members() {
        let mut set = BitSet::new(3);
        set.insert(1000);
        set.remove(1000);
        assert!(!set.contains(1000) && set.next(0, 5000).is_none());
    }

    #[test]
    fn common_members_can_leave_some_out() {
        let (mut a, mut b, mut c) = (BitSet::new(70), BitSet::new(70), BitSet::new(70));
        for number in [2, 65, 69] {
            a.insert(number);
            b.insert(number);
        }
        b.insert(1);
        c.insert(2);
        assert_eq!(a.next_common(&b, 0, 69), Some(2));
        assert_eq!(a.next_common_without(&b, &c, 0, 69), Some(65));
        a.remove(65);
        assert_eq!(a.next_common_without(&b, &c, 0, 69), Some(69));
    }
}
