//! Words that plain technical English does without. STYLE.md has the vocabulary.

use super::TidyFinding;
use super::allowances::{Check, Measure};
use super::prose::prose;
use super::workspace::{TextFile, Workspace};

/// Never in prose.
const BANNED: [&str; 22] = [
    "whoever",
    "nobody",
    "somebody",
    "anybody",
    "told",
    "tells",
    "goes by",
    "looks on",
    "makes known",
    "knows of",
    "of ours",
    "in vain",
    "heeds",
    "obeys",
    "goes on forever",
    "go on forever",
    "comes to the same",
    "begins anew",
    "is said to",
    "is said by",
    "are said to",
    "in the making",
];

/// Not at the beginning of a comment, which names its subject: "its kind", not "what it is".
const QUESTION_STARTS: [&str; 2] = ["What ", "Who "];

pub(crate) fn measures(workspace: &Workspace) -> Vec<Measure> {
    Measure::by_owner(workspace, Check::Words, 0, check_file)
}

fn check_file(file: &TextFile) -> Vec<TidyFinding> {
    let is_code = file.path.extension().is_some_and(|extension| extension != "md");
    let mut findings = Vec::new();
    for line in prose(file) {
        if is_code && QUESTION_STARTS.iter().any(|word| line.text.starts_with(word)) {
            let message = "a comment names its subject and does not ask for it";
            findings.push(TidyFinding::new(&file.path, line.number, message));
        }
        findings.extend(banned(&line.text).map(|word| {
            TidyFinding::new(&file.path, line.number, format!("`{word}`: use plain technical English"))
        }));
    }
    findings
}

/// The banned words in a text.
fn banned(text: &str) -> impl Iterator<Item = &'static str> {
    let words: Vec<String> = text.split(|c: char| !c.is_alphanumeric()).map(str::to_lowercase).collect();
    let text = format!(" {} ", words.join(" "));
    BANNED.into_iter().filter(move |word| text.contains(&format!(" {word} ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn banned_words_are_found_with_file_and_line() {
        let text = "// One.\n// A hint for Whoever reads it.\n";
        let found = check_file(&TextFile { path: "a.rs".into(), text: text.into() });
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].to_string(), "a.rs:2: `whoever`: use plain technical English");
    }

    #[test]
    fn comments_that_ask_for_the_thing_are_found() {
        let found =
            |path: &str, text: &str| check_file(&TextFile { path: path.into(), text: text.into() }).len();
        assert_eq!(found("a.rs", "/// What it is.\nstruct A; // The kind: what it is.\n"), 1);
        assert_eq!(found("a.md", "What differs is the order.\n"), 0);
    }

    #[test]
    fn words_are_whole_and_phrases_are_in_order() {
        assert_eq!(banned("it goes by, nobody's").collect::<Vec<_>>(), ["nobody", "goes by"]);
        assert_eq!(banned("extolled; by goes").count(), 0);
    }
}
