//! Renders diagnostics: with the source underlined, or as one JSON object per line.

use std::fmt;
use std::io;

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode};
use serde_json::{Value, json};
use yase::{Diagnostic, Severity};

use super::{CommandOutput, Format};

/// Writes diagnostics on standard error, in the given order.
pub(crate) fn write(
    console: &mut CommandOutput<'_>,
    format: Format,
    diagnostics: &[Diagnostic],
) -> io::Result<()> {
    for diagnostic in diagnostics {
        match format {
            Format::Text => writeln!(console.err, "{}", drawn(diagnostic, console.colour_err))?,
            Format::Json => writeln!(console.err, "{}", object(diagnostic))?,
        }
    }
    if format == Format::Text && diagnostics.len() > 1 {
        writeln!(console.err, "{}", count(diagnostics))?;
    }
    Ok(())
}

/// `2 errors, 1 warning`
fn count(diagnostics: &[Diagnostic]) -> String {
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
    let others = diagnostics.len() - errors;
    let plural = |count: usize, word: &str| match count {
        0 => None,
        1 => Some(format!("1 {word}")),
        _ => Some(format!("{count} {word}s")),
    };
    [plural(errors, "error"), plural(others, "warning")].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

pub(crate) fn object(diagnostic: &Diagnostic) -> Value {
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

/// The diagnostic with its source; in one line if there is no source.
fn drawn(diagnostic: &Diagnostic, colour: bool) -> String {
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let mut text = String::new();
    let drawing = GraphicalReportHandler::new_themed(theme).with_links(false);
    match MietteDiagnostic::new(diagnostic) {
        Some(drawable) if drawing.render_report(&mut text, &drawable).is_ok() => text,
        _ => diagnostic.to_string(),
    }
}

/// Adapts a diagnostic to miette.
#[derive(Debug)]
struct MietteDiagnostic<'a> {
    diagnostic: &'a Diagnostic,
    source: NamedSource<String>,
}

impl<'a> MietteDiagnostic<'a> {
    /// None if there is no source text.
    fn new(diagnostic: &'a Diagnostic) -> Option<MietteDiagnostic<'a>> {
        let source = diagnostic.source.as_ref().filter(|source| !source.text.is_empty())?;
        Some(MietteDiagnostic { diagnostic, source: NamedSource::new(&source.name, source.text.clone()) })
    }

    /// Start and length of the span, clipped to the text.
    fn place(&self) -> (usize, usize) {
        let length = self.source.inner().len();
        let start = self.diagnostic.span.start.min(length);
        (start, self.diagnostic.span.end.clamp(start, length) - start)
    }
}

impl fmt::Display for MietteDiagnostic<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.diagnostic.message)
    }
}

impl std::error::Error for MietteDiagnostic<'_> {}

impl miette::Diagnostic for MietteDiagnostic<'_> {
    fn code<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        Some(Box::new(self.diagnostic.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity {
            Severity::Information => miette::Severity::Advice,
            Severity::Warning => miette::Severity::Warning,
            Severity::Error => miette::Severity::Error,
        })
    }

    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.diagnostic.hint.as_ref().map(|hint| Box::new(hint) as Box<dyn fmt::Display + 'b>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (start, length) = self.place();
        Some(Box::new(std::iter::once(LabeledSpan::new_primary_with_span(None, (start, length)))))
    }
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
    fn a_drawing_names_file_line_and_column_and_underlines() {
        let text = drawn(&finding(), false);
        let source_line = "active = Serch . Track";
        for part in
            ["E0201", "models/goalie.srm:2:10", "`Serch` is unknown", source_line, "did you mean `Search`?"]
        {
            assert!(text.contains(part), "no {part} in\n{text}");
        }
        let marked = text.lines().skip_while(|line| !line.contains(source_line)).nth(1).unwrap_or_default();
        assert_eq!(marked.matches(['─', '┬']).count(), "Serch".len(), "{text}");
        assert!(!text.contains('\x1b'));
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
    fn json_has_every_key() {
        let expected = json!({"code": "E0201", "severity": "error", "message": "`Serch` is unknown",
            "file": "models/goalie.srm", "line": 2, "column": 10, "hint": "did you mean `Search`?"});
        assert_eq!(object(&finding()), expected);
    }

    #[test]
    fn several_are_counted() {
        let warning = Diagnostic::warning("E0202", Span::default(), "unused");
        assert_eq!(count(&[finding(), warning.clone()]), "1 error, 1 warning");
        assert_eq!(count(&[warning.clone(), warning]), "2 warnings");
    }
}
