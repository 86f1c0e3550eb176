//! Texts of the document: literals and ids.

/// A text as a literal of the language.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::from("'");
    for character in text.chars() {
        match character {
            '\'' => quoted.push_str("\\'"),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\r' => quoted.push_str("\\r"),
            other => quoted.push(other),
        }
    }
    quoted.push('\'');
    quoted
}

/// Whether a text can be the id of a state.
pub(crate) fn is_id(text: &str) -> bool {
    let part = |character: char| character.is_alphanumeric() || "_-.:".contains(character);
    text.starts_with(|first: char| first.is_alphabetic() || first == '_') && text.chars().all(part)
}
