//! Positions in a text as a page counts them: in UTF-16 code units.

use yase::Span;

/// The characters of a text that are not one byte and one code unit.
pub(crate) struct TextPositions {
    /// The bytes and the code units after each of them.
    ends: Vec<(usize, usize)>,
    bytes: usize,
}

impl TextPositions {
    pub(crate) fn of(text: &str) -> TextPositions {
        let (mut ends, mut units) = (Vec::new(), 0);
        for (at, letter) in text.char_indices() {
            units += letter.len_utf16();
            if !letter.is_ascii() {
                ends.push((at + letter.len_utf8(), units));
            }
        }
        TextPositions { ends, bytes: text.len() }
    }

    /// The code units before a byte.
    pub(crate) fn units(&self, byte: usize) -> usize {
        let byte = byte.min(self.bytes);
        let known = self.ends.partition_point(|(end, _)| *end <= byte);
        let (end, units) = known.checked_sub(1).map_or((0, 0), |index| self.ends[index]);
        units + (byte - end)
    }

    /// The bytes before a code unit.
    pub(crate) fn byte(&self, unit: usize) -> usize {
        let known = self.ends.partition_point(|(_, units)| *units <= unit);
        let (end, units) = known.checked_sub(1).map_or((0, 0), |index| self.ends[index]);
        (end + (unit - units)).min(self.bytes)
    }

    /// Start and end of a span.
    pub(crate) fn range(&self, span: Span) -> (usize, usize) {
        (self.units(span.start), self.units(span.end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_and_code_units_are_converted() {
        let text = "aω😀b";
        let positions = TextPositions::of(text);
        let pairs = [(0, 0), (1, 1), (3, 2), (7, 4), (8, 5)];
        for (byte, unit) in pairs {
            assert_eq!((positions.units(byte), positions.byte(unit)), (unit, byte));
        }
        assert_eq!((positions.units(99), positions.byte(99)), (5, 8));
    }
}
