//! Options of a kind of body: further attributes of `body` in configurations.

use std::fmt;

use crate::{Anatomy, Error, ErrorKind};

/// An option of a kind of body.
#[derive(Clone, Copy, Debug)]
pub struct BodyOption {
    /// The attribute that configurations use.
    pub name: &'static str,
    /// The kind of its values.
    pub kind: OptionKind,
    /// Its meaning, with the default.
    pub doc: &'static str,
}

/// The values of an option.
#[derive(Clone, Copy, Debug)]
pub enum OptionKind {
    /// A non-empty text.
    Text,
    /// Letters, digits, `-` and `_`.
    Name,
    /// One of these words.
    Word(&'static [&'static str]),
    /// An integer from the first to the second.
    Whole(i64, i64),
    /// A number from the first to the second, in the unit that the option documents.
    Number(f64, f64),
    /// `0` or `1`; `false` and `true` mean the same.
    Flag,
    /// A file, which a configuration names relative to its own place.
    File,
    /// A file with a sequence of poses of the joints of this anatomy, named like other files. It is
    /// checked with the configuration.
    Poses(fn() -> &'static Anatomy),
    /// A file in URDF of a robot that is built like this one. It is checked with the configuration.
    Anatomy(fn() -> &'static Anatomy),
}

/// A fault of a body's settings, at one of its attributes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BodyFault {
    /// The attribute.
    pub attribute: &'static str,
    /// The value and what is expected: `` `number` is `0`, expected a whole number from 1 to 99 ``.
    pub message: String,
}

impl BodyFault {
    /// A fault at an attribute.
    pub fn new(attribute: &'static str, message: impl Into<String>) -> BodyFault {
        BodyFault { attribute, message: message.into() }
    }
}

impl fmt::Display for BodyFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<BodyFault> for Error {
    fn from(fault: BodyFault) -> Error {
        Error::new(ErrorKind::Configuration, fault.message)
    }
}

impl BodyOption {
    /// Checks that a text is of the option's kind. The files that it names are not read.
    ///
    /// # Errors
    /// It is not; the fault says what is.
    pub fn check(&self, value: &str) -> Result<(), BodyFault> {
        if self.kind.allows(value) {
            return Ok(());
        }
        let (name, expected) = (self.name, self.kind.expected());
        Err(BodyFault::new(name, format!("`{name}` is `{value}`, expected {expected}")))
    }
}

impl OptionKind {
    /// The words that are possible, for kinds with words.
    pub const fn words(&self) -> &'static [&'static str] {
        match self {
            OptionKind::Word(words) => words,
            _ => &[],
        }
    }

    fn allows(&self, value: &str) -> bool {
        let is_of_name = |letter: u8| letter.is_ascii_alphanumeric() || b"_-".contains(&letter);
        match *self {
            OptionKind::Name => !value.is_empty() && value.bytes().all(is_of_name),
            OptionKind::Word(words) => words.contains(&value),
            OptionKind::Whole(min, max) => value.parse().is_ok_and(|number| (min..=max).contains(&number)),
            OptionKind::Number(min, max) => value.parse().is_ok_and(|number| (min..=max).contains(&number)),
            OptionKind::Flag => matches!(value, "0" | "1" | "false" | "true"),
            OptionKind::Text | OptionKind::File | OptionKind::Poses(_) | OptionKind::Anatomy(_) => {
                !value.is_empty()
            }
        }
    }

    fn expected(&self) -> String {
        match *self {
            OptionKind::Text => "a text".to_owned(),
            OptionKind::Name => "a name of letters, digits, `-` and `_`".to_owned(),
            OptionKind::Word(words) => {
                words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(" or ")
            }
            OptionKind::Whole(min, max) => format!("a whole number from {min} to {max}"),
            OptionKind::Number(min, max) => format!("a number from {min} to {max}"),
            OptionKind::Flag => "`0` or `1`".to_owned(),
            OptionKind::File | OptionKind::Poses(_) | OptionKind::Anatomy(_) => {
                "the path of a file".to_owned()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use super::*;

    fn check(kind: OptionKind, value: &str) -> Result<(), String> {
        BodyOption { name: "it", kind, doc: "" }.check(value).map_err(|fault| fault.to_string())
    }

    #[test]
    fn values_are_of_the_kind_of_the_option_or_refused() {
        static NONE: LazyLock<Anatomy> =
            LazyLock::new(|| Anatomy::new("none", std::time::Duration::from_millis(10)));
        for (kind, right, wrong) in [
            (OptionKind::Text, &["a b", "é"][..], &[""][..]),
            (OptionKind::Name, &["a_b-1"], &["", "a b", "A) (B", "é"]),
            (OptionKind::Word(&["T1", "K1"]), &["T1", "K1"], &["", "t1", "T2", "T1 "]),
            (OptionKind::Whole(1, 99), &["1", "99"], &["", "0", "100", "1.5", "x"]),
            (OptionKind::Number(-1.0, 2.5), &["-1", "2.5", "1e0"], &["", "-1.1", "2.6", "NaN", "inf", "x"]),
            (OptionKind::Flag, &["0", "1", "true", "false"], &["", "2", "yes"]),
            (OptionKind::File, &["walk.toml"], &[""]),
            (OptionKind::Poses(|| &NONE), &["kick.xml"], &[""]),
            (OptionKind::Anatomy(|| &NONE), &["nao.urdf"], &[""]),
        ] {
            for value in right {
                assert_eq!(check(kind, value), Ok(()), "{kind:?}");
            }
            for value in wrong {
                assert!(check(kind, value).is_err(), "{kind:?}: {value}");
            }
        }
    }

    #[test]
    fn a_refusal_names_the_value_and_what_is_allowed() {
        let refusal = |kind, value| check(kind, value).unwrap_err();
        assert_eq!(refusal(OptionKind::Word(&["T1", "K1"]), "T2"), "`it` is `T2`, expected `T1` or `K1`");
        assert_eq!(
            refusal(OptionKind::Whole(1, 99), "0"),
            "`it` is `0`, expected a whole number from 1 to 99"
        );
        assert_eq!(
            refusal(OptionKind::Number(0.5, 2.0), "x"),
            "`it` is `x`, expected a number from 0.5 to 2"
        );
    }
}
