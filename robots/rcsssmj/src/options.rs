//! The options of this body in configurations.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::str::FromStr;

use monas_robot::{BodyFault, BodyOption, BodySettings, CameraOutput, OptionKind};

use crate::body::DEFAULT_ADDRESS;
use crate::error::Error;
use crate::humanoid::Humanoid;
use crate::kick::KickParameters;
use crate::match_rules::{FieldPose, FieldSize};
use crate::policy::PolicyWalk;
use crate::sine_parameters::SineParameters;
use crate::sine_walk::SineWalk;
use crate::walk::WalkEngine;

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
    option("robot", OptionKind::Word(&Humanoid::NAMES), "`T1`, which is the default, or `K1`"),
    option("server", OptionKind::Text, "the program of the server; by default `rcssservermj`"),
    option("monitor", OptionKind::Text, "the monitors' address of a server that is not started here"),
    option("realtime", OptionKind::Flag, "`1` keeps real time; by default the run waits for the server"),
    option("team", OptionKind::Name, "the name of the robot's team; by default `Monas`"),
    option("number", OptionKind::Whole(1, 99), "the number of the robot; by default 2, since 1 is a goalie"),
    option("start_x", LENGTH_ON_FIELD, "where the robot begins, m; by default -1.5"),
    option("start_y", LENGTH_ON_FIELD, "the same to the left; by default 0"),
    option("policy", OptionKind::File, "a file of weights of the walking policy; by default the own walk"),
    option("walk", OptionKind::File, "a file of parameters of the own walk"),
    option("kick", OptionKind::File, "a file of parameters of the kick"),
    option("kick_off", OptionKind::Flag, "`0` leaves the kick-off to others"),
    option("pick_up", OptionKind::Flag, "`1` puts a robot that lies on its feet, by the monitor"),
    option("field_length", SIDE_OF_FIELD, "between the goal lines, m; by default 55"),
    option("field_width", SIDE_OF_FIELD, "between the touch lines, m; by default 36"),
    option(
        "goal_width",
        OptionKind::Number(0.1, MAX_FIELD_SIDE),
        "between the posts of a goal, m; by default 3.66",
    ),
    option("half", OptionKind::Number(1.0, 100_000.0), "the length of a half, s; by default 300"),
];

/// The longest side of a field, m.
const MAX_FIELD_SIDE: f64 = 1000.0;
const SIDE_OF_FIELD: OptionKind = OptionKind::Number(1.0, MAX_FIELD_SIDE);
/// The range on the longest field; [`Options::of`] has that on the field of the options.
const LENGTH_ON_FIELD: OptionKind = OptionKind::Number(-MAX_FIELD_SIDE / 2.0, MAX_FIELD_SIDE / 2.0);

const fn option(name: &'static str, kind: OptionKind, doc: &'static str) -> BodyOption {
    BodyOption { name, kind, doc }
}

impl Options {
    /// Reads the options of a configuration.
    ///
    /// # Errors
    /// A value is not of its kind or has no meaning.
    pub(crate) fn of(given: &BTreeMap<String, String>) -> Result<Options, BodyFault> {
        for option in OPTIONS {
            given.get(option.name).map_or(Ok(()), |value| option.check(value))?;
        }
        let given = Given { given };
        let size = FieldSize::default();
        let field = FieldSize {
            length: given.number("field_length", size.length),
            width: given.number("field_width", size.width),
            goal_width: given.number("goal_width", size.goal_width),
        };
        let (x, y) = (given.number("start_x", -1.5), given.number("start_y", 0.0));
        check_range("goal_width", field.goal_width, 0.1, field.width)?;
        check_range("start_x", x, -field.length / 2.0, 0.0)?;
        check_range("start_y", y, -field.width / 2.0, field.width / 2.0)?;
        let [default, ..] = Humanoid::ALL;
        Ok(Options {
            robot: given.text("robot").and_then(|name| Humanoid::named(&name)).unwrap_or(default),
            server: given.text("server"),
            monitor: given.text("monitor"),
            realtime: given.flag("realtime", false),
            team: given.text("team").unwrap_or_else(|| "Monas".to_owned()),
            number: given.number("number", 2),
            start: FieldPose { x, y, heading: 0.0 },
            policy: given.text("policy").map(PathBuf::from),
            walk: given.text("walk").map(PathBuf::from),
            kick: given.text("kick").map(PathBuf::from),
            kick_off: given.flag("kick_off", true),
            pick_up: given.flag("pick_up", false),
            field,
            half: given.number("half", 300.0),
        })
    }

    /// The walk that the options name.
    ///
    /// # Errors
    /// The file has another content, or is for another robot.
    pub(crate) fn walk_engine(&self) -> Result<Box<dyn WalkEngine>, BodyFault> {
        match (&self.policy, &self.walk) {
            (Some(_), Some(_)) => {
                let message = "a robot walks by a `policy` or by a `walk`, not by both";
                Err(BodyFault::new("policy", message))
            }
            (Some(file), None) => {
                let walk = PolicyWalk::load(self.robot, file).map_err(at("policy"))?;
                Ok(Box::new(walk))
            }
            (None, file) => {
                let parameters = match file {
                    Some(file) => SineParameters::load(file),
                    None => SineParameters::own(self.robot),
                };
                Ok(Box::new(SineWalk::new(self.robot, parameters.map_err(at("walk"))?)))
            }
        }
    }

    /// The parameters of the kick that the options name.
    ///
    /// # Errors
    /// The file has another content.
    pub(crate) fn kick_parameters(&self) -> Result<KickParameters, BodyFault> {
        let parameters = match &self.kick {
            Some(file) => KickParameters::load(file),
            None => KickParameters::own(self.robot),
        };
        parameters.map_err(at("kick"))
    }
}

/// The faults of settings whose options are each of their kind.
pub(crate) fn faults(settings: &BodySettings) -> Vec<BodyFault> {
    let options = match Options::of(&settings.options) {
        Ok(options) => options,
        Err(fault) => return vec![fault],
    };
    let addresses = [("address", &settings.address), ("monitor", &options.monitor)];
    let mut faults: Vec<BodyFault> = addresses
        .into_iter()
        .filter_map(|(name, address)| check_address(name, address.as_deref()?).err())
        .collect();
    let idle = match settings.address {
        Some(_) => ("server", &options.server, "a server at an `address` is not started here"),
        None => ("monitor", &options.monitor, "a server without an `address` is started here"),
    };
    if let (name, Some(_), why) = idle {
        faults.push(BodyFault::new(name, format!("`{name}` has no effect: {why}")));
    }
    if settings.vision == CameraOutput::Images {
        faults.push(BodyFault::new("vision", "the server has no images, expected `vision=\"sightings\"`"));
    }
    faults.extend(options.walk_engine().err());
    faults.extend(options.kick_parameters().err());
    faults
}

fn at(attribute: &'static str) -> impl Fn(Error) -> BodyFault {
    move |error| BodyFault::new(attribute, error.to_string())
}

fn check_address(name: &'static str, address: &str) -> Result<(), BodyFault> {
    match address.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(()),
        _ => {
            let message =
                format!("`{name}` is `{address}`, expected a host and a port, such as `{DEFAULT_ADDRESS}`");
            Err(BodyFault::new(name, message))
        }
    }
}

fn check_range(name: &'static str, value: f64, min: f64, max: f64) -> Result<(), BodyFault> {
    match (min..=max).contains(&value) {
        true => Ok(()),
        false => {
            let message = format!("`{name}` is `{value}`, expected {min} to {max} on this field");
            Err(BodyFault::new(name, message))
        }
    }
}

/// Values that were checked to be of their kinds.
struct Given<'a> {
    given: &'a BTreeMap<String, String>,
}

impl Given<'_> {
    fn text(&self, name: &str) -> Option<String> {
        self.given.get(name).cloned()
    }

    fn number<T: FromStr>(&self, name: &str, default: T) -> T {
        self.given.get(name).and_then(|text| text.parse().ok()).unwrap_or(default)
    }

    fn flag(&self, name: &str, default: bool) -> bool {
        self.given.get(name).map_or(default, |text| text == "1" || text == "true")
    }
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
        let refusal = |name, value| read(&[(name, value)]).unwrap_err();
        assert_eq!(refusal("number", "0"), "`number` is `0`, expected a whole number from 1 to 99");
        assert_eq!(refusal("pick_up", "maybe"), "`pick_up` is `maybe`, expected `0` or `1`");
        assert_eq!(refusal("robot", "k1"), "`robot` is `k1`, expected `T1` or `K1`");
        assert!(refusal("team", "A) (B").contains("expected a name of letters, digits"));
        assert_eq!(refusal("start_x", "3"), "`start_x` is `3`, expected -27.5 to 0 on this field");
        assert_eq!(refusal("goal_width", "37"), "`goal_width` is `37`, expected 0.1 to 36 on this field");
    }

    #[test]
    fn settings_that_cannot_be_opened_have_faults_at_their_attributes() {
        let file = |name: &str| format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
        let (walk, kick) = (file("walk.toml"), file("kick.toml"));
        let faults_at = |address: Option<&str>, options: &[(&str, &str)]| {
            let options = options.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned()));
            let (address, options) = (address.map(str::to_owned), options.collect());
            let settings = BodySettings { address, options, ..BodySettings::default() };
            faults(&settings).into_iter().map(|fault| fault.attribute).collect::<Vec<_>>()
        };
        assert_eq!(faults_at(None, &[("walk", &walk), ("kick", &kick), ("robot", "K1")]), [""; 0]);
        assert_eq!(faults_at(Some("robot:60000"), &[("monitor", "[::1]:60001")]), [""; 0]);
        assert_eq!(faults_at(None, &[("start_y", "19")]), ["start_y"]);
        assert_eq!(faults_at(None, &[("walk", &kick)]), ["walk"]);
        assert_eq!(faults_at(None, &[("kick", &walk)]), ["kick"]);
        assert_eq!(faults_at(None, &[("policy", &walk)]), ["policy"]);
        assert_eq!(faults_at(None, &[("policy", &walk), ("walk", &walk)]), ["policy"]);
        assert_eq!(faults_at(None, &[("monitor", "here:1")]), ["monitor"]);
        assert_eq!(faults_at(Some("here"), &[("monitor", "here:70000")]), ["address", "monitor"]);
        assert_eq!(faults_at(Some("here:1"), &[("server", "rcssservermj")]), ["server"]);
        let vision = CameraOutput::Images;
        let [fault] = &faults(&BodySettings { vision, ..BodySettings::default() })[..] else {
            panic!("images are delivered")
        };
        assert_eq!(fault.attribute, "vision");
    }
}
