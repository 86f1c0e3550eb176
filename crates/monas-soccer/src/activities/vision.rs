//! From what is sighted to what is known: the ball, the pose, the other robots.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use monas_robot::{ObjectKind, Sighting, Sightings, topics as body};
use nalgebra::Isometry2;
use narukom::Moment;

use crate::functionality::ball_filter::{BallEstimate, BallFilter, BallModel};
use crate::functionality::geometry::pose;
use crate::functionality::interception::{Crossing, crossing};
use crate::functionality::localisation::{Localisation, LocalisationModel};
use crate::functionality::obstacles::{Obstacle, Obstacles};
use crate::{Ball, GameState, OtherRobot, Pose, Robots, convert, topics};

/// Filters what the body sees: the ball with its velocity, the robot's pose from goal posts, the other robots.
///
/// Everything is set against the odometry of the moment of the image, which Sensors keeps, and carried on to the moment of publication.
/// A referee who puts the robot down tells it where it stands; what it saw before is then forgotten.
///
/// Parameters `memory` (s): how long a ball that is not seen again counts as found; `rolling_deceleration` (m/s²) of the ball;
/// `least_speed` (m/s) and `reach` (m): from which speed on, and how far beside the robot, a ball that rolls towards it counts as
/// approaching.
#[derive(Clone, Debug)]
pub struct Vision {
    memory: f64,
    least_speed: f64,
    reach: f64,
    ball_model: BallModel,
    sight: Option<Sight>,
    calibration: u32,
}

/// What Vision remembers from one look to the next.
#[derive(Clone, Debug)]
struct Sight {
    /// The moment to which the filters are carried, and the odometry of that moment.
    moment: Moment,
    odometry: Isometry2<f64>,
    /// The last image.
    taken_at: u64,
    ball: BallFilter,
    /// When the ball was seen last, or the search for it began.
    ball_at: Moment,
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
            sight: None,
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
        self.heed_calibration(blackboard);
        let now = blackboard.now();
        // Before Sensors has run there is nothing to set an image against.
        let Some(odometry) = odometry_at(blackboard, now) else { return Ok(Progress::Done) };
        let sight = self.sight.get_or_insert_with(|| Sight::new(self.ball_model, now, odometry));
        if let Some(game) = blackboard.read(topics::GAME_STATE) {
            sight.heed_placement(game, now, odometry);
        }
        sight.feel(blackboard);
        sight.look(blackboard);
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
    fn heed_calibration(&mut self, blackboard: &Blackboard) {
        let number = blackboard.read(topics::CALIBRATION).map_or(0, |calibration| calibration.number);
        if number != self.calibration {
            self.calibration = number;
            self.sight = None;
        }
    }

    fn publish(&self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let Some(sight) = &self.sight else { return Ok(()) };
        blackboard.publish(topics::BALL, self.ball(sight))?;
        blackboard.publish(topics::ROBOTS, sight.robots())?;
        if let Some(filter) = &sight.localisation {
            blackboard.publish(topics::POSE, Pose::from_filter(filter))?;
        }
        Ok(())
    }

    fn ball(&self, sight: &Sight) -> Ball {
        let age = sight.moment.since(sight.ball_at).as_secs_f64();
        let unseen = Ball { age, ..Ball::default() }.with_crossing(None);
        let Some(estimate) = sight.ball.estimate() else { return unseen };
        let ball = Ball { found: age <= self.memory, seen_at: sight.ball_at.as_nanos(), ..unseen };
        ball.with_estimate(&estimate).with_crossing(self.approach(&estimate))
    }

    /// Where the ball crosses the robot's line, if it surely rolls and comes within reach.
    fn approach(&self, ball: &BallEstimate) -> Option<Crossing> {
        let surely = self.least_speed.max(2.0 * ball.velocity_deviation);
        if -ball.velocity.x < surely {
            return None;
        }
        let crossing = crossing(ball.position, ball.velocity, self.ball_model.rolling_deceleration);
        crossing.filter(|crossing| crossing.y.abs() <= self.reach)
    }
}

impl Sight {
    fn new(model: BallModel, moment: Moment, odometry: Isometry2<f64>) -> Sight {
        Sight {
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

    /// Believes a referee who has put the robot down, and forgets what was seen from elsewhere.
    fn heed_placement(&mut self, game: &GameState, now: Moment, odometry: Isometry2<f64>) {
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

    /// A fall turns and moves the robot in ways that the odometry does not tell.
    fn feel(&mut self, blackboard: &Blackboard) {
        let posture = blackboard.read(body::SENSORS).map(|sensors| sensors.posture());
        let fallen = posture == Some(monas_robot::Posture::Fallen);
        if let (true, false, Some(filter)) = (fallen, self.fallen, &mut self.localisation) {
            filter.disturb(0.1, 0.3);
        }
        self.fallen = fallen;
    }

    /// Takes the newest image, if it is new, at the moment it was taken.
    fn look(&mut self, blackboard: &Blackboard) {
        let image = blackboard.read(body::SIGHTINGS).filter(|image| image.taken_at > self.taken_at);
        let (Some(image), Some(game)) = (image, blackboard.read(topics::GAME_STATE)) else { return };
        let taken_at = Moment::from_nanos(image.taken_at);
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

    /// Carries everything on to a moment; an image older than what is known is taken as one of now.
    fn advance(&mut self, moment: Moment, odometry: &Isometry2<f64>) {
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

/// The odometry at a moment: from the history that Sensors keeps, and what the body has felt since its end.
fn odometry_at(blackboard: &Blackboard, moment: Moment) -> Option<Isometry2<f64>> {
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
    use crate::activities::stage::Stage;
    use crate::activities::{SendCalibration, Sensors};

    /// A body that stands still, and an eye that sees what the test shows it.
    struct Eye {
        stage: Stage,
        vision: Vision,
    }

    const FRAME: Duration = Duration::from_millis(100);

    impl Eye {
        fn new() -> Eye {
            Eye { stage: Stage::new(), vision: Vision::default() }
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

        /// Shows a picture taken now, 0.1 s after the last, while the robot has walked ahead by `step`.
        fn show(&mut self, step: f64, objects: &[(ObjectKind, Colour, f64, f64)]) -> Ball {
            self.stage.wait(FRAME);
            let measured_at = self.stage.now.as_nanos();
            self.stage.tell(body::SENSORS, Felt { measured_at, odometry_x: step, ..Felt::default() });
            let objects = objects.iter().map(|&(kind, colour, distance, bearing)| Sighting {
                kind: kind.into(),
                colour: colour.into(),
                distance,
                bearing,
            });
            let image =
                Sightings { taken_at: measured_at, objects: objects.collect(), ..Sightings::default() };
            self.stage.tell(body::SIGHTINGS, image);
            self.stage.run(&mut Sensors);
            self.stage.run(&mut self.vision);
            self.stage.said(topics::BALL).unwrap()
        }

        fn ball(&mut self, distance: f64, bearing: f64) -> Ball {
            self.show(0.0, &[(ObjectKind::Ball, Colour::Orange, distance, bearing)])
        }
    }

    #[test]
    fn without_a_history_there_is_nothing_to_say() {
        let mut eye = Eye::new();
        eye.stage.run(&mut eye.vision);
        assert_eq!(eye.stage.said(topics::BALL), None);
    }

    #[test]
    fn a_ball_is_found_while_it_is_remembered() {
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, 0.0, 0.0, 0.0));
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
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, 0.0, 0.0, 0.0));
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
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, 0.0, 0.0, 0.0));
        for _ in 0..10 {
            assert!(!eye.ball(1.0, 0.1).approaching);
        }
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, 0.0, 0.0, 0.0));
        for frame in 0..10 {
            let y = 1.0 - 0.15 * f64::from(frame);
            assert!(!eye.ball(libm::hypot(1.5, y), libm::atan2(y, 1.5)).approaching);
        }
    }

    #[test]
    fn the_robot_stands_where_it_was_put_and_where_posts_tell() {
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, -1.0, 0.5, 0.0));
        eye.show(0.0, &[]);
        let pose = eye.stage.said(topics::POSE).unwrap();
        assert_eq!((pose.x, pose.y, pose.heading), (-1.0, 0.5, 0.0));
        for _ in 0..20 {
            eye.show(0.05, &[]);
        }
        let walked = eye.stage.said(topics::POSE).unwrap();
        assert!((walked.x - 0.0).abs() < 1e-9 && walked.confidence < pose.confidence, "{walked:?}");
        for _ in 0..30 {
            let post = |kind, y: f64| (kind, Colour::Yellow, libm::hypot(2.9, y), libm::atan2(y, 2.9));
            eye.show(0.0, &[post(ObjectKind::LeftPost, 0.2), post(ObjectKind::RightPost, -1.2)]);
        }
        let seen = eye.stage.said(topics::POSE).unwrap();
        assert!((seen.x - 0.1).abs() < 0.05 && (seen.y - 0.5).abs() < 0.05, "{seen:?}");
        assert!(seen.confidence > walked.confidence);
    }

    #[test]
    fn who_is_put_down_again_forgets_what_it_saw() {
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        assert!(eye.ball(1.0, 0.0).found);
        eye.stage.tell(topics::GAME_STATE, Eye::placed(2, 1.0, 1.0, 3.0));
        assert!(!eye.show(0.0, &[]).found);
        let pose = eye.stage.said(topics::POSE).unwrap();
        assert_eq!((pose.x, pose.y), (1.0, 1.0));
    }

    #[test]
    fn a_calibration_makes_it_forget_the_ball() {
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        assert!(eye.ball(1.0, 0.0).found);
        eye.stage.run(&mut SendCalibration);
        assert!(!eye.show(0.0, &[]).found);
    }

    #[test]
    fn robots_are_told_apart_by_their_colour() {
        let mut eye = Eye::new();
        eye.stage.tell(topics::GAME_STATE, Eye::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        eye.show(
            0.0,
            &[(ObjectKind::Robot, Colour::Red, 1.0, 0.0), (ObjectKind::Robot, Colour::Blue, 2.0, 0.5)],
        );
        let robots = eye.stage.said(topics::ROBOTS).unwrap();
        assert_eq!(robots.nearest, 1.0);
        let robots = robots.robots;
        assert_eq!(robots.iter().map(|robot| robot.team_mate).collect::<Vec<_>>(), [true, false]);
    }
}
