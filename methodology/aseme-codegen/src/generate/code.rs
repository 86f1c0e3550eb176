//! Rust expressions, laid out as rustfmt does.

/// The longest line.
pub(crate) const MAX_LINE_LENGTH: usize = 110;
const INDENT: usize = 4;

/// A Rust expression.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum RustCode {
    /// An expression on one line.
    Plain(String),
    /// `name(arguments)` and what follows it.
    Call { name: String, arguments: Vec<RustCode>, after: String },
    /// A prefix operator and its operand.
    Before(&'static str, Box<RustCode>),
    /// `&[items]`.
    List(Vec<RustCode>),
}

impl RustCode {
    pub(crate) fn plain(text: impl Into<String>) -> RustCode {
        RustCode::Plain(text.into())
    }

    /// `name(arguments)?`.
    pub(crate) fn tried(name: impl Into<String>, arguments: Vec<RustCode>) -> RustCode {
        RustCode::Call { name: name.into(), arguments, after: "?".into() }
    }

    pub(crate) fn call(name: impl Into<String>, arguments: Vec<RustCode>) -> RustCode {
        RustCode::Call { name: name.into(), arguments, after: String::new() }
    }

    /// The expression without its `?`.
    pub(crate) fn untried(self) -> RustCode {
        match self {
            RustCode::Call { name, arguments, after } if after == "?" => RustCode::call(name, arguments),
            other => RustCode::call("Ok", vec![other]),
        }
    }

    /// On one line.
    pub(crate) fn flat(&self) -> String {
        let list = |items: &[RustCode]| items.iter().map(RustCode::flat).collect::<Vec<_>>().join(", ");
        match self {
            RustCode::Plain(text) => text.clone(),
            RustCode::Call { name, arguments, after } => format!("{name}({}){after}", list(arguments)),
            RustCode::Before(sign, code) => format!("{sign}{}", code.flat()),
            RustCode::List(items) => format!("&[{}]", list(items)),
        }
    }

    /// The expression starting at a column, its further lines indented, with room for some
    /// characters after the last.
    pub(crate) fn laid_out(&self, indent: usize, column: usize, room: usize) -> String {
        let flat = self.flat();
        if column + flat.chars().count() + room <= MAX_LINE_LENGTH {
            return flat;
        }
        match self {
            RustCode::Plain(_) => flat,
            RustCode::Before(sign, code) => {
                format!("{sign}{}", code.laid_out(indent, column + sign.len(), room))
            }
            RustCode::List(items) => match items.as_slice() {
                [only] => format!("&[{}]", only.laid_out(indent, column + 2, room + 1)),
                items => format!("&[{}]", broken(items, indent)),
            },
            RustCode::Call { name, arguments, after } => match arguments.as_slice() {
                [only @ (RustCode::Call { .. } | RustCode::Before(..))] => {
                    let begun = column + name.chars().count() + 1;
                    let inner = only.laid_out(indent, begun, room + after.len() + 1);
                    format!("{name}({inner}){after}")
                }
                [only @ RustCode::List(_)] => {
                    let begun = column + name.chars().count() + 1;
                    format!("{name}({}){after}", only.laid_out(indent, begun, room + after.len() + 1))
                }
                arguments => format!("{name}({}){after}", broken(arguments, indent)),
            },
        }
    }

    /// A statement in a function.
    pub(crate) fn statement(&self) -> String {
        format!("    {};\n", self.laid_out(INDENT, INDENT, 1))
    }
}

/// One item a line.
fn broken(items: &[RustCode], indent: usize) -> String {
    let inner = indent + INDENT;
    let line = |item: &RustCode| format!("\n{:inner$}{},", "", item.laid_out(inner, inner, 1));
    format!("{}\n{:indent$}", items.iter().map(line).collect::<String>(), "")
}

/// A string literal.
pub(crate) fn literal(text: &str) -> String {
    format!("{text:?}")
}

/// A text as inline code for a line of documentation.
pub(crate) fn quoted(text: &str) -> String {
    let text = text.replace('\n', " ");
    if text.contains('`') { format!("`` {text} ``") } else { format!("`{text}`") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_calls_have_one_argument_per_line() {
        let long = |letter: &str| RustCode::plain(letter.repeat(60));
        let code = RustCode::call("Ok", vec![RustCode::tried("all!", vec![long("a"), long("b")])]);
        let expected =
            format!("    Ok(all!(\n        {},\n        {},\n    )?);\n", "a".repeat(60), "b".repeat(60));
        assert_eq!(code.statement(), expected);
    }

    #[test]
    fn matching_entries_keep_their_lines() {
        let code = RustCode::Before("!", Box::new(RustCode::tried("holds", vec![RustCode::plain("x")])));
        assert_eq!(code.statement(), "    !holds(x)?;\n");
    }
}
