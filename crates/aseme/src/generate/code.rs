//! Rust expressions, laid out as rustfmt does.

/// The longest line.
pub(super) const WIDTH: usize = 110;
const INDENT: usize = 4;

/// A piece of Rust.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Code {
    /// What stands on one line.
    Plain(String),
    /// `name(arguments)` and what follows it.
    Call { name: String, arguments: Vec<Code>, after: String },
    /// `!` and its like before something.
    Before(&'static str, Box<Code>),
    /// `&[items]`.
    List(Vec<Code>),
}

impl Code {
    pub(super) fn plain(text: impl Into<String>) -> Code {
        Code::Plain(text.into())
    }

    /// `name(arguments)?`.
    pub(super) fn tried(name: impl Into<String>, arguments: Vec<Code>) -> Code {
        Code::Call { name: name.into(), arguments, after: "?".into() }
    }

    pub(super) fn call(name: impl Into<String>, arguments: Vec<Code>) -> Code {
        Code::Call { name: name.into(), arguments, after: String::new() }
    }

    /// The result that `?` would have opened.
    pub(super) fn untried(self) -> Code {
        match self {
            Code::Call { name, arguments, after } if after == "?" => Code::call(name, arguments),
            other => Code::call("Ok", vec![other]),
        }
    }

    /// On one line.
    pub(super) fn flat(&self) -> String {
        let list = |items: &[Code]| items.iter().map(Code::flat).collect::<Vec<_>>().join(", ");
        match self {
            Code::Plain(text) => text.clone(),
            Code::Call { name, arguments, after } => format!("{name}({}){after}", list(arguments)),
            Code::Before(sign, code) => format!("{sign}{}", code.flat()),
            Code::List(items) => format!("&[{}]", list(items)),
        }
    }

    /// From a column on, in lines that are indented by so much, with room for so many more characters at the end of the last.
    pub(super) fn laid_out(&self, indent: usize, column: usize, room: usize) -> String {
        let flat = self.flat();
        if column + flat.chars().count() + room <= WIDTH {
            return flat;
        }
        match self {
            Code::Plain(_) => flat,
            Code::Before(sign, code) => format!("{sign}{}", code.laid_out(indent, column + sign.len(), room)),
            Code::List(items) => match items.as_slice() {
                [only] => format!("&[{}]", only.laid_out(indent, column + 2, room + 1)),
                items => format!("&[{}]", broken(items, indent)),
            },
            Code::Call { name, arguments, after } => match arguments.as_slice() {
                [only @ (Code::Call { .. } | Code::Before(..))] => {
                    let begun = column + name.chars().count() + 1;
                    let inner = only.laid_out(indent, begun, room + after.len() + 1);
                    format!("{name}({inner}){after}")
                }
                [only @ Code::List(_)] => {
                    let begun = column + name.chars().count() + 1;
                    format!("{name}({}){after}", only.laid_out(indent, begun, room + after.len() + 1))
                }
                arguments => format!("{name}({}){after}", broken(arguments, indent)),
            },
        }
    }

    /// A statement in a function.
    pub(super) fn statement(&self) -> String {
        format!("    {};\n", self.laid_out(INDENT, INDENT, 1))
    }
}

/// One item a line.
fn broken(items: &[Code], indent: usize) -> String {
    let inner = indent + INDENT;
    let line = |item: &Code| format!("\n{:inner$}{},", "", item.laid_out(inner, inner, 1));
    format!("{}\n{:indent$}", items.iter().map(line).collect::<String>(), "")
}

/// A text as Rust writes it.
pub(super) fn literal(text: &str) -> String {
    format!("{text:?}")
}

/// What fits into a line of documentation, in the font of code.
pub(super) fn quoted(text: &str) -> String {
    let text = text.replace('\n', " ");
    if text.contains('`') { format!("`` {text} ``") } else { format!("`{text}`") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_long_has_an_argument_a_line() {
        let long = |letter: &str| Code::plain(letter.repeat(60));
        let code = Code::call("Ok", vec![Code::tried("all!", vec![long("a"), long("b")])]);
        let expected =
            format!("    Ok(all!(\n        {},\n        {},\n    )?);\n", "a".repeat(60), "b".repeat(60));
        assert_eq!(code.statement(), expected);
    }

    #[test]
    fn what_fits_stays_on_its_line() {
        let code = Code::Before("!", Box::new(Code::tried("holds", vec![Code::plain("x")])));
        assert_eq!(code.statement(), "    !holds(x)?;\n");
    }
}
