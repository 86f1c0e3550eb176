//! Text in a drawing: width, line breaks, display of names.

/// Font size of names, in pixels.
pub(crate) const NAME_SIZE: f64 = 13.0;
/// Font size of all other text, in pixels.
pub(crate) const LABEL_SIZE: f64 = 11.0;
/// Line spacing of labels.
pub(crate) const LABEL_LINE: f64 = 14.0;
/// Line spacing of titles.
pub(crate) const NAME_LINE: f64 = 17.0;

/// Estimated width of a text in a sans-serif font of this size; an upper estimate, since the font
/// is unknown.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(relative_width).sum::<f64>() * size
}

fn relative_width(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | '|' | '!' | '.' | ',' | ':' | ';' | '\'' | ' ' => 0.34,
        'f' | 'r' | 't' | 'I' | '(' | ')' | '[' | ']' | '/' | '-' | '"' => 0.42,
        'm' | 'w' | 'M' | 'W' | '&' | '@' | '%' | '→' => 0.98,
        '=' | '<' | '>' | '+' | '~' => 0.84,
        'A'..='Z' | 'ω' => 0.74,
        _ => 0.63,
    }
}

/// Wraps a text to lines of at most this width, where its words allow.
pub(crate) fn wrap(text: &str, size: f64, max_width: f64) -> Vec<String> {
    fill(text.split_whitespace().map(String::from), size, max_width)
}

/// Wraps a transition expression to lines of at most this width, before `&&`, `||` and `/` if that
/// is sufficient.
pub(crate) fn wrap_condition(text: &str, size: f64, max_width: f64) -> Vec<String> {
    let mut parts: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match parts.last_mut() {
            Some(part) if !matches!(word, "&&" | "||" | "/") => part.extend([" ", word]),
            _ => parts.push(word.into()),
        }
    }
    fill(parts.into_iter(), size, max_width).iter().flat_map(|line| wrap(line, size, max_width)).collect()
}

/// Joins pieces to lines of at most this width; a piece with a leading `/` begins a line.
fn fill(pieces: impl Iterator<Item = String>, size: f64, max_width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for piece in pieces {
        match lines.last_mut() {
            Some(line)
                if !piece.starts_with('/')
                    && width(line, size) + width(&piece, size) + 0.34 * size <= max_width =>
            {
                line.extend([" ", &piece]);
            }
            _ => lines.push(piece),
        }
    }
    lines
}

/// The width of the widest line.
pub(crate) fn widest(lines: &[String], size: f64) -> f64 {
    lines.iter().map(|line| width(line, size)).fold(0.0, f64::max)
}

/// A name as written in a formula: blanks around binary operators, `ω` for forever.
pub(crate) fn formula_text(name: &str) -> String {
    let mut text = String::with_capacity(name.len() + 8);
    let mut rest = name;
    while let Some(character) = rest.chars().next() {
        let (piece, length) = match character {
            '|' if rest.starts_with("||") => (" || ", 2),
            '|' => (" | ", 1),
            '.' => (" . ", 1),
            '~' => ("ω", 1),
            _ => (&rest[..character.len_utf8()], character.len_utf8()),
        };
        text.push_str(piece);
        rest = &rest[length..];
    }
    text
}

/// A text as the content of an XML element.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            _ if character.is_control() => escaped.push(' '),
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_break_before_operators_and_actions() {
        let text = "[alpha && beta && gamma] / StartTimeout(t, 100ms)";
        assert_eq!(
            wrap_condition(text, LABEL_SIZE, 1000.0),
            ["[alpha && beta && gamma]", "/ StartTimeout(t, 100ms)"]
        );
        let narrow = width("[alpha && beta &&", LABEL_SIZE);
        assert_eq!(wrap_condition(text, LABEL_SIZE, narrow)[..2], ["[alpha && beta", "&& gamma]"]);
    }

    #[test]
    fn lines_break_at_words() {
        let lines = wrap("one two three four", LABEL_SIZE, width("one two", LABEL_SIZE) + 0.1);
        assert_eq!(lines, ["one two", "three", "four"]);
        assert!(wrap("  ", LABEL_SIZE, 10.0).is_empty());
    }

    #[test]
    fn names_look_as_in_the_formula() {
        assert_eq!(formula_text("Sensors~||(a.b|c)*"), "Sensorsω || (a . b | c)*");
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("a<b && \"c\"\n"), "a&lt;b &amp;&amp; &quot;c&quot; ");
    }
}
