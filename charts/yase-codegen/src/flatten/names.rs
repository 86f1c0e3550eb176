//! Rust identifiers for texts.

use std::collections::BTreeSet;

/// Operators, longer ones first, and their words.
const OPERATORS: [(&str, &str); 15] = [
    ("&&", "and"),
    ("||", "or"),
    ("==", "equals"),
    ("!=", "differs_from"),
    ("<=", "at_most"),
    (">=", "at_least"),
    ("<", "below"),
    (">", "above"),
    ("=", "becomes"),
    ("!", "not"),
    ("+", "plus"),
    ("-", "minus"),
    ("*", "times"),
    ("/", "over"),
    ("%", "percent"),
];

/// Reserved words of all editions.
const KEYWORDS: &str = "abstract as async await become box break const continue crate do dyn else enum extern false final fn for gen if impl \
in let loop macro match mod move mut override priv pub ref return self static struct super trait true try type typeof unsafe unsized use \
virtual where while yield";

/// Unique identifiers.
#[derive(Default)]
pub(crate) struct UniqueNames {
    taken: BTreeSet<String>,
}

impl UniqueNames {
    /// The method name of a text: its words joined by underscores.
    pub(crate) fn method(&mut self, text: &str) -> String {
        let name = words(text, &OPERATORS)
            .iter()
            .map(|word| word.to_ascii_lowercase())
            .collect::<Vec<_>>()
            .join("_");
        let name = if KEYWORDS.split(' ').any(|keyword| keyword == name) { format!("{name}_") } else { name };
        self.unique(&in_order(name, "n"), "_")
    }

    /// The variant name of a text: its capitalised words.
    pub(crate) fn variant(&mut self, text: &str) -> String {
        let name: String = words(text, &[]).iter().map(|word| capitalized(word)).collect();
        let name = if name == "Self" { String::from("Self_") } else { name };
        self.unique(&in_order(name, "N"), "V")
    }

    fn unique(&mut self, name: &str, between: &str) -> String {
        let others = (2..).map(|number: u32| format!("{name}{between}{number}"));
        let mut all = std::iter::once(name.to_owned()).chain(others);
        let free = all.find(|name| !self.taken.contains(name)).unwrap_or_default();
        self.taken.insert(free.clone());
        free
    }
}

/// Ensures that an identifier begins with a letter.
fn in_order(name: String, letter: &str) -> String {
    match name.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => name,
        _ => format!("{letter}{name}"),
    }
}

/// The words of a text: sequences of letters and digits. A capital after a small letter begins a
/// new word, and operators are replaced by words.
fn words(text: &str, operators: &[(&str, &str)]) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let operator = operators.iter().find(|(sign, _)| rest.starts_with(sign));
        if let Some((sign, said)) = operator {
            words.extend([(*said).to_owned(), String::new()]);
            rest = &rest[sign.len()..];
            continue;
        }
        let begins = first.is_ascii_uppercase()
            && words
                .last()
                .and_then(|word| word.chars().last())
                .is_some_and(|last| last.is_ascii_lowercase());
        if begins || !first.is_ascii_alphanumeric() {
            words.push(String::new());
        }
        if let (true, Some(word)) = (first.is_ascii_alphanumeric(), words.last_mut()) {
            word.push(first);
        }
        rest = &rest[first.len_utf8()..];
    }
    words.retain(|word| !word.is_empty());
    words
}

fn capitalized(word: &str) -> String {
    word.split('_')
        .map(|part| {
            let mut letters = part.chars();
            letters
                .next()
                .map_or_else(String::new, |first| first.to_ascii_uppercase().to_string() + letters.as_str())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_become_names_that_say_what_they_say() {
        let mut names = UniqueNames::default();
        let cases = [
            ("Ball.found && !(Ball.distance < 0.25)", "ball_found_and_not_ball_distance_below_0_25"),
            ("Goal.mine = true", "goal_mine_becomes_true"),
            ("kickOff", "kick_off"),
            ("kick off", "kick_off_2"),
            ("match", "match_"),
            ("42", "n42"),
            ("ü", "n"),
            ("", "n_2"),
        ];
        for (text, name) in cases {
            assert_eq!(names.method(text), name);
        }
    }

    #[test]
    fn variants_have_capitals() {
        let mut names = UniqueNames::default();
        let cases = [
            ("look", "Look"),
            ("both/one/s0", "BothOneS0"),
            ("self", "Self_"),
            ("look", "LookV2"),
            ("1.2", "N12"),
            ("kick-off", "KickOff"),
        ];
        for (text, name) in cases {
            assert_eq!(names.variant(text), name);
        }
    }
}
