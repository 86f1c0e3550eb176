//! Kinds of values.

use std::str::FromStr;
use std::time::Duration;

use super::super::element::listed;

/// Kind of an attribute's value or an element's text.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum Kind {
    /// A boolean: `1`, `0`, `true` or `false`.
    Flag,
    /// An integer within these limits.
    Whole {
        /// The minimum.
        min: i64,
        /// The maximum.
        max: i64,
    },
    /// A finite number within these limits.
    Number {
        /// The minimum.
        min: f64,
        /// The maximum.
        max: f64,
    },
    /// A duration with its unit: `300s`, `100ms` or `10min`.
    Duration {
        /// The minimum.
        min: Duration,
    },
    /// One of these words.
    Word(Vec<&'static str>),
    /// A name of letters, digits, `_` and `-`.
    Name,
    /// The path of a file, relative to the folder of the configuration or a parent of it.
    File,
    /// Several words separated by spaces; TOML also allows an array.
    List,
    /// Any text.
    Text,
}

impl Kind {
    /// Any integer.
    pub const fn whole() -> Kind {
        Kind::Whole { min: i32::MIN as i64, max: i32::MAX as i64 }
    }

    /// An integer with a minimum.
    pub const fn whole_from(min: i64) -> Kind {
        Kind::Whole { min, max: u32::MAX as i64 }
    }

    /// An integer in a range.
    pub const fn whole_in(min: i64, max: i64) -> Kind {
        Kind::Whole { min, max }
    }

    /// A number with a minimum.
    pub const fn number_from(min: f64) -> Kind {
        Kind::Number { min, max: f64::MAX }
    }

    /// A number in a range.
    pub const fn number_in(min: f64, max: f64) -> Kind {
        Kind::Number { min, max }
    }

    /// Whether a text is a value of this kind.
    pub fn allows(&self, text: &str) -> bool {
        let text = text.trim();
        match self {
            Kind::Flag => flag(text).is_some(),
            Kind::Whole { min, max } => {
                i64::from_str(text).is_ok_and(|number| (*min..=*max).contains(&number))
            }
            Kind::Number { min, max } => {
                f64::from_str(text).is_ok_and(|number| (*min..=*max).contains(&number))
            }
            Kind::Duration { min } => crate::duration(text).is_some_and(|length| length >= *min),
            Kind::Word(words) => words.contains(&text),
            Kind::Name => {
                !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
            }
            Kind::File => !text.is_empty(),
            Kind::List | Kind::Text => true,
        }
    }

    /// The expected value, in prose.
    pub fn expected(&self) -> String {
        match self {
            Kind::Flag => format!("one of {}", listed(&FLAGS.map(|(word, _)| word))),
            Kind::Whole { min, max } => match (*min, *max) {
                (min, max) if min <= i32::MIN.into() && max >= i32::MAX.into() => "a whole number".into(),
                (min, max) if max >= u32::MAX.into() => format!("a whole number from {min}"),
                (min, max) if min <= i32::MIN.into() => format!("a whole number of at most {max}"),
                (min, max) => format!("a whole number from {min} to {max}"),
            },
            Kind::Number { min: f64::MIN, max: f64::MAX } => "a number".into(),
            Kind::Number { min, max: f64::MAX } => format!("a number of at least {min}"),
            Kind::Number { min, max } => format!("a number from {min} to {max}"),
            Kind::Duration { min: Duration::ZERO } => "a time such as `300s` or `100ms`".into(),
            Kind::Duration { min } => {
                let example = Duration::from_millis(200).max(*min * 2);
                format!("a time of at least `{min:?}`, such as `{example:?}`")
            }
            Kind::Word(words) => format!("one of {}", listed(words)),
            Kind::Name => "a name of letters, digits, `_` and `-`".into(),
            Kind::File => "the path of a file".into(),
            Kind::List => "words separated by blanks".into(),
            Kind::Text => "a text".into(),
        }
    }

    /// The nearest allowed word, for kinds with words.
    pub(crate) fn nearest(&self, text: &str) -> Option<String> {
        let Kind::Word(words) = self else { return None };
        let near = yase::diagnostic::nearest(text, words.iter().copied());
        near.map(|word| format!("did you mean `{word}`?"))
    }
}

const FLAGS: [(&str, bool); 4] = [("1", true), ("0", false), ("true", true), ("false", false)];

/// Parses a boolean: `1`, `0`, `true` or `false`.
pub(crate) fn flag(text: &str) -> Option<bool> {
    FLAGS.iter().find(|(word, _)| *word == text).map(|(_, value)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_allowed_or_not() {
        let tick = Kind::Duration { min: Duration::from_millis(1) };
        for (kind, right, wrong) in [
            (Kind::Flag, &["1", "0", "true", "false", " 1 "][..], &["yes", "2", ""][..]),
            (Kind::whole_in(1, 7), &["1", "7"], &["0", "8", "1.5", "one", ""]),
            (Kind::number_in(0.5, 2.0), &["0.5", "2", "1e0"], &["0.4", "NaN", "inf", "x"]),
            (tick, &["1ms", " 2s ", "1.5min", "1.5h"], &["1", "999us", "-1s", "ms", "1e3s"]),
            (Kind::Word(vec!["left", "right"]), &["left"], &["up", "Left"]),
            (Kind::Name, &["robot_2", "a-b"], &["", "a b", "a/b"]),
            (Kind::File, &["a.xml"], &["", " "]),
            (Kind::Text, &["", "anything"], &[]),
        ] {
            assert!(right.iter().all(|text| kind.allows(text)), "{kind:?}");
            assert!(!wrong.iter().any(|text| kind.allows(text)), "{kind:?}");
        }
    }

    #[test]
    fn expectations_are_described() {
        assert_eq!(Kind::whole().expected(), "a whole number");
        assert_eq!(Kind::whole_from(1).expected(), "a whole number from 1");
        assert_eq!(Kind::whole_in(1, 7).expected(), "a whole number from 1 to 7");
        assert_eq!(Kind::whole_in(i64::from(i32::MIN), 4).expected(), "a whole number of at most 4");
        assert_eq!(Kind::number_from(2.0).expected(), "a number of at least 2");
        assert_eq!(Kind::Word(vec!["a", "b"]).nearest("a"), Some("did you mean `a`?".into()));
    }
}
