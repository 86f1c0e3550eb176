//! Parameters of motions, and their files.

use toml::de::{DeTable, DeValue};

/// Defines the parameters of a motion from one list: name, range and meaning. The first line names
/// the field of [`Humanoid`](crate::Humanoid) with the file that the project brings.
macro_rules! parameters {
    ($(#[$doc:meta])* $type:ident, $own:ident; $($name:ident: $low:expr, $high:expr, $meaning:literal;)*) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Debug, Default)]
        pub struct $type {
            $(#[doc = $meaning] pub $name: f64,)*
        }

        impl $type {
            /// Name, least and greatest value, and meaning of each parameter.
            const ROWS: &[crate::parameters::Row] = &[$((stringify!($name), $low, $high, $meaning)),*];

            /// The parameters that the project brings for a robot.
            ///
            /// # Errors
            /// None, unless its file was changed to one without meaning.
            pub fn own(robot: &crate::Humanoid) -> Result<$type, crate::Error> {
                $type::parse(robot.$own).map_err(crate::Error::configuration)
            }

            /// Reads a file of parameters. All of them have to be there.
            ///
            /// # Errors
            /// The file cannot be read, a parameter is missing, unknown, or out of its range.
            pub fn load(path: &std::path::Path) -> Result<$type, crate::Error> {
                let named = |what: String| {
                    crate::Error::configuration(format!("the parameters {}: {what}", path.display()))
                };
                let text = std::fs::read_to_string(path).map_err(|error| named(error.to_string()))?;
                $type::parse(&text).map_err(named)
            }

            /// Sets a parameter by its name, clamped to its range. Returns whether there is such a
            /// one.
            pub fn set(&mut self, name: &str, value: f64) -> bool {
                let Some((_, min, max, _)) = $type::ROWS.iter().find(|row| row.0 == name) else {
                    return false;
                };
                let value = value.clamp(*min, *max);
                match name {
                    $(stringify!($name) => self.$name = value,)*
                    _ => return false,
                }
                true
            }

            /// The text of a file with these parameters and their meanings.
            pub fn to_toml(&self) -> String {
                let line = |name: &str, value: f64, meaning: &str| {
                    format!("{:<28}# {meaning}\n", format!("{name} = {value:?}"))
                };
                [$(line(stringify!($name), self.$name, $meaning)),*].concat()
            }

            fn parse(text: &str) -> Result<$type, String> {
                let mut parameters = $type::default();
                crate::parameters::read(text, $type::ROWS, |name, value| {
                    parameters.set(name, value);
                })?;
                Ok(parameters)
            }
        }
    };
}

pub(crate) use parameters;

/// Name, least and greatest value, and meaning of a parameter.
pub(crate) type Row = (&'static str, f64, f64, &'static str);

/// Reads a file with all parameters, and passes each on.
pub(crate) fn read(text: &str, rows: &[Row], mut set: impl FnMut(&str, f64)) -> Result<(), String> {
    let table = DeTable::parse(text).map_err(|error| error.to_string())?;
    let is_unknown = |name: &&str| !rows.iter().any(|row| row.0 == *name);
    let names = table.get_ref().keys().map(|name| -> &str { name.get_ref() });
    if let Some(unknown) = names.into_iter().find(is_unknown) {
        return Err(format!("there is no parameter `{unknown}`"));
    }
    for (name, min, max, _) in rows {
        let value = table.get_ref().get(*name).map(|value| value.get_ref());
        set(name, in_range(value, *min, *max).map_err(|what| format!("`{name}` {what}"))?);
    }
    Ok(())
}

fn in_range(value: Option<&DeValue<'_>>, min: f64, max: f64) -> Result<f64, String> {
    let text = match value {
        Some(DeValue::Float(number)) => number.as_str(),
        Some(DeValue::Integer(number)) => number.as_str(),
        Some(other) => return Err(format!("is not a number but a {}", other.type_str())),
        None => return Err("is missing".into()),
    };
    match text.parse() {
        Ok(number) if (min..=max).contains(&number) => Ok(number),
        _ => Err(format!("is {text}, expected {min} to {max}")),
    }
}
