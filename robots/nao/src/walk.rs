//! Walking: velocities in the plane become joint targets.

use nalgebra::{Isometry3, Translation3};

use crate::kinematics::{self, JointAngles, Side, heading, wrapped, yaw};

/// A velocity of the robot in its own frame.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct WalkVelocity {
    /// Ahead, m/s.
    pub x: f64,
    /// To the left, m/s.
    pub y: f64,
    /// Counterclockwise, rad/s.
    pub turn: f64,
}

impl WalkVelocity {
    /// Standing.
    pub const STILL: WalkVelocity = WalkVelocity { x: 0.0, y: 0.0, turn: 0.0 };
}

/// Turns velocities into targets for the joints of the legs.
pub trait WalkEngine: Send {
    /// Advances by one cycle of `seconds` towards a velocity, and sets the joints of both legs in
    /// `angles`, within their limits.
    fn advance(&mut self, wanted: WalkVelocity, seconds: f64, angles: &mut JointAngles);

    /// Whether the feet move.
    fn is_moving(&self) -> bool;

    /// Forgets the motion: the next step begins from a stand.
    fn stop(&mut self);
}

/// Height of the torso above the soles, m: 2.5 cm lower than with straight legs.
pub(crate) const TORSO_HEIGHT: f64 = 0.308;
/// Half the distance between the feet, m.
const HALF_STANCE: f64 = 0.05;
/// The height to which a foot is lifted, m.
const FOOT_LIFT: f64 = 0.02;
/// The cycles of one step: 21 of 12 ms are a quarter of a second.
const STEP_CYCLES: u32 = 21;
/// The greatest velocities: ahead, backwards, sideways, turning; m/s and rad/s.
const MAX_VELOCITIES: [f64; 4] = [0.3, 0.15, 0.15, 1.2];
/// The greatest changes of velocity, m/s2 and rad/s2.
const MAX_ACCELERATIONS: (f64, f64) = (0.6, 4.0);
/// Rate at which the toes return to their nominal position in a step, 1/s. The torso sways by it,
/// without a turn in the long run.
const TOES_RETURN: f64 = 2.0;

/// A walk of equal steps. The foot on the ground moves straight under the torso, the other swings
/// to the position at which its own stance phase begins.
///
/// The torso stays upright at a constant height. The engine has no feedback of balance: it walks on
/// the embedded field, where the torso keeps its balance by the field's rules. A real Nao needs an
/// engine that shifts its weight from foot to foot, which is what the trait is for.
#[derive(Clone, Debug)]
pub struct SteppingWalk {
    velocity: WalkVelocity,
    /// The foot on the ground.
    support: Side,
    /// Elapsed cycles of the step.
    cycle: u32,
    moving: bool,
    /// Foot positions and headings in the plane under the torso, left and right.
    feet: [PlanarPose; 2],
    /// The pose at which the swinging foot left the ground.
    lifted: PlanarPose,
}

/// A position and heading in the plane.
#[derive(Clone, Copy, PartialEq, Debug)]
struct PlanarPose {
    x: f64,
    y: f64,
    heading: f64,
}

const STANCE: [PlanarPose; 2] = [
    PlanarPose { x: 0.0, y: HALF_STANCE, heading: 0.0 },
    PlanarPose { x: 0.0, y: -HALF_STANCE, heading: 0.0 },
];

impl Default for SteppingWalk {
    fn default() -> SteppingWalk {
        SteppingWalk {
            velocity: WalkVelocity::STILL,
            support: Side::Right,
            cycle: 0,
            moving: false,
            feet: STANCE,
            lifted: STANCE[0],
        }
    }
}

impl WalkEngine for SteppingWalk {
    fn advance(&mut self, wanted: WalkVelocity, seconds: f64, angles: &mut JointAngles) {
        self.accelerate(limited(wanted), seconds);
        if self.velocity != WalkVelocity::STILL && !self.moving {
            self.moving = true;
            self.begin_step();
        }
        let mut lift = 0.0;
        if self.moving {
            self.cycle += 1;
            self.move_supporting_foot(seconds);
            lift = self.swing(seconds);
            if self.cycle == STEP_CYCLES {
                self.end_step();
            }
        }
        self.place_feet(lift, angles);
    }

    fn is_moving(&self) -> bool {
        self.moving
    }

    fn stop(&mut self) {
        *self = SteppingWalk::default();
    }
}

impl SteppingWalk {
    fn accelerate(&mut self, wanted: WalkVelocity, seconds: f64) {
        let (linear, angular) = MAX_ACCELERATIONS;
        let change = (wanted.x - self.velocity.x, wanted.y - self.velocity.y);
        let size = libm::hypot(change.0, change.1);
        let part = if size > linear * seconds { linear * seconds / size } else { 1.0 };
        self.velocity.x += change.0 * part;
        self.velocity.y += change.1 * part;
        let turn = wanted.turn - self.velocity.turn;
        self.velocity.turn += turn.clamp(-angular * seconds, angular * seconds);
    }

    fn begin_step(&mut self) {
        self.cycle = 0;
        self.lifted = self.feet[self.support.other() as usize];
    }

    /// The torso moves, so that the foot on the ground moves the other way in the torso's frame.
    fn move_supporting_foot(&mut self, seconds: f64) {
        let WalkVelocity { x, y, turn } = self.velocity;
        let foot = &mut self.feet[self.support as usize];
        let remaining = f64::from(STEP_CYCLES) / 2.0 - f64::from(self.cycle - 1);
        let toes = turn * remaining * seconds;
        let turned = (turn + TOES_RETURN * (foot.heading - toes)) * seconds;
        let (sin, cos) = libm::sincos(-turned);
        let (px, py) = (foot.x - x * seconds, foot.y - y * seconds);
        *foot = PlanarPose { x: cos * px - sin * py, y: sin * px + cos * py, heading: foot.heading - turned };
    }

    /// Moves the swinging foot towards where it lands; returns its height.
    fn swing(&mut self, seconds: f64) -> f64 {
        let part = f64::from(self.cycle) / f64::from(STEP_CYCLES);
        let swinging = self.support.other();
        let WalkVelocity { x, y, .. } = self.velocity;
        let half = f64::from(STEP_CYCLES) * seconds / 2.0;
        // A step to the side widens the stance, so that the feet never meet.
        let beside = HALF_STANCE + (y * half).abs();
        let (to_x, to_y) = (x * half, swinging.sign() * beside + y * half);
        let smooth = (1.0 - libm::cos(std::f64::consts::PI * part)) / 2.0;
        let opposite = -self.feet[self.support as usize].heading;
        self.feet[swinging as usize] = PlanarPose {
            x: self.lifted.x + (to_x - self.lifted.x) * smooth,
            y: self.lifted.y + (to_y - self.lifted.y) * smooth,
            // One motor turns the toes of both feet.
            heading: opposite,
        };
        FOOT_LIFT * libm::sin(std::f64::consts::PI * part)
    }

    /// The feet swap roles; the walk ends once both feet are in their positions of a stand.
    fn end_step(&mut self) {
        self.support = self.support.other();
        let near = |foot: &PlanarPose, stance: &PlanarPose| {
            let PlanarPose { x, y, heading } = *foot;
            (x - stance.x).abs() < 1e-3
                && (y - stance.y).abs() < 1e-3
                && wrapped(heading - stance.heading).abs() < 1e-2
        };
        let stands = self.feet.iter().zip(&STANCE).all(|(foot, stance)| near(foot, stance));
        if self.velocity == WalkVelocity::STILL && stands {
            self.moving = false;
        } else {
            self.begin_step();
        }
    }

    fn place_feet(&self, lift: f64, angles: &mut JointAngles) {
        let swinging = self.support.other();
        let pose = |side: Side| {
            let PlanarPose { x, y, heading } = self.feet[side as usize];
            let height = if side == swinging { lift } else { 0.0 };
            Isometry3::from_parts(Translation3::new(x, y, height - TORSO_HEIGHT), yaw(heading))
        };
        let support = pose(self.support);
        // The foot on the ground determines the shared joint.
        kinematics::place_foot_and_toes(self.support, &support, angles);
        let shared = angles[crate::anatomy::NaoJoint::LHipYawPitch as usize];
        kinematics::place_foot(swinging, &pose(swinging), shared, angles);
    }
}

/// The velocity, or the greatest possible one in its direction: the possible ones are an ellipsoid.
fn limited(wanted: WalkVelocity) -> WalkVelocity {
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    let WalkVelocity { x, y, turn } = wanted;
    let (x, y, turn) = (finite(x), finite(y), finite(turn));
    let [ahead, backwards, sideways, around] = MAX_VELOCITIES;
    let along = if x >= 0.0 { ahead } else { backwards };
    let effort =
        ((x / along) * (x / along) + (y / sideways) * (y / sideways) + (turn / around) * (turn / around))
            .sqrt();
    let part = if effort > 1.0 { 1.0 / effort } else { 1.0 };
    WalkVelocity { x: x * part, y: y * part, turn: turn * part }
}

/// The displacement of the torso between two sets of angles, as the foot on the ground shows it: x,
/// y and heading in the frame before.
pub(crate) fn displacement(before: &JointAngles, after: &JointAngles) -> [f64; 3] {
    let feet = Side::BOTH
        .map(|side| (kinematics::foot_in_torso(side, before), kinematics::foot_in_torso(side, after)));
    let height =
        |(before, after): &(Isometry3<f64>, Isometry3<f64>)| before.translation.z + after.translation.z;
    let [left, right] = feet;
    let (before, after) = if height(&left) <= height(&right) { left } else { right };
    let moved = before * after.inverse();
    [moved.translation.x, moved.translation.y, heading(&moved)]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::anatomy::limits;
    use crate::lola::{CYCLE_SECONDS, JOINTS};

    /// Walks for a time and returns the way by odometry of the feet: x, y and heading.
    fn walk(engine: &mut SteppingWalk, wanted: WalkVelocity, seconds: f64) -> [f64; 3] {
        let mut angles = [0.0; JOINTS];
        // The foot that swings is as high as in the middle of its way.
        engine.clone().place_feet(if engine.moving { FOOT_LIFT } else { 0.0 }, &mut angles);
        let mut pose = [0.0; 3];
        for _ in 0..(seconds / CYCLE_SECONDS).round() as usize {
            let before = angles;
            engine.advance(wanted, CYCLE_SECONDS, &mut angles);
            let [x, y, turn] = displacement(&before, &angles);
            let (sin, cos) = libm::sincos(pose[2]);
            pose = [pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y, pose[2] + turn];
        }
        pose
    }

    #[test]
    fn the_feet_carry_the_torso_with_the_velocity_that_was_asked_for() {
        for (x, y, turn) in
            [(0.2, 0.0, 0.0), (-0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, -0.1, 0.0), (0.0, 0.0, 0.8)]
        {
            let mut engine = SteppingWalk::default();
            walk(&mut engine, WalkVelocity { x, y, turn }, 2.0);
            let moved = walk(&mut engine, WalkVelocity { x, y, turn }, 3.024);
            let error = (moved[0] - 3.024 * x).abs().max((moved[1] - 3.024 * y).abs());
            assert!(turn != 0.0 || error < 0.01, "{x} {y}: {moved:?}");
            assert!((moved[2] - 3.024 * turn).abs() < 0.01, "{turn}: {moved:?}");
        }
    }

    #[test]
    fn a_walk_ends_in_a_stand() {
        let mut engine = SteppingWalk::default();
        walk(&mut engine, WalkVelocity { x: 0.2, y: 0.05, turn: 0.4 }, 1.0);
        assert!(engine.is_moving());
        walk(&mut engine, WalkVelocity::STILL, 6.0);
        assert!(!engine.is_moving(), "{engine:?}");
        let moved = walk(&mut engine, WalkVelocity::STILL, 1.0);
        assert!(moved.iter().all(|part| part.abs() < 1e-12), "{moved:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
        #[test]
        fn every_target_is_within_the_limits(
            velocities in prop::collection::vec((-1.0..1.0, -1.0..1.0, -3.0..3.0, 1..60_usize), 1..8),
        ) {
            let mut engine = SteppingWalk::default();
            let mut angles = [0.0; JOINTS];
            for (x, y, turn, cycles) in velocities {
                for _ in 0..cycles {
                    engine.advance(WalkVelocity { x, y, turn }, CYCLE_SECONDS, &mut angles);
                    for (joint, &target) in angles.iter().enumerate().skip(Side::Left.leg() - 1).take(11) {
                        prop_assert!(limits(joint).contains(target), "joint {joint}: {target} {engine:?}");
                    }
                }
            }
        }
    }
}
