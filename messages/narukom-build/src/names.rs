//! Rust names of a schema's names: a name that follows the style of its kind is kept.

use crate::error::{Error, ErrorKind};

/// The Rust field of a protobuf field.
pub(crate) fn field_name(name: &str) -> Result<String, Error> {
    let edges = name.starts_with('_') || name.ends_with('_') || name.contains("__");
    let letters = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if edges || !letters { Err(badly_named("field", name, "snake_case")) } else { Ok(identifier(name)) }
}

/// The Rust type of a message or enumeration.
pub(crate) fn type_name(name: &str) -> Result<&str, Error> {
    let letters: Vec<char> = name.chars().filter(|c| !c.is_ascii_digit()).collect();
    let capital = |index: usize| letters.get(index).is_some_and(char::is_ascii_uppercase);
    let small = |index: usize| letters.get(index).is_some_and(char::is_ascii_lowercase);
    let plain = letters.iter().all(char::is_ascii_alphabetic) && name.starts_with(char::is_alphabetic);
    let acronym = (1..letters.len()).any(|index| capital(index - 1) && capital(index) && !small(index + 1));
    if !plain || !capital(0) || acronym || name == "Self" {
        return Err(badly_named("type", name, "UpperCamelCase, with acronyms written as words (Id, Led)"));
    }
    Ok(name)
}

/// Refuses the name of a type of the package that the generated code would take for Rust's.
pub(crate) fn check_shadowing(name: &str) -> Result<(), Error> {
    match ["Into", "Option", "Result"].contains(&name) {
        true => {
            let text =
                format!("the type `{name}` cannot have the name of a type of Rust that generated code uses");
            Err(Error::new(ErrorKind::Name, text))
        }
        false => Ok(()),
    }
}

/// The Rust module that holds the types nested in a message.
pub(crate) fn module_name(message: &str) -> String {
    let mut module = String::new();
    let mut before = None::<char>;
    let mut letters = message.chars().peekable();
    while let Some(c) = letters.next() {
        let next_is_small = letters.peek().is_some_and(char::is_ascii_lowercase);
        let ends_word = before.is_some_and(|before| before.is_ascii_lowercase() || next_is_small);
        if c.is_ascii_uppercase() && ends_word {
            module.push('_');
        }
        if !c.is_ascii_digit() {
            before = Some(c);
        }
        module.push(c.to_ascii_lowercase());
    }
    identifier(&module)
}

/// `name`, as a raw identifier if it is a keyword.
pub(crate) fn identifier(name: &str) -> String {
    match name {
        "super" | "self" | "extern" | "crate" => format!("{name}_"),
        _ if KEYWORDS.contains(&name) => format!("r#{name}"),
        _ if name.starts_with(|c: char| c.is_ascii_digit()) => format!("_{name}"),
        _ => name.to_owned(),
    }
}

fn badly_named(what: &str, name: &str, style: &str) -> Error {
    Error::new(ErrorKind::Name, format!("the {what} `{name}` is not named in {style}"))
}

/// The keywords of the Rust Reference that are allowed as raw identifiers.
const KEYWORDS: [&str; 47] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "do", "dyn", "else",
    "enum", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "override", "priv", "pub", "ref", "return", "static", "struct", "trait", "true", "try",
    "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_keep_their_names() {
        assert_eq!(field_name("head_yaw").unwrap(), "head_yaw");
        assert_eq!(field_name("x1").unwrap(), "x1");
        assert_eq!(field_name("type").unwrap(), "r#type");
        assert_eq!(field_name("self").unwrap(), "self_");
        for name in ["headYaw", "_x", "x_", "a__b", "X"] {
            assert_eq!(field_name(name).unwrap_err().kind(), ErrorKind::Name, "{name}");
        }
    }

    #[test]
    fn types_keep_their_names() {
        for name in ["Ball", "HeadJoints", "XMark", "Vector3", "Vector3D", "A"] {
            assert_eq!(type_name(name).unwrap(), name);
        }
        for name in ["ball", "RobotID", "LEDState", "Head_Joints", "Self", "A1B", "3D"] {
            assert_eq!(type_name(name).unwrap_err().kind(), ErrorKind::Name, "{name}");
        }
    }

    #[test]
    fn modules_are_the_messages_in_snake_case() {
        assert_eq!(module_name("Ball"), "ball");
        assert_eq!(module_name("HeadJoints"), "head_joints");
        assert_eq!(module_name("XMark"), "x_mark");
        assert_eq!(module_name("Vector3D"), "vector3_d");
        assert_eq!(module_name("Match"), "r#match");
    }
}
