//! Renders diagnostics: with the source underlined, or as one JSON object per line.

use std::fmt::Write;
use std::io;

use serde_json::{Value, json};
use unicode_width::UnicodeWidthChar;
use yase::{Diagnostic, Severity};

use crate::{CommandOutput, Format};

/// The columns that are shown of a source line with more characters: it is cut around the finding.
const MAX_SOURCE_COLUMNS: usize = 100;

/// The number of columns of a long line that are shown before the finding.
const COLUMNS_BEFORE_FINDING: usize = 30;

/// The characters of a message or a hint that are shown, at most: a name may fill a whole file.
const MAX_MESSAGE_LENGTH: usize = 1000;

/// Writes diagnostics on standard error, in the given order.
pub fn write(console: &mut CommandOutput<'_>, format: Format, diagnostics: &[Diagnostic]) -> io::Result<()> {
    let is_shown = |diagnostic: &&Diagnostic| diagnostic.is_error() || !console.quiet;
    let diagnostics: Vec<&Diagnostic> = diagnostics.iter().filter(is_shown).collect();
    for diagnostic in &diagnostics {
        match format {
            Format::Text => writeln!(console.err, "{}\n", drawn(diagnostic, console.colour_err))?,
            Format::Json => writeln!(console.err, "{}", object(diagnostic))?,
        }
    }
    if format == Format::Text && diagnostics.len() > 1 {
        writeln!(console.err, "{}", count(&diagnostics))?;
    }
    if let Some(codes) = console.codes.as_ref().filter(|_| format == Format::Text) {
        codes.borrow_mut().extend(diagnostics.iter().map(|diagnostic| diagnostic.code));
    }
    Ok(())
}

/// Writes a remark about what the command does, on standard error.
pub fn note(console: &mut CommandOutput<'_>, format: Format, message: &str) -> io::Result<()> {
    match format {
        Format::Text => writeln!(console.remarks(), "note: {message}"),
        Format::Json => {
            writeln!(console.remarks(), "{}", json!({"severity": "information", "message": message}))
        }
    }
}

/// `2 errors, 1 warning`
fn count(diagnostics: &[&Diagnostic]) -> String {
    let of = |severity| diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
    let plural = |count: usize, word: &str| match count {
        0 => None,
        1 => Some(format!("1 {word}")),
        _ => Some(format!("{count} {word}s")),
    };
    let counts =
        [(Severity::Error, "error"), (Severity::Warning, "warning"), (Severity::Information, "note")];
    counts
        .map(|(severity, word)| plural(of(severity), word))
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(", ")
}

/// A diagnostic as a JSON object: code, severity, message, file, line, column and hint.
pub fn object(diagnostic: &Diagnostic) -> Value {
    let position = diagnostic.position();
    json!({
        "code": diagnostic.code,
        "severity": severity(diagnostic.severity),
        "message": diagnostic.message,
        "file": diagnostic.source.as_ref().map(|source| source.name.as_str()),
        "line": position.map(|(line, _)| line),
        "column": position.map(|(_, column)| column),
        "hint": diagnostic.hint,
    })
}

const fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Information => "information",
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

/// The diagnostic as compilers print it: severity, code and message, file and position, the line
/// with the place underlined, and the hint.
fn drawn(diagnostic: &Diagnostic, colour: bool) -> String {
    let paint = |code: &str, text: &str| match colour {
        true => format!("\x1b[{code}m{text}\x1b[0m"),
        false => text.to_owned(),
    };
    let tone = match diagnostic.severity {
        Severity::Error => "1;31",
        Severity::Warning => "1;33",
        Severity::Information => "1;36",
    };
    let head = paint(tone, &format!("{}[{}]", severity(diagnostic.severity), diagnostic.code));
    let mut text = format!("{head}: {}", paint("1", &shown(&diagnostic.message)));
    let mut margin = 1;
    if let (Some(source), Some((line, column))) = (&diagnostic.source, diagnostic.position()) {
        let number = line.to_string();
        margin += number.len();
        let position = match source.text.is_empty() {
            true => shown(&source.name),
            false => format!("{}:{line}:{column}", shown(&source.name)),
        };
        let (arrow, bar) = (paint("34", "-->"), paint("34", "|"));
        // Writing to a string does not fail.
        let _ = write!(text, "\n{:>margin$}{arrow} {position}", "");
        if !source.text.is_empty() {
            let (start, content) = source.line(diagnostic.span.start);
            let span = (
                diagnostic.span.start - start.min(diagnostic.span.start),
                diagnostic.span.end.saturating_sub(start),
            );
            let Excerpt { line, before, marked } = Excerpt::of(content, span.0, span.1);
            let mark = format!("{:before$}{}", "", paint(tone, &"^".repeat(marked)));
            let number = paint("34", &number);
            let _ = write!(text, "\n{:margin$}{bar}\n{number} {bar} {line}\n{:margin$}{bar} {mark}", "", "");
        }
    }
    if let Some(hint) = &diagnostic.hint {
        let _ = write!(text, "\n{:margin$}{} {}", "", paint("34", "= help:"), shown(hint));
    }
    text
}

/// A text of the user in displayable form: without control characters, and not longer than a
/// screen.
fn shown(text: &str) -> String {
    let mut shown: String = text.chars().take(MAX_MESSAGE_LENGTH).map(printable).collect();
    if text.chars().nth(MAX_MESSAGE_LENGTH).is_some() {
        shown.push('…');
    }
    shown
}

/// The character, or its replacement if a terminal would interpret it.
fn printable(c: char) -> char {
    match c {
        '\n' => '\n',
        '\t' => ' ',
        c if c.is_control() => '\u{fffd}',
        c => c,
    }
}

/// The part of a line around a place.
#[derive(PartialEq, Eq, Debug)]
struct Excerpt {
    line: String,
    /// Columns before the place.
    before: usize,
    /// Columns of the place; at least one.
    marked: usize,
}

impl Excerpt {
    /// The part of a line around its bytes `start..end`, which are clipped to it.
    fn of(line: &str, start: usize, end: usize) -> Excerpt {
        let width = |c: char| printable(c).width().unwrap_or(0);
        let is_long = line.chars().nth(MAX_SOURCE_COLUMNS).is_some();
        let mut left: Vec<char> = Vec::new();
        let mut columns = 0;
        // Backwards from the place, so that a long line costs no more than a short one.
        let before = &line[..floor(line, start)];
        for c in before.chars().rev() {
            columns += width(c);
            if is_long && columns > COLUMNS_BEFORE_FINDING {
                left.push('…');
                break;
            }
            left.push(printable(c));
        }
        let mut excerpt = Excerpt { line: left.iter().rev().collect(), before: 0, marked: 0 };
        excerpt.before = left.iter().map(|&c| width(c)).sum();
        let mut at = before.len();
        let mut columns = excerpt.before;
        for c in line[before.len()..].chars() {
            if is_long && columns + width(c) >= MAX_SOURCE_COLUMNS {
                excerpt.line.push('…');
                break;
            }
            columns += width(c);
            excerpt.line.push(printable(c));
            if at < end {
                excerpt.marked += width(c);
            }
            at += c.len_utf8();
        }
        excerpt.marked = excerpt.marked.max(1);
        excerpt
    }
}

/// The largest boundary of a character that is not after the byte.
fn floor(text: &str, byte: usize) -> usize {
    let byte = byte.min(text.len());
    (0..=byte).rev().find(|&byte| text.is_char_boundary(byte)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use yase::{Source, Span};

    use super::*;

    fn finding() -> Diagnostic {
        let source = Source::new("models/goalie.srm", "Liveness:\nactive = Serch . Track\n");
        Diagnostic::error("E0201", Span::new(19, 24), "`Serch` is unknown")
            .with_hint("did you mean `Search`?")
            .in_source(&source)
    }

    #[test]
    fn a_drawing_names_severity_file_line_and_column_and_underlines() {
        let expected = "\
error[E0201]: `Serch` is unknown
  --> models/goalie.srm:2:10
  |
2 | active = Serch . Track
  |          ^^^^^
  = help: did you mean `Search`?";
        assert_eq!(drawn(&finding(), false), expected);
    }

    #[test]
    fn colours_are_used_on_request() {
        assert!(drawn(&finding(), true).contains('\x1b'));
    }

    #[test]
    fn a_place_outside_the_text_is_still_reported() {
        let mut outside = finding();
        outside.span = Span::new(1000, 2000);
        assert!(drawn(&outside, false).contains("`Serch` is unknown"));
    }

    #[test]
    fn without_a_source_one_line_remains() {
        let text = drawn(&Diagnostic::error("E0001", Span::default(), "nothing there"), false);
        assert_eq!(text, "error[E0001]: nothing there");
    }

    #[test]
    fn a_file_that_cannot_be_read_is_named() {
        let source = Source::new("nowhere.srm", "");
        let text = drawn(&Diagnostic::error("E0001", 0..0, "cannot be read").in_source(&source), false);
        assert_eq!(text, "error[E0001]: cannot be read\n  --> nowhere.srm");
    }

    #[test]
    fn a_long_line_is_cut_around_the_place() {
        let line = format!("{}ab{}", "x".repeat(200), "y".repeat(200));
        let Excerpt { line, before, marked } = Excerpt::of(&line, 200, 202);
        assert_eq!(
            line,
            format!(
                "…{}ab{}…",
                "x".repeat(COLUMNS_BEFORE_FINDING),
                "y".repeat(MAX_SOURCE_COLUMNS - COLUMNS_BEFORE_FINDING - 4)
            )
        );
        assert_eq!((before, marked), (COLUMNS_BEFORE_FINDING + 1, 2));
        let whole = "z".repeat(100_000);
        let cut = Excerpt::of(&whole, 70_000, 100_000);
        assert!(cut.line.chars().count() <= MAX_SOURCE_COLUMNS && cut.marked < MAX_SOURCE_COLUMNS, "{cut:?}");
        let short = Excerpt::of("a = b", 4, 5);
        assert_eq!(short, Excerpt { line: "a = b".into(), before: 4, marked: 1 });
    }

    #[test]
    fn columns_are_those_of_a_terminal() {
        let Excerpt { line, before, marked } = Excerpt::of("\t球 = ω\x1b[2J", 7, 9);
        assert_eq!(line, " 球 = ω\u{fffd}[2J");
        assert_eq!((before, marked), (6, 1));
        assert_eq!(Excerpt::of("球", 1, 2).before, 0, "within a character");
    }

    #[test]
    fn a_text_cannot_command_the_terminal_or_fill_it() {
        let name = "\x1b[31m".repeat(1000);
        let text = drawn(&Diagnostic::error("E0001", Span::default(), name), false);
        assert!(!text.contains('\x1b') && text.ends_with('…') && text.len() < 5000, "{text}");
    }

    #[test]
    fn json_has_every_key() {
        let expected = json!({"code": "E0201", "severity": "error", "message": "`Serch` is unknown",
            "file": "models/goalie.srm", "line": 2, "column": 10, "hint": "did you mean `Search`?"});
        assert_eq!(object(&finding()), expected);
    }

    #[test]
    fn several_are_counted() {
        let warning = Diagnostic::warning("E0202", Span::default(), "unused");
        assert_eq!(count(&[&finding(), &warning]), "1 error, 1 warning");
        assert_eq!(count(&[&warning, &warning]), "2 warnings");
    }
}
