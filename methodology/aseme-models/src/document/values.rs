//! Syntax of values, names and lists in an [`ItemDocument`](super::ItemDocument).

use super::SpannedText;
use aseme::text::{self, QuoteScanner};

/// A value as text: without quotes if it parses back to the same value, otherwise quoted.
pub(crate) fn value_text(value: &str) -> String {
    let bare = !value.is_empty() && !value.starts_with('"') && text::is_plain(value);
    if bare { value.into() } else { quoted(value) }
}

/// A text in quotes.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '\n' => quoted.push_str("\\n"),
            '\r' => quoted.push_str("\\r"),
            '\t' => quoted.push_str("\\t"),
            '"' | '\\' => quoted.extend(['\\', letter]),
            other if other.is_control() || other == '\u{feff}' => quoted.extend(other.escape_unicode()),
            other => quoted.push(other),
        }
    }
    quoted.push('"');
    quoted
}

/// The content of a bare or quoted value. `None` if the quotes or an escape are invalid.
pub(crate) fn unquoted(value: &str) -> Option<String> {
    if !value.starts_with('"') {
        return Some(value.into());
    }
    let (text, rest) = leading_text(value)?;
    rest.is_empty().then_some(text)
}

/// The quoted text at the start of a text, and the text after it.
fn leading_text(text: &str) -> Option<(String, &str)> {
    let mut meant = String::new();
    let mut rest = text.strip_prefix('"')?;
    loop {
        let letter = rest.chars().next()?;
        rest = &rest[letter.len_utf8()..];
        match letter {
            '"' => return Some((meant, rest)),
            '\\' => {
                let (letter, after) = escape(rest)?;
                meant.push(letter);
                rest = after;
            }
            other => meant.push(other),
        }
    }
}

/// The character of an escape sequence, and the text after it.
fn escape(text: &str) -> Option<(char, &str)> {
    let letter = text.chars().next()?;
    let after = &text[letter.len_utf8()..];
    let meant = match letter {
        'n' => '\n',
        'r' => '\r',
        't' => '\t',
        '"' | '\\' => letter,
        'u' => {
            let (digits, after) = after.strip_prefix('{')?.split_once('}')?;
            return Some((char::from_u32(u32::from_str_radix(digits, 16).ok()?)?, after));
        }
        _ => return None,
    };
    Some((meant, after))
}

/// A reference to the k-th element of a name, from 1.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Reference {
    pub(crate) name: String,
    pub(crate) number: usize,
}

impl Reference {
    /// Parses an element of a list; `None` if it is invalid.
    pub(crate) fn parse(text: &str) -> Option<Reference> {
        let (name, rest) = match text.starts_with('"') {
            true => leading_text(text)?,
            false => {
                let end = text.find('[').unwrap_or(text.len());
                (text[..end].trim_end().to_owned(), &text[end..])
            }
        };
        let number = match rest.trim() {
            "" => 1,
            number => {
                number.strip_prefix('[')?.strip_suffix(']')?.parse().ok().filter(|&number| number > 0)?
            }
        };
        Some(Reference { name, number })
    }
}

/// A reference as text.
pub(crate) fn reference(name: &str, number: usize) -> String {
    let bare = !name.is_empty() && value_text(name) == name && !name.contains([',', '[', ']', '"']);
    let name = if bare { name.into() } else { quoted(name) };
    if number == 1 { name } else { format!("{name}[{number}]") }
}

/// The elements of a list, separated by commas outside quotes.
pub(crate) fn list(value: &SpannedText) -> Vec<SpannedText> {
    if value.text.is_empty() {
        return Vec::new();
    }
    let (mut words, mut start, mut quotes) = (Vec::new(), 0, QuoteScanner::default());
    for (at, letter) in value.text.char_indices() {
        if !quotes.hold(letter) && letter == ',' {
            words.push(value.part(start..at));
            start = at + 1;
        }
    }
    words.push(value.part(start..value.text.len()));
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_read_back_as_they_were() {
        for value in ["plain words", "a, b", " led", "", "a # b", "say \"x\"", "a\nb\t\r\\", "\u{7}\u{feff}"]
        {
            let written = value_text(value);
            assert!(!written.contains(['\n', '\r', '\t']));
            assert_eq!(unquoted(&written).as_deref(), Some(value), "{written}");
        }
        for wrong in ["\"open", "\"a\" b", "\"\\x\"", "\"\\u{d800}\""] {
            assert_eq!(unquoted(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn references_read_back_as_they_were() {
        for (name, number) in [("a", 1), ("two words", 3), ("a,b", 1), ("x[2]", 2), ("", 1), ("\"", 4)] {
            let written = reference(name, number);
            assert_eq!(
                Reference::parse(&written),
                Some(Reference { name: name.into(), number }),
                "{written}"
            );
        }
        for wrong in ["a[0]", "a[x]", "\"a\"b", "a[2"] {
            assert_eq!(Reference::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn commas_in_quotes_do_not_separate() {
        let words: Vec<String> =
            list(&SpannedText::new("a, \"b, \\\" c\" , d[2]")).into_iter().map(|word| word.text).collect();
        assert_eq!(words, ["a", "\"b, \\\" c\"", "d[2]"]);
    }
}
