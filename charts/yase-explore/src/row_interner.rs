//! Interner of rows of words.

/// Distinct rows of words, numbered from 0 in the order of their insertion.
///
/// A hash table with open addressing over one store of words. Rows are never iterated in table
/// order, so results do not depend on the hash function.
#[derive(Debug, Default)]
pub struct RowInterner {
    words: Vec<u32>,
    /// The end of each row.
    ends: Vec<usize>,
    /// The index of a row plus one, or 0 for an empty slot; the length is a power of two.
    slots: Vec<u32>,
}

impl RowInterner {
    /// The index of a row, if it is known.
    pub fn find(&self, row: &[u32]) -> Option<usize> {
        if self.slots.is_empty() {
            return None;
        }
        self.slots[self.slot(row)].checked_sub(1).map(|number| number as usize)
    }

    /// The index of a row, inserted if it is new.
    pub fn number(&mut self, row: &[u32]) -> usize {
        if self.slots.len() <= 2 * self.ends.len() {
            self.grow();
        }
        let slot = self.slot(row);
        match self.slots[slot].checked_sub(1) {
            Some(number) => number as usize,
            None => {
                self.words.extend_from_slice(row);
                self.ends.push(self.words.len());
                self.slots[slot] = self.ends.len() as u32;
                self.ends.len() - 1
            }
        }
    }

    /// The memory that the rows and their table take, in bytes.
    pub fn bytes(&self) -> usize {
        4 * (self.words.capacity() + self.slots.capacity()) + size_of::<usize>() * self.ends.capacity()
    }

    fn row(&self, number: usize) -> &[u32] {
        let begin = number.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.words[begin..self.ends[number]]
    }

    /// The slot of a row.
    fn slot(&self, row: &[u32]) -> usize {
        let last = self.slots.len() - 1;
        let mut slot = mixed(row) as usize & last;
        while let Some(number) = self.slots[slot].checked_sub(1) {
            if self.row(number as usize) == row {
                break;
            }
            slot = (slot + 1) & last;
        }
        slot
    }

    fn grow(&mut self) {
        self.slots = vec![0; (4 * self.ends.len()).next_power_of_two().max(16)];
        for number in 0..self.ends.len() {
            let slot = self.slot(self.row(number));
            self.slots[slot] = number as u32 + 1;
        }
    }
}

fn mixed(row: &[u32]) -> u64 {
    let sum = row.iter().fold(row.len() as u64, |sum, &word| {
        (sum.rotate_left(5) ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    });
    sum ^ sum >> 32
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn rows_have_the_numbers_of_their_first_coming(rows in prop::collection::vec(prop::collection::vec(0..3_u32, 0..4), 0..200)) {
            let (mut numbers, mut expected) = (RowInterner::default(), BTreeMap::new());
            for row in rows {
                prop_assert_eq!(numbers.find(&row), expected.get(&row).copied());
                let next = expected.len();
                let number = *expected.entry(row.clone()).or_insert(next);
                prop_assert_eq!(numbers.number(&row), number);
            }
        }
    }
}
