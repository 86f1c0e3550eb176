//! The text form shared by all models: items, each with a header and lines below it.
//!
//! ```text
//! # who plays
//! Goal: WinGame              # an item: a word with a capital letter, a colon, a name
//!   depender = Manager       # a setting: a key and a value
//!   dependee = Player, "the other, too"
//!   liveness:                # a block: a key and the lines further in
//!     goalie = Track~
//! ```
//!
//! - A header begins in the first column, everything else is indented.
//! - `#` begins a comment, except within double quotes. A comment belongs to its line or, on a line
//!   of its own, to the next line, and moves with it.
//! - A value extends to the end of its line. A quoted value begins and ends with a double quote; in
//!   it `\n`, `\r`, `\t`, `\"`, `\\` and `\u{..}` are escapes. Elements of a list are separated by
//!   commas.
//! - `name[2]` is the second of that name.
//!
//! The parser makes an [`ItemDocument`] of a text: the same for all kinds of models, with the
//! position of each word.

mod parse;
mod print;
mod values;

use yase::Span;

pub(crate) use values::{Reference, list, quoted, reference, unquoted, value_text};

/// A text as a list of items.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct ItemDocument {
    pub(crate) items: Vec<Item>,
    /// Comments after the last line.
    pub(crate) tail: Vec<String>,
}

/// A header and the lines below it.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Item {
    pub(crate) comments: Comments,
    /// The word before the colon.
    pub(crate) word: SpannedText,
    /// The text after the colon.
    pub(crate) name: SpannedText,
    pub(crate) lines: Vec<Line>,
}

/// A line below a header.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Line {
    pub(crate) comments: Comments,
    /// Its indentation.
    pub(crate) indent: usize,
    pub(crate) content: SpannedText,
}

/// Comments, each with its `#`.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct Comments {
    /// Comments on the lines above.
    pub(crate) above: Vec<String>,
    /// The comment after the text on the same line; empty if there is none.
    pub(crate) trailing: String,
}

/// A text with its position, without surrounding blanks.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct SpannedText {
    pub(crate) text: String,
    pub(crate) span: Span,
}

impl SpannedText {
    /// A text without a position.
    pub(crate) fn new(text: impl Into<String>) -> SpannedText {
        SpannedText { text: text.into(), span: Span::default() }
    }

    /// A part of it given by a byte range, without surrounding blanks.
    pub(crate) fn part(&self, range: std::ops::Range<usize>) -> SpannedText {
        let part = &self.text[range.clone()];
        let start = self.span.start + range.start + (part.len() - part.trim_start().len());
        let text = part.trim().to_owned();
        let span = Span::new(start, start + text.len());
        SpannedText { text, span }
    }
}

/// The beginning of the last word of a text.
pub(crate) fn last_word(text: &str) -> usize {
    text.char_indices().rfind(|(_, c)| c.is_whitespace()).map_or(0, |(at, blank)| at + blank.len_utf8())
}

/// A setting: `key = value`, or `key:` and a block of lines.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct KeyValue<'a> {
    pub(crate) key: SpannedText,
    pub(crate) value: SpannedText,
    pub(crate) comments: &'a Comments,
    /// The deeper indented lines, if it ends with a colon.
    pub(crate) block: Option<&'a [Line]>,
}

/// The settings of lines; a line that is not a setting is returned as the error.
pub(crate) fn settings(lines: &[Line]) -> Vec<Result<KeyValue<'_>, &Line>> {
    let mut settings = Vec::new();
    let mut rest = lines;
    while let Some((line, below)) = rest.split_first() {
        let inside = below.iter().take_while(|inner| inner.indent > line.indent).count();
        match setting(line, &below[..inside]) {
            Some(setting) => {
                rest = if setting.block.is_some() { &below[inside..] } else { below };
                settings.push(Ok(setting));
            }
            None => {
                rest = below;
                settings.push(Err(line));
            }
        }
    }
    settings
}

fn setting<'a>(line: &'a Line, inside: &'a [Line]) -> Option<KeyValue<'a>> {
    let text = &line.content.text;
    let comments = &line.comments;
    if let Some(key) = text.strip_suffix(':').filter(|key| is_key(key)) {
        let (key, value) = (line.content.part(0..key.len()), line.content.part(text.len()..text.len()));
        return Some(KeyValue { key, value, comments, block: Some(inside) });
    }
    let equals = text.find('=').filter(|&equals| is_key(text[..equals].trim_end()))?;
    let (key, value) = (line.content.part(0..equals), line.content.part(equals + 1..text.len()));
    Some(KeyValue { key, value, comments, block: None })
}

fn is_key(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}

impl Item {
    /// An item without a position.
    pub(crate) fn new(word: &str, name: String) -> Item {
        Item { word: SpannedText::new(word), name: SpannedText::new(name), ..Item::default() }
    }

    /// Adds a line.
    pub(crate) fn line(&mut self, indent: usize, content: String) {
        self.lines.push(Line { indent, content: SpannedText::new(content), ..Line::default() });
    }

    /// Adds `key = value`.
    pub(crate) fn set(&mut self, key: &str, value: &str) {
        self.line(2, format!("{key} = {value}"));
    }

    /// The span of its header.
    pub(crate) fn span(&self) -> Span {
        if self.name.text.is_empty() { self.word.span } else { self.word.span.to(self.name.span) }
    }
}
