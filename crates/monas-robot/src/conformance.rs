//! What every body has to do right, as a suite that runs on any of them.

use narukom::Moment;

use crate::{Actuators, Percepts, Posture, Robot, Sensors};

/// Runs the suite on a body that stands free: some twenty seconds of its own time. It rests in the end.
///
/// # Panics
/// With the promise that was broken, if one was: the suite is for tests.
#[allow(clippy::panic)] // a suite for tests speaks by panicking
pub fn check(robot: &mut dyn Robot) {
    let cycle = robot.anatomy().cycle;
    assert!(!cycle.is_zero(), "the cycle of a body takes time");
    let mut now = Moment::from_nanos(0);
    let mut percepts = Percepts::default();
    for command in commands() {
        for _ in 0..200 {
            now += cycle;
            sense(robot, now, &mut percepts);
            speak(robot, now);
            if let Err(error) = robot.act(now, &command) {
                panic!("{command:?} was refused: {error}");
            }
        }
    }
    come_to_rest(robot, now);
}

/// A body that is to rest does so, and stays where it is.
#[allow(clippy::panic)] // see `check`
fn come_to_rest(robot: &mut dyn Robot, mut now: Moment) {
    let (cycle, mut percepts) = (robot.anatomy().cycle, Percepts::default());
    for round in 0..600 {
        now += cycle;
        sense(robot, now, &mut percepts);
        if let Err(error) = robot.rest(now) {
            panic!("it does not rest: {error}");
        }
        let Sensors { odometry_x, odometry_y, .. } = percepts.sensors;
        let still = odometry_x.abs() < 1e-3 && odometry_y.abs() < 1e-3;
        assert!(
            round < 500 || (still && percepts.sensors.posture() != Posture::Walking),
            "it does not rest: {percepts:?}"
        );
    }
}

/// Sensible, useless and impossible commands.
fn commands() -> [Actuators; 5] {
    let still = Actuators::default();
    [
        still,
        Actuators { walk_x: 0.1, head_yaw: 0.5, ..still },
        Actuators { walk_x: 1e9, walk_y: -1e9, walk_turn: 1e9, head_yaw: 1e9, head_pitch: -1e9, ..still },
        Actuators { walk_x: f64::NAN, head_yaw: f64::NAN, head_pitch: f64::INFINITY, ..still },
        Actuators { skill: -7, skill_number: u64::MAX, ..still },
    ]
}

/// A body says what its anatomy promises, and nothing longer.
#[allow(clippy::panic)] // see `check`
fn speak(robot: &mut dyn Robot, now: Moment) {
    let words = vec![0; robot.anatomy().radio + 1];
    if robot.say(now, &words).is_ok() {
        panic!("{} bytes were said, more than the radio sends", words.len());
    }
    let promised = words.len() - 1;
    if promised > 0
        && let Err(error) = robot.say(now, &words[..promised])
    {
        panic!("{promised} bytes were not said: {error}");
    }
}

#[allow(clippy::panic)] // see `check`
fn sense(robot: &mut dyn Robot, now: Moment, percepts: &mut Percepts) {
    (percepts.sightings, percepts.announcement) = (None, None);
    percepts.heard.clear();
    if let Err(error) = robot.sense(now, percepts) {
        panic!("sensing failed: {error}");
    }
    let (sensors, anatomy) = (&percepts.sensors, robot.anatomy());
    assert!(sensors.measured_at <= now.as_nanos(), "a measurement lies in the future: {sensors:?}");
    assert!(anatomy.head_yaw.contains(sensors.head_yaw), "the head's yaw is beyond its limits: {sensors:?}");
    assert!(
        anatomy.head_pitch.contains(sensors.head_pitch),
        "the head's pitch is beyond its limits: {sensors:?}"
    );
    let felt = [
        sensors.torso_roll,
        sensors.torso_pitch,
        sensors.odometry_x,
        sensors.odometry_y,
        sensors.odometry_turn,
    ];
    assert!(felt.iter().all(|value| value.is_finite()), "a sensor is no number: {sensors:?}");
    for sighting in percepts.sightings.iter().flat_map(|sightings| &sightings.objects) {
        assert!(
            sighting.distance >= 0.0 && sighting.bearing.abs() <= 3.2,
            "a sighting is nowhere: {sighting:?}"
        );
    }
}
