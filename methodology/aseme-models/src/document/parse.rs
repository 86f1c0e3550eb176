//! Parser of an [`ItemDocument`].

use yase::{Diagnostic, Span};

use super::{Comments, Item, ItemDocument, Line, SpannedText};
use aseme::text;

impl ItemDocument {
    /// Parses a text. Lines that belong to no item are reported (E0260).
    pub(crate) fn parse(text: &str) -> (ItemDocument, Vec<Diagnostic>) {
        let mut document = ItemDocument::default();
        let mut diagnostics = Vec::new();
        let mut above: Vec<String> = Vec::new();
        let blanked = text::without_comments(text);
        for line in text::lines_of(&blanked, Span::new(0, blanked.len())) {
            let comment = text::comment_of(text, &blanked, line).unwrap_or_default();
            let content = text::trimmed(&blanked, line);
            if content.start == content.end {
                above.extend(Some(comment).filter(|comment| !comment.is_empty()).map(String::from));
                continue;
            }
            let comments = Comments { above: std::mem::take(&mut above), trailing: comment.into() };
            let word = SpannedText { text: blanked[content.start..content.end].into(), span: content };
            let indent = blanked[line.start..content.start].trim_start_matches('\u{feff}').chars().count();
            let indent = if starts_text(text, line, content) { 0 } else { indent };
            document.line(comments, indent, word, &mut diagnostics);
        }
        document.tail = above;
        (document, diagnostics)
    }

    fn line(
        &mut self,
        comments: Comments,
        indent: usize,
        content: SpannedText,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        match (header(&content), self.items.last_mut()) {
            (Some((word, name)), _) if indent == 0 => {
                self.items.push(Item { comments, word, name, lines: Vec::new() });
            }
            (_, Some(item)) => {
                if indent == 0 {
                    let message = format!("`{}` is neither a header nor indented below one", content.text);
                    let hint =
                        format!("a header is `Word: name`; lines of `{}:` are indented", item.word.text);
                    diagnostics.push(Diagnostic::error("E0260", content.span, message).with_hint(hint));
                }
                item.lines.push(Line { comments, indent: indent.max(1), content });
            }
            (_, None) => {
                let message = format!("`{}` precedes the first header", content.text);
                let hint = "a model starts with a line such as `SAG:` or `IAC: name`";
                diagnostics.push(Diagnostic::error("E0260", content.span, message).with_hint(hint));
            }
        }
    }
}

/// Whether only a byte order mark precedes the content of the first line.
fn starts_text(text: &str, line: Span, content: Span) -> bool {
    text[line.start..content.start].trim_start_matches('\u{feff}').is_empty()
}

/// `Word: name`
fn header(content: &SpannedText) -> Option<(SpannedText, SpannedText)> {
    let colon = content.text.find(':')?;
    let word = &content.text[..colon];
    let is_word = word.starts_with(|letter: char| letter.is_ascii_uppercase())
        && word.bytes().all(|byte| byte.is_ascii_alphabetic());
    is_word.then(|| (content.part(0..colon), content.part(colon + 1..content.text.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_have_lines_and_everything_has_its_comments() {
        let text = "# one\n\nGoal: Win # two\n  # three\n  depender = M # four\n# five\n";
        let (document, findings) = ItemDocument::parse(text);
        assert_eq!(findings, []);
        let item = &document.items[0];
        assert_eq!((item.word.text.as_str(), item.name.text.as_str()), ("Goal", "Win"));
        assert_eq!(item.comments, Comments { above: vec!["# one".into()], trailing: "# two".into() });
        assert_eq!(item.lines[0].content.text, "depender = M");
        assert_eq!(
            item.lines[0].comments,
            Comments { above: vec!["# three".into()], trailing: "# four".into() }
        );
        assert_eq!(document.tail, ["# five"]);
        let span = item.lines[0].content.span;
        assert_eq!(&text[span.start..span.end], "depender = M");
    }

    #[test]
    fn stray_lines_are_reported() {
        let (document, findings) = ItemDocument::parse("\u{feff}a = b\nGoal: Win\nc = d\n");
        assert_eq!(findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["E0260", "E0260"]);
        assert_eq!(document.items[0].lines.len(), 1);
    }
}
