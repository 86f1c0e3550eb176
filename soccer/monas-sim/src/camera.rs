//! Simulated cameras: noisy percepts of ball, posts and robots in the field of view.
//!
//! Like the Nao, a robot has two cameras, one above the other. Both follow the head, the second
//! tilted further down, and both take a picture at the same time. Angles are compared as yaw and
//! elevation, not in the image plane; within these fields of view the difference is below the
//! noise.

mod faults;

pub(crate) use faults::CameraFaults;

use crate::pose::{Vector, direction_of, normalize_angle};
use crate::rng::RandomStream;
use crate::state::WorldView;
use crate::{FieldSide, GoalColour, Physics, Pose, Side, TeamColour};

/// The apparent position of an object relative to the centre of the robot; straight ahead is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Percept {
    /// Direction, rad, positive to the left of the robot's heading.
    pub bearing: f64,
    /// Angle above the horizon at the camera, rad; negative is below.
    pub elevation: f64,
    /// Distance along the ground, m.
    pub distance: f64,
}

/// One object in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sighting {
    /// The ball. Its distance is computed from its elevation, so the error grows with distance.
    Ball(Percept),
    /// A goal post, at its foot.
    Post {
        /// The colour of its goal.
        goal: GoalColour,
        /// Which post of the goal, as seen from the field; known only if both are in the picture.
        side: Option<Side>,
        /// Its apparent position.
        percept: Percept,
    },
    /// A place of the lines. Its distance is computed from its elevation.
    Line {
        /// Its kind.
        feature: LineFeature,
        /// Its apparent position.
        percept: Percept,
    },
    /// Another robot.
    Robot {
        /// The colour of its team.
        colour: TeamColour,
        /// Its apparent position.
        percept: Percept,
    },
}

/// A place of the lines that a picture shows as such.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineFeature {
    /// The corner of two lines: of the field or of a goal area.
    Corner,
    /// A place where a line ends at another: at the halfway line or at a goal area.
    Junction,
    /// The middle of the centre circle.
    CentreCircle,
}

/// The state of the world and a robot at the time of a picture.
pub(crate) struct CameraView<'a> {
    /// Index of the robot, which does not see itself.
    pub(crate) robot: usize,
    pub(crate) scene: WorldView<'a>,
    /// The current colour of each team.
    pub(crate) colours: [TeamColour; 2],
    /// The badness of the light: 0 for good light, at most 1.
    pub(crate) darkness: f64,
}

/// The true position of an object relative to the camera's robot.
#[derive(Clone, Copy)]
struct VisibleObject {
    bearing: f64,
    distance: f64,
    /// Lowest and highest point that make it visible, m.
    span: (f64, f64),
    range: f64,
}

impl CameraView<'_> {
    /// Appends the objects in one picture to `sightings`.
    pub(crate) fn observe(&self, stream: &mut RandomStream, sightings: &mut Vec<Sighting>) {
        if !self.me().phase.is_upright() {
            return;
        }
        self.look_for_ball(stream, sightings);
        for side in [FieldSide::Left, FieldSide::Right] {
            self.look_for_goal(side, stream, sightings);
        }
        self.look_for_robots(stream, sightings);
        self.look_for_lines(stream, sightings);
    }

    fn look_for_ball(&self, stream: &mut RandomStream, sightings: &mut Vec<Sighting>) {
        let physics = self.physics();
        let height = physics.ball_radius;
        let target = self.target(self.scene.ball.position, (height, height), physics.ball_range);
        if self.sees(&target, None, stream) {
            sightings.push(Sighting::Ball(self.percept_by_elevation(&target, height, stream)));
        }
    }

    fn look_for_goal(&self, side: FieldSide, stream: &mut RandomStream, sightings: &mut Vec<Sighting>) {
        let height = self.scene.field.goal_height;
        let targets = self
            .scene
            .field
            .posts(side)
            .map(|post| self.target(post, (0.0, height), self.physics().post_range));
        let seen = targets.map(|target| self.sees(&target, None, stream));
        let both = seen == [true, true];
        for ((target, seen), post) in targets.iter().zip(seen).zip([Side::Left, Side::Right]) {
            if seen {
                let percept = self.percept(target, stream);
                let goal = side.goal_colour();
                sightings.push(Sighting::Post { goal, side: both.then_some(post), percept });
            }
        }
    }

    fn look_for_robots(&self, stream: &mut RandomStream, sightings: &mut Vec<Sighting>) {
        let physics = self.physics();
        for (index, robot) in self.scene.on_field().filter(|(index, _)| *index != self.robot) {
            let height =
                if robot.phase.is_fallen() { 2.0 * physics.lying_radius } else { physics.robot_height };
            let target = self.target(robot.pose.position, (0.0, height), physics.robot_range);
            if self.sees(&target, Some(index), stream) {
                let percept = self.percept(&target, stream);
                sightings.push(Sighting::Robot { colour: self.colours[robot.team], percept });
            }
        }
    }

    fn look_for_lines(&self, stream: &mut RandomStream, sightings: &mut Vec<Sighting>) {
        for (feature, position) in self.scene.field.line_features() {
            let target = self.target(position, (0.0, 0.0), self.physics().line_range);
            if self.sees(&target, None, stream) {
                let percept = self.percept_by_elevation(&target, 0.0, stream);
                sightings.push(Sighting::Line { feature, percept });
            }
        }
    }

    fn target(&self, point: Vector, span: (f64, f64), range: f64) -> VisibleObject {
        let own = self.pose().to_own(point);
        VisibleObject { bearing: direction_of(own), distance: own.norm(), span, range }
    }

    /// Whether the picture shows a target. One random number is drawn for each target in view.
    fn sees(&self, target: &VisibleObject, itself: Option<usize>, stream: &mut RandomStream) -> bool {
        if !self.in_view(target) || self.is_hidden(target, itself) {
            return false;
        }
        let beyond = (2.0 * target.distance / target.range - 1.0).clamp(0.0, 1.0);
        let physics = self.physics();
        let miss = (physics.sight_miss * (1.0 + physics.light_change * self.darkness)).min(1.0);
        stream.chance((1.0 - miss) * (1.0 - beyond))
    }

    fn in_view(&self, target: &VisibleObject) -> bool {
        let physics = self.physics();
        let me = self.me();
        // Most targets are beside the picture: these need no elevation.
        let aside = normalize_angle(target.bearing - me.head_yaw);
        if aside.abs() > physics.camera_view_horizontal / 2.0 {
            return false;
        }
        let down = |height| self.angle_below_horizon(height, target.distance);
        let (lowest, highest) = (down(target.span.0), down(target.span.1));
        let half = physics.camera_view_vertical / 2.0;
        let shows = |axis: f64| lowest >= axis - half && highest <= axis + half;
        let upper = shows(me.head_pitch);
        let lower = shows(me.head_pitch + physics.camera_tilt);
        upper || lower
    }

    /// Whether another robot stands between the camera and the target.
    fn is_hidden(&self, target: &VisibleObject, itself: Option<usize>) -> bool {
        let radius = self.physics().robot_radius;
        let others =
            self.scene.on_field().filter(|(index, _)| *index != self.robot && Some(*index) != itself);
        let mut upright = others.filter(|(_, robot)| !robot.phase.is_fallen());
        upright.any(|(_, robot)| {
            let other = self.pose().to_own(robot.pose.position);
            let (sin, cos) = libm::sincos(target.bearing);
            let along = other.x * cos + other.y * sin;
            let beside = other.y * cos - other.x * sin;
            beside.abs() < radius && along > 0.0 && along < target.distance - radius / 2.0
        })
    }

    /// A percept whose distance is measured by size or by the foot on the ground.
    fn percept(&self, target: &VisibleObject, stream: &mut RandomStream) -> Percept {
        let bearing =
            normalize_angle(target.bearing + stream.normal(self.physics().bearing_noise * self.shake()));
        let factor = (1.0 + stream.normal(self.physics().distance_noise)).max(0.1);
        let distance = target.distance * factor;
        Percept { bearing, elevation: -self.angle_below_horizon(0.0, distance), distance }
    }

    /// A percept of an object of known height, whose distance follows from its elevation.
    fn percept_by_elevation(
        &self,
        target: &VisibleObject,
        height: f64,
        stream: &mut RandomStream,
    ) -> Percept {
        /// Least angle below the horizon of a visible object on the ground, rad: 28 m away.
        const LEAST_ANGLE: f64 = 0.017;
        let physics = self.physics();
        let bearing = normalize_angle(target.bearing + stream.normal(physics.bearing_noise * self.shake()));
        let angle = self.angle_below_horizon(height, target.distance);
        let angle = angle + stream.normal(physics.elevation_noise * self.shake());
        let angle = angle.clamp(LEAST_ANGLE, std::f64::consts::FRAC_PI_2);
        let distance = (physics.camera_height - height) / libm::tan(angle);
        Percept { bearing, elevation: -angle, distance: distance.max(0.0) }
    }

    fn angle_below_horizon(&self, height: f64, distance: f64) -> f64 {
        libm::atan2(self.physics().camera_height - height, distance)
    }

    /// Factor on the noise of angles while the body moves.
    fn shake(&self) -> f64 {
        match self.me().phase {
            crate::BodyPhase::Standing => 1.0,
            _ => self.physics().moving_noise_factor,
        }
    }

    fn me(&self) -> &crate::RobotState {
        &self.scene.robots[self.robot]
    }

    fn pose(&self) -> &Pose {
        &self.me().pose
    }

    fn physics(&self) -> &Physics {
        self.scene.physics
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BallState, BodyPhase, FieldGeometry, RobotState};

    struct SceneGeometry {
        field: FieldGeometry,
        physics: Physics,
        robots: Vec<RobotState>,
        ball: Vector,
        darkness: f64,
    }

    fn robot(team: usize, pose: Pose) -> RobotState {
        RobotState {
            team,
            number: 2,
            pose,
            velocity: Vector::zeros(),
            intent: Vector::zeros(),
            phase: BodyPhase::Standing,
            head_yaw: 0.0,
            head_pitch: 0.0,
            on_field: true,
        }
    }

    fn stage(ball: Vector) -> SceneGeometry {
        let physics = Physics { sight_miss: 0.0, ..Physics::default() };
        SceneGeometry {
            field: FieldGeometry::default(),
            physics,
            robots: vec![robot(0, Pose::default())],
            ball,
            darkness: 0.0,
        }
    }

    impl SceneGeometry {
        fn look(&self, stream: &mut RandomStream) -> Vec<Sighting> {
            let scene = WorldView {
                field: &self.field,
                physics: &self.physics,
                ball: BallState { position: self.ball, velocity: Vector::zeros() },
                robots: &self.robots,
                touching_ball: &[],
                contacts: &[],
            };
            let mut sightings = Vec::new();
            let colours = [TeamColour::Blue, TeamColour::Red];
            CameraView { robot: 0, scene, colours, darkness: self.darkness }.observe(stream, &mut sightings);
            sightings
        }

        fn balls(&self, pictures: usize) -> Vec<Percept> {
            let mut stream = RandomStream::new(5, "camera");
            let all = (0..pictures).flat_map(|_| self.look(&mut stream));
            all.filter_map(|s| if let Sighting::Ball(percept) = s { Some(percept) } else { None }).collect()
        }
    }

    #[test]
    fn the_field_of_view_ends_at_its_edges() {
        let half = Physics::default().camera_view_horizontal / 2.0;
        let at = |angle: f64| Vector::new(libm::cos(angle), libm::sin(angle));
        assert_eq!(stage(at(half - 0.01)).balls(1).len(), 1);
        assert_eq!(stage(at(half + 0.01)).balls(1).len(), 0);
        assert_eq!(stage(at(-half - 0.01)).balls(1).len(), 0);
        assert_eq!(stage(Vector::new(-1.0, 0.0)).balls(1).len(), 0);
    }

    #[test]
    fn the_view_follows_the_head() {
        let mut stage = stage(Vector::new(0.0, 1.0));
        assert_eq!(stage.balls(1).len(), 0);
        stage.robots[0].head_yaw = 1.5;
        let percepts = stage.balls(1);
        assert!((percepts[0].bearing - std::f64::consts::FRAC_PI_2).abs() < 0.05);
    }

    #[test]
    fn a_ball_at_the_feet_needs_a_nod() {
        let mut stage = stage(Vector::new(0.15, 0.0));
        assert_eq!(stage.balls(1).len(), 0);
        stage.robots[0].head_pitch = 0.4;
        assert_eq!(stage.balls(1).len(), 1);
    }

    #[test]
    fn distances_are_worse_farther_away_and_right_on_average() {
        let spread = |distance: f64| {
            let percepts = stage(Vector::new(distance, 0.0)).balls(3000);
            let mean = percepts.iter().map(|p| p.distance).sum::<f64>() / percepts.len() as f64;
            let square = |p: &Percept| (p.distance - mean) * (p.distance - mean);
            (mean, (percepts.iter().map(square).sum::<f64>() / percepts.len() as f64).sqrt())
        };
        let (near, near_spread) = spread(0.6);
        let (far, far_spread) = spread(2.4);
        assert!((near - 0.6).abs() < 0.01 && (far - 2.4).abs() < 0.05, "{near} {far}");
        assert!(near_spread < 0.02 && far_spread > 5.0 * near_spread, "{near_spread} {far_spread}");
    }

    #[test]
    fn far_balls_are_missed_more_often_and_very_far_ones_always() {
        let seen = |distance| stage(Vector::new(distance, 0.0)).balls(1000).len();
        assert_eq!(seen(2.0), 1000);
        assert!((450..550).contains(&seen(3.75)), "{}", seen(3.75));
        assert_eq!(seen(5.1), 0);
        let mut missing = stage(Vector::new(1.0, 0.0));
        missing.physics.sight_miss = 0.25;
        assert!((700..800).contains(&missing.balls(1000).len()));
    }

    #[test]
    fn bad_light_multiplies_the_misses() {
        let mut dark = stage(Vector::new(1.0, 0.0));
        (dark.physics.sight_miss, dark.physics.light_change, dark.darkness) = (0.1, 3.0, 0.5);
        // 0.1 * (1 + 3 * 0.5) = 0.25; four standard deviations of 1000 draws are 0.055.
        assert!((695..805).contains(&dark.balls(1000).len()), "{}", dark.balls(1000).len());
        dark.darkness = 0.0;
        assert!((862..938).contains(&dark.balls(1000).len()), "{}", dark.balls(1000).len());
        (dark.darkness, dark.physics.light_change) = (1.0, 25.0);
        assert_eq!(dark.balls(1000).len(), 0, "at most every object is missed");
    }

    #[test]
    fn an_upright_robot_hides_the_ball_and_a_fallen_one_does_not() {
        let mut stage = stage(Vector::new(2.0, 0.0));
        stage.robots.push(robot(1, Pose::new(1.0, 0.05, 0.0)));
        assert_eq!(stage.balls(5).len(), 0);
        stage.robots[1].phase = BodyPhase::Fallen(crate::Direction::Front);
        assert_eq!(stage.balls(5).len(), 5);
        stage.robots[1] = robot(1, Pose::new(1.0, 0.3, 0.0));
        assert_eq!(stage.balls(5).len(), 5);
        stage.robots[1] = robot(1, Pose::new(2.3, 0.0, 0.0));
        assert_eq!(stage.balls(5).len(), 5, "it stands behind the ball");
    }

    #[test]
    fn goals_and_robots_have_colours() {
        let mut stage = stage(Vector::new(-1.0, 0.0));
        stage.robots[0].pose = Pose::new(0.5, 0.0, 0.0);
        stage.robots.push(robot(1, Pose::new(2.0, 0.0, 0.0)));
        let sightings = stage.look(&mut RandomStream::new(1, "camera"));
        let post = |wanted| {
            sightings.iter().any(|s| {
                matches!(s, Sighting::Post { goal: GoalColour::Yellow, side, percept }
                if *side == Some(wanted) && (percept.bearing > 0.0) == (wanted == Side::Left))
            })
        };
        assert!(post(Side::Left) && post(Side::Right), "{sightings:?}");
        assert!(sightings.iter().any(|s| matches!(s, Sighting::Robot { colour: TeamColour::Red, .. })));
        assert_eq!(without_lines(&sightings).len(), 3);
    }

    #[test]
    fn a_single_post_has_no_side() {
        let mut stage = stage(Vector::new(-1.0, 0.0));
        stage.robots[0].pose = Pose::new(2.0, 0.0, 0.6);
        let sightings = stage.look(&mut RandomStream::new(1, "camera"));
        let seen = without_lines(&sightings);
        assert!(matches!(seen[..], [Sighting::Post { side: None, .. }]), "{sightings:?}");
    }

    fn without_lines(sightings: &[Sighting]) -> Vec<Sighting> {
        sightings.iter().filter(|seen| !matches!(seen, Sighting::Line { .. })).copied().collect()
    }

    #[test]
    fn corners_and_junctions_of_lines_are_seen_where_they_are() {
        let mut stage = stage(Vector::new(-1.0, 0.0));
        stage.robots[0].pose = Pose::new(1.5, 1.1, 0.0);
        let sightings = stage.look(&mut RandomStream::new(1, "camera"));
        let seen = |wanted: LineFeature, position: Vector| {
            let position = stage.robots[0].pose.to_own(position);
            sightings.iter().any(|seen| match seen {
                Sighting::Line { feature, percept } => {
                    *feature == wanted
                        && (percept.bearing - direction_of(position)).abs() < 0.05
                        && (percept.distance - position.norm()).abs() < 0.3
                }
                _ => false,
            })
        };
        assert!(seen(LineFeature::Corner, Vector::new(2.4, 1.1)), "{sightings:?}");
        assert!(seen(LineFeature::Junction, Vector::new(3.0, 1.1)), "{sightings:?}");
        assert!(!seen(LineFeature::Corner, Vector::new(2.4, -1.1)), "it is out of view");
    }

    #[test]
    fn a_lying_robot_sees_nothing() {
        let mut stage = stage(Vector::new(1.0, 0.0));
        stage.robots[0].phase = BodyPhase::Fallen(crate::Direction::Front);
        assert!(stage.look(&mut RandomStream::new(1, "camera")).is_empty());
    }
}
