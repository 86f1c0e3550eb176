//! Conformance tests for bodies.

use narukom::Timestamp;

use crate::{Actuators, Percepts, Posture, Robot, Sensors};

/// Runs the suite on a free-standing body: about twenty seconds of simulated or real time. The body
/// rests at the end.
///
/// # Panics
/// If a requirement is violated; the message names it. The suite is for tests.
#[allow(clippy::panic)] // a test suite reports failures by panicking
pub fn check(robot: &mut dyn Robot) {
    let cycle = robot.anatomy().cycle;
    assert!(!cycle.is_zero(), "the cycle of a body takes time");
    let mut now = Timestamp::from_nanos(0);
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

/// Checks that a body comes to rest on request and stays there.
#[allow(clippy::panic)] // see `check`
fn come_to_rest(robot: &mut dyn Robot, mut now: Timestamp) {
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

/// Valid, ineffective and impossible commands.
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

/// Checks that a body sends messages up to the length in its anatomy and rejects longer ones.
#[allow(clippy::panic)] // see `check`
fn speak(robot: &mut dyn Robot, now: Timestamp) {
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
fn sense(robot: &mut dyn Robot, now: Timestamp, percepts: &mut Percepts) {
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
