//! The ground truth after the last step.

use crate::arena::Arena;
use crate::pose::rotate;
use crate::state::WorldView;
use crate::{BallState, BodyPhase, Buttons, FieldGeometry, Physics, Pose, RobotSetup, RobotState, Vector};

/// The field with everything on it after the last step.
pub(crate) struct Snapshot {
    pub(crate) field: FieldGeometry,
    pub(crate) physics: Physics,
    pub(crate) ball: BallState,
    pub(crate) robots: Vec<RobotState>,
    pub(crate) touching_ball: Vec<bool>,
    pub(crate) contacts: Vec<(usize, usize)>,
    /// For each robot, the velocity in the field frame that its feet produced in the last step.
    pub(crate) driven: Vec<Vector>,
}

impl Snapshot {
    pub(crate) fn new(
        field: FieldGeometry,
        physics: Physics,
        robots: &[RobotSetup],
        team_of: &[usize],
    ) -> Self {
        let still = |(robot, team): (&RobotSetup, &usize)| RobotState {
            team: *team,
            number: robot.number,
            pose: Pose::default(),
            velocity: Vector::zeros(),
            intent: Vector::zeros(),
            phase: BodyPhase::Standing,
            head_yaw: 0.0,
            head_pitch: 0.0,
            on_field: true,
        };
        let count = robots.len();
        Self {
            field,
            physics,
            ball: BallState { position: Vector::zeros(), velocity: Vector::zeros() },
            robots: robots.iter().zip(team_of).map(still).collect(),
            touching_ball: vec![false; count],
            contacts: Vec::with_capacity(count * count / 2 + 1),
            driven: vec![Vector::zeros(); count],
        }
    }

    pub(crate) fn scene(&self) -> WorldView<'_> {
        WorldView {
            field: &self.field,
            physics: &self.physics,
            ball: self.ball,
            robots: &self.robots,
            touching_ball: &self.touching_ball,
            contacts: &self.contacts,
        }
    }

    /// Copies from the arena which robots touch each other.
    pub(crate) fn find_contacts(&mut self, arena: &Arena) {
        self.contacts.clear();
        for other in 1..self.robots.len() {
            for one in 0..other {
                if arena.robots_touch(one, other) {
                    self.contacts.push((one, other));
                }
            }
        }
    }

    /// The change of a robot's velocity that contacts caused in the last step, in its own frame.
    pub(crate) fn blow(&self, robot: usize) -> Vector {
        let state = &self.robots[robot];
        rotate(state.velocity - self.driven[robot], -state.pose.heading)
    }

    /// Whether a robot touches another.
    pub(crate) fn is_pressed(&self, robot: usize) -> bool {
        self.contacts.iter().any(|&(one, other)| one == robot || other == robot)
    }

    /// A robot's velocity without the component that would lead it off the carpet: a person stops
    /// it there, without a blow.
    pub(crate) fn stopped_at_edge(&self, robot: usize, velocity: Vector) -> Vector {
        const MARGIN: f64 = 0.02;
        let far = Vector::new(self.field.half_length(), self.field.half_width());
        let room = self.field.border - self.physics.robot_radius - MARGIN;
        let position = self.robots[robot].pose.position;
        velocity.zip_zip_map(&position, &far, |velocity, at, line| {
            let leaves = at.abs() > line + room && velocity * at > 0.0;
            if leaves { 0.0 } else { velocity }
        })
    }

    /// The bumpers that touch another robot in front of the feet.
    pub(crate) fn bumpers(&self, robot: usize) -> Buttons {
        let mut buttons = Buttons::default();
        for &(one, other) in self.contacts.iter().filter(|(one, other)| *one == robot || *other == robot) {
            let other = if one == robot { other } else { one };
            let position = self.robots[robot].pose.to_own(self.robots[other].pose.position);
            buttons.left_bumper |= position.x > position.y.abs() && position.y >= 0.0;
            buttons.right_bumper |= position.x > position.y.abs() && position.y <= 0.0;
        }
        buttons
    }
}
