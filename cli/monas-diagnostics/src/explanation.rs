//! The explanation of one code.

/// Meaning, causes and remedy of a diagnostic code.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Explanation {
    /// The code, such as `E0205`.
    pub code: &'static str,
    /// The fault in a few words.
    pub title: &'static str,
    /// The parts, in their order.
    pub parts: Vec<ExplanationPart>,
}

/// A part of an explanation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ExplanationPart {
    /// A paragraph, with line breaks.
    Paragraph(&'static str),
    /// A file of the example.
    File {
        /// Its name, if the example names it.
        name: Option<&'static str>,
        /// The language of its content, which is the usual ending of its name.
        language: &'static str,
        /// The text.
        text: &'static str,
    },
    /// The commands that report the example, one per line.
    Commands(&'static str),
}

impl Explanation {
    /// Reads a section of a file, without the marks of its heading.
    pub(crate) fn parse(section: &'static str) -> Explanation {
        let (heading, body) = section.split_once('\n').unwrap_or((section, ""));
        let (code, title) = heading.split_once(": ").unwrap_or((heading, ""));
        let (mut parts, mut rest) = (Vec::new(), body.trim());
        while !rest.is_empty() {
            let (part, after) = match rest.strip_prefix("```") {
                Some(block) => {
                    let (header, block) = block.split_once('\n').unwrap_or((block, ""));
                    let (text, after) = block.split_once("```").unwrap_or((block, ""));
                    (block_of(header, text), after)
                }
                None => {
                    let (paragraph, after) = rest.split_once("\n\n").unwrap_or((rest, ""));
                    (ExplanationPart::Paragraph(paragraph), after)
                }
            };
            parts.push(part);
            rest = after.trim_start();
        }
        Explanation { code, title, parts }
    }

    /// The files of the example, each with its name and its text.
    pub fn files(&self) -> impl Iterator<Item = (String, &'static str)> {
        self.parts.iter().filter_map(|part| match *part {
            ExplanationPart::File { name, language, text } => {
                Some((name.map_or_else(|| format!("example.{language}"), str::to_owned), text))
            }
            _ => None,
        })
    }

    /// The commands that report the example, one per line; none if there is no example.
    pub fn command(&self) -> Option<String> {
        let commands = self.parts.iter().find_map(|part| match part {
            ExplanationPart::Commands(lines) => Some(lines.trim_end().to_owned()),
            _ => None,
        });
        commands.or_else(|| {
            let (file, _) = self.files().last()?;
            let is_configuration = file.ends_with(".xml") || file.ends_with(".toml");
            Some(format!("monas {} check {file}", if is_configuration { "config" } else { "model" }))
        })
    }

    /// The explanation for a terminal: paragraphs are wrapped at `width`, blocks are indented.
    pub fn text(&self, width: usize) -> String {
        let mut text = format!("{}: {}\n", self.code, self.title);
        let mut put = |title: &str, lines: &str| {
            text += "\n";
            let lines = lines.lines().map(|line| format!("    {line}").trim_end().to_owned());
            let title = Some(title.to_owned()).filter(|title| !title.is_empty());
            title.into_iter().chain(lines).for_each(|line| text += &format!("{line}\n"));
        };
        let last = self.parts.iter().rposition(|part| matches!(part, ExplanationPart::File { .. }));
        let is_usual = !self.parts.iter().any(|part| matches!(part, ExplanationPart::Commands(_)));
        let mut files = self.files();
        for (index, part) in self.parts.iter().enumerate() {
            match part {
                ExplanationPart::Paragraph(paragraph) => put(&wrapped(paragraph, width), ""),
                ExplanationPart::File { text, .. } => {
                    put(&format!("{}:", files.next().unwrap_or_default().0), text)
                }
                ExplanationPart::Commands(lines) => put("", lines),
            }
            if is_usual && Some(index) == last {
                put("", &self.command().unwrap_or_default());
            }
        }
        text
    }
}

fn block_of(header: &'static str, text: &'static str) -> ExplanationPart {
    match header.split_once(' ') {
        None if header == "sh" => ExplanationPart::Commands(text),
        None => ExplanationPart::File { name: None, language: header, text },
        Some((language, name)) => ExplanationPart::File { name: Some(name), language, text },
    }
}

/// A paragraph in lines of at most `width` characters.
fn wrapped(paragraph: &str, width: usize) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in paragraph.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                *line += &format!(" {word}");
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECTION: &str = "E0001: a test\n\nIt is\na test.\n\n```srm\na = b\n\nc\n```\n\nRemedy: none.\n";

    #[test]
    fn a_section_has_paragraphs_and_files() {
        let found = Explanation::parse(SECTION);
        assert_eq!((found.code, found.title, found.parts.len()), ("E0001", "a test", 3));
        let files: Vec<_> = found.files().collect();
        assert_eq!(files, [("example.srm".to_owned(), "a = b\n\nc\n")]);
        let text = "E0001: a test\n\nIt is a test.\n\nexample.srm:\n    a = b\n\n    c\n\n    \
                    monas model check example.srm\n\nRemedy: none.\n";
        assert_eq!(found.text(80), text);
    }

    #[test]
    fn commands_replace_the_usual_one() {
        let section = "E0001: a test\n\n```xml a.xml\n<a/>\n```\n\n```sh\nmonas run a.xml\n```\n";
        let found = Explanation::parse(section);
        assert_eq!(found.command().as_deref(), Some("monas run a.xml"));
        assert_eq!(found.text(80), "E0001: a test\n\na.xml:\n    <a/>\n\n    monas run a.xml\n");
    }
}
