//! The search of the walk: trials in which the robot starts, turns, changes its speed and stops.

use std::error::Error;

use monas_rcsssmj::walk::{Motors, Ramp, WalkEngine, WalkVelocity};
use monas_rcsssmj::{Humanoid, K1, SineParameters, SineWalk};
use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::world::{CYCLE, State, World};
use crate::{Motion, Searched, begin};

/// The walk of a robot.
pub(crate) struct Walking {
    robot: &'static Humanoid,
    searched: Vec<Searched>,
    /// The greatest speed ahead, m/s.
    fast: f64,
}

/// The start of the search for the T1: the result of an earlier search, rounded.
const SEARCHED_PARAMETERS: &[Searched] = &[
    ("frequency", 1.9, 0.12),
    ("height", 0.45, 0.009),
    ("foot", 0.02, 0.009),
    ("lean", 0.003, 0.024),
    ("lift", 0.058, 0.006),
    ("support", 0.19, 0.06),
    ("linear", 0.0, 0.12),
    ("phase", 0.6, 0.12),
    ("sway", -0.007, 0.006),
    ("sway_phase", -0.28, 0.3),
    ("ankle_sway", 0.016, 0.018),
    ("spread", 0.018, 0.006),
    ("stride", 1.19, 0.18),
    ("drift", 0.048, 0.018),
    ("side_stride", 1.0, 0.18),
    ("turn_stride", 1.27, 0.24),
    ("ankle_pitch", 1.36, 0.12),
    ("ankle_pitch_rate", 0.11, 0.018),
    ("hip_pitch", 0.65, 0.09),
    ("hip_pitch_rate", 0.058, 0.012),
    ("ankle_roll", -0.057, 0.09),
    ("ankle_roll_rate", 0.082, 0.018),
    ("hip_roll", 0.095, 0.09),
    ("hip_roll_rate", -0.027, 0.012),
    ("step_pitch", 0.46, 0.24),
    ("step_pitch_rate", 0.22, 0.03),
    ("step_roll", 0.39, 0.18),
    ("step_roll_rate", 0.19, 0.06),
    ("acceleration", 0.65, 0.12),
    ("turn_acceleration", 3.44, 0.3),
    ("starting", 0.6, 0.09),
];

/// The start of the other values for the K1: the walk of the T1, scaled by the length of the legs.
const K1_BEGIN: &[(&str, f64)] = &[
    ("frequency", 2.2),
    ("height", 0.4),
    ("foot", 0.01),
    ("lean", 0.02),
    ("lift", 0.06),
    ("support", 0.24),
    ("phase", 0.7),
    ("sway", -0.006),
    ("sway_phase", -2.1),
    ("ankle_sway", 0.1),
    ("spread", 0.025),
    ("stride", 1.0),
    ("drift", 0.05),
    ("side_stride", 1.3),
    ("turn_stride", 1.4),
    ("ankle_pitch", 1.5),
    ("ankle_pitch_rate", 0.08),
    ("hip_pitch", 0.75),
    ("hip_pitch_rate", 0.06),
    ("ankle_roll", -0.16),
    ("ankle_roll_rate", 0.08),
    ("hip_roll", 0.5),
    ("hip_roll_rate", -0.013),
    ("step_pitch", 0.9),
    ("step_pitch_rate", 0.09),
    ("step_roll", 0.75),
    ("step_roll_rate", 0.3),
    ("acceleration", 0.7),
    ("turn_acceleration", 4.0),
    ("starting", 0.4),
];

/// The greatest speed ahead, m/s, of a T1 and of a K1.
const MAX_SPEED: f64 = 0.8;
const K1_FAST: f64 = 0.5;

/// Values that are not searched, besides the greatest speed ahead and the gains of the motors.
const FIXED_PARAMETERS: [(&str, f64); 3] = [("backwards", 0.2), ("sideways", 0.2), ("turning", 0.8)];

/// Seconds, and the velocities in them: ahead, at most the greatest, to the left, and of turning.
type Part = (f64, [f64; 3]);

const TRIALS: [&[Part]; 3] = [
    &[
        (3.0, [0.3, 0.0, 0.0]),
        (1.7, [0.0, 0.0, 0.0]),
        (4.0, [MAX_SPEED, 0.0, 0.0]),
        (2.3, [0.0, 0.0, 0.6]),
        (2.0, [0.0, 0.0, 0.0]),
    ],
    &[
        (3.0, [0.0, 0.0, 0.7]),
        (3.0, [0.3, 0.0, -0.5]),
        (1.5, [0.0, 0.0, 0.0]),
        (2.5, [-0.2, 0.0, 0.0]),
        (1.2, [0.0, 0.0, 0.0]),
        (3.0, [0.15, 0.0, 0.0]),
        (2.0, [0.0, 0.0, -0.7]),
    ],
    &[
        (2.5, [0.0, 0.12, 0.0]),
        (2.5, [0.0, -0.12, 0.0]),
        (1.3, [0.0, 0.0, 0.0]),
        (3.0, [0.4, 0.0, 0.5]),
        (1.0, [0.0, 0.0, 0.0]),
        (3.0, [MAX_SPEED, 0.0, 0.0]),
        (1.0, [-0.1, 0.0, 0.0]),
        (3.0, [MAX_SPEED, 0.0, -0.2]),
    ],
];
/// By how much the seconds of a part differ by chance, in both directions.
const TIME_SPREAD: f64 = 0.4;
/// Time for which the robot stands first, s.
const STANDING_TIME: f64 = 1.0;
/// Time for the robot to reach a velocity before deviations count, s.
const SETTLING_TIME: f64 = 0.8;
/// Deviations that cost as much as a second: m/s, m/s and rad/s.
const DEVIATIONS: [f64; 3] = [0.2, 0.15, 0.4];
/// The part of a deviation that counts while the robot is to stand.
const STANDING_WEIGHT: f64 = 0.3;
/// The cost of a fall, and the factor for the part of the trial that is left after it.
const FALL_COST: [f64; 2] = [1.5, 4.0];
/// The cost of the mean inclination.
const INCLINATION_COST: f64 = 15.0;
/// A torso with a smaller cosine of its inclination has fallen.
const MIN_UPRIGHT_COSINE: f64 = 0.54;

impl Walking {
    pub(crate) fn of(robot: &'static Humanoid) -> Walking {
        let (elsewhere, fast): (&[_], _) = if *robot == K1 { (K1_BEGIN, K1_FAST) } else { (&[], MAX_SPEED) };
        Walking { robot, searched: begin(SEARCHED_PARAMETERS, elsewhere), fast }
    }

    fn parameters(&self, values: &[f64]) -> SineParameters {
        let mut walk = SineParameters::default();
        let searched = self.searched.iter().map(|(name, ..)| *name).zip(values.iter().copied());
        let (leg, other) = (self.robot.gains(self.robot.joint_count() - 1), self.robot.gains(0));
        let gains = [
            ("leg_stiffness", leg.0),
            ("leg_damping", leg.1),
            ("other_stiffness", other.0),
            ("other_damping", other.1),
        ];
        for (name, value) in searched.chain(FIXED_PARAMETERS).chain(gains).chain([("forwards", self.fast)]) {
            walk.set(name, value);
        }
        walk
    }
}

impl Motion for Walking {
    fn searched(&self) -> &[Searched] {
        &self.searched
    }

    fn cost(&self, values: &[f64], world: &mut World, chance: &mut Pcg32) -> Result<f64, Box<dyn Error>> {
        let walk = SineWalk::new(self.robot, self.parameters(values));
        let mut cost = 0.0;
        for trial in TRIALS {
            cost += trial_cost(&walk, trial, world, chance)?;
        }
        Ok(cost / TRIALS.len() as f64)
    }

    fn file(&self, values: &[f64]) -> String {
        self.parameters(values).to_toml()
    }
}

fn trial_cost(
    walk: &SineWalk,
    trial: &[Part],
    world: &mut World,
    chance: &mut Pcg32,
) -> Result<f64, Box<dyn Error>> {
    let mut walker = Walker { walk: walk.clone(), ramp: Ramp::default(), motors: Motors::default() };
    let mut state = world.reset([20.0, 0.0])?;
    let (mut deviation, mut inclination, mut cycles) = (0.0, 0.0, 0);
    let stand = [(STANDING_TIME, [0.0; 3])];
    let fast = walk.gait().x.high;
    let parts: Vec<(usize, [f64; 3])> = stand
        .iter()
        .chain(trial)
        .map(|(seconds, velocity)| {
            let share = f64::from(chance.next_u32()) / f64::from(u32::MAX);
            let [x, y, turn] = *velocity;
            (((seconds + TIME_SPREAD * (2.0 * share - 1.0)) / CYCLE) as usize, [x.min(fast), y, turn])
        })
        .collect();
    let total: usize = parts.iter().map(|(cycles, _)| cycles).sum();
    for (part, (length, velocity)) in parts.iter().enumerate() {
        let reaching = ((SETTLING_TIME / CYCLE) as usize).min(length / 2);
        let (mut sum, mut counted) = ([0.0; 3], 0);
        for cycle in 0..*length {
            let before = state;
            state = world.cycle(walker.advance(*velocity, &state))?;
            if state.upright < MIN_UPRIGHT_COSINE {
                let left = (total - cycles) as f64 / total as f64;
                return Ok(deviation / total as f64
                    + FALL_COST[0]
                    + FALL_COST[1] * left
                    + INCLINATION_COST * inclination / cycles.max(1) as f64);
            }
            cycles += 1;
            inclination += 1.0 - state.upright;
            if cycle >= reaching {
                let step = moved(&before, &state);
                (0..3).for_each(|axis| sum[axis] += step[axis]);
                counted += 1;
            }
        }
        if part > 0 {
            let weight = if *velocity == [0.0; 3] { STANDING_WEIGHT } else { 1.0 } * *length as f64;
            for axis in 0..3 {
                let mean = sum[axis] / (f64::from(counted.max(1)) * CYCLE);
                deviation += weight * (mean - velocity[axis]).abs() / DEVIATIONS[axis];
            }
        }
    }
    Ok(deviation / total as f64 + INCLINATION_COST * inclination / total as f64)
}

/// The motion of a robot in its own frame, m and rad.
pub(crate) fn moved(from: &State, to: &State) -> [f64; 3] {
    let (sin, cos) = libm::sincos(from.heading);
    let (x, y) = (to.position[0] - from.position[0], to.position[1] - from.position[1]);
    let turn = libm::remainder(to.heading - from.heading, std::f64::consts::TAU);
    [cos * x + sin * y, cos * y - sin * x, turn]
}

struct Walker {
    walk: SineWalk,
    ramp: Ramp,
    motors: Motors,
}

impl Walker {
    fn advance(&mut self, [x, y, turn]: [f64; 3], state: &State) -> &Motors {
        let velocity = self.ramp.advance(WalkVelocity { x, y, turn }, &self.walk.gait(), CYCLE);
        self.walk.advance(velocity, &state.motion, &mut self.motors);
        &self.motors
    }
}
