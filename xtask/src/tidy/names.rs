//! Names of types, functions and constants that docs/vocabulary.md excludes.

use super::TidyFinding;
use super::source::code;
use super::workspace::{TextFile, Workspace};

/// Last words of a type's name. `docs/vocabulary.md` lists them with their replacements.
const TYPE_WORDS: [&str; 12] = [
    "Manager", "Handler", "Helper", "Util", "Info", "Place", "Way", "Desk", "Post", "Crew", "Staff", "Teller",
];

/// Words in the name of a function.
const FUNCTION_WORDS: [&str; 6] = ["obey", "obeys", "heed", "tell", "tells", "told"];

/// Names of constants that do not name a quantity: `MAX_STATES` is not `MOST`.
const CONSTANTS: [&str; 15] = [
    "MOST", "LEAST", "LONGEST", "SHORTEST", "LARGEST", "SMALLEST", "GREATEST", "FEWEST", "FASTEST",
    "SLOWEST", "DEEPEST", "WIDEST", "SOON", "LATE", "PATIENCE",
];

/// Terms of the domain: an activity of the thesis, and a part of the goal.
const ALLOWED: [&str; 2] = ["LedHandler", "GoalPost"];

const KEYWORDS: [&str; 8] = ["fn", "const", "static", "struct", "enum", "trait", "type", "union"];

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    workspace.files.iter().filter(|file| is_checked(file)).flat_map(check_file).collect()
}

/// Names in generated charts come from the formulas.
fn is_checked(file: &TextFile) -> bool {
    file.is_rust() && !file.path.starts_with("statecharts")
}

fn check_file(file: &TextFile) -> Vec<TidyFinding> {
    let code = code(&file.text);
    let mut findings = Vec::new();
    for (index, line) in code.lines().enumerate() {
        for (keyword, name) in declarations(line) {
            let word = match keyword {
                "fn" => function_word(name),
                "const" | "static" => CONSTANTS.into_iter().find(|&word| word == name),
                _ => type_word(name),
            };
            findings.extend(word.map(|word| {
                let message = format!("`{name}`: `{word}` is not used in names, see docs/vocabulary.md");
                TidyFinding::new(&file.path, index + 1, message)
            }));
        }
    }
    findings
}

/// The declarations in a line: keyword and name.
fn declarations(line: &str) -> impl Iterator<Item = (&str, &str)> {
    let words = || line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    words().zip(words().skip(1)).filter(|(keyword, _)| KEYWORDS.contains(keyword))
}

/// The excluded word that a type's name ends with.
fn type_word(name: &str) -> Option<&'static str> {
    let last = name.rfind(char::is_uppercase).map_or(name, |start| &name[start..]);
    TYPE_WORDS.into_iter().find(|&word| word == last).filter(|_| !ALLOWED.contains(&name))
}

/// The excluded word that a function's name contains.
fn function_word(name: &str) -> Option<&'static str> {
    FUNCTION_WORDS.into_iter().find(|&word| name.split('_').any(|part| part == word))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<String> {
        let workspace = Workspace::example(&[(path, text)]);
        check(&workspace).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn excluded_words_end_names_of_types() {
        let text = "struct LogManager;\npub(crate) enum Way {\n    Place,\n}\nstruct Placement(Wayside);\n";
        let end = "is not used in names, see docs/vocabulary.md";
        let expected =
            [format!("a.rs:1: `LogManager`: `Manager` {end}"), format!("a.rs:2: `Way`: `Way` {end}")];
        assert_eq!(found("a.rs", text), expected);
    }

    #[test]
    fn excluded_words_are_parts_of_names_of_functions() {
        let text = "fn tell_all() {}\nfn teller() {}\nfn untold() {}\nlet f = |told| told;\n";
        let end = "is not used in names, see docs/vocabulary.md";
        assert_eq!(found("a.rs", text), [format!("a.rs:1: `tell_all`: `tell` {end}")]);
    }

    #[test]
    fn superlatives_are_not_names_of_constants() {
        let text =
            "const MOST: usize = 3;\nstatic LATE: u8 = 0;\nconst MOST_PLAYED: u8 = 1;\nconst fn most() {}\n";
        let end = "is not used in names, see docs/vocabulary.md";
        let expected = [format!("a.rs:1: `MOST`: `MOST` {end}"), format!("a.rs:2: `LATE`: `LATE` {end}")];
        assert_eq!(found("a.rs", text), expected);
    }

    #[test]
    fn domain_terms_comments_and_generated_charts_are_exempt() {
        assert!(found("a.rs", "struct LedHandler;\nenum GoalPost {}\n// struct Desk;\n").is_empty());
        assert!(found("statecharts/a/src/lib.rs", "fn tell() {}\n").is_empty());
    }

    #[test]
    fn the_vocabulary_lists_every_word() {
        let vocabulary = include_str!("../../../docs/vocabulary.md");
        let (_, avoided) = vocabulary.split_once("## Words that are not used").expect("the section exists");
        let listed: Vec<&str> = avoided.split(|c: char| !c.is_alphanumeric()).collect();
        let inflected = ["obeys", "tells"];
        for word in TYPE_WORDS
            .iter()
            .chain(&FUNCTION_WORDS)
            .chain(&CONSTANTS)
            .filter(|word| !inflected.contains(word))
        {
            assert!(listed.contains(word), "{word}");
        }
    }
}
