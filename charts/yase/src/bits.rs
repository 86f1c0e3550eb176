//! Sets of small numbers, one bit each.

/// A set of numbers below a capacity that is fixed at creation, rounded up to a word. Numbers
/// beyond it are never members.
///
/// The first two words are stored inline: most charts have no more than 128 nodes.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct BitSet {
    low: [u64; INLINE_WORDS],
    rest: Box<[u64]>,
}

const BITS: usize = u64::BITS as usize;

/// The number of words stored inline.
const INLINE_WORDS: usize = 2;

impl BitSet {
    /// The empty set of numbers below `capacity`.
    pub(crate) fn new(capacity: usize) -> BitSet {
        let rest = capacity.div_ceil(BITS).saturating_sub(INLINE_WORDS);
        BitSet { low: [0; INLINE_WORDS], rest: vec![0; rest].into_boxed_slice() }
    }

    #[inline]
    pub(crate) fn insert(&mut self, number: usize) {
        if let Some(word) = self.word_mut(number / BITS) {
            *word |= 1 << (number % BITS);
        }
    }

    #[inline]
    pub(crate) fn remove(&mut self, number: usize) {
        if let Some(word) = self.word_mut(number / BITS) {
            *word &= !(1 << (number % BITS));
        }
    }

    #[inline]
    pub(crate) fn contains(&self, number: usize) -> bool {
        self.word(number / BITS) >> (number % BITS) & 1 == 1
    }

    #[inline]
    pub(crate) fn clear(&mut self) {
        self.low = [0; INLINE_WORDS];
        // avoid a call for an empty slice
        if !self.rest.is_empty() {
            self.rest.fill(0);
        }
    }

    /// Whether there is no member.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.low == [0; INLINE_WORDS] && self.rest.iter().all(|&word| word == 0)
    }

    /// Whether the sets have a member in common.
    #[inline]
    pub(crate) fn meets(&self, other: &BitSet) -> bool {
        self.low.iter().zip(&other.low).fold(0, |common, (one, other)| common | one & other) != 0
            || self.rest.iter().zip(&other.rest).any(|(one, other)| one & other != 0)
    }

    /// The number of words.
    #[inline]
    pub(crate) fn word_count(&self) -> usize {
        INLINE_WORDS + self.rest.len()
    }

    /// The members from `64 * index` on, as the bits of a word.
    #[inline]
    pub(crate) fn word(&self, index: usize) -> u64 {
        match self.low.get(index) {
            Some(&word) => word,
            None => self.rest.get(index - INLINE_WORDS).copied().unwrap_or(0),
        }
    }

    #[inline]
    fn word_mut(&mut self, index: usize) -> Option<&mut u64> {
        match self.low.get_mut(index) {
            Some(word) => Some(word),
            None => self.rest.get_mut(index - INLINE_WORDS),
        }
    }

    /// Adds the members of another set from `from` to `last`, inclusive.
    #[inline]
    pub(crate) fn add_between(&mut self, other: &BitSet, from: usize, last: usize) {
        let mut index = from / BITS;
        let mut mask = u64::MAX << (from % BITS);
        while index <= last / BITS {
            if index == last / BITS {
                mask &= u64::MAX >> (BITS - 1 - last % BITS);
            }
            let added = other.word(index) & mask;
            if let Some(word) = self.word_mut(index) {
                *word |= added;
            }
            mask = u64::MAX;
            index += 1;
        }
    }

    /// The least member from `from` to `last`, inclusive.
    #[inline]
    pub(crate) fn next(&self, from: usize, last: usize) -> Option<usize> {
        first_bit(from, last, |index| self.word(index))
    }

    /// The greatest member from `first` to `last`, inclusive.
    pub(crate) fn last(&self, first: usize, last: usize) -> Option<usize> {
        if first > last {
            return None;
        }
        let mut index = last / BITS;
        let mut bits = self.word(index) & (u64::MAX >> (BITS - 1 - last % BITS));
        while bits == 0 {
            if index <= first / BITS {
                return None;
            }
            index -= 1;
            bits = self.word(index);
        }
        let number = index * BITS + BITS - 1 - bits.leading_zeros() as usize;
        (number >= first).then_some(number)
    }

    /// The members as the bits of words; sets of equal capacity have equally many.
    pub(crate) fn words(&self) -> impl Iterator<Item = u64> {
        self.low.iter().chain(&self.rest).copied()
    }

    /// The members, in ascending order.
    pub(crate) fn members(&self) -> impl Iterator<Item = usize> {
        self.words().enumerate().flat_map(|(index, word)| {
            let mut left = word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                left &= left.wrapping_sub(1);
                (bit < BITS).then_some(index * BITS + bit)
            })
        })
    }

    /// Copies a set of the same capacity.
    #[inline]
    pub(crate) fn copy_from(&mut self, other: &BitSet) {
        self.low = other.low;
        if !self.rest.is_empty() {
            self.rest.copy_from_slice(&other.rest);
        }
    }

    /// The least member from `from` to `last` that is not in `without`.
    #[inline]
    pub(crate) fn next_without(&self, without: &BitSet, from: usize, last: usize) -> Option<usize> {
        first_bit(from, last, |index| self.word(index) & !without.word(index))
    }

    /// The least number from `from` to `last` that is in both sets.
    #[inline]
    pub(crate) fn next_common(&self, other: &BitSet, from: usize, last: usize) -> Option<usize> {
        first_bit(from, last, |index| self.word(index) & other.word(index))
    }

    /// The least number from `from` to `last` that is in this set and `other`, but not in
    /// `without`.
    #[inline]
    pub(crate) fn next_common_without(
        &self,
        other: &BitSet,
        without: &BitSet,
        from: usize,
        last: usize,
    ) -> Option<usize> {
        first_bit(from, last, |index| self.word(index) & other.word(index) & !without.word(index))
    }

    /// Whether there is a member from `first` to `last`, inclusive.
    #[inline]
    pub(crate) fn any_in(&self, first: usize, last: usize) -> bool {
        self.next(first, last).is_some()
    }
}

/// The number of the first bit from `from` to `last` that is set in the words returned by `word`.
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
    use std::collections::BTreeSet;

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

    /// All sets of up to three numbers at word boundaries.
    fn sets() -> Vec<(BitSet, BTreeSet<usize>)> {
        let numbers = [0, 1, 62, 63, 64, 65, 127, 128, 190];
        let mut sets = BTreeSet::from([BTreeSet::new()]);
        for _ in 0..3 {
            let larger = |set: &BTreeSet<usize>| {
                let set = set.clone();
                numbers.map(|number| set.iter().copied().chain([number]).collect::<BTreeSet<usize>>())
            };
            sets.extend(sets.clone().iter().flat_map(larger));
        }
        let with_bits = |members: BTreeSet<usize>| {
            let mut set = BitSet::new(191);
            members.iter().for_each(|&number| set.insert(number));
            (set, members)
        };
        sets.into_iter().map(with_bits).collect()
    }

    #[test]
    fn a_set_of_bits_is_a_set() {
        for (set, expected) in sets() {
            assert_eq!(members(&set), expected.iter().copied().collect::<Vec<_>>());
            assert!(set.members().eq(expected.iter().copied()));
            assert_eq!(set.is_empty(), expected.is_empty());
            for number in 0..192 {
                let next = expected.range(number..).next().copied();
                assert_eq!(
                    (set.next(number, 191), set.next(number, number).is_some()),
                    (next, set.contains(number))
                );
                assert_eq!(set.last(0, number), expected.range(..=number).next_back().copied());
                let mut without = set.clone();
                without.remove(number);
                let rest = expected.iter().copied().filter(|&member| member != number);
                assert_eq!(members(&without), rest.collect::<Vec<_>>());
            }
            let mut copy = BitSet::new(191);
            copy.copy_from(&set);
            assert_eq!(copy, set);
            copy.clear();
            assert_eq!(copy, BitSet::new(191));
        }
    }

    #[test]
    fn members_of_a_range_can_be_added() {
        let sets = sets();
        for (one, its) in sets.iter().step_by(3) {
            for (other, others) in &sets {
                for (from, last) in [(0, 190), (1, 63), (63, 64), (65, 65), (64, 127), (70, 62)] {
                    let mut sum = one.clone();
                    sum.add_between(other, from, last);
                    let added = others.iter().filter(|&&number| from <= number && number <= last);
                    let expected: BTreeSet<usize> = its.iter().chain(added).copied().collect();
                    assert_eq!(members(&sum), expected.into_iter().collect::<Vec<_>>());
                }
            }
        }
    }

    #[test]
    fn two_sets_of_bits_are_two_sets() {
        let sets = sets();
        for (one, its) in sets.iter().step_by(3) {
            for (other, others) in &sets {
                assert_eq!(one.meets(other), !its.is_disjoint(others));
                for from in [0, 1, 63, 64, 70, 128] {
                    let common = its.intersection(others).copied().find(|&number| number >= from);
                    assert_eq!(one.next_common(other, from, 190), common);
                    let without = its.difference(others).copied().find(|&number| number >= from);
                    assert_eq!(one.next_without(other, from, 190), without);
                }
            }
        }
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
