//! Separates the code of a Rust file from its comments and literals, so that a search finds one
//! only.

/// Replaces comments and the contents of literals by blanks. Lines and columns stay.
pub(crate) fn code(text: &str) -> String {
    split(text).0
}

/// Replaces everything but comments by blanks. Lines and columns stay.
pub(crate) fn comments(text: &str) -> String {
    split(text).1
}

/// The code and the comments of a text, each with the other blanked out.
fn split(text: &str) -> (String, String) {
    let with_capacity = || String::with_capacity(text.len());
    let mut blanker = Blanker { rest: text, code: with_capacity(), comments: with_capacity() };
    while !blanker.rest.is_empty() {
        blanker.item();
    }
    (blanker.code, blanker.comments)
}

/// Blanks out the items under `#[cfg(test)]`, and anything else on their lines.
pub(crate) fn without_tests(code: &str) -> String {
    let mut kept = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(start) = rest.find("#[cfg(test)]") {
        let (before, item) = rest.split_at(start);
        kept.push_str(before);
        let (item, after) = item.split_at(item_length(item));
        kept.extend(item.chars().map(blank));
        rest = after;
    }
    kept + rest
}

/// The length of the item a text starts with: to its semicolon, or to the end of its braces.
fn item_length(text: &str) -> usize {
    let mut depth = 0_usize;
    for (index, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth <= 1 => return index + 1,
            '}' => depth -= 1,
            ';' if depth == 0 => return index + 1,
            _ => {}
        }
    }
    text.len()
}

const fn blank(c: char) -> char {
    if c == '\n' { '\n' } else { ' ' }
}

struct Blanker<'a> {
    rest: &'a str,
    code: String,
    comments: String,
}

impl Blanker<'_> {
    /// Takes one comment, literal, word, or other character.
    fn item(&mut self) {
        match self.rest.as_bytes() {
            [b'/', b'/', ..] => self.comment(self.rest.find('\n').unwrap_or(self.rest.len())),
            [b'/', b'*', ..] => self.comment(block_comment(self.rest)),
            [b'"', ..] => self.literal(0, quoted(self.rest)),
            [b'\'', ..] => match character(self.rest) {
                Some(length) => self.literal(0, length),
                None => self.copy_through(1),
            },
            _ => self.word(),
        }
    }

    /// Takes a word, with the raw literal it may begin, or one character.
    fn word(&mut self) {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let length = self.rest.find(|c| !is_part(c)).unwrap_or(self.rest.len());
        let after = &self.rest[length..];
        let hashes = after.len() - after.trim_start_matches('#').len();
        match &self.rest[..length] {
            "r" | "br" | "cr" if after[hashes..].starts_with('"') => {
                self.literal(length, length + raw(after, hashes))
            }
            "" => self.copy_through(self.rest.chars().next().map_or(0, char::len_utf8)),
            _ => self.copy_through(length),
        }
    }

    fn copy_through(&mut self, length: usize) {
        let (kept, rest) = self.rest.split_at(length);
        self.code.push_str(kept);
        self.comments.extend(kept.chars().map(blank));
        self.rest = rest;
    }

    fn comment(&mut self, length: usize) {
        let (comment, rest) = self.rest.split_at(length);
        self.code.extend(comment.chars().map(blank));
        self.comments.push_str(comment);
        self.rest = rest;
    }

    fn blank(&mut self, length: usize) {
        let (blanked, rest) = self.rest.split_at(length);
        self.code.extend(blanked.chars().map(blank));
        self.comments.extend(blanked.chars().map(blank));
        self.rest = rest;
    }

    /// Takes a literal of `length` bytes whose first `prefix` bytes are a word. The quotes stay, so
    /// that it remains a literal.
    fn literal(&mut self, prefix: usize, length: usize) {
        self.copy_through(prefix);
        let inner = length - prefix;
        if inner < 2 {
            return self.copy_through(inner);
        }
        self.copy_through(1);
        self.blank(inner - 2);
        self.copy_through(1);
    }
}

fn block_comment(text: &str) -> usize {
    let (mut depth, mut index) = (0_usize, 0);
    let bytes = text.as_bytes();
    while index < bytes.len() {
        match bytes[index..] {
            [b'/', b'*', ..] => (depth, index) = (depth + 1, index + 2),
            [b'*', b'/', ..] if depth == 1 => return index + 2,
            [b'*', b'/', ..] => (depth, index) = (depth - 1, index + 2),
            _ => index += 1,
        }
    }
    bytes.len()
}

/// The length of the text in double quotes that `text` starts with.
fn quoted(text: &str) -> usize {
    let mut escaped = false;
    for (index, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return index + 1,
            _ => {}
        }
    }
    text.len()
}

/// The length of a raw literal from its hashes on.
fn raw(text: &str, hashes: usize) -> usize {
    let end = format!("\"{}", &text[..hashes]);
    text[hashes + 1..].find(&end).map_or(text.len(), |found| hashes + 1 + found + end.len())
}

/// The length of the character literal that `text` starts with, or none if it is a lifetime.
fn character(text: &str) -> Option<usize> {
    let mut inner = text.char_indices().skip(1);
    match inner.next()? {
        (_, '\\') => text[3..].find('\'').map(|end| 3 + end + 1),
        _ => inner.next().filter(|&(_, c)| c == '\'').map(|(index, _)| index + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_literals_are_blank_and_code_stays() {
        let cases = [
            ("a // b\nc", "a     \nc"),
            ("a /* b /* c */ d */ e", "a                   e"),
            (r#"f("x // y", z)"#, r#"f("      ", z)"#),
            (r#"f("a\"b")"#, r#"f("    ")"#),
            (r##"r#"a"b"# c"##, "r#     # c"),
            ("'a' 'b '\\n' &'c d", "' ' 'b '  ' &'c d"),
            ("'\"' x", "' ' x"),
        ];
        for (text, expected) in cases {
            assert_eq!(code(text), expected, "{text}");
        }
    }

    #[test]
    fn comments_stay_without_code() {
        let text = "a(\"// b\"); // c\n/* d */ e\n";
        assert_eq!(comments(text), "           // c\n/* d */  \n");
    }

    #[test]
    fn lengths_in_characters_stay() {
        let text = "let ω = \"Ω…\"; // π\n";
        assert_eq!(code(text).chars().count(), text.chars().count());
    }

    #[test]
    fn tests_are_left_out() {
        let text = "fn a() {}\n#[cfg(test)]\nmod tests {\n fn b() { {} }\n}\nfn c() {}\n";
        let kept = without_tests(text);
        assert!(kept.contains("fn a") && kept.contains("fn c") && !kept.contains("fn b"));
        assert_eq!(kept.lines().count(), text.lines().count());
    }

    #[test]
    fn a_test_import_is_one_item() {
        assert_eq!(without_tests("#[cfg(test)] use a::b; fn c() {}").trim(), "fn c() {}");
    }
}
