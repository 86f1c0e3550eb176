//! Contacts between bodies, ball and posts; the only module that uses rapier.
//!
//! Rapier resolves contacts; walking bodies and the rolling ball are computed elsewhere and passed
//! in as velocities. Rapier computes in `f32` with its `enhanced-determinism`, the rest of the
//! crate in `f64`; values are converted only here.
//!
//! A robot has two shapes: its torso, a disk that collides with other torsos, posts and the
//! carpet's edge, and its base (feet, or the lying body), which collides with the ball. As with
//! real robots, the ball can therefore come closer to the feet than two robots can to each other.

use crate::pose::{Pose, Vector, normalize_angle};
use crate::{FieldGeometry, FieldSide, Physics, STEP};
use rapier::{ColliderBuilder, ColliderHandle, Group, InteractionGroups, RigidBodyBuilder, RigidBodyHandle};
use rapier2d::prelude as rapier;

const BALL: Group = Group::GROUP_1;
const BASE: Group = Group::GROUP_2;
const TORSO: Group = Group::GROUP_3;
const POST: Group = Group::GROUP_4;
const EDGE: Group = Group::GROUP_5;
const WALL: Group = Group::GROUP_6;

/// Half the thickness of walls and of the carpet's edge: larger than any displacement in one step.
const WALL_HALF_THICKNESS: f64 = 0.25;

/// Shapes that are nearer than this count as touching, as do shapes that push each other: a quick
/// ball bounces within one step and is farther away both before and after it.
const TOUCH_DISTANCE: f32 = 0.003;

/// The part of a robot that collides with the ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum BallObstacle {
    /// The feet of an upright robot.
    Feet,
    /// A body on the ground: it reaches from where it stood in a direction of its own frame.
    Lying { direction: Vector, reach: f64 },
}

struct RobotHandles {
    body: RigidBodyHandle,
    torso: ColliderHandle,
    base: ColliderHandle,
}

/// All bodies that can collide.
pub(crate) struct Arena {
    world: rapier::PhysicsWorld,
    ball: RigidBodyHandle,
    ball_shape: ColliderHandle,
    robots: Vec<RobotHandles>,
    feet: (rapier::SharedShape, rapier::Pose),
    lying_radius: f64,
    foot_restitution: f32,
    lying_restitution: f32,
}

impl Arena {
    pub(crate) fn new(field: &FieldGeometry, physics: &Physics, robots: usize) -> Self {
        let mut world = rapier::PhysicsWorld::new();
        world.gravity = rapier::Vector::ZERO;
        world.integration_parameters.dt = STEP as f32;
        build_posts(&mut world, field, physics);
        build_edge(&mut world, field);
        if field.has_walls() {
            build_walls(&mut world, field, physics);
        }
        let (ball, ball_shape) = build_ball(&mut world, physics);
        let feet = feet(physics);
        let robots = (0..robots).map(|_| build_robot(&mut world, physics, &feet)).collect();
        Self {
            world,
            ball,
            ball_shape,
            robots,
            feet,
            lying_radius: physics.lying_radius,
            foot_restitution: physics.foot_restitution as f32,
            lying_restitution: physics.lying_restitution as f32,
        }
    }

    /// Advances all bodies by one step.
    pub(crate) fn step(&mut self) {
        self.world.step();
    }

    /// Position and velocity of the ball.
    pub(crate) fn ball(&self) -> (Vector, Vector) {
        let ball = &self.world.bodies[self.ball];
        (wide(ball.translation()), wide(ball.linvel()))
    }

    pub(crate) fn place_ball(&mut self, position: Vector, velocity: Vector) {
        self.world.bodies[self.ball].set_translation(narrow(position), true);
        self.set_ball_velocity(velocity);
    }

    pub(crate) fn set_ball_velocity(&mut self, velocity: Vector) {
        self.world.bodies[self.ball].set_linvel(narrow(velocity), true);
    }

    pub(crate) fn robot_pose(&self, robot: usize) -> Pose {
        let body = &self.world.bodies[self.robots[robot].body];
        let rotation = body.rotation();
        let heading = libm::atan2(f64::from(rotation.sin()), f64::from(rotation.cos()));
        Pose { position: wide(body.translation()), heading }
    }

    /// Velocity of a robot in the field frame.
    pub(crate) fn robot_velocity(&self, robot: usize) -> Vector {
        wide(self.world.bodies[self.robots[robot].body].linvel())
    }

    /// Places a robot at a pose, at rest.
    pub(crate) fn place_robot(&mut self, robot: usize, pose: Pose) {
        let (sin, cos) = libm::sincos(normalize_angle(pose.heading));
        let rotation = rapier::Rotation::from_cos_sin_unchecked(cos as f32, sin as f32);
        let body = &mut self.world.bodies[self.robots[robot].body];
        body.set_position(rapier::Pose::from_parts(narrow(pose.position), rotation), true);
        body.set_linvel(rapier::Vector::ZERO, true);
        body.set_angvel(0.0, true);
    }

    /// Sets a robot's velocity in the field frame and its angular velocity.
    pub(crate) fn drive_robot(&mut self, robot: usize, velocity: Vector, turn: f64) {
        let body = &mut self.world.bodies[self.robots[robot].body];
        body.set_linvel(narrow(velocity), true);
        body.set_angvel(turn as f32, true);
    }

    /// Changes the part of a robot that collides with the ball.
    pub(crate) fn set_base(&mut self, robot: usize, base: BallObstacle) {
        let ((shape, position), restitution) = match base {
            BallObstacle::Feet => (self.feet.clone(), self.foot_restitution),
            BallObstacle::Lying { direction, reach } => {
                (self.lying(direction, reach), self.lying_restitution)
            }
        };
        let collider = &mut self.world.colliders[self.robots[robot].base];
        collider.set_shape(shape);
        collider.set_position_wrt_parent(position);
        collider.set_restitution(restitution);
    }

    /// Puts a robot on the field, or removes it from all contacts.
    pub(crate) fn set_present(&mut self, robot: usize, present: bool) {
        let handles = &self.robots[robot];
        for shape in [handles.torso, handles.base] {
            self.world.colliders[shape].set_enabled(present);
        }
    }

    /// Whether a robot touches the ball.
    pub(crate) fn touches_ball(&self, robot: usize) -> bool {
        self.touching(self.robots[robot].base, self.ball_shape)
    }

    /// Whether two robots touch each other.
    pub(crate) fn robots_touch(&self, one: usize, other: usize) -> bool {
        self.touching(self.robots[one].torso, self.robots[other].torso)
    }

    fn touching(&self, one: ColliderHandle, other: ColliderHandle) -> bool {
        let Some(pair) = self.world.narrow_phase.contact_pair(one, other) else { return false };
        let near = pair.find_deepest_contact().is_some_and(|(_, contact)| contact.dist <= TOUCH_DISTANCE);
        near || pair.total_impulse_magnitude() > 0.0
    }

    fn lying(&self, direction: Vector, reach: f64) -> (rapier::SharedShape, rapier::Pose) {
        let middle = direction * (reach / 2.0);
        let half = direction.abs() * (reach / 2.0).max(self.lying_radius)
            + left_of(direction).abs() * self.lying_radius;
        let shape = rapier::SharedShape::cuboid(half.x as f32, half.y as f32);
        (shape, rapier::Pose::from_translation(narrow(middle)))
    }
}

/// `direction`, rotated counterclockwise by a right angle.
fn left_of(direction: Vector) -> Vector {
    Vector::new(-direction.y, direction.x)
}

fn build_ball(world: &mut rapier::PhysicsWorld, physics: &Physics) -> (RigidBodyHandle, ColliderHandle) {
    let body = RigidBodyBuilder::dynamic().can_sleep(false).lock_rotations().ccd_enabled(true);
    let shape = ColliderBuilder::ball(physics.ball_radius as f32)
        .mass(physics.ball_mass as f32)
        .friction(0.0)
        .restitution(0.0)
        .restitution_combine_rule(rapier::CoefficientCombineRule::Max)
        .collision_groups(groups(BALL, BASE | POST | WALL));
    world.insert(body, shape)
}

fn build_robot(
    world: &mut rapier::PhysicsWorld,
    physics: &Physics,
    feet: &(rapier::SharedShape, rapier::Pose),
) -> RobotHandles {
    let body = RigidBodyBuilder::dynamic().can_sleep(false);
    let torso = ColliderBuilder::ball(physics.robot_radius as f32)
        .mass(physics.robot_mass as f32)
        .friction(0.0)
        .restitution(0.0)
        .collision_groups(groups(TORSO, TORSO | POST | EDGE));
    let (body, torso) = world.insert(body, torso);
    let base = ColliderBuilder::new(feet.0.clone())
        .position(feet.1)
        .density(0.0)
        .friction(0.0)
        .restitution(physics.foot_restitution as f32)
        .collision_groups(groups(BASE, BALL));
    let base = world.insert_collider(base, Some(body));
    RobotHandles { body, torso, base }
}

fn feet(physics: &Physics) -> (rapier::SharedShape, rapier::Pose) {
    let half_length = (physics.foot_front + physics.foot_back) / 2.0;
    let middle = (physics.foot_front - physics.foot_back) / 2.0;
    let shape = rapier::SharedShape::cuboid(half_length as f32, physics.foot_side as f32);
    (shape, rapier::Pose::from_translation(narrow(Vector::new(middle, 0.0))))
}

fn build_posts(world: &mut rapier::PhysicsWorld, field: &FieldGeometry, physics: &Physics) {
    for post in [FieldSide::Left, FieldSide::Right].into_iter().flat_map(|side| field.posts(side)) {
        let shape = ColliderBuilder::ball(field.post_radius as f32)
            .translation(narrow(post))
            .friction(0.0)
            .restitution(physics.post_restitution as f32)
            .collision_groups(groups(POST, BALL | TORSO));
        world.insert_collider(shape, None);
    }
}

/// The edge of the carpet, which robots cannot cross.
fn build_edge(world: &mut rapier::PhysicsWorld, field: &FieldGeometry) {
    let far = Vector::new(field.half_length() + field.border, field.half_width() + field.border);
    let t = WALL_HALF_THICKNESS;
    for sign in [-1.0, 1.0] {
        let ends = Vector::new(sign * (far.x + t), 0.0);
        let sides = Vector::new(0.0, sign * (far.y + t));
        world.insert_collider(barrier(ends, Vector::new(t, far.y + 2.0 * t), 0.0, groups(EDGE, TORSO)), None);
        world
            .insert_collider(barrier(sides, Vector::new(far.x + 2.0 * t, t), 0.0, groups(EDGE, TORSO)), None);
    }
}

/// Walls on the lines that reflect the ball, with gaps at the goals.
fn build_walls(world: &mut rapier::PhysicsWorld, field: &FieldGeometry, physics: &Physics) {
    let t = WALL_HALF_THICKNESS;
    let groups = groups(WALL, BALL);
    let beside_goal = (field.width - field.goal_width) / 4.0;
    for sign in [-1.0, 1.0] {
        let touch_line = Vector::new(0.0, sign * (field.half_width() + t));
        let half = Vector::new(field.half_length() + 2.0 * t, t);
        world.insert_collider(barrier(touch_line, half, physics.post_restitution, groups), None);
        for end in [-1.0, 1.0] {
            let middle =
                Vector::new(end * (field.half_length() + t), sign * (field.goal_width / 2.0 + beside_goal));
            let half = Vector::new(t, beside_goal);
            world.insert_collider(barrier(middle, half, physics.post_restitution, groups), None);
        }
    }
}

fn barrier(middle: Vector, half: Vector, restitution: f64, groups: InteractionGroups) -> ColliderBuilder {
    ColliderBuilder::cuboid(half.x as f32, half.y as f32)
        .translation(narrow(middle))
        .friction(0.0)
        .restitution(restitution as f32)
        .collision_groups(groups)
}

fn groups(own: Group, meets: Group) -> InteractionGroups {
    InteractionGroups::new(own, meets, rapier::InteractionTestMode::And)
}

fn narrow(vector: Vector) -> rapier::Vector {
    rapier::Vector::new(vector.x as f32, vector.y as f32)
}

fn wide(vector: rapier::Vector) -> Vector {
    Vector::new(f64::from(vector.x), f64::from(vector.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arena(robots: usize) -> Arena {
        Arena::new(&FieldGeometry::default(), &Physics::default(), robots)
    }

    #[test]
    fn a_ball_bounces_from_a_post() {
        let mut arena = arena(0);
        let post = FieldGeometry::default().posts(FieldSide::Right)[0];
        arena.place_ball(post - Vector::new(0.3, 0.0), Vector::new(2.0, 0.0));
        (0..30).for_each(|_| arena.step());
        let (_, velocity) = arena.ball();
        assert!((velocity.x + 2.0 * Physics::default().post_restitution).abs() < 0.05, "{velocity}");
    }

    #[test]
    fn the_ball_touches_feet_and_leaves() {
        let mut arena = arena(1);
        arena.place_robot(0, Pose::default());
        arena.place_ball(Vector::new(0.3, 0.0), Vector::new(-1.0, 0.0));
        let touched = (0..40).filter(|_| {
            arena.step();
            arena.touches_ball(0)
        });
        assert!(touched.count() >= 1);
        let (position, velocity) = arena.ball();
        assert!(position.x > 0.12 && velocity.x > 0.0, "{position} {velocity}");
    }

    #[test]
    fn torsos_meet_farther_out_than_feet() {
        let mut arena = arena(2);
        arena.place_robot(0, Pose::default());
        arena.place_robot(1, Pose::new(0.4, 0.0, 0.0));
        for _ in 0..200 {
            arena.drive_robot(0, Vector::zeros(), 0.0);
            arena.drive_robot(1, Vector::new(-0.2, 0.0), 0.0);
            arena.step();
        }
        assert!(arena.robots_touch(0, 1));
        let gap = arena.robot_pose(1).position.x - arena.robot_pose(0).position.x;
        assert!((gap - 0.26).abs() < 0.01, "{gap}");
    }

    #[test]
    fn an_absent_robot_has_no_contacts() {
        let mut arena = arena(1);
        arena.place_robot(0, Pose::default());
        arena.set_present(0, false);
        arena.place_ball(Vector::new(0.5, 0.0), Vector::new(-2.0, 0.0));
        (0..50).for_each(|_| arena.step());
        assert!(arena.ball().0.x < -0.4);
        arena.set_present(0, true);
        arena.place_ball(Vector::new(0.5, 0.0), Vector::new(-2.0, 0.0));
        (0..50).for_each(|_| arena.step());
        assert!(arena.ball().0.x > 0.0);
    }

    #[test]
    fn a_lying_body_blocks_to_its_side() {
        let mut arena = arena(1);
        arena.place_robot(0, Pose::default());
        let crosses = |arena: &mut Arena| {
            arena.place_ball(Vector::new(0.5, 0.4), Vector::new(-2.0, 0.0));
            (0..50).for_each(|_| arena.step());
            arena.ball().0.x < 0.0
        };
        assert!(crosses(&mut arena));
        arena.set_base(0, BallObstacle::Lying { direction: Vector::new(0.0, 1.0), reach: 0.5 });
        assert!(!crosses(&mut arena));
    }
}
