//! Numbers that a configuration file can set by name.
//!
//! [`FieldGeometry`](crate::FieldGeometry), [`Physics`](crate::Physics) and
//! [`MatchRules`](crate::MatchRules) are plain structs of numbers. The macro of this module
//! generates, from the fields, the table through which configuration files set them by name and
//! users list them. The doc comment of a field documents both, so that they cannot differ.

/// One number of a parameter struct, as its `keys()` lists it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// The name, in snake case: the field of the struct and the key in a file.
    pub key: &'static str,
    /// The unit of the value, such as `m` or `1/s`.
    pub unit: &'static str,
    /// The value unless it is set.
    pub default: f64,
    /// The least value allowed.
    pub min: f64,
    /// The greatest value allowed.
    pub max: f64,
    /// Its meaning and the source of the value.
    pub doc: &'static str,
}

impl Parameter {
    /// Whether `value` is finite and inside the range.
    pub fn allows(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

/// Defines a struct of `f64` with a documented, ranged default for each, and access to them by
/// name.
macro_rules! parameters {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $( $(#[doc = $doc:literal])+ $field:ident : $unit:literal = $default:literal in $min:literal to $max:literal; )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $name {
            $( $(#[doc = $doc])+ #[doc = concat!("\nUnit: ", $unit, ". Default: ", stringify!($default), ".")]
               pub $field: f64, )+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $field: $default, )+ }
            }
        }

        impl $name {
            const KEYS: &'static [$crate::Parameter] = &[ $( $crate::Parameter {
                key: stringify!($field),
                unit: $unit,
                default: $default,
                min: $min,
                max: $max,
                doc: concat!($($doc),+).trim_ascii(),
            }, )+ ];

            /// Every parameter, in the order of the fields.
            pub fn keys() -> &'static [$crate::Parameter] {
                Self::KEYS
            }

            /// The value of the parameter named `key`.
            pub fn get(&self, key: &str) -> Option<f64> {
                match key {
                    $( stringify!($field) => Some(self.$field), )+
                    _ => None,
                }
            }

            /// Sets the parameter named `key`.
            ///
            /// # Errors
            /// [`UnknownParameter`](crate::ErrorKind::UnknownParameter) when there is none of this
            /// name, [`OutOfRange`](crate::ErrorKind::OutOfRange) when the value is not finite or
            /// not allowed.
            pub fn set(&mut self, key: &str, value: f64) -> Result<(), $crate::Error> {
                let unknown = || $crate::Error::unknown_parameter(stringify!($name), key);
                let parameter = Self::KEYS.iter().find(|parameter| parameter.key == key).ok_or_else(unknown)?;
                Self::check(parameter, value)?;
                match key {
                    $( stringify!($field) => self.$field = value, )+
                    _ => return Err(unknown()),
                }
                Ok(())
            }

            /// Checks the range of every field, for structs that were filled field by field.
            fn check_ranges(&self) -> Result<(), $crate::Error> {
                Self::KEYS.iter().zip([ $( self.$field, )+ ]).try_for_each(|(parameter, value)| Self::check(parameter, value))
            }

            fn check(parameter: &$crate::Parameter, value: f64) -> Result<(), $crate::Error> {
                if parameter.allows(value) {
                    return Ok(());
                }
                Err($crate::Error::out_of_range(parameter.key, value, parameter.min, parameter.max, parameter.unit))
            }
        }
    };
}
pub(crate) use parameters;
