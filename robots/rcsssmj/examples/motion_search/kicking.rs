//! The search of the kick: trials in which the ball lies in slightly different places.

use std::error::Error;

use monas_rcsssmj::kinematics::Foot;
use monas_rcsssmj::walk::{Motors, WalkEngine, WalkVelocity};
use monas_rcsssmj::{Humanoid, K1, Kick, KickParameters, SineParameters, SineWalk};
use rand_core::Rng;
use rand_pcg::Pcg32;

use crate::world::{CYCLE, World};
use crate::{Motion, Searched, begin};

/// The kick, from the stand of the project's own walk.
pub(crate) struct Kicking {
    robot: &'static Humanoid,
    walk: SineWalk,
    searched: Vec<Searched>,
}

/// The start of the search for the T1: the result of an earlier search for one foot, rounded.
const SEARCHED_PARAMETERS: &[Searched] = &[
    ("ball_x", 0.21, 0.014),
    ("ball_y", 0.1, 0.0105),
    ("height", 0.52, 0.0105),
    ("foot", 0.015, 0.0105),
    ("lean", 0.028, 0.035),
    ("shift", 0.045, 0.0105),
    ("tilt", -0.003, 0.035),
    ("lift", 0.15, 0.0105),
    ("raise", 0.15, 0.014),
    ("inward", -0.051, 0.0105),
    ("back", 0.0, 0.028),
    ("ahead", 0.33, 0.028),
    ("toes", 0.22, 0.07),
    ("twist", -0.36, 0.105),
    ("shifting", 0.86, 0.07),
    ("lifting", 0.15, 0.056),
    ("swinging", 0.04, 0.021),
    ("holding", 0.0, 0.035),
    ("returning", 0.33, 0.056),
    ("unshifting", 0.2, 0.07),
    ("ankle_pitch", 1.28, 0.14),
    ("ankle_pitch_rate", 0.072, 0.021),
    ("hip_pitch", -0.071, 0.14),
    ("hip_pitch_rate", 0.04, 0.014),
    ("ankle_roll", 0.25, 0.14),
    ("ankle_roll_rate", -0.011, 0.021),
    ("hip_roll", 1.28, 0.14),
    ("hip_roll_rate", 0.092, 0.014),
];

/// The start of the other values for the K1: the kick of the T1, scaled by the length of the legs.
const K1_BEGIN: &[(&str, f64)] = &[
    ("ball_x", 0.23),
    ("ball_y", 0.13),
    ("height", 0.465),
    ("foot", -0.01),
    ("lean", 0.01),
    ("shift", 0.055),
    ("lift", 0.1),
    ("raise", 0.08),
    ("inward", -0.05),
    ("ahead", 0.25),
    ("toes", 0.2),
    ("shifting", 0.7),
    ("lifting", 0.12),
    ("swinging", 0.03),
    ("ankle_pitch", 1.0),
    ("ankle_pitch_rate", 0.1),
    ("hip_pitch", 0.6),
    ("hip_pitch_rate", 0.06),
    ("ankle_roll", 0.1),
    ("ankle_roll_rate", -0.05),
    ("hip_roll", 0.6),
];

/// The values that are not searched.
const FIXED_PARAMETERS: [(&str, f64); 4] =
    [("still", 1.2), ("blending", 0.4), ("stiffness", 200.0), ("damping", 5.0)];

/// Kicks that are tried of each kick.
const KICKS: usize = 6;
/// By how much the place of the ball differs from that of the kick, m.
const POSITION_SPREAD: f64 = 0.03;
/// Time for which the robot stands before a kick, to twice that, s; after it the robot walks a
/// little.
const STANDING_TIME: f64 = 1.0;
const ROLLING_TIME: f64 = 3.0;
const WALKING_TIME: f64 = 2.0;
/// The longest kick, s.
const MAX_KICK_TIME: f64 = 8.0;
/// A torso with a smaller cosine of its inclination has fallen.
const MIN_UPRIGHT_COSINE: f64 = 0.54;
/// The distance at which a kick costs nothing, m.
const FREE_DISTANCE: f64 = 6.0;
/// The cost of a fall, m.
const FALL_COST: f64 = 6.0;
/// The cost of a metre to the side.
const LATERAL_COST: f64 = 1.0;
/// The cost of the greatest inclination, by 1 minus its cosine.
const INCLINATION_COST: f64 = 10.0;

impl Motion for Kicking {
    fn searched(&self) -> &[Searched] {
        &self.searched
    }

    fn cost(&self, values: &[f64], world: &mut World, chance: &mut Pcg32) -> Result<f64, Box<dyn Error>> {
        let kick = parameters(values);
        let mut cost = 0.0;
        for trial in 0..KICKS {
            // The feet differ: the masses of the legs do.
            let (foot, side) = if trial % 2 == 0 { (Foot::Left, 1.0) } else { (Foot::Right, -1.0) };
            let mut spread =
                || POSITION_SPREAD * (2.0 * f64::from(chance.next_u32()) / f64::from(u32::MAX) - 1.0);
            let ball = [self.robot.hips().x + kick.ball_x + spread(), side * (kick.ball_y + spread())];
            let standing = STANDING_TIME + STANDING_TIME * f64::from(chance.next_u32()) / f64::from(u32::MAX);
            cost += self.trial_cost(&mut Kick::new(self.robot, kick, foot), ball, standing, world)?;
        }
        Ok(cost / KICKS as f64)
    }

    fn file(&self, values: &[f64]) -> String {
        parameters(values).to_toml()
    }
}

impl Kicking {
    /// The kick of a robot, from the stand of its walk.
    pub(crate) fn of(robot: &'static Humanoid, walk: SineParameters) -> Kicking {
        let elsewhere: &[_] = if *robot == K1 { K1_BEGIN } else { &[] };
        Kicking { robot, walk: SineWalk::new(robot, walk), searched: begin(SEARCHED_PARAMETERS, elsewhere) }
    }

    fn trial_cost(
        &self,
        kick: &mut Kick,
        ball: [f64; 2],
        standing: f64,
        world: &mut World,
    ) -> Result<f64, Box<dyn Error>> {
        let mut walk = self.walk.clone();
        let mut motors = Motors::default();
        let mut state = world.reset(ball)?;
        let cycles = |seconds: f64| (seconds / CYCLE) as usize;
        let (mut inclination, mut after) = (0.0_f64, None);
        for cycle in 0..cycles(standing + MAX_KICK_TIME + ROLLING_TIME) {
            let walks = after.is_some_and(|since| cycle > since + cycles(ROLLING_TIME - WALKING_TIME));
            let velocity = WalkVelocity { x: if walks { -0.1 } else { 0.0 }, ..WalkVelocity::default() };
            walk.advance(velocity, &state.motion, &mut motors);
            if cycle > cycles(standing) && after.is_none() && !kick.advance(&state.motion, &mut motors) {
                after = Some(cycle);
            }
            state = world.cycle(&motors)?;
            inclination = inclination.max(1.0 - state.upright);
            let moved = [state.ball[0] - ball[0], state.ball[1] - ball[1]];
            if state.upright < MIN_UPRIGHT_COSINE {
                return Ok(FALL_COST + FREE_DISTANCE - moved[0].clamp(0.0, FREE_DISTANCE));
            }
            if after.is_some_and(|since| cycle > since + cycles(ROLLING_TIME)) {
                break;
            }
        }
        let moved = [state.ball[0] - ball[0], state.ball[1] - ball[1]];
        Ok(FREE_DISTANCE - moved[0].clamp(-1.0, FREE_DISTANCE)
            + LATERAL_COST * moved[1].abs()
            + INCLINATION_COST * inclination)
    }
}

fn parameters(values: &[f64]) -> KickParameters {
    let mut kick = KickParameters::default();
    let searched = SEARCHED_PARAMETERS.iter().map(|(name, ..)| *name).zip(values.iter().copied());
    for (name, value) in searched.chain(FIXED_PARAMETERS) {
        kick.set(name, value);
    }
    kick
}
