//! The project's own walk: sines without a model of balance.

use std::f64::consts::TAU;
use std::path::Path;

use monas_robot::Limits;
use toml::de::{DeTable, DeValue};

use crate::anatomy::{
    CYCLE_SECONDS, JOINTS, JointValues, LEFT_LEG, LEFT_SHOULDER_ROLL, RIGHT_LEG, RIGHT_SHOULDER_ROLL, limits,
};
use crate::effector::MotorCommand;
use crate::error::Error;
use crate::walk::{Gait, Motion, Motors, WalkEngine, WalkVelocity};

/// The numbers of a walk, as its file names them.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct SineParameters {
    /// Pairs of steps in a second.
    pub frequency: f64,
    /// Pitch of the hips in a stand, forwards, rad.
    pub crouch: f64,
    /// Angle of the knees in a stand, in parts of the crouch.
    pub knee: f64,
    /// Added to the pitch of the ankles, rad.
    pub lean: f64,
    /// By how much a swinging leg bends in addition, rad.
    pub lift: f64,
    /// Amplitude of the hips' pitch at full speed, rad.
    pub stride: f64,
    /// Phase of the stride after the lift, rad.
    pub phase: f64,
    /// Amplitude of the hips' roll, rad.
    pub sway: f64,
    /// Amplitude of the ankles' roll, rad.
    pub ankle_sway: f64,
    /// Ankle pitch for each rad/s of the torso's pitch, s.
    pub gyro_pitch: f64,
    /// Ankle roll for each rad/s of the torso's roll, s.
    pub gyro_roll: f64,
    /// Amplitude of the hips' yaw at full turn, rad.
    pub turn: f64,
    /// Speed ahead at full stride, m/s.
    pub speed: f64,
    /// Speed ahead of steps without a stride, m/s: the robot leans forwards.
    pub drift: f64,
    /// The slowest steps ahead, m/s: slower ones make the robot fall.
    pub slowest: f64,
    /// Rate at full turn, rad/s.
    pub turn_rate: f64,
    /// Torque per angle and per angular velocity of the legs.
    pub leg_gains: [f64; 2],
    /// The same of the other joints.
    pub other_gains: [f64; 2],
}

/// The file of the walk that is used without another.
const OWN: &str = include_str!("../walk.toml");

impl SineParameters {
    /// The parameters that the project brings.
    ///
    /// # Errors
    /// None, unless its file was changed to one without meaning.
    pub fn own() -> Result<SineParameters, Error> {
        SineParameters::parse(OWN).map_err(Error::configuration)
    }

    /// Reads a file of parameters. All of them have to be there.
    ///
    /// # Errors
    /// The file cannot be read, a parameter is missing, unknown, or out of its range.
    pub fn load(path: &Path) -> Result<SineParameters, Error> {
        let named = |what: String| Error::configuration(format!("the walk {}: {what}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| named(error.to_string()))?;
        SineParameters::parse(&text).map_err(named)
    }

    fn parse(text: &str) -> Result<SineParameters, String> {
        let table = DeTable::parse(text).map_err(|error| error.to_string())?;
        let value = |name: &str| table.get_ref().get(name).map(|value| value.get_ref());
        let mut walk = SineParameters::default();
        let known = walk.numbers().map(|(name, ..)| name);
        if let Some(unknown) = table.get_ref().keys().find(|name| {
            let name: &str = name.get_ref();
            !known.contains(&name) && !GAINS.contains(&name)
        }) {
            return Err(format!("there is no parameter `{}`", unknown.get_ref()));
        }
        for (name, number, least, most) in walk.numbers() {
            *number = in_range(value(name), least, most).map_err(|what| format!("`{name}` {what}"))?;
        }
        for (name, gains) in GAINS.into_iter().zip([&mut walk.leg_gains, &mut walk.other_gains]) {
            let Some(DeValue::Array(pair)) = value(name) else {
                return Err(format!("`{name}` needs two numbers"));
            };
            if pair.len() != gains.len() {
                return Err(format!("`{name}` needs two numbers"));
            }
            for (gain, value) in gains.iter_mut().zip(pair.iter()) {
                *gain = in_range(Some(value.get_ref()), 0.0, 1000.0)
                    .map_err(|what| format!("`{name}` {what}"))?;
            }
        }
        match walk.speed > walk.drift {
            true => Ok(walk),
            false => Err("`speed` has to be more than `drift`".into()),
        }
    }

    /// All single numbers with their names and ranges.
    fn numbers(&mut self) -> [(&'static str, &mut f64, f64, f64); 16] {
        [
            ("frequency", &mut self.frequency, 0.1, 10.0),
            ("crouch", &mut self.crouch, 0.0, 1.0),
            ("knee", &mut self.knee, 1.0, 3.0),
            ("lean", &mut self.lean, -0.5, 0.5),
            ("lift", &mut self.lift, 0.0, 1.0),
            ("stride", &mut self.stride, 0.0, 1.0),
            ("phase", &mut self.phase, -TAU, TAU),
            ("sway", &mut self.sway, 0.0, 0.4),
            ("ankle_sway", &mut self.ankle_sway, 0.0, 0.4),
            ("gyro_pitch", &mut self.gyro_pitch, -1.0, 1.0),
            ("gyro_roll", &mut self.gyro_roll, -1.0, 1.0),
            ("turn", &mut self.turn, 0.0, 1.0),
            ("speed", &mut self.speed, 0.01, 5.0),
            ("drift", &mut self.drift, 0.0, 5.0),
            ("slowest", &mut self.slowest, 0.0, 5.0),
            ("turn_rate", &mut self.turn_rate, 0.01, 5.0),
        ]
    }
}

/// The parameters with two numbers.
const GAINS: [&str; 2] = ["leg_gains", "other_gains"];

fn in_range(value: Option<&DeValue<'_>>, least: f64, most: f64) -> Result<f64, String> {
    let text = match value {
        Some(DeValue::Float(number)) => number.as_str(),
        Some(DeValue::Integer(number)) => number.as_str(),
        Some(other) => return Err(format!("is no number but a {}", other.type_str())),
        None => return Err("is missing".into()),
    };
    match text.parse() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(format!("is {text}, expected {least} to {most}")),
    }
}

/// A walk in which each joint of the legs follows a sine of one clock. The gyroscope moves the
/// ankles; there is no other feedback of balance. It turns by the yaw of the hips and walks neither
/// to a side nor backwards.
#[derive(Clone, Debug)]
pub struct SineWalk {
    parameters: SineParameters,
    /// Where it is in a pair of steps, rad.
    clock: f64,
    /// How far the robot has gone into its crouch, and how far the steps are lifted: 0 to 1.
    crouched: f64,
    stepping: f64,
    /// Seconds since the last command that was not to stand.
    still: f64,
}

/// The times in which the robot goes into its crouch and begins or ends its steps, s.
const CROUCHING: f64 = 0.4;
const STARTING: f64 = 0.6;
/// How long the robot takes slow steps before it stands, s: it has to lose its speed.
const SLOWING: f64 = 1.2;
/// Roll of the shoulders beside the body, rad: the arms hang.
const ARMS: f64 = 1.35;

impl SineWalk {
    /// A walk with parameters, for a robot that stands.
    pub fn new(parameters: SineParameters) -> SineWalk {
        SineWalk { parameters, clock: 0.0, crouched: 0.0, stepping: 0.0, still: SLOWING }
    }

    fn step(&mut self, velocity: WalkVelocity) {
        self.crouched = (self.crouched + CYCLE_SECONDS / CROUCHING).min(1.0);
        let moves = velocity != WalkVelocity::default();
        self.still = if moves { 0.0 } else { self.still + CYCLE_SECONDS };
        let steps = self.crouched >= 1.0 && self.still < SLOWING;
        let change = CYCLE_SECONDS / STARTING;
        self.stepping = (self.stepping + if steps { change } else { -change }).clamp(0.0, 1.0);
        self.clock = match self.stepping > 0.0 {
            true => libm::fmod(self.clock + TAU * self.parameters.frequency * CYCLE_SECONDS, TAU),
            false => 0.0,
        };
    }

    fn angles(&self, velocity: WalkVelocity, gyro: [f64; 3]) -> JointValues {
        let walk = &self.parameters;
        let mut angles = [0.0; JOINTS];
        let arms = ARMS * self.crouched;
        (angles[LEFT_SHOULDER_ROLL], angles[RIGHT_SHOULDER_ROLL]) = (-arms, arms);
        let lift = libm::sin(self.clock);
        let swing = libm::cos(self.clock + walk.phase) * self.stepping;
        // Steps on the spot are safe in a turn only; the last ones before a stand go ahead.
        let ahead = if velocity.x > 0.0 || velocity.turn == 0.0 { velocity.x.max(walk.slowest) } else { 0.0 };
        let stride = walk.stride * (ahead - walk.drift) / (walk.speed - walk.drift);
        let yaw = walk.turn * velocity.turn / walk.turn_rate;
        let crouch = walk.crouch * self.crouched;
        for (leg, side) in [(LEFT_LEG, 1.0), (RIGHT_LEG, -1.0)] {
            let up = (side * lift).max(0.0) * walk.lift * self.stepping;
            let ahead = side * swing * stride;
            angles[leg] = ahead - crouch - up;
            angles[leg + 1] = walk.sway * lift * self.stepping;
            angles[leg + 2] = -side * swing * yaw;
            angles[leg + 3] = walk.knee * crouch + 2.0 * up;
            let level = -(walk.knee - 1.0) * crouch - up - ahead;
            angles[leg + 4] = level + walk.lean * self.crouched + walk.gyro_pitch * gyro[1];
            angles[leg + 5] = -walk.ankle_sway * lift * self.stepping + walk.gyro_roll * gyro[0];
        }
        angles
    }
}

impl WalkEngine for SineWalk {
    fn gait(&self) -> Gait {
        let SineParameters { speed, turn_rate, .. } = self.parameters;
        Gait {
            x: Limits::new(0.0, speed),
            y: Limits::symmetric(0.0),
            turn: Limits::symmetric(turn_rate),
            run: speed,
        }
    }

    fn advance(&mut self, velocity: WalkVelocity, motion: &Motion, motors: &mut Motors) {
        self.step(velocity);
        let angles = self.angles(velocity, motion.gyro);
        for (joint, motor) in motors.iter_mut().enumerate() {
            let [stiffness, damping] = match joint < LEFT_LEG {
                true => self.parameters.other_gains,
                false => self.parameters.leg_gains,
            };
            let angle = limits(joint).clamp(angles[joint]);
            *motor = MotorCommand { angle, stiffness, damping, ..MotorCommand::default() };
        }
    }

    fn reset(&mut self) {
        *self = SineWalk::new(self.parameters);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    const STILL: Motion = Motion {
        positions: [0.0; JOINTS],
        velocities: [0.0; JOINTS],
        gyro: [0.0; 3],
        down: Vector3::new(0.0, 0.0, -1.0),
    };

    fn run(walk: &mut SineWalk, velocity: WalkVelocity, cycles: usize) -> Vec<JointValues> {
        let mut motors = [MotorCommand::default(); JOINTS];
        let mut cycle = || {
            walk.advance(velocity, &STILL, &mut motors);
            motors.map(|motor| motor.angle)
        };
        (0..cycles).map(|_| cycle()).collect()
    }

    #[test]
    fn it_crouches_without_a_jump_and_stands_until_a_command_to_walk() {
        let mut walk = SineWalk::new(SineParameters::own().unwrap());
        let angles = run(&mut walk, WalkVelocity::default(), 100);
        let knees = |angles: &JointValues| (angles[LEFT_LEG + 3], angles[RIGHT_LEG + 3]);
        assert!(knees(&angles[0]).0 < 0.1);
        assert_eq!(knees(&angles[99]), knees(&angles[60]));
        assert!(knees(&angles[99]).0 > 0.5 && knees(&angles[99]).0 == knees(&angles[99]).1);
    }

    #[test]
    fn the_legs_step_in_turn_and_stop_after_the_command() {
        let mut walk = SineWalk::new(SineParameters::own().unwrap());
        run(&mut walk, WalkVelocity::default(), 50);
        let ahead = run(&mut walk, WalkVelocity { x: 0.2, ..WalkVelocity::default() }, 200);
        let is_lifted = |angles: &&JointValues, leg: usize| angles[leg + 3] > ahead[0][leg + 3] + 0.2;
        let lifted = |leg| ahead[100..].iter().filter(|angles| is_lifted(angles, leg)).count();
        assert!(lifted(LEFT_LEG) > 20 && lifted(RIGHT_LEG) > 20);
        assert!(ahead.iter().all(|angles| (angles[LEFT_LEG + 3] - angles[RIGHT_LEG + 3]).abs() < 0.5));
        let stand = run(&mut walk, WalkVelocity::default(), 150);
        assert_eq!(stand[149], stand[140]);
    }

    #[test]
    fn a_file_without_a_parameter_or_with_an_unknown_one_is_refused() {
        let error = |text: String| SineParameters::parse(&text).unwrap_err();
        assert_eq!(error(OWN.replace("lean =", "# lean =")), "`lean` is missing");
        assert_eq!(error(format!("{OWN}\nhop = 1")), "there is no parameter `hop`");
        assert_eq!(error(OWN.replace("lift = ", "lift = 7 #")), "`lift` is 7, expected 0 to 1");
        assert_eq!(error(OWN.replace("[200.0, 5.0]", "[200.0]")), "`leg_gains` needs two numbers");
        assert_eq!(
            error(OWN.replace("[200.0, 5.0]", "[200.0, \"x\"]")),
            "`leg_gains` is no number but a string"
        );
    }
}
