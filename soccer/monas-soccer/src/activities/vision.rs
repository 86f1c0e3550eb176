//! Estimates of ball, pose and other robots from sightings.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use monas_robot::{ObjectKind, Sighting, Sightings, topics as body};
use nalgebra::Isometry2;
use narukom::Timestamp;

use crate::functionality::ball_filter::{BallEstimate, BallFilter, BallModel};
use crate::functionality::field::FieldModel;
use crate::functionality::geometry::pose;
use crate::functionality::interception::{Crossing, crossing};
use crate::functionality::localisation::{Localisation, LocalisationModel};
use crate::functionality::obstacles::{Obstacle, Obstacles};
use crate::{Ball, GameState, OtherRobot, Pose, Robots, convert, topics};

/// Filters what the body sees: the ball with its velocity, the robot's pose from goal posts, the
/// other robots.
///
/// Sightings are related to the odometry at the time of the image, which Sensors keeps, and
/// propagated to the time of publication. A placement by the referee resets the pose and discards
/// earlier sightings.
///
/// Parameters `memory` (s): how long a ball counts as found after it was last seen;
/// `rolling_deceleration` (m/s²) of the ball; `least_speed` (m/s) and `reach` (m): least speed, and
/// largest lateral distance from the robot, of an approaching ball.
#[derive(Clone, Debug)]
pub struct Vision {
    memory: f64,
    least_speed: f64,
    reach: f64,
    ball_model: BallModel,
    state: Option<VisionState>,
    calibration: u32,
}

/// State of Vision between calls.
#[derive(Clone, Debug)]
struct VisionState {
    /// The time to which the filters are propagated, and the odometry at that time.
    moment: Timestamp,
    odometry: Isometry2<f64>,
    /// Time of the last image.
    taken_at: u64,
    ball: BallFilter,
    /// When the ball was last seen, or the search for it began.
    ball_at: Timestamp,
    localisation: Option<Localisation>,
    placements: Option<u32>,
    obstacles: Obstacles,
    fallen: bool,
}

/// Distance of the nearest robot when there is none, metres.
const NOBODY: f64 = 1e6;

impl Default for Vision {
    fn default() -> Vision {
        Vision {
            memory: 1.2,
            least_speed: 0.3,
            reach: 0.9,
            ball_model: BallModel::default(),
            state: None,
            calibration: 0,
        }
    }
}

impl Activity for Vision {
    fn configure(&mut self, parameters: &Parameters) {
        self.memory = parameters.number("memory").unwrap_or(self.memory);
        self.least_speed = parameters.number("least_speed").unwrap_or(self.least_speed);
        self.reach = parameters.number("reach").unwrap_or(self.reach);
        let deceleration = &mut self.ball_model.rolling_deceleration;
        *deceleration = parameters.number("rolling_deceleration").unwrap_or(*deceleration);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.apply_calibration(blackboard);
        let now = blackboard.now();
        // Without a history from Sensors, images cannot be related to odometry.
        let Some(odometry) = odometry_at(blackboard, now) else { return Ok(Progress::Done) };
        let sight = self.state.get_or_insert_with(|| VisionState::new(self.ball_model, now, odometry));
        if let Some(game) = blackboard.read(topics::GAME_STATE) {
            sight.apply_placement(game, now, odometry);
        }
        sight.feel(blackboard);
        sight.process_sightings(blackboard);
        sight.advance(now, &odometry);
        self.publish(blackboard)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(body::SENSORS).reads(body::SIGHTINGS).reads(topics::SENSORS);
        let topics = topics.reads(topics::GAME_STATE).reads(topics::CALIBRATION);
        topics.publishes(topics::BALL).publishes(topics::POSE).publishes(topics::ROBOTS)
    }
}

impl Vision {
    fn apply_calibration(&mut self, blackboard: &Blackboard) {
        let number = blackboard.read(topics::CALIBRATION).map_or(0, |calibration| calibration.number);
        if number != self.calibration {
            self.calibration = number;
            self.state = None;
        }
    }

    fn publish(&self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let Some(sight) = &self.state else { return Ok(()) };
        let field = blackboard.read(topics::GAME_STATE).map(GameState::field);
        let robots = sight.robots();
        blackboard.publish(topics::BALL, sight.in_surroundings(self.ball(sight), &robots, field))?;
        blackboard.publish(topics::ROBOTS, robots)?;
        if let Some(filter) = &sight.localisation {
            blackboard.publish(topics::POSE, Pose::from_filter(filter))?;
        }
        Ok(())
    }

    fn ball(&self, sight: &VisionState) -> Ball {
        let age = sight.moment.since(sight.ball_at).as_secs_f64();
        let unseen = Ball { age, ..Ball::default() }.with_crossing(None);
        let Some(estimate) = sight.ball.estimate() else { return unseen };
        let ball = Ball { found: age <= self.memory, seen_at: sight.ball_at.as_nanos(), ..unseen };
        ball.with_estimate(&estimate).with_crossing(self.approach(&estimate))
    }

    /// Where the ball crosses the robot's lateral axis, if it is certainly rolling and will pass
    /// within reach.
    fn approach(&self, ball: &BallEstimate) -> Option<Crossing> {
        let surely = self.least_speed.max(2.0 * ball.velocity_deviation);
        if -ball.velocity.x < surely {
            return None;
        }
        let crossing = crossing(ball.position, ball.velocity, self.ball_model.rolling_deceleration);
        crossing.filter(|crossing| crossing.y.abs() <= self.reach)
    }
}

impl VisionState {
    fn new(model: BallModel, moment: Timestamp, odometry: Isometry2<f64>) -> VisionState {
        VisionState {
            moment,
            odometry,
            taken_at: 0,
            ball: BallFilter::new(model),
            ball_at: moment,
            localisation: None,
            placements: None,
            obstacles: Obstacles::default(),
            fallen: false,
        }
    }

    /// Applies a placement by the referee and discards earlier sightings.
    fn apply_placement(&mut self, game: &GameState, now: Timestamp, odometry: Isometry2<f64>) {
        if self.placements == Some(game.placements) || game.placements == 0 {
            return;
        }
        self.placements = Some(game.placements);
        let placed = pose(game.placed_x, game.placed_y, game.placed_heading);
        self.localisation = Some(Localisation::new(LocalisationModel::default(), placed));
        self.ball.forget();
        self.obstacles.forget();
        (self.moment, self.odometry, self.ball_at) = (now, odometry, now);
        self.taken_at = now.as_nanos();
    }

    /// Increases the uncertainty of the pose after a fall, which odometry does not measure.
    fn feel(&mut self, blackboard: &Blackboard) {
        let posture = blackboard.read(body::SENSORS).map(|sensors| sensors.posture());
        let fallen = posture == Some(monas_robot::Posture::Fallen);
        if let (true, false, Some(filter)) = (fallen, self.fallen, &mut self.localisation) {
            filter.disturb(0.1, 0.3);
        }
        self.fallen = fallen;
    }

    /// Processes the newest image, if it is new, at the time it was taken.
    fn process_sightings(&mut self, blackboard: &Blackboard) {
        let image = blackboard.read(body::SIGHTINGS).filter(|image| image.taken_at > self.taken_at);
        let (Some(image), Some(game)) = (image, blackboard.read(topics::GAME_STATE)) else { return };
        let taken_at = Timestamp::from_nanos(image.taken_at);
        let Some(odometry) = odometry_at(blackboard, taken_at) else { return };
        self.taken_at = image.taken_at;
        self.advance(taken_at, &odometry);
        self.see(image, game);
    }

    fn see(&mut self, image: &Sightings, game: &GameState) {
        for sighting in &image.objects {
            if let (Some(post), Some(filter)) = (convert::post(sighting, game), &mut self.localisation) {
                filter.correct(&game.field(), &post);
            }
            match sighting.kind() {
                ObjectKind::Ball => self.see_ball(sighting),
                ObjectKind::Robot => self.obstacles.see(Obstacle {
                    position: convert::position(sighting),
                    team_mate: sighting.colour == game.team_colour,
                    seen_at: self.moment,
                }),
                _ => {}
            }
        }
    }

    fn see_ball(&mut self, sighting: &Sighting) {
        self.ball.correct(sighting.distance, sighting.bearing);
        self.ball_at = self.moment;
    }

    /// Propagates all filters to a time; earlier times are ignored.
    fn advance(&mut self, moment: Timestamp, odometry: &Isometry2<f64>) {
        if moment <= self.moment {
            return;
        }
        let old_from_new = self.odometry.inverse() * odometry;
        let elapsed = moment.since(self.moment);
        self.ball.predict(elapsed, &old_from_new);
        self.obstacles.advance(moment, &old_from_new);
        if let Some(filter) = &mut self.localisation {
            filter.advance(&old_from_new);
        }
        (self.moment, self.odometry) = (moment, *odometry);
    }

    /// Sets where the ball lies to the team mates that were seen, and to the own goal area.
    fn in_surroundings(&self, ball: Ball, robots: &Robots, field: Option<FieldModel>) -> Ball {
        let mates = robots.robots.iter().filter(|robot| robot.team_mate);
        let nearest = mates.map(|mate| (mate.position() - ball.position()).norm()).fold(NOBODY, f64::min);
        let in_area = |(field, filter): (FieldModel, &Localisation)| {
            field.in_own_area(filter.field_from_robot() * ball.position(), 0.0)
        };
        let in_own_area = ball.found && field.zip(self.localisation.as_ref()).is_some_and(in_area);
        Ball { mate_lead: (ball.distance - nearest).max(0.0), in_own_area, ..ball }
    }

    fn robots(&self) -> Robots {
        let robots = self.obstacles.iter().map(|robot| OtherRobot {
            x: robot.position.x,
            y: robot.position.y,
            team_mate: robot.team_mate,
            age: self.moment.since(robot.seen_at).as_secs_f64(),
        });
        let robots: Vec<OtherRobot> = robots.collect();
        let distances = robots.iter().map(|robot| robot.position().coords.norm());
        Robots { nearest: distances.fold(NOBODY, f64::min), robots }
    }
}

/// The odometry at a time: from the history of Sensors and the newer sensor readings.
fn odometry_at(blackboard: &Blackboard, moment: Timestamp) -> Option<Isometry2<f64>> {
    let until = moment.as_nanos();
    let history = blackboard.recent(topics::SENSORS, Duration::MAX);
    let last = history.filter(|entry| entry.measured_at <= until).last()?;
    let felt = blackboard.recent(body::SENSORS, Duration::MAX);
    let since = felt.filter(|felt| last.measured_at < felt.measured_at && felt.measured_at <= until);
    Some(since.fold(last.odometry(), |odometry, felt| odometry * convert::odometry(felt.message)))
}

monas::activity!(Vision);

#[cfg(test)]
mod tests {
    use monas_robot::{Colour, Sensors as Felt};

    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::activities::{SendCalibration, Sensors};

    /// A standing body whose camera sees the objects given by the test.
    struct VisionFixture {
        stage: ActivityFixture,
        vision: Vision,
    }

    const FRAME: Duration = Duration::from_millis(100);

    impl VisionFixture {
        fn new() -> VisionFixture {
            VisionFixture { stage: ActivityFixture::new(), vision: Vision::default() }
        }

        fn placed(number: u32, x: f64, y: f64, heading: f64) -> GameState {
            GameState {
                placements: number,
                placed_x: x,
                placed_y: y,
                placed_heading: heading,
                goal_to_attack: Colour::Yellow.into(),
                team_colour: Colour::Red.into(),
                field_length: 6.0,
                field_width: 4.0,
                goal_width: 1.4,
                ..GameState::default()
            }
        }

        /// Publishes an image taken 0.1 s after the last, after the robot has walked ahead by
        /// `step`.
        fn show(&mut self, step: f64, objects: &[(ObjectKind, Colour, f64, f64)]) -> Ball {
            self.stage.wait(FRAME);
            let measured_at = self.stage.now.as_nanos();
            self.stage.publish(body::SENSORS, Felt { measured_at, odometry_x: step, ..Felt::default() });
            let objects = objects.iter().map(|&(kind, colour, distance, bearing)| Sighting {
                kind: kind.into(),
                colour: colour.into(),
                distance,
                bearing,
            });
            let image =
                Sightings { taken_at: measured_at, objects: objects.collect(), ..Sightings::default() };
            self.stage.publish(body::SIGHTINGS, image);
            self.stage.run(&mut Sensors);
            self.stage.run(&mut self.vision);
            self.stage.latest(topics::BALL).unwrap()
        }

        fn ball(&mut self, distance: f64, bearing: f64) -> Ball {
            self.show(0.0, &[(ObjectKind::Ball, Colour::Orange, distance, bearing)])
        }
    }

    #[test]
    fn without_a_history_there_is_nothing_to_say() {
        let mut eye = VisionFixture::new();
        eye.stage.run(&mut eye.vision);
        assert_eq!(eye.stage.latest(topics::BALL), None);
    }

    #[test]
    fn a_ball_is_found_while_it_is_remembered() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        assert!(!eye.show(0.0, &[]).found);
        let ball = eye.ball(1.0, 0.5);
        assert!(
            ball.found && (ball.distance - 1.0).abs() < 0.01 && (ball.bearing - 0.5).abs() < 0.01,
            "{ball:?}"
        );
        assert_eq!((ball.seen_at, ball.age), (eye.stage.now.as_nanos(), 0.0));
        for _ in 0..12 {
            assert!(eye.show(0.0, &[]).found);
        }
        let ball = eye.show(0.0, &[]);
        assert!(
            !ball.found && ball.age > 1.2 && (ball.bearing - 0.5).abs() < 0.01,
            "its bearing is kept: {ball:?}"
        );
    }

    #[test]
    fn a_ball_that_rolls_at_the_robot_approaches_on_its_side() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        let mut ball = Ball::default();
        for frame in 0..8 {
            let x = 2.4 - 0.15 * f64::from(frame);
            ball = eye.ball(libm::hypot(x, 0.4), libm::atan2(0.4, x));
        }
        assert!(ball.approaching && (0.6..1.3).contains(&ball.time_to_cross), "{ball:?}");
        assert!((ball.crossing_y - 0.4).abs() < 0.1 && ball.crossing_bearing > 0.15, "{ball:?}");
    }

    #[test]
    fn a_resting_or_passing_ball_does_not_approach() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        for _ in 0..10 {
            assert!(!eye.ball(1.0, 0.1).approaching);
        }
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        for frame in 0..10 {
            let y = 1.0 - 0.15 * f64::from(frame);
            assert!(!eye.ball(libm::hypot(1.5, y), libm::atan2(y, 1.5)).approaching);
        }
    }

    #[test]
    fn the_robot_is_localised_by_placement_and_posts() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, -1.0, 0.5, 0.0));
        eye.show(0.0, &[]);
        let pose = eye.stage.latest(topics::POSE).unwrap();
        assert_eq!((pose.x, pose.y, pose.heading), (-1.0, 0.5, 0.0));
        for _ in 0..20 {
            eye.show(0.05, &[]);
        }
        let walked = eye.stage.latest(topics::POSE).unwrap();
        assert!((walked.x - 0.0).abs() < 1e-9 && walked.confidence < pose.confidence, "{walked:?}");
        for _ in 0..30 {
            let post = |kind, y: f64| (kind, Colour::Yellow, libm::hypot(2.9, y), libm::atan2(y, 2.9));
            eye.show(0.0, &[post(ObjectKind::LeftPost, 0.2), post(ObjectKind::RightPost, -1.2)]);
        }
        let seen = eye.stage.latest(topics::POSE).unwrap();
        assert!((seen.x - 0.1).abs() < 0.05 && (seen.y - 0.5).abs() < 0.05, "{seen:?}");
        assert!(seen.confidence > walked.confidence);
    }

    #[test]
    fn a_replaced_robot_forgets_its_percepts() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        assert!(eye.ball(1.0, 0.0).found);
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(2, 1.0, 1.0, 3.0));
        assert!(!eye.show(0.0, &[]).found);
        let pose = eye.stage.latest(topics::POSE).unwrap();
        assert_eq!((pose.x, pose.y), (1.0, 1.0));
    }

    #[test]
    fn a_calibration_makes_it_forget_the_ball() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        assert!(eye.ball(1.0, 0.0).found);
        eye.stage.run(&mut SendCalibration);
        assert!(!eye.show(0.0, &[]).found);
    }

    #[test]
    fn robots_are_distinguished_by_their_colour() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        eye.show(
            0.0,
            &[(ObjectKind::Robot, Colour::Red, 1.0, 0.0), (ObjectKind::Robot, Colour::Blue, 2.0, 0.5)],
        );
        let robots = eye.stage.latest(topics::ROBOTS).unwrap();
        assert_eq!(robots.nearest, 1.0);
        let robots = robots.robots;
        assert_eq!(robots.iter().map(|robot| robot.team_mate).collect::<Vec<_>>(), [true, false]);
    }
}
