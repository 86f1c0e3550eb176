//! S-expressions, read in place: `(time (now 4.17))`.
//!
//! A message is a sequence of lists. A list holds words, which are runs of bytes without blanks and
//! parentheses, and lists. Nothing is copied and nothing is allocated; a list within a list is
//! found by counting parentheses, so that deep nesting needs no stack.

use crate::error::Error;

/// The items of a list, or of a whole message, in their order.
///
/// ```
/// use monas_rcsssmj::expression::Items;
///
/// let mut message = Items::of(b"(time (now 4.17))")?;
/// let (name, mut content) = message.next_named().unwrap();
/// assert_eq!(name, b"time");
/// let (name, mut content) = content.next_named().unwrap();
/// assert_eq!((name, content.number()), (&b"now"[..], Some(4.17)));
/// # Ok::<(), monas_rcsssmj::Error>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Items<'a> {
    /// The unread text, with balanced parentheses.
    rest: &'a [u8],
}

/// A word or a list.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Item<'a> {
    /// A word.
    Word(&'a [u8]),
    /// The items of a list.
    List(Items<'a>),
}

impl<'a> Items<'a> {
    /// The items of a message.
    ///
    /// # Errors
    /// The parentheses are not balanced.
    pub fn of(message: &'a [u8]) -> Result<Items<'a>, Error> {
        let mut depth = 0usize;
        for (index, byte) in message.iter().enumerate() {
            depth = match byte {
                b'(' => depth + 1,
                b')' => depth.checked_sub(1).ok_or_else(|| {
                    Error::protocol(format!("a parenthesis is closed at byte {index} that none opened"))
                })?,
                _ => depth,
            };
        }
        match depth {
            0 => Ok(Items { rest: message }),
            open => Err(Error::protocol(format!("{open} parentheses are not closed"))),
        }
    }

    /// The next item if it is a word.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        let mut ahead = *self;
        match ahead.next() {
            Some(Item::Word(word)) => {
                *self = ahead;
                Some(word)
            }
            _ => None,
        }
    }

    /// The next item if it is a finite number.
    pub fn number(&mut self) -> Option<f64> {
        let mut ahead = *self;
        let number = std::str::from_utf8(ahead.word()?).ok()?.parse().ok();
        let finite = number.filter(|number: &f64| number.is_finite())?;
        *self = ahead;
        Some(finite)
    }

    /// The next `N` items if they are finite numbers.
    pub fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let (mut ahead, mut numbers) = (*self, [0.0; N]);
        for number in &mut numbers {
            *number = ahead.number()?;
        }
        *self = ahead;
        Some(numbers)
    }

    /// The next list that begins with a word, as this word and the items after it; what stands
    /// before it is passed over.
    pub fn next_named(&mut self) -> Option<(&'a [u8], Items<'a>)> {
        self.by_ref().find_map(|item| match item {
            Item::List(mut items) => items.word().map(|name| (name, items)),
            Item::Word(_) => None,
        })
    }

    /// The items after the name of the first list with a name.
    pub fn find_named(mut self, name: &[u8]) -> Option<Items<'a>> {
        std::iter::from_fn(|| self.next_named()).find(|(known, _)| *known == name).map(|(_, items)| items)
    }
}

impl<'a> Iterator for Items<'a> {
    type Item = Item<'a>;

    fn next(&mut self) -> Option<Item<'a>> {
        let start = self.rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &self.rest[start..];
        if rest[0] == b'(' {
            let end = end_of_list(rest)?;
            self.rest = &rest[end + 1..];
            return Some(Item::List(Items { rest: &rest[1..end] }));
        }
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'(' | b')');
        let end = rest.iter().position(is_end).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(Item::Word(word))
    }
}

/// The place of the parenthesis that closes the list at the beginning.
fn end_of_list(text: &[u8]) -> Option<usize> {
    let mut depth = 0usize;
    text.iter().position(|byte| {
        match byte {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn written(items: Items<'_>) -> String {
        let item = |item| match item {
            Item::Word(word) => String::from_utf8_lossy(word).into_owned(),
            Item::List(items) => format!("({})", written(items)),
        };
        items.map(item).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn words_and_lists_keep_their_order_and_nesting() {
        let items = Items::of(b"  (a(b  1)(c))d (  ) ").unwrap();
        assert_eq!(written(items), "(a (b 1) (c)) d ()");
    }

    #[test]
    fn open_and_surplus_parentheses_are_errors_with_their_place() {
        let error = |text: &[u8]| Items::of(text).unwrap_err().to_string();
        assert_eq!(error(b"(a))(b)"), "a parenthesis is closed at byte 3 that none opened");
        assert_eq!(error(b"((a)"), "1 parentheses are not closed");
    }

    #[test]
    fn what_is_not_a_number_is_left_where_it_is() {
        let mut items = Items::of(b"1 x 2").unwrap();
        assert_eq!(items.numbers::<2>(), None);
        assert_eq!((items.number(), items.number()), (Some(1.0), None));
        assert_eq!((items.word(), items.number()), (Some(&b"x"[..]), Some(2.0)));
        assert_eq!(Items::of(b"nan").unwrap().number(), None);
        assert_eq!(Items::of(b"inf").unwrap().number(), None);
    }

    #[test]
    fn nesting_of_any_depth_is_read() {
        let mut deep = vec![b'('; 100_000];
        deep.extend(vec![b')'; 100_000]);
        assert_eq!(Items::of(&deep).unwrap().count(), 1);
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_to_their_end(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            if let Ok(items) = Items::of(&bytes) {
                let parts = items.count();
                prop_assert!(parts <= bytes.len());
            }
        }

        #[test]
        fn parentheses_at_random_are_read_to_their_end(text in "[()a 1.-]{0,80}") {
            let balanced = text.bytes().try_fold(0i32, |depth, byte| {
                let depth = depth + i32::from(byte == b'(') - i32::from(byte == b')');
                (depth >= 0).then_some(depth)
            }) == Some(0);
            let read = Items::of(text.as_bytes());
            prop_assert_eq!(read.is_ok(), balanced);
            if let Ok(items) = read {
                let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
                prop_assert_eq!(letters(&written(items)), letters(&text));
            }
        }
    }
}
