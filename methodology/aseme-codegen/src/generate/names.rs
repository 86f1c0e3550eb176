//! Mapping between paths of states and Rust identifiers, in both directions.
//!
//! Letters, digits and inner underscores are kept. Every other character becomes a word between
//! double underscores: `Stand` is `Stand`, `RobotController~` is `RobotController__ever__`, and the
//! START in `active` is `START__of__active`.

/// The words for characters; longer sequences first.
const WORDS: [(&str, &str); 13] = [
    ("||", "par"),
    ("|", "or"),
    (".", "then"),
    ("~", "ever"),
    ("*", "any"),
    ("+", "more"),
    ("(", "open"),
    (")", "close"),
    ("[", "opt"),
    ("]", "end"),
    (" ", "blank"),
    ("-", "dash"),
    ("/", "slash"),
];

/// Separates the segments of a path; also a segment without characters.
const SEPARATOR: &str = "of";
const EMPTY: &str = "empty";

/// The identifier of a path, whose segments are given from the innermost outwards. The mapping is
/// injective; [`path_of`] inverts it.
pub fn identifier(path: &[&str]) -> String {
    let segments: Vec<String> = path.iter().map(|segment| encoded(segment)).collect();
    let text = segments.join(&format!("__{SEPARATOR}__"));
    let starts_badly = text.starts_with(|first: char| first.is_ascii_digit());
    match text.chars().next() {
        Some(first) if starts_badly || KEYWORDS.contains(&text.as_str()) => {
            format!("{}{}", by_number(first), &text[first.len_utf8()..])
        }
        _ => text,
    }
}

/// The path of an identifier, from the innermost segment outwards; `None` if no path has it.
pub fn path_of(identifier: &str) -> Option<Vec<String>> {
    let mut path = vec![String::new()];
    let mut rest = identifier;
    while let Some(at) = rest.find("__") {
        let (word, after) = rest[at + 2..].split_once("__")?;
        let segment = path.last_mut()?;
        segment.push_str(&rest[..at]);
        match word {
            SEPARATOR => path.push(String::new()),
            EMPTY => {}
            word => segment.push_str(&decoded(word)?),
        }
        rest = after;
    }
    path.last_mut()?.push_str(rest);
    let segments: Vec<&str> = path.iter().map(String::as_str).collect();
    (self::identifier(&segments) == identifier).then_some(path)
}

fn encoded(segment: &str) -> String {
    if segment.is_empty() {
        return format!("__{EMPTY}__");
    }
    let mut text = String::new();
    let mut rest = segment;
    while let Some(first) = rest.chars().next() {
        let before = segment[..segment.len() - rest.len()].chars().next_back();
        let after = rest[first.len_utf8()..].chars().next();
        let is_plain = |c: Option<char>| c.is_some_and(|c| c.is_ascii_alphanumeric());
        let word = WORDS.iter().find(|(characters, _)| rest.starts_with(characters));
        let length = match (first, word) {
            ('_', _) if is_plain(before) && is_plain(after) => {
                text.push('_');
                1
            }
            (_, Some((characters, word))) => {
                text.push_str(&format!("__{word}__"));
                characters.len()
            }
            _ if first.is_ascii_alphanumeric() => {
                text.push(first);
                1
            }
            _ => {
                text.push_str(&by_number(first));
                first.len_utf8()
            }
        };
        rest = &rest[length..];
    }
    text
}

fn by_number(character: char) -> String {
    format!("__u{:x}__", u32::from(character))
}

fn decoded(word: &str) -> Option<String> {
    if let Some((characters, _)) = WORDS.iter().find(|(_, known)| *known == word) {
        return Some((*characters).to_owned());
    }
    let number = u32::from_str_radix(word.strip_prefix('u')?, 16).ok()?;
    char::from_u32(number).map(String::from)
}

/// The keywords of all editions, which are not identifiers.
const KEYWORDS: [&str; 54] = [
    "Self", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do",
    "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "union", "unsafe", "unsized", "use",
    "virtual", "where", "while", "yield", "raw",
];

/// A path from the root of all crates. Paths within the crate and single names stay as they are.
pub(crate) fn absolute(path: &str) -> String {
    match path.split_once("::") {
        Some(("" | "crate" | "self" | "super" | "Self" | "$crate", _)) | None => path.to_owned(),
        Some(_) => format!("::{path}"),
    }
}

/// The field of a message in Rust, as prost calls it.
pub(crate) fn field(name: &str) -> String {
    match name {
        "super" | "self" | "extern" | "crate" => format!("{name}_"),
        "union" | "raw" => name.to_owned(),
        name if KEYWORDS.contains(&name) => format!("r#{name}"),
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_stay() {
        for name in ["Stand", "take_action2", "x"] {
            assert_eq!(identifier(&[name]), name);
        }
    }

    #[test]
    fn everything_else_is_spelt_out() {
        let cases: [(&[&str], &str); 8] = [
            (&["RobotController~"], "RobotController__ever__"),
            (&["START", "active"], "START__of__active"),
            (&["A||B|C"], "A__par__B__or__C"),
            (&["2"], "__u32__"),
            (&["type"], "__u74__ype"),
            (&["_a_"], "__u5f__a__u5f__"),
            (&[""], "__empty__"),
            (&["a/b", "ω"], "a__slash__b__of____u3c9__"),
        ];
        for (path, expected) in cases {
            assert_eq!(identifier(path), expected);
            assert_eq!(path_of(expected).unwrap(), path);
        }
    }

    #[test]
    fn identifiers_of_no_path_are_rejected() {
        for text in ["a__", "a__b", "a__never__", "__u61__", "a__uffffffff__b", "type", "2"] {
            assert_eq!(path_of(text), None, "{text}");
        }
    }
}
