//! The prose of the project: comments in code and paragraphs in Markdown.

use super::source::comments;
use super::workspace::TextFile;

/// A line of prose.
#[derive(PartialEq, Eq, Debug)]
pub(crate) struct ProseLine {
    /// Counted from 1.
    pub(crate) number: usize,
    /// The prose, without code in the same line and without inline code.
    pub(crate) text: String,
    /// The columns of the whole line, or 0 if its width is free: it starts with code, belongs to a
    /// table, or holds an address.
    pub(crate) columns: usize,
}

/// The prose of a file; code blocks are left out.
pub(crate) fn prose(file: &TextFile) -> Vec<ProseLine> {
    if is_generated(file) {
        return Vec::new(); // the names of states are their formulas
    }
    match file.path.extension().and_then(|extension| extension.to_str()) {
        Some("rs" | "proto") => comment_lines(&file.text),
        Some("md") => blocks(file.text.lines().map(|line| (line, line))),
        _ => Vec::new(),
    }
}

fn is_generated(file: &TextFile) -> bool {
    file.path.starts_with("statecharts") || file.path.iter().any(|folder| folder == "generated")
}

fn comment_lines(text: &str) -> Vec<ProseLine> {
    let comments = comments(text);
    blocks(text.lines().zip(comments.lines()))
}

/// The prose in pairs of a whole line and its prose.
fn blocks<'a>(lines: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<ProseLine> {
    let mut is_code = false;
    let mut prose = Vec::new();
    for (index, (line, text)) in lines.enumerate() {
        let text = text.trim().trim_start_matches(['/', '!', '*']).trim_start();
        if text.starts_with("```") {
            is_code = !is_code;
        } else if !is_code && !text.is_empty() {
            prose.push(ProseLine { number: index + 1, text: words(text), columns: columns(line, text) });
        }
    }
    prose
}

/// A text without its inline code.
fn words(text: &str) -> String {
    text.split('`').step_by(2).collect()
}

fn columns(line: &str, text: &str) -> usize {
    let is_comment = line.trim_start().starts_with("//") || line.trim_start().starts_with(text);
    let is_free = !is_comment || text.starts_with('|') || line.contains("://");
    if is_free { 0 } else { line.chars().count() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<(usize, String, usize)> {
        let lines = prose(&TextFile { path: path.into(), text: text.into() });
        lines.into_iter().map(|line| (line.number, line.text, line.columns)).collect()
    }

    #[test]
    fn comments_are_prose_and_literals_are_not() {
        let text = "//! One.\nlet a = \"// no\"; // Two `code`.\n    /// ```\n    /// code\n    /// ```\n";
        assert_eq!(lines("a.rs", text), [(1, "One.".into(), 8), (2, "Two .".into(), 0)]);
    }

    #[test]
    fn generated_files_have_no_prose() {
        assert_eq!(lines("statecharts/a/src/lib.rs", "// One.\n"), []);
        assert_eq!(lines("a/tests/golden/generated/b.rs", "// One.\n"), []);
    }

    #[test]
    fn paragraphs_are_prose_and_code_blocks_are_not() {
        let text = "# One\n\n```sh\ncode\n```\n\n| a | b |\nsee <https://example.org>\n";
        let found = lines("a.md", text);
        assert_eq!(found.iter().map(|line| (line.0, line.2)).collect::<Vec<_>>(), [(1, 5), (7, 0), (8, 0)]);
    }

    #[test]
    fn other_files_hold_no_prose() {
        assert!(lines("a.xml", "<!-- a -->\n").is_empty());
    }
}
