//! The rule books, and the tables of what their packets call by number.

use std::fmt;

use crate::{Error, ErrorKind};

/// A rule book of the league, which determines the version of the control data.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RuleBook {
    /// Standard Platform League, version 18.
    StandardPlatform,
    /// Humanoid Soccer League, version 19.
    HumanoidSoccer,
}

impl RuleBook {
    /// All rule books.
    pub const ALL: [RuleBook; 2] = [RuleBook::StandardPlatform, RuleBook::HumanoidSoccer];

    /// The version byte of control data.
    pub fn version(self) -> u8 {
        match self {
            RuleBook::StandardPlatform => 18,
            RuleBook::HumanoidSoccer => 19,
        }
    }

    /// The length of control data in bytes.
    pub fn packet_length(self) -> usize {
        match self {
            RuleBook::StandardPlatform => 118,
            RuleBook::HumanoidSoccer => 198,
        }
    }
}

impl fmt::Display for RuleBook {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RuleBook::StandardPlatform => "Standard Platform League (version 18)",
            RuleBook::HumanoidSoccer => "Humanoid Soccer League (version 19)",
        })
    }
}

/// A value with its name in the league and its number in version 18 and in version 19.
pub(crate) type Code<T> = (T, &'static str, Option<u8>, Option<u8>);

fn number<T>(code: &Code<T>, rules: RuleBook) -> Option<u8> {
    match rules {
        RuleBook::StandardPlatform => code.2,
        RuleBook::HumanoidSoccer => code.3,
    }
}

/// The value with a number.
pub(crate) fn decode<T: Copy>(codes: &[Code<T>], field: &str, rules: RuleBook, byte: u8) -> Result<T, Error> {
    let found = codes.iter().find(|code| number(code, rules) == Some(byte));
    let unknown = || {
        Error::new(ErrorKind::Value, format!("{field} {byte} is not defined in version {}", rules.version()))
    };
    found.map(|code| code.0).ok_or_else(unknown)
}

/// The number of a value.
pub(crate) fn encode<T: Copy + PartialEq>(
    codes: &[Code<T>],
    field: &str,
    rules: RuleBook,
    value: T,
) -> Result<u8, Error> {
    let code = codes.iter().find(|code| code.0 == value);
    let missing = || {
        let message = format!("version {} has no {field} `{}`", rules.version(), name(codes, value));
        Error::new(ErrorKind::Value, message)
    };
    code.and_then(|code| number(code, rules)).ok_or_else(missing)
}

/// The name of a value.
pub(crate) fn name<T: Copy + PartialEq>(codes: &[Code<T>], value: T) -> &'static str {
    codes.iter().find(|code| code.0 == value).map_or("", |code| code.1)
}

/// Defines an enum with the name and the numbers of each value.
macro_rules! codes {
    ($(#[$about:meta])* $kind:ident, $field:literal:
     $($(#[$doc:meta])* $variant:ident $name:literal $v18:expr, $v19:expr;)+) => {
        $(#[$about])*
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        pub enum $kind { $($(#[$doc])* $variant,)+ }

        impl $kind {
            const CODES: &[$crate::rule_book::Code<$kind>] = &[$(($kind::$variant, $name, $v18, $v19),)+];

            /// All values, of both rule books.
            pub fn all() -> impl Iterator<Item = $kind> {
                Self::CODES.iter().map(|code| code.0)
            }

            /// The value with a number in a rule book.
            pub(crate) fn decode(rules: $crate::RuleBook, byte: u8) -> Result<$kind, $crate::Error> {
                $crate::rule_book::decode(Self::CODES, $field, rules, byte)
            }

            /// The number of the value in a rule book.
            ///
            /// # Errors
            /// The rule book does not define it.
            pub fn number(self, rules: $crate::RuleBook) -> Result<u8, $crate::Error> {
                $crate::rule_book::encode(Self::CODES, $field, rules, self)
            }
        }

        impl std::fmt::Display for $kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str($crate::rule_book::name(Self::CODES, *self))
            }
        }
    };
}
pub(crate) use codes;
