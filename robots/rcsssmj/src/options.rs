//! What a configuration can say of this body.

use std::collections::BTreeMap;
use std::path::PathBuf;

use monas_robot::{BodyOption, OptionKind};

use crate::error::Error;
use crate::humanoid::Humanoid;
use crate::match_rules::{FieldPose, FieldSize};

/// The options, as [`OPTIONS`] documents them.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Options {
    pub(crate) robot: &'static Humanoid,
    pub(crate) server: Option<String>,
    pub(crate) monitor: Option<String>,
    pub(crate) realtime: bool,
    pub(crate) team: String,
    pub(crate) number: u32,
    pub(crate) start: FieldPose,
    pub(crate) policy: Option<PathBuf>,
    pub(crate) walk: Option<PathBuf>,
    pub(crate) kick: Option<PathBuf>,
    pub(crate) kick_off: bool,
    pub(crate) pick_up: bool,
    pub(crate) field: FieldSize,
    pub(crate) half: f64,
}

/// All options.
pub(crate) const OPTIONS: &[BodyOption] = &[
    option("robot", OptionKind::Name, "`T1`, which is the default, or `K1`"),
    option("server", OptionKind::Text, "the program of the server; by default `rcssservermj`"),
    option("monitor", OptionKind::Text, "the monitors' address of a server that is not started here"),
    option("realtime", OptionKind::Flag, "`1` keeps real time; by default the run waits for the server"),
    option("team", OptionKind::Name, "the name of the robot's team; by default `Monas`"),
    option("number", OptionKind::Number, "the number of the robot; by default 2, since 1 is a goalie"),
    option("start_x", OptionKind::Number, "where the robot begins, m; by default -1.5"),
    option("start_y", OptionKind::Number, "the same to the left; by default 0"),
    option("policy", OptionKind::File, "a file of weights of the walking policy; by default the own walk"),
    option("walk", OptionKind::File, "a file of parameters of the own walk"),
    option("kick", OptionKind::File, "a file of parameters of the kick"),
    option("kick_off", OptionKind::Flag, "`0` leaves the kick-off to others"),
    option("pick_up", OptionKind::Flag, "`1` puts a robot that lies on its feet, by the monitor"),
    option("field_length", OptionKind::Number, "between the goal lines, m; by default 55"),
    option("field_width", OptionKind::Number, "between the touch lines, m; by default 36"),
    option("goal_width", OptionKind::Number, "between the posts of a goal, m; by default 3.66"),
    option("half", OptionKind::Number, "the length of a half, s; by default 300"),
];

const fn option(name: &'static str, kind: OptionKind, doc: &'static str) -> BodyOption {
    BodyOption { name, kind, doc }
}

impl Options {
    /// Reads the options of a configuration.
    ///
    /// # Errors
    /// A value is not of its kind or has no meaning.
    pub(crate) fn of(given: &BTreeMap<String, String>) -> Result<Options, Error> {
        let given = Given { given };
        let size = FieldSize::default();
        let field = FieldSize {
            length: given.number("field_length", size.length, 1.0, 1000.0)?,
            width: given.number("field_width", size.width, 1.0, 1000.0)?,
            goal_width: given.number("goal_width", size.goal_width, 0.1, 1000.0)?,
        };
        Ok(Options {
            robot: given.robot()?,
            server: given.text("server"),
            monitor: given.text("monitor"),
            realtime: given.flag("realtime", false)?,
            team: given.word("team", "Monas")?,
            number: given.number("number", 2.0, 1.0, 99.0)? as u32,
            start: FieldPose {
                x: given.number("start_x", -1.5, -field.length / 2.0, 0.0)?,
                y: given.number("start_y", 0.0, -field.width / 2.0, field.width / 2.0)?,
                heading: 0.0,
            },
            policy: given.text("policy").map(PathBuf::from),
            walk: given.text("walk").map(PathBuf::from),
            kick: given.text("kick").map(PathBuf::from),
            kick_off: given.flag("kick_off", true)?,
            pick_up: given.flag("pick_up", false)?,
            field,
            half: given.number("half", 300.0, 1.0, 100_000.0)?,
        })
    }
}

struct Given<'a> {
    given: &'a BTreeMap<String, String>,
}

impl Given<'_> {
    fn text(&self, name: &str) -> Option<String> {
        self.given.get(name).filter(|text| !text.is_empty()).cloned()
    }

    fn word(&self, name: &str, default: &str) -> Result<String, Error> {
        let word = self.text(name).unwrap_or_else(|| default.to_owned());
        match word.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-".contains(&byte)) {
            true => Ok(word),
            false => Err(wrong(name, &word, "letters, digits, `-` and `_`")),
        }
    }

    fn robot(&self) -> Result<&'static Humanoid, Error> {
        let [default, ..] = Humanoid::ALL;
        let Some(name) = self.text("robot") else { return Ok(default) };
        let names = Humanoid::ALL.map(|robot| format!("`{}`", robot.name())).join(" or ");
        Humanoid::named(&name).ok_or_else(|| wrong("robot", &name, &names))
    }

    fn number(&self, name: &str, default: f64, least: f64, most: f64) -> Result<f64, Error> {
        let Some(text) = self.text(name) else { return Ok(default) };
        match text.parse() {
            Ok(number) if (least..=most).contains(&number) => Ok(number),
            _ => Err(wrong(name, &text, &format!("a number from {least} to {most}"))),
        }
    }

    fn flag(&self, name: &str, default: bool) -> Result<bool, Error> {
        match self.text(name).as_deref() {
            None => Ok(default),
            Some("1" | "true") => Ok(true),
            Some("0" | "false") => Ok(false),
            Some(other) => Err(wrong(name, other, "`0` or `1`")),
        }
    }
}

fn wrong(name: &str, value: &str, expected: &str) -> Error {
    Error::configuration(format!("`{name}` is `{value}`, expected {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(given: &[(&str, &str)]) -> Result<Options, String> {
        let given = given.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
        Options::of(&given).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_not_given_has_its_default() {
        let options = read(&[("number", "7"), ("pick_up", "1"), ("goal_width", "2")]).unwrap();
        assert_eq!((options.number, options.pick_up, options.kick_off), (7, true, true));
        assert_eq!((options.field.goal_width, options.field.length), (2.0, 55.0));
        assert_eq!((options.team.as_str(), options.start.x), ("Monas", -1.5));
        assert_eq!(options.robot.name(), "T1");
        assert_eq!(read(&[("robot", "K1")]).unwrap().robot.name(), "K1");
    }

    #[test]
    fn a_value_without_meaning_is_refused() {
        assert_eq!(read(&[("number", "0")]).unwrap_err(), "`number` is `0`, expected a number from 1 to 99");
        assert_eq!(read(&[("pick_up", "maybe")]).unwrap_err(), "`pick_up` is `maybe`, expected `0` or `1`");
        assert_eq!(read(&[("robot", "k1")]).unwrap_err(), "`robot` is `k1`, expected `T1` or `K1`");
        assert!(read(&[("team", "A) (B")]).unwrap_err().contains("expected letters, digits"));
        assert!(read(&[("start_x", "3")]).unwrap_err().contains("from -27.5 to 0"));
    }
}
