//! Estimates of ball, pose and other robots from sightings.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use monas_robot::topics as body;
use nalgebra::Isometry2;
use narukom::Timestamp;

use crate::image_interpreter::{ImageInterpreter, Interpretation};
use crate::perception::{Perception, PerceptionModel};
use crate::{FieldLines, GameState, convert, topics};

/// Filters what the body sees: the ball with its velocity, the robot's pose from goal posts and
/// lines, the other robots and whether the opponents stand still.
///
/// It reads finished sightings, or images from a body that delivers these. An image is interpreted
/// with the camera pose from the head joints and the torso's inclination at the time it was taken,
/// which the history of sensor readings has. Images also give the lines and the border of the
/// field, in the robot's frame at their time.
///
/// Sightings are related to the odometry at the time of the image, which Sensors keeps, and
/// propagated to the time of publication. A ball or a robot counts once two of a few images show
/// it, since images show things that are not there. After a placement by hand every pose that the
/// rules allow is possible, and earlier sightings are discarded.
///
/// Parameters `memory` (s): how long a ball counts as found after it was last seen;
/// `rolling_deceleration` (m/s²) of the ball; `least_speed` (m/s) and `reach` (m): least speed, and
/// largest lateral distance from the robot, of an approaching ball; `eye_height` (m) of the camera,
/// `elevation_noise` and `bearing_noise` (rad): standard deviations of measured angles of the ball.
#[derive(Clone, Debug, Default)]
pub struct Vision {
    model: PerceptionModel,
    perception: Option<Perception>,
    interpreter: ImageInterpreter,
    calibration: u32,
}

impl Activity for Vision {
    fn configure(&mut self, parameters: &Parameters) {
        let read = |key, value: &mut f64| *value = parameters.number(key).unwrap_or(*value);
        read("memory", &mut self.model.memory);
        read("least_speed", &mut self.model.least_speed);
        read("reach", &mut self.model.reach);
        read("rolling_deceleration", &mut self.model.ball.rolling_deceleration);
        read("eye_height", &mut self.model.ball.eye_height);
        read("elevation_noise", &mut self.model.ball.elevation_noise);
        read("bearing_noise", &mut self.model.ball.bearing_noise);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.apply_calibration(blackboard);
        let now = blackboard.now();
        // Without a history from Sensors, images cannot be related to odometry.
        let Some(odometry) = odometry_at(blackboard, now) else { return Ok(Progress::Done) };
        let perception = self.perception.get_or_insert_with(|| Perception::new(&self.model, now, odometry));
        if let Some(game) = blackboard.read(topics::GAME_STATE) {
            perception.apply_placement(game, now, odometry);
        }
        perception.feel(blackboard.read(body::SENSORS).map(|sensors| sensors.posture()));
        let lines = see(perception, &mut self.interpreter, blackboard)?;
        perception.advance(now, &odometry);
        self.publish(blackboard)?;
        if let Some(lines) = lines {
            blackboard.publish(topics::FIELD_LINES, lines)?;
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(body::SENSORS).reads(body::SIGHTINGS).reads(topics::SENSORS);
        let topics = topics.reads(body::IMAGES).reads(topics::GAME_STATE).reads(topics::CALIBRATION);
        let topics = topics.publishes(topics::BALL).publishes(topics::POSE).publishes(topics::ROBOTS);
        topics.publishes(topics::FIELD_LINES)
    }
}

impl Vision {
    fn apply_calibration(&mut self, blackboard: &Blackboard) {
        let number = blackboard.read(topics::CALIBRATION).map_or(0, |calibration| calibration.number);
        if number != self.calibration {
            self.calibration = number;
            self.perception = None;
            self.interpreter = ImageInterpreter::default();
        }
    }

    fn publish(&self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let Some(perception) = &self.perception else { return Ok(()) };
        let field = blackboard.read(topics::GAME_STATE).map(GameState::field);
        let robots = perception.robots();
        blackboard.publish(topics::BALL, perception.ball(&self.model, &robots, field))?;
        blackboard.publish(topics::ROBOTS, robots)?;
        if let Some(pose) = perception.pose() {
            blackboard.publish(topics::POSE, pose)?;
        }
        Ok(())
    }
}

/// Processes the newest image, or the newest sightings, if they are new, at the time at which the
/// image was taken. Returns the lines and the border that a new image shows.
fn see(
    perception: &mut Perception,
    interpreter: &mut ImageInterpreter,
    blackboard: &Blackboard,
) -> Result<Option<FieldLines>, BoxError> {
    let Some(game) = blackboard.read(topics::GAME_STATE) else { return Ok(None) };
    let odometry = |taken_at| odometry_at(blackboard, Timestamp::from_nanos(taken_at));
    let is_new = |perception: &Perception, taken_at| taken_at > perception.taken_at();
    let sightings = blackboard.read(body::SIGHTINGS);
    if let Some(image) = sightings.filter(|image| is_new(perception, image.taken_at))
        && let Some(odometry) = odometry(image.taken_at)
    {
        perception.see(image, game, &odometry);
    }
    let images = blackboard.read(body::IMAGES);
    if let Some(images) = images.filter(|images| is_new(perception, images.taken_at))
        && let Some(odometry) = odometry(images.taken_at)
        && let Some(sensors) = sensors_at(blackboard, images.taken_at)
    {
        let Interpretation { sightings, lines } = interpreter.interpret(images, sensors)?;
        perception.see(&sightings, game, &odometry);
        perception.see_lines(&lines, game, &odometry);
        return Ok(Some(lines));
    }
    Ok(None)
}

/// The sensor readings of a time: the last that were not later.
fn sensors_at(blackboard: &Blackboard, moment: u64) -> Option<&monas_robot::Sensors> {
    let mut felt = blackboard.recent(body::SENSORS, Duration::MAX);
    felt.rfind(|felt| felt.measured_at <= moment).map(|felt| felt.message)
}

/// The odometry at a time: from the history of Sensors and the newer sensor readings.
fn odometry_at(blackboard: &Blackboard, moment: Timestamp) -> Option<Isometry2<f64>> {
    let until = moment.as_nanos();
    let mut history = blackboard.recent(topics::SENSORS, Duration::MAX);
    let last = history.rfind(|entry| entry.measured_at <= until)?;
    let felt = blackboard.recent(body::SENSORS, Duration::MAX);
    let since = felt.filter(|felt| last.measured_at < felt.measured_at && felt.measured_at <= until);
    Some(since.fold(last.odometry(), |odometry, felt| odometry * convert::odometry(felt.message)))
}

monas::activity!(Vision);

#[cfg(test)]
mod tests {
    use monas_robot::{Colour, Image, Images, ObjectKind, Sensors as Felt, Sighting, Sightings};
    use monas_vision::render::{Light, Renderer, Scene};
    use monas_vision::{Camera, FieldObjects, HeadPose};
    use nalgebra::Point2;

    use super::*;
    use crate::Ball;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::activities::{SendCalibration, Sensors};
    use crate::functionality::geometry::pose;

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
        assert!(!eye.ball(1.0, 0.5).found, "one sighting may be false");
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

    /// The greatest error of the published position of a ball that starts 2 m ahead and rolls to
    /// the left, m. The robot turns, and each picture is delivered `latency` after its exposure.
    fn greatest_error(speed: f64, turn: f64, latency: Duration) -> f64 {
        const CYCLE: Duration = Duration::from_millis(20);
        let start = Timestamp::from_nanos(2_000_000_000);
        let seen_at = |time: Timestamp| {
            let elapsed = time.since(start).as_secs_f64();
            let (y, heading) = (speed * elapsed, turn * elapsed);
            pose(0.0, 0.0, heading).inverse_transform_point(&Point2::new(2.0, y))
        };
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        let mut greatest: f64 = 0.0;
        for cycle in 1..=60 {
            eye.stage.wait(CYCLE);
            let now = eye.stage.now;
            let odometry_turn = turn * CYCLE.as_secs_f64();
            let felt = Felt { measured_at: now.as_nanos(), odometry_turn, ..Felt::default() };
            eye.stage.publish(body::SENSORS, felt);
            let taken_at = now.as_nanos() - latency.as_nanos() as u64;
            if cycle % 2 == 0 && taken_at > start.as_nanos() {
                let ball = seen_at(Timestamp::from_nanos(taken_at)).coords;
                let (distance, bearing) = (ball.norm(), libm::atan2(ball.y, ball.x));
                let kind = ObjectKind::Ball.into();
                let objects = vec![Sighting { kind, distance, bearing, ..Sighting::default() }];
                eye.stage.publish(body::SIGHTINGS, Sightings { taken_at, objects, ..Sightings::default() });
            }
            eye.stage.run(&mut Sensors);
            eye.stage.run(&mut eye.vision);
            let ball = eye.stage.latest(topics::BALL).unwrap();
            // The filter knows the velocity after half a second.
            if cycle > 25 {
                assert!(ball.found, "cycle {cycle}");
                greatest = greatest.max((ball.position() - seen_at(now)).norm());
            }
        }
        greatest
    }

    #[test]
    fn a_latency_does_not_displace_the_ball() {
        let (none, latency) = (Duration::ZERO, Duration::from_millis(60));
        for (speed, turn) in [(0.0, 0.0), (0.0, 1.2), (1.0, 0.0), (1.0, -1.2), (0.5, 1.2)] {
            let (prompt, late) = (greatest_error(speed, turn, none), greatest_error(speed, turn, latency));
            // Without propagation to the present, the ball lags by latency * speed, and a turn at
            // 2 m displaces it by 0.14 m.
            let explained = latency.as_secs_f64() * speed / 2.0 + 0.005;
            assert!(late <= prompt + explained, "{speed} m/s, {turn} rad/s: {prompt} m, late {late} m");
            assert!(prompt < 0.05, "{speed} m/s, {turn} rad/s: {prompt} m");
        }
    }

    #[test]
    fn a_late_picture_of_posts_and_robots_is_turned_into_the_present() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        let kind = |kind: ObjectKind, colour: Colour, x: f64, y: f64| Sighting {
            kind: kind.into(),
            colour: colour.into(),
            distance: libm::hypot(x, y),
            bearing: libm::atan2(y, x),
        };
        // Each cycle turns the robot by 0.1 rad; pictures are one cycle old.
        let turn = 0.1;
        for cycle in 1..=6 {
            let exposed_at = eye.stage.now.as_nanos();
            eye.stage.wait(FRAME);
            let measured_at = eye.stage.now.as_nanos();
            eye.stage.publish(body::SENSORS, Felt { measured_at, odometry_turn: turn, ..Felt::default() });
            let heading = turn * f64::from(cycle - 1);
            let seen = |x: f64, y: f64| {
                let from = pose(0.0, 0.0, heading);
                from.inverse_transform_point(&Point2::new(x, y))
            };
            let (post, robot) = (seen(3.0, 0.7), seen(1.0, 0.5));
            let objects = vec![
                kind(ObjectKind::LeftPost, Colour::Yellow, post.x, post.y),
                kind(ObjectKind::Robot, Colour::Blue, robot.x, robot.y),
            ];
            let image = Sightings { taken_at: exposed_at, objects, ..Sightings::default() };
            eye.stage.publish(body::SIGHTINGS, image);
            eye.stage.run(&mut Sensors);
            eye.stage.run(&mut eye.vision);
        }
        let own = eye.stage.latest(topics::POSE).unwrap();
        assert!((own.heading - 0.6).abs() < 0.01 && own.x.abs() < 0.02 && own.y.abs() < 0.02, "{own:?}");
        let robots = eye.stage.latest(topics::ROBOTS).unwrap().robots;
        let expected = pose(0.0, 0.0, 0.6).inverse_transform_point(&Point2::new(1.0, 0.5));
        assert_eq!(robots.len(), 1);
        assert!((robots[0].position() - expected).norm() < 0.01, "{robots:?}");
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

    /// The image of a camera at the centre of the field towards the yellow goal.
    fn image(tilt: f64) -> Image {
        let (width, height, angle_of_view, camera_height) = (320, 240, 0.8343, 0.5);
        let head = HeadPose { height: camera_height, pitch: tilt, ..HeadPose::default() };
        let camera = Camera::new(width, height, angle_of_view, &head.robot_from_camera()).unwrap();
        let objects = FieldObjects::OF_2010;
        let scene = Scene { markings: Default::default(), objects, ball: None, robots: vec![], variant: 1 };
        let mut pixels = Vec::new();
        Renderer::default().draw(&scene, &camera, &Light::default(), 1, &mut pixels).unwrap();
        let (width, height) = (width as u32, height as u32);
        Image { width, height, angle_of_view, camera_height, camera_tilt: tilt, pixels }
    }

    #[test]
    fn lines_and_border_of_images_are_published_with_their_time() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        eye.ball(1.0, 0.0);
        assert_eq!(eye.stage.latest(topics::FIELD_LINES), None, "sightings have no lines");
        eye.stage.wait(FRAME);
        let taken_at = eye.stage.now.as_nanos();
        eye.stage.publish(body::SENSORS, Felt { measured_at: taken_at, ..Felt::default() });
        let images = Images { taken_at, images: vec![image(0.1), image(0.6)], ..Images::default() };
        eye.stage.publish(body::IMAGES, images);
        eye.stage.run(&mut Sensors);
        eye.stage.run(&mut eye.vision);
        let seen = eye.stage.latest(topics::FIELD_LINES).unwrap();
        assert_eq!(seen.taken_at, taken_at);
        // The goal line, 3 m ahead, and the front of the goal area, 2.4 m ahead, run across.
        for ahead in [2.4, 3.0] {
            let is_it = |line: &&crate::FieldLine| {
                (line.x1 - ahead).abs() < 0.12
                    && (line.x2 - ahead).abs() < 0.12
                    && (line.y1 - line.y2).abs() > 0.8
            };
            assert_eq!(seen.lines.iter().filter(is_it).count(), 1, "{ahead} m: {:?}", seen.lines);
        }
        // The carpet ends 3.7 m ahead.
        assert!((8..=32).contains(&seen.border.len()), "{:?}", seen.border);
        assert!(seen.border.iter().all(|point| (point.x - 3.7).abs() < 0.25), "{:?}", seen.border);
    }

    #[test]
    fn a_replaced_robot_forgets_its_percepts() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        eye.ball(1.0, 0.0);
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
        eye.ball(1.0, 0.0);
        assert!(eye.ball(1.0, 0.0).found);
        eye.stage.run(&mut SendCalibration);
        assert!(!eye.show(0.0, &[]).found);
    }

    #[test]
    fn robots_are_distinguished_by_their_colour() {
        let mut eye = VisionFixture::new();
        eye.stage.publish(topics::GAME_STATE, VisionFixture::placed(1, 0.0, 0.0, 0.0));
        eye.show(0.0, &[]);
        for _ in 0..2 {
            eye.show(
                0.0,
                &[(ObjectKind::Robot, Colour::Red, 1.0, 0.0), (ObjectKind::Robot, Colour::Blue, 2.0, 0.5)],
            );
        }
        let robots = eye.stage.latest(topics::ROBOTS).unwrap();
        assert_eq!(robots.nearest, 1.0);
        let robots = robots.robots;
        assert_eq!(robots.iter().map(|robot| robot.team_mate).collect::<Vec<_>>(), [true, false]);
    }
}
