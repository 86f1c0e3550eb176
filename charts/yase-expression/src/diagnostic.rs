//! Diagnostics about texts that users write.
//!
//! Parsing never fails: it returns the part that could be parsed and a list of [`Diagnostic`]s. A
//! diagnostic has a position as a byte [`Span`] and, once [attached](Diagnostic::in_source), the
//! text and the name of the file, from which line, column and the underlined text are derived.

use std::cell::Cell;
use std::fmt;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// A range of a text: bytes `start..end`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The bytes from `start` to before `end`.
    pub const fn new(start: usize, end: usize) -> Span {
        Span { start, end }
    }

    /// The same range in a text with `offset` more bytes in front.
    pub const fn shifted(self, offset: usize) -> Span {
        Span::new(self.start + offset, self.end + offset)
    }

    /// The smallest span that covers both.
    pub fn to(self, other: Span) -> Span {
        Span::new(self.start.min(other.start), self.end.max(other.end))
    }
}

impl From<Range<usize>> for Span {
    fn from(range: Range<usize>) -> Span {
        Span::new(range.start, range.end)
    }
}

/// A text with its file name, shared by the diagnostics about it.
#[derive(Clone, Debug)]
pub struct Source {
    /// The path as given by the user, or a word such as `formula`.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// The first byte of each line, determined once: a text may have a finding in every line. The
    /// first line begins after a byte order mark, which editors do not show.
    line_starts: OnceLock<Box<[usize]>>,
    /// The number of characters before each block of [`BLOCK_SIZE`] bytes: one line may have many
    /// findings.
    characters: OnceLock<Box<[usize]>>,
}

/// Characters are counted by blocks of so many bytes.
const BLOCK_SIZE: usize = 256;

impl Source {
    /// A text and its name, ready to be shared.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Source> {
        Arc::new(Source {
            name: name.into(),
            text: text.into(),
            line_starts: OnceLock::new(),
            characters: OnceLock::new(),
        })
    }

    /// Line and column of a byte, both from 1; columns count characters.
    pub fn position(&self, byte: usize) -> (usize, usize) {
        let (number, start) = self.line_at(byte);
        let mut end = byte.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        (number, self.characters_before(end).saturating_sub(self.characters_before(start)) + 1)
    }

    /// The line that contains a byte, without its line break, and its first byte.
    pub fn line(&self, byte: usize) -> (usize, &str) {
        let (number, start) = self.line_at(byte);
        let end = self.line_starts().get(number).copied().unwrap_or(self.text.len());
        let line = &self.text[start..end];
        let Some(line) = line.strip_suffix('\n') else { return (start, line) };
        (start, line.strip_suffix('\r').unwrap_or(line))
    }

    /// The number of characters that begin before a byte.
    fn characters_before(&self, byte: usize) -> usize {
        let begins = |bytes: &[u8]| bytes.iter().filter(|&&byte| byte & 0xc0 != 0x80).count();
        let text = self.text.as_bytes();
        let blocks = self.characters.get_or_init(|| {
            let mut before = 0;
            let ends = text.chunks(BLOCK_SIZE).map(|block| {
                before += begins(block);
                before
            });
            std::iter::once(0).chain(ends).collect()
        });
        let block = byte / BLOCK_SIZE;
        blocks[block] + begins(&text[block * BLOCK_SIZE..byte])
    }

    /// The number, from 1, and the first byte of the line that contains a byte.
    fn line_at(&self, byte: usize) -> (usize, usize) {
        let starts = self.line_starts();
        let number = starts.partition_point(|&start| start <= byte).max(1);
        (number, starts[number - 1])
    }

    fn line_starts(&self) -> &[usize] {
        self.line_starts.get_or_init(|| {
            let after = self.text.match_indices('\n').map(|(newline, _)| newline + 1);
            let mark = if self.text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
            std::iter::once(mark).chain(after).collect()
        })
    }
}

impl PartialEq for Source {
    fn eq(&self, other: &Source) -> bool {
        (&self.name, &self.text) == (&other.name, &other.text)
    }
}

impl Eq for Source {}

/// Severity of a diagnostic.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Severity {
    /// Additional information.
    Information,
    /// Probably a mistake.
    Warning,
    /// The text cannot be used.
    Error,
}

/// A finding about a text: what is wrong, where, and how to correct it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagnostic {
    /// A stable code such as `E0123`, for documentation and tests.
    pub code: &'static str,
    /// Its severity.
    pub severity: Severity,
    /// One sentence in lower case without a full stop that names the cause.
    pub message: String,
    /// The position, in bytes of [`source`](Diagnostic::source) (before it is attached, of the
    /// parsed text).
    pub span: Span,
    /// A correction, if one is known.
    pub hint: Option<String>,
    /// The text that contains the span.
    pub source: Option<Arc<Source>>,
}

impl Diagnostic {
    /// An error at a position.
    pub fn error(code: &'static str, span: impl Into<Span>, message: impl Into<String>) -> Diagnostic {
        let (span, message) = (span.into(), message.into());
        Diagnostic { code, severity: Severity::Error, message, span, hint: None, source: None }
    }

    /// A warning at a position.
    pub fn warning(code: &'static str, span: impl Into<Span>, message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(code, span, message) }
    }

    /// Adds a hint with a correction.
    pub fn with_hint(mut self, hint: impl Into<String>) -> Diagnostic {
        self.hint = Some(hint.into());
        self
    }

    /// Adds "did you mean" if a candidate is similar to the unknown name.
    pub fn with_nearest<'a>(self, wrong: &str, candidates: impl IntoIterator<Item = &'a str>) -> Diagnostic {
        match nearest(wrong, candidates) {
            Some(name) => self.with_hint(format!("did you mean `{name}`?")),
            None => self,
        }
    }

    /// The same with limited [suggestions](Suggestions).
    pub fn with_suggestion<'a>(
        self,
        suggestions: &Suggestions,
        wrong: &str,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> Diagnostic {
        match suggestions.nearest(wrong, candidates) {
            Some(name) => self.with_hint(format!("did you mean `{name}`?")),
            None => self,
        }
    }

    /// Attaches the text that contains the span; the first attached source is kept.
    pub fn in_source(mut self, source: &Arc<Source>) -> Diagnostic {
        self.source.get_or_insert_with(|| source.clone());
        self
    }

    /// The same finding for a text that begins at byte `offset` of a larger one.
    pub fn shifted(mut self, offset: usize) -> Diagnostic {
        self.span = self.span.shifted(offset);
        self
    }

    /// Line and column (from 1) of the position, if the source is attached.
    pub fn position(&self) -> Option<(usize, usize)> {
        self.source.as_ref().map(|source| source.position(self.span.start))
    }

    /// Whether it is an error.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl fmt::Display for Diagnostic {
    /// `file:line:column: error[E0123]: message (hint)`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (Some(source), Some((line, column))) = (&self.source, self.position()) {
            write!(f, "{}:{line}:{column}: ", source.name)?;
        }
        let severity = match self.severity {
            Severity::Information => "information",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        write!(f, "{severity}[{}]: {}", self.code, self.message)?;
        match &self.hint {
            Some(hint) => write!(f, " ({hint})"),
            None => Ok(()),
        }
    }
}

/// Suggestions for many unknown names of one text. Each is compared with all candidates, so that
/// the effort would grow with the square of the text: after a number of comparisons there are no
/// more suggestions.
#[derive(Clone, Debug)]
pub struct Suggestions {
    left: Cell<usize>,
}

/// The number of comparisons for the suggestions about one text.
const MAX_COMPARISONS: usize = 300_000;

impl Default for Suggestions {
    fn default() -> Suggestions {
        Suggestions { left: Cell::new(MAX_COMPARISONS) }
    }
}

impl Suggestions {
    /// The candidate [nearest] to `wrong`; none if the comparisons are used up.
    pub fn nearest<'a>(&self, wrong: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
        let candidates = candidates.into_iter().map_while(|name| {
            self.left.set(self.left.get().checked_sub(1)?);
            Some(name)
        });
        // of candidates that were compared in part the nearest is not known
        nearest(wrong, candidates).filter(|_| self.left.get() > 0)
    }
}

/// The candidate most similar to `wrong`, if at most a third of its letters differ, ignoring case.
pub fn nearest<'a>(wrong: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = wrong.to_lowercase();
    let length = wrong.chars().count();
    let limit = (length / 3).max(1);
    candidates
        .into_iter()
        // Names of very different lengths differ by more; comparing lengths is cheap.
        .filter(|name| name.chars().count().abs_diff(length) <= limit)
        .map(|name| (strsim::damerau_levenshtein(&lower, &name.to_lowercase()), name))
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn position_counts_lines_and_characters_from_one() {
        let source = Source::new("a.srm", "goalie = aω\nb = c");
        assert_eq!(source.position(0), (1, 1));
        assert_eq!(source.position("goalie = aω".len()), (1, 12));
        assert_eq!(source.position("goalie = aω\nb".len()), (2, 2));
        assert_eq!(source.position(1000), (2, 6));
        assert_eq!(source.position("goalie = a".len() + 1), (1, 11), "within a character");
    }

    #[test]
    fn columns_of_a_long_line_count_characters() {
        let line = "aω球".repeat(500);
        let source = Source::new("a.srm", format!("b\n{line}\nc"));
        for (column, (at, _)) in line.char_indices().enumerate() {
            assert_eq!(source.position(at + 2), (2, column + 1));
        }
        assert_eq!(source.line(1000), (2, line.as_str()));
        assert_eq!(source.position(line.len() + 3), (3, 1));
    }

    /// A million places in a line of a million characters would take minutes if each counted them.
    #[test]
    fn a_place_in_a_long_line_is_found_without_a_look_at_the_whole_line() {
        let source = Source::new("a.srm", "x".repeat(1_000_000));
        for byte in (0..1_000_000).step_by(3) {
            assert_eq!((source.position(byte).1, source.line(byte).0), (byte + 1, 0));
        }
    }

    #[test]
    fn suggestions_end_with_their_comparisons() {
        let suggestions = Suggestions::default();
        assert_eq!(suggestions.nearest("Vsion", ["Vision", "Sensors"]), Some("Vision"));
        assert_eq!(suggestions.nearest("x", std::iter::repeat_n("other", MAX_COMPARISONS)), None);
        assert_eq!(suggestions.nearest("Vsion", ["Vision", "Sensors"]), None);
    }

    #[test]
    fn a_line_is_found_by_any_of_its_bytes() {
        let source = Source::new("a.srm", "a = b\r\n\nc");
        assert_eq!(
            [0, 6, 7, 8, 9].map(|byte| source.line(byte)),
            [(0, "a = b"), (0, "a = b"), (7, ""), (8, "c"), (8, "c")]
        );
        assert_eq!(Source::new("empty", "").line(3), (0, ""));
    }

    #[test]
    fn display_names_file_line_column_code_and_hint() {
        let source = Source::new("a.xml", "<agent>\n<actvity/>");
        let diagnostic = Diagnostic::error("E0001", 9..16, "unknown element `actvity`")
            .with_nearest("actvity", ["name", "activity"])
            .in_source(&source);
        assert_eq!(
            diagnostic.to_string(),
            "a.xml:2:2: error[E0001]: unknown element `actvity` (did you mean `activity`?)"
        );
    }

    #[test]
    fn a_byte_order_mark_is_no_column() {
        let source = Source::new("a.srm", "\u{feff}a = b\nc");
        assert_eq!([0, 3, 4, 9].map(|byte| source.position(byte)), [(1, 1), (1, 1), (1, 2), (2, 1)]);
        assert_eq!(source.line(0), (3, "a = b"));
    }

    #[test]
    fn nearest_is_silent_when_nothing_is_near() {
        assert_eq!(nearest("Vsion", ["Vision", "Sensors"]), Some("Vision"));
        assert_eq!(nearest("Elephant", ["Vision", "Sensors"]), None);
        assert_eq!(nearest("Visi", ["Vision"]), None, "two letters more");
        assert_eq!(nearest("Ball", ["Balls", "Bal"]), Some("Bal"), "a letter more or less");
    }
}
