//! A walk learnt by the league's T1: a small neural network that is loaded from a file.
//!
//! The network is the one of the example `nn_client` in the server's repository (MIT licence),
//! which commands velocities: 78 inputs, hidden layers of 512 (with layer normalisation), 256 and
//! 128 units with ELU, and an angle for each of the 23 joints. Its weights are not part of this
//! project. The file holds them as 32 bit numbers, the lowest byte first: of each layer the
//! weights, one row for each output, then the biases; after the biases of the first layer the gains
//! and the biases of its normalisation.

use std::path::Path;

use monas_robot::Limits;

use crate::T1;
use crate::effector::MotorCommand;
use crate::error::Error;
use crate::humanoid::{Humanoid, JOINTS};
use crate::walk::{Gait, Motion, Motors, WalkEngine, WalkVelocity};

const INPUTS: usize = 3 * JOINTS + 9;
const HIDDEN: [usize; 3] = [512, 256, 128];

/// The numbers in a file of weights.
const WEIGHT_COUNT: usize = INPUTS * HIDDEN[0]
    + 3 * HIDDEN[0]
    + HIDDEN[0] * HIDDEN[1]
    + HIDDEN[1]
    + HIDDEN[1] * HIDDEN[2]
    + HIDDEN[2]
    + HIDDEN[2] * JOINTS
    + JOINTS;

/// Default angles to which the network's outputs are added, rad, before [`JOINT_SIGNS`].
#[rustfmt::skip]
const NOMINAL_ANGLES: [f32; JOINTS] = [
    0.0, 0.0,
    0.0, 1.4, 0.0, -0.4,
    0.0, -1.4, 0.0, 0.4,
    0.0,
    -0.4, 0.0, 0.0, 0.8, -0.4, 0.0,
    0.4, 0.0, 0.0, -0.8, 0.4, 0.0,
];
/// The signs of the network's joints.
#[rustfmt::skip]
const JOINT_SIGNS: [f32; JOINTS] = [
    1.0, -1.0,
    1.0, -1.0, -1.0, 1.0,
    -1.0, -1.0, 1.0, 1.0,
    1.0,
    1.0, -1.0, -1.0, 1.0, 1.0, -1.0,
    -1.0, -1.0, -1.0, -1.0, -1.0, -1.0,
];
/// Torque per angle and per angular velocity with which the network was trained.
const GAINS: (f64, f64) = (25.0, 0.6);
/// Greatest size of inputs and outputs.
const MAX_VALUE: f32 = 10.0;
/// Angular velocity, rad/s, from which the lateral velocity is halved for safety.
const FAST_TURN_RATE: f64 = 0.3;

/// The network with its last output.
pub struct PolicyWalk {
    layers: Vec<Layer>,
    normal: Normalisation,
    input: Vec<f32>,
    hidden: [Vec<f32>; 3],
    action: [f32; JOINTS],
}

struct Layer {
    weights: Vec<f32>,
    biases: Vec<f32>,
}

struct Normalisation {
    gains: Vec<f32>,
    biases: Vec<f32>,
}

impl PolicyWalk {
    /// Loads the weights from a file, for a robot.
    ///
    /// # Errors
    /// The robot is not a T1. The file cannot be read, does not have the size of the network, or
    /// holds what is not a number.
    pub fn load(robot: &Humanoid, path: &Path) -> Result<PolicyWalk, Error> {
        if *robot != T1 {
            let name = robot.name();
            let what = format!("the `policy` walks a T1 only: a {name} walks by a `walk`, or by its own");
            return Err(Error::configuration(what));
        }
        let named =
            |what: String| Error::configuration(format!("the walking policy {}: {what}", path.display()));
        let bytes = std::fs::read(path).map_err(|error| named(error.to_string()))?;
        PolicyWalk::from_bytes(&bytes).map_err(named)
    }

    fn from_bytes(bytes: &[u8]) -> Result<PolicyWalk, String> {
        if bytes.len() != 4 * WEIGHT_COUNT {
            return Err(format!(
                "it has {} bytes, {} are the {WEIGHT_COUNT} weights of the network",
                bytes.len(),
                4 * WEIGHT_COUNT
            ));
        }
        let mut numbers = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        if let Some(index) = numbers.clone().position(|number| !number.is_finite()) {
            return Err(format!("weight {index} is not a finite number"));
        }
        let mut take = |count| numbers.by_ref().take(count).collect::<Vec<f32>>();
        let mut layer = |inputs, outputs| Layer { weights: take(inputs * outputs), biases: take(outputs) };
        let first = layer(INPUTS, HIDDEN[0]);
        let normal = layer(1, HIDDEN[0]);
        let normal = Normalisation { gains: normal.weights, biases: normal.biases };
        let layers =
            vec![first, layer(HIDDEN[0], HIDDEN[1]), layer(HIDDEN[1], HIDDEN[2]), layer(HIDDEN[2], JOINTS)];
        let hidden = HIDDEN.map(|units| vec![0.0; units]);
        Ok(PolicyWalk { layers, normal, input: vec![0.0; INPUTS], hidden, action: [0.0; JOINTS] })
    }

    fn observe(&mut self, velocity: WalkVelocity, motion: &Motion) {
        for joint in 0..JOINTS {
            let flip = JOINT_SIGNS[joint];
            let input = &mut self.input[3 * joint..3 * joint + 3];
            input[0] = (motion.positions[joint] as f32 * flip - NOMINAL_ANGLES[joint]) / 4.6;
            input[1] = motion.velocities[joint] as f32 * flip / 110.0;
            input[2] = self.action[joint] / 10.0;
        }
        let gyro = motion.gyro.map(|rate| (rate as f32 / 50.0).clamp(-1.0, 1.0));
        let command = [velocity.x as f32, velocity.y as f32, velocity.turn as f32];
        let down = [motion.down.x as f32, motion.down.y as f32, motion.down.z as f32];
        let rest = &mut self.input[3 * JOINTS..];
        for (input, value) in rest.iter_mut().zip(gyro.into_iter().chain(command).chain(down)) {
            *input = value;
        }
        self.input.iter_mut().for_each(|value| *value = value.clamp(-MAX_VALUE, MAX_VALUE));
    }

    fn infer(&mut self) {
        let [first, second, third] = &mut self.hidden;
        self.layers[0].apply(&self.input, first);
        self.normal.apply(first);
        first.iter_mut().for_each(elu);
        self.layers[1].apply(first, second);
        second.iter_mut().for_each(elu);
        self.layers[2].apply(second, third);
        third.iter_mut().for_each(elu);
        self.layers[3].apply(third, &mut self.action);
        self.action.iter_mut().for_each(|value| *value = value.clamp(-MAX_VALUE, MAX_VALUE));
    }
}

impl Layer {
    fn apply(&self, input: &[f32], output: &mut [f32]) {
        let rows = self.weights.chunks_exact(input.len());
        for ((value, row), bias) in output.iter_mut().zip(rows).zip(&self.biases) {
            *value = bias + dot(row, input);
        }
    }
}

/// Eight sums side by side, which the compiler turns into vector instructions; the order of the
/// additions is fixed, so that the result is the same everywhere.
fn dot(one: &[f32], other: &[f32]) -> f32 {
    let (ones, rest) = one.as_chunks::<8>();
    let (others, other_rest) = other.as_chunks::<8>();
    let mut sums = [0.0f32; 8];
    for (one, other) in ones.iter().zip(others) {
        for lane in 0..8 {
            sums[lane] += one[lane] * other[lane];
        }
    }
    let tail: f32 = rest.iter().zip(other_rest).map(|(one, other)| one * other).sum();
    sums.iter().sum::<f32>() + tail
}

impl Normalisation {
    /// Layer normalisation (Ba, Kiros, Hinton 2016), with an epsilon of 1e-6.
    fn apply(&self, values: &mut [f32]) {
        let count = values.len() as f32;
        let mean = values.iter().sum::<f32>() / count;
        let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f32>() / count;
        let scale = 1.0 / (variance + 1e-6).sqrt();
        for ((value, gain), bias) in values.iter_mut().zip(&self.gains).zip(&self.biases) {
            *value = (*value - mean) * scale * gain + bias;
        }
    }
}

/// Exponential linear unit (Clevert, Unterthiner, Hochreiter 2016).
fn elu(value: &mut f32) {
    if *value < 0.0 {
        *value = libm::expm1f(*value);
    }
}

impl WalkEngine for PolicyWalk {
    fn gait(&self) -> Gait {
        Gait { x: Limits::new(-0.8, 1.1), y: Limits::symmetric(0.2), turn: Limits::symmetric(1.2) }
    }

    fn advance(&mut self, velocity: WalkVelocity, motion: &Motion, motors: &mut Motors) {
        let aside = 1.0 - (velocity.turn.abs() / FAST_TURN_RATE).min(1.0) / 2.0;
        self.observe(WalkVelocity { y: velocity.y * aside, ..velocity }, motion);
        self.infer();
        for (joint, motor) in motors.iter_mut().enumerate() {
            let target = (NOMINAL_ANGLES[joint] + 0.5 * self.action[joint]) * JOINT_SIGNS[joint];
            // Also beyond the limits of a joint: the network uses targets as torques.
            let (angle, (stiffness, damping)) = (target.into(), GAINS);
            *motor = MotorCommand { angle, stiffness, damping, ..MotorCommand::default() };
        }
    }

    fn reset(&mut self) {
        self.action = [0.0; JOINTS];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::K1;

    /// Weights that are all zero, except for some.
    fn weights(set: &[(usize, f32)]) -> Vec<u8> {
        let mut numbers = vec![0.0f32; WEIGHT_COUNT];
        set.iter().for_each(|(index, value)| numbers[*index] = *value);
        numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    #[test]
    fn a_file_of_another_size_or_with_other_than_numbers_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("policy.f32");
        let error = || PolicyWalk::load(&T1, &path).err().unwrap().to_string();
        assert!(error().contains("policy.f32") && error().contains("No such file"), "{}", error());
        std::fs::write(&path, [0; 12]).unwrap();
        assert!(
            error().ends_with("it has 12 bytes, 834652 are the 208663 weights of the network"),
            "{}",
            error()
        );
        std::fs::write(&path, weights(&[(7, f32::NAN)])).unwrap();
        assert!(error().ends_with("weight 7 is not a finite number"), "{}", error());
        std::fs::write(&path, weights(&[])).unwrap();
        assert!(PolicyWalk::load(&T1, &path).is_ok());
    }

    #[test]
    fn a_robot_with_other_joints_is_refused() {
        let error = PolicyWalk::load(&K1, Path::new("policy.f32")).err().unwrap().to_string();
        assert_eq!(error, "the `policy` walks a T1 only: a K1 walks by a `walk`, or by its own");
    }

    #[test]
    fn without_weights_the_joints_are_where_the_network_moves_them_around() {
        let mut walk = PolicyWalk::from_bytes(&weights(&[])).unwrap();
        let mut motors = [MotorCommand::default(); JOINTS];
        walk.advance(WalkVelocity::default(), &Motion::STILL, &mut motors);
        let bent = MotorCommand { stiffness: 25.0, damping: 0.6, ..MotorCommand::default() };
        let angles = motors.map(|motor| (motor.angle * 10.0).round() / 10.0);
        assert_eq!((angles[3], angles[11], angles[14], angles[17], angles[20]), (-1.4, -0.4, 0.8, -0.4, 0.8));
        assert_eq!(motors[0], bent);
    }

    /// One path through the network, computed by hand: input 75 is the command ahead.
    #[test]
    fn a_command_passes_all_layers() {
        let normal = INPUTS * HIDDEN[0] + HIDDEN[0];
        let second = normal + 2 * HIDDEN[0];
        let third = second + HIDDEN[0] * HIDDEN[1] + HIDDEN[1];
        let last = third + HIDDEN[1] * HIDDEN[2] + HIDDEN[2];
        let set = [
            (3 * JOINTS + 3, 1.0),            // the first unit is the command ahead,
            (normal, 0.1),                    // normalised and made smaller,
            (second + 3 * HIDDEN[0], -1.0),   // which the fourth unit inverts,
            (third + 5 * HIDDEN[1] + 3, 2.0), // the sixth doubles,
            (last + 4 * HIDDEN[2] + 5, 1.0),  // and the fifth joint follows.
        ];
        let mut walk = PolicyWalk::from_bytes(&weights(&set)).unwrap();
        let mut motors = [MotorCommand::default(); JOINTS];
        walk.advance(WalkVelocity { x: 0.8, ..WalkVelocity::default() }, &Motion::STILL, &mut motors);
        // One value among 512 equal ones has the deviation sqrt(511) after normalisation.
        let unit = 0.1 * 511f64.sqrt();
        let expected = -0.5 * libm::expm1(2.0 * libm::expm1(-unit));
        assert!((motors[4].angle - expected).abs() < 1e-4, "{} {expected}", motors[4].angle);
        assert!((f64::from(walk.action[4]) + 2.0 * expected).abs() < 1e-3, "joint 4 is flipped");
    }

    #[test]
    fn steps_to_a_side_are_halved_in_a_turn() {
        let mut walk = PolicyWalk::from_bytes(&weights(&[])).unwrap();
        let mut motors = [MotorCommand::default(); JOINTS];
        let aside = WalkVelocity { y: 0.2, ..WalkVelocity::default() };
        walk.advance(aside, &Motion::STILL, &mut motors);
        assert_eq!(walk.input[3 * JOINTS + 4], 0.2);
        walk.advance(WalkVelocity { turn: -0.5, ..aside }, &Motion::STILL, &mut motors);
        assert_eq!(walk.input[3 * JOINTS + 4], 0.1);
    }
}
