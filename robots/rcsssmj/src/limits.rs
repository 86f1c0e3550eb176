//! The limits of a robot on the server.

use monas_robot::topics::{BATTERY, CONTACTS, HEARD, LEDS, SAID, SIGHTINGS, SONAR};
use monas_robot::{BodyLimit, BodySettings, Skill};

use crate::options::Options;

/// The limits that do not depend on the walk.
const COMMON_LIMITS: [BodyLimit; 11] = [
    BodyLimit::skill(Skill::FallLeft, NO_MOTION),
    BodyLimit::skill(Skill::FallRight, NO_MOTION),
    BodyLimit::skill(Skill::DiveLeft, NO_MOTION),
    BodyLimit::skill(Skill::DiveRight, NO_MOTION),
    BodyLimit::topic(SIGHTINGS.path(), "the server reports no lines of the field"),
    BodyLimit::topic(HEARD.path(), NO_RADIO),
    BodyLimit::topic(SAID.path(), NO_RADIO),
    BodyLimit::topic(CONTACTS.path(), "the robot feels no contacts"),
    BodyLimit::topic(SONAR.path(), "the robot has no sonar"),
    BodyLimit::topic(BATTERY.path(), "the battery is always full"),
    BodyLimit::topic(LEDS.path(), "the robot has no LEDs"),
];

const NO_MOTION: &str = "the skill is over at once, without a motion";
const NO_RADIO: &str = "the robot has no radio: messages of the server have ten bytes";

const STAND_UP_LIMIT: BodyLimit = BodyLimit::skill(Skill::StandUp, "a robot that lies waits for the referee");
const PICKED_UP: BodyLimit =
    BodyLimit::skill(Skill::StandUp, "a robot that lies is put on its feet by the monitor");

/// The limits of a robot with these settings.
pub(crate) fn limits(settings: &BodySettings) -> Vec<BodyLimit> {
    let mut limits = COMMON_LIMITS.to_vec();
    // Wrong options are reported as faults of the configuration.
    let Ok(options) = Options::of(&settings.options) else { return limits };
    limits.push(if options.pick_up { PICKED_UP } else { STAND_UP_LIMIT });
    limits
}
