//! Conformance tests for bodies.

use narukom::Timestamp;

use crate::{
    Actuators, Anatomy, ErrorKind, JointCommands, Joints, Percepts, Posture, Robot, Sensors, SkillResult,
};

/// Tolerance of a measured joint beyond its limits, radians: the encoders are not perfect.
const JOINT_TOLERANCE: f64 = 0.02;

/// Runs the suite on a free-standing body: about twenty seconds of simulated or real time. The body
/// rests at the end.
///
/// # Panics
/// If a requirement is violated; the message names it. The suite is for tests.
#[allow(clippy::panic)] // a test suite reports failures by panicking
pub fn check(robot: &mut dyn Robot) {
    check_anatomy(robot.anatomy());
    let cycle = robot.anatomy().cycle;
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
    now = move_joints(robot, now);
    come_to_rest(robot, now);
}

/// Checks that the parts of an anatomy fit each other.
fn check_anatomy(anatomy: &Anatomy) {
    assert!(!anatomy.cycle.is_zero(), "the cycle of a body takes time");
    for joint in &anatomy.joints {
        assert!(joint.limits.low <= joint.limits.high, "`{}` has no range", joint.name);
    }
    for (index, link) in anatomy.links.iter().enumerate() {
        let is_carried = match link.parent {
            Some(parent) => parent < index,
            None => index == 0,
        };
        assert!(is_carried, "`{}` comes before the link that carries it", link.name);
        let joint = link.motion.map(|motion| motion.joint);
        assert!(joint.is_none_or(|joint| joint < anatomy.joints.len()), "no joint moves `{}`", link.name);
    }
    for camera in &anatomy.cameras {
        let is_at_link = camera.link.is_none_or(|link| link < anatomy.links.len());
        assert!(
            is_at_link && camera.horizontal > 0.0 && camera.vertical > 0.0,
            "it sees nothing: {camera:?}"
        );
    }
}

/// Checks that joints stay within their limits whatever is commanded, and that commands without a
/// meaning are refused. A body without joints refuses all. Returns the time afterwards.
#[allow(clippy::panic)] // see `check`
fn move_joints(robot: &mut dyn Robot, mut now: Timestamp) -> Timestamp {
    let command = |joint: usize, target: f64, stiffness: f64| JointCommands {
        joints: vec![u32::try_from(joint).unwrap_or(u32::MAX)],
        targets: vec![target],
        stiffnesses: vec![stiffness],
    };
    let (cycle, count) = (robot.anatomy().cycle, robot.anatomy().joints.len());
    if count == 0 {
        assert!(robot.command_joints(now, &command(0, 0.0, 1.0)).is_err(), "a joint that is none was moved");
        return now;
    }
    let longer = JointCommands { targets: vec![0.0; 2], ..command(0, 0.0, 1.0) };
    for bad in [command(0, f64::NAN, 1.0), command(0, 0.0, f64::INFINITY), command(count, 0.0, 1.0), longer] {
        match robot.command_joints(now, &bad) {
            Err(error) if error.kind() == ErrorKind::Command => {}
            other => panic!("{bad:?} was not refused as a command: {other:?}"),
        }
    }
    let mut percepts = Percepts::default();
    for (joint, target) in [(0, 1e9), (count - 1, -1e9), (0, 0.0)] {
        now += cycle;
        sense(robot, now, &mut percepts);
        let before = clamped(&percepts);
        if let Err(error) = robot.command_joints(now, &command(joint, target, 1.0)) {
            panic!("a command beyond the limits was refused: {error}");
        }
        for _ in 0..100 {
            now += cycle;
            sense(robot, now, &mut percepts);
        }
        let reported = clamped(&percepts) - before;
        assert_eq!(reported, u64::from(target != 0.0), "commands beyond a limit are counted");
    }
    if let Err(error) = robot.command_joints(now, &JointCommands::default()) {
        panic!("the joints were not released: {error}");
    }
    now
}

fn clamped(percepts: &Percepts) -> u64 {
    percepts.joints.as_ref().map_or(0, |joints| joints.clamped)
}

/// Checks the measurements of the joints.
fn check_joints(robot: &dyn Robot, joints: Option<&Joints>, now: Timestamp) {
    let anatomy = robot.anatomy();
    let Some(joints) = joints else {
        assert!(anatomy.joints.is_empty(), "a body with joints reports none");
        return;
    };
    let Joints { measured_at, positions, velocities, temperatures, currents, stiffnesses, .. } = joints;
    assert!(*measured_at <= now.as_nanos(), "the joints were measured in the future: {joints:?}");
    for values in [positions, velocities, temperatures, currents, stiffnesses] {
        assert_eq!(values.len(), anatomy.joints.len(), "a value for each joint: {joints:?}");
        assert!(values.iter().all(|value| value.is_finite()), "a joint is not a number: {joints:?}");
    }
    for (joint, &position) in anatomy.joints.iter().zip(positions) {
        let beyond = (position - joint.limits.clamp(position)).abs();
        assert!(beyond <= JOINT_TOLERANCE, "`{}` is beyond its limits: {position}", joint.name);
    }
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
        Actuators { skill: -7, skill_number: u64::MAX, ball_speed: f64::NAN, ..still },
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
    percepts.clear_news();
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
    assert!(felt.iter().all(|value| value.is_finite()), "a sensor is not a number: {sensors:?}");
    let has_result = sensors.skill_result() != SkillResult::NoResult;
    assert_eq!(sensors.skill_done != 0, has_result, "the end of a skill has a result: {sensors:?}");
    check_joints(robot, percepts.joints.as_ref(), now);
    for sighting in percepts.sightings.iter().flat_map(|sightings| &sightings.objects) {
        assert!(
            sighting.distance >= 0.0 && sighting.bearing.abs() <= 3.2,
            "a sighting is nowhere: {sighting:?}"
        );
    }
}
