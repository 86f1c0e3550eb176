//! The text form that all models share: items with a header each, and lines below it.
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
//! - A header stands at the beginning of its line, all else further in.
//! - `#` begins a comment, unless within double quotes. A comment belongs to the line it stands on or to the next one; it goes where that goes.
//! - A value goes to the end of its line. One that begins with a double quote ends with one, and between them `\n`, `\r`, `\t`, `\"`,
//!   `\\` and `\u{..}` stand for what cannot be written otherwise. A list has commas between.
//! - `name[2]` is the second of that name.
//!
//! What this grammar makes of a text is a [`Document`]: the same for all kinds of models, with the place of each word.

mod parse;
mod print;
mod words;

use yase::Span;

pub(crate) use words::{Reference, list, quoted, reference, unquoted, value_text};

/// A text in items.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Document {
    pub(crate) items: Vec<Item>,
    /// Comments after the last line.
    pub(crate) tail: Vec<String>,
}

/// A header and what is below it.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Item {
    pub(crate) comments: Comments,
    /// The word before the colon.
    pub(crate) word: Word,
    /// What stands behind the colon.
    pub(crate) name: Word,
    pub(crate) lines: Vec<Line>,
}

/// A line below a header.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Line {
    pub(crate) comments: Comments,
    /// How far in it stands.
    pub(crate) indent: usize,
    pub(crate) content: Word,
}

/// Comments, each with its `#`.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct Comments {
    /// On lines of their own above.
    pub(crate) above: Vec<String>,
    /// Behind, on the same line; empty if there is none.
    pub(crate) beside: String,
}

/// Some text and its place, without blanks around it.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Word {
    pub(crate) text: String,
    pub(crate) span: Span,
}

impl Word {
    /// A text that stands nowhere yet.
    pub(crate) fn new(text: impl Into<String>) -> Word {
        Word { text: text.into(), span: Span::default() }
    }

    /// A part of it, by its bytes, without blanks around it.
    pub(crate) fn part(&self, range: std::ops::Range<usize>) -> Word {
        let part = &self.text[range.clone()];
        let start = self.span.start + range.start + (part.len() - part.trim_start().len());
        let text = part.trim().to_owned();
        let span = Span::new(start, start + text.len());
        Word { text, span }
    }
}

/// A setting: `key = value`, or `key:` and a block of lines.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Setting<'a> {
    pub(crate) key: Word,
    pub(crate) value: Word,
    pub(crate) comments: &'a Comments,
    /// The lines further in, if it ends with a colon.
    pub(crate) block: Option<&'a [Line]>,
}

/// The settings that lines are made of; what is none is handed back as it is.
pub(crate) fn settings(lines: &[Line]) -> Vec<Result<Setting<'_>, &Line>> {
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

fn setting<'a>(line: &'a Line, inside: &'a [Line]) -> Option<Setting<'a>> {
    let text = &line.content.text;
    let comments = &line.comments;
    if let Some(key) = text.strip_suffix(':').filter(|key| is_key(key)) {
        let (key, value) = (line.content.part(0..key.len()), line.content.part(text.len()..text.len()));
        return Some(Setting { key, value, comments, block: Some(inside) });
    }
    let equals = text.find('=').filter(|&equals| is_key(text[..equals].trim_end()))?;
    let (key, value) = (line.content.part(0..equals), line.content.part(equals + 1..text.len()));
    Some(Setting { key, value, comments, block: None })
}

fn is_key(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}

impl Item {
    /// An item that stands nowhere yet.
    pub(crate) fn new(word: &str, name: String) -> Item {
        Item { word: Word::new(word), name: Word::new(name), ..Item::default() }
    }

    /// Adds a line.
    pub(crate) fn line(&mut self, indent: usize, content: String) {
        self.lines.push(Line { indent, content: Word::new(content), ..Line::default() });
    }

    /// Adds `key = value`.
    pub(crate) fn set(&mut self, key: &str, value: &str) {
        self.line(2, format!("{key} = {value}"));
    }

    /// The place of its header.
    pub(crate) fn span(&self) -> Span {
        if self.name.text.is_empty() { self.word.span } else { self.word.span.to(self.name.span) }
    }
}
