//! Ball, pose and other robots, estimated from sightings and odometry.
//!
//! [`Perception`] is the activity [`Vision`](crate::activities::Vision) without a blackboard, for
//! programs that have none.

use monas_robot::{ObjectKind, Posture, Sighting, Sightings};
use nalgebra::{Isometry2, Point2};
use narukom::Timestamp;

use crate::functionality::ball_filter::{BallEstimate, BallFilter, BallModel};
use crate::functionality::field::FieldModel;
use crate::functionality::geometry;
use crate::functionality::interception::{Crossing, crossing};
use crate::functionality::landmarks::{LandmarkSighting, LineSighting};
use crate::functionality::localisation::{Localisation, LocalisationModel, PoseEstimate};
use crate::functionality::obstacles::{Obstacle, Obstacles};
use crate::functionality::opponent_motion::is_evidence;
use crate::functionality::placement;
use crate::{Ball, FieldLines, GameState, OtherRobot, Placement, PlayerState, Pose, Robots, convert};

/// When a ball counts as found and as approaching.
#[derive(Clone, Copy, Debug)]
pub struct PerceptionModel {
    /// Time for which a ball counts as found after it was last seen, seconds.
    pub memory: f64,
    /// Least speed of an approaching ball, m/s.
    pub least_speed: f64,
    /// Largest lateral distance at which an approaching ball passes the robot, metres.
    pub reach: f64,
    /// The model of a rolling ball.
    pub ball: BallModel,
}

impl Default for PerceptionModel {
    fn default() -> PerceptionModel {
        PerceptionModel { memory: 1.2, least_speed: 0.3, reach: 0.9, ball: BallModel::default() }
    }
}

/// The filters for ball, pose and other robots, at one time and one odometry.
#[derive(Clone, Debug)]
pub struct Perception {
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
    /// The landmarks of the current image; kept to reuse its allocation.
    landmarks: Vec<LandmarkSighting>,
    obstacles: Obstacles,
    fallen: bool,
}

/// Distance of the nearest robot when there is none, metres.
const NO_ROBOT: f64 = 1e6;

/// Standard deviation of a pose that the robot reaches by placing itself: metres and radians.
const PLACEMENT_DEVIATION: (f64, f64) = (0.05, 0.05);

/// Least length of a line, and the farthest distance of its middle, that corrects the pose, metres.
const LEAST_LINE: f64 = 0.15;
const FARTHEST_LINE: f64 = 3.0;

impl Perception {
    /// Filters that have seen nothing. The odometry is the pose of the robot relative to any fixed
    /// point, the same for all calls.
    pub fn new(model: &PerceptionModel, moment: Timestamp, odometry: Isometry2<f64>) -> Perception {
        Perception {
            moment,
            odometry,
            taken_at: 0,
            ball: BallFilter::new(model.ball),
            ball_at: moment,
            localisation: None,
            placements: None,
            landmarks: Vec::new(),
            obstacles: Obstacles::default(),
            fallen: false,
        }
    }

    /// The time of the last image, nanoseconds.
    pub fn taken_at(&self) -> u64 {
        self.taken_at
    }

    /// Applies a placement and discards earlier sightings. After a placement by a person, every
    /// pose that the rules allow is possible.
    pub fn apply_placement(&mut self, game: &GameState, now: Timestamp, odometry: Isometry2<f64>) {
        if self.placements == Some(game.placements) || game.placements == 0 {
            return;
        }
        self.placements = Some(game.placements);
        let field = game.field();
        let poses = match game.placement() {
            Placement::KnownPose => vec![PoseEstimate {
                field_from_robot: geometry::pose(game.placed_x, game.placed_y, game.placed_heading),
                place_deviation: PLACEMENT_DEVIATION.0,
                turn_deviation: PLACEMENT_DEVIATION.1,
            }],
            Placement::OwnHalf => placement::Placement::OwnHalf.poses(&field),
            Placement::HalfwayLine => placement::Placement::HalfwayLine.poses(&field),
        };
        self.localisation = Some(Localisation::new(LocalisationModel::default(), &poses));
        self.ball.forget();
        self.obstacles.forget();
        (self.moment, self.odometry, self.ball_at) = (now, odometry, now);
        self.taken_at = now.as_nanos();
    }

    /// Increases the uncertainty of the pose after a fall, which odometry does not measure.
    pub fn feel(&mut self, posture: Option<Posture>) {
        let fallen = posture == Some(Posture::Fallen);
        if let (true, false, Some(filter)) = (fallen, self.fallen, &mut self.localisation) {
            filter.disturb(0.1, 0.3);
        }
        self.fallen = fallen;
    }

    /// Processes an image, given the odometry at the time it was taken. The filters may have been
    /// propagated past that time: then what it shows is transformed into their frame.
    pub fn see(&mut self, image: &Sightings, game: &GameState, odometry: &Isometry2<f64>) {
        let taken_at = Timestamp::from_nanos(image.taken_at);
        self.taken_at = image.taken_at;
        self.advance(taken_at, odometry);
        let then_from_now = self.moved_since(taken_at, odometry);
        let moved = |sighting: &Sighting| match &then_from_now {
            Some(then_from_now) => convert::moved(sighting, then_from_now),
            None => *sighting,
        };
        let objects = image.objects.iter().map(moved);
        let of_kind = |kind| objects.clone().filter(move |sighting| sighting.kind() == kind);
        self.landmarks.clear();
        self.landmarks.extend(objects.clone().filter_map(|sighting| convert::landmark(&sighting, game)));
        if let Some(filter) = &mut self.localisation {
            filter.correct(&game.field(), &self.landmarks);
        }
        let age = self.moment.since(taken_at);
        if self.ball.correct(of_kind(ObjectKind::Ball).map(convert::ball_sighting), age) {
            self.ball_at = taken_at;
        }
        let field_from_robot = self.localisation.as_ref().map(Localisation::field_from_robot);
        let is_evidence = |position: Point2<f64>| {
            game.player_state() == PlayerState::Playing
                && field_from_robot
                    .is_some_and(|frame| is_evidence(&game.field(), position, frame * position))
        };
        self.obstacles.see(of_kind(ObjectKind::Robot).map(|sighting| {
            let (position, team_mate) = (convert::position(&sighting), sighting.colour == game.team_colour);
            let is_evidence = !team_mate && is_evidence(position);
            Obstacle { position, team_mate, seen_at: taken_at, is_evidence }
        }));
    }

    /// Corrects the pose with the lines of an image that was [seen](Perception::see), given the
    /// odometry at the time it was taken.
    pub fn see_lines(&mut self, seen: &FieldLines, game: &GameState, odometry: &Isometry2<f64>) {
        let then_from_now = self.moved_since(Timestamp::from_nanos(seen.taken_at), odometry);
        let now_from_then = then_from_now.map_or(Isometry2::identity(), |moved| moved.inverse());
        let lines = seen.lines.iter().map(|line| {
            let ends = [(line.x1, line.y1), (line.x2, line.y2)];
            LineSighting { ends: ends.map(|(x, y)| now_from_then * Point2::new(x, y)) }
        });
        let is_clear = |line: &LineSighting| {
            line.along().norm() >= LEAST_LINE && line.middle().coords.norm() <= FARTHEST_LINE
        };
        if let Some(filter) = &mut self.localisation {
            filter.correct_by_lines(&game.field(), lines.filter(is_clear));
        }
    }

    /// The motion since a time with an odometry, if the filters are propagated past it.
    fn moved_since(&self, moment: Timestamp, odometry: &Isometry2<f64>) -> Option<Isometry2<f64>> {
        (self.moment > moment).then(|| odometry.inverse() * self.odometry)
    }

    /// Propagates all filters to a time; earlier times are ignored.
    pub fn advance(&mut self, moment: Timestamp, odometry: &Isometry2<f64>) {
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

    /// The ball, with its relation to the robots that are seen and to the own goal area.
    pub fn ball(&self, model: &PerceptionModel, robots: &Robots, field: Option<FieldModel>) -> Ball {
        self.in_surroundings(self.estimated_ball(model), robots, field)
    }

    fn estimated_ball(&self, model: &PerceptionModel) -> Ball {
        let age = self.moment.since(self.ball_at).as_secs_f64();
        let unseen = Ball { age, ..Ball::default() }.with_crossing(None);
        let Some(estimate) = self.ball.estimate() else { return unseen };
        let ball = Ball { found: age <= model.memory, seen_at: self.ball_at.as_nanos(), ..unseen };
        ball.with_estimate(&estimate).with_crossing(model.approach(&estimate))
    }

    /// Sets where the ball lies to the team mates that were seen, and to the own goal area.
    fn in_surroundings(&self, ball: Ball, robots: &Robots, field: Option<FieldModel>) -> Ball {
        let mates = robots.robots.iter().filter(|robot| robot.team_mate);
        let nearest = mates.map(|mate| (mate.position() - ball.position()).norm()).fold(NO_ROBOT, f64::min);
        let in_area = |(field, filter): (FieldModel, &Localisation)| {
            field.in_own_area(filter.field_from_robot() * ball.position(), 0.0)
        };
        let in_own_area = ball.found && field.zip(self.localisation.as_ref()).is_some_and(in_area);
        Ball { mate_lead: (ball.distance - nearest).max(0.0), in_own_area, ..ball }
    }

    /// The other robots that were seen recently.
    pub fn robots(&self) -> Robots {
        let robots = self.obstacles.iter().map(|robot| OtherRobot {
            x: robot.position.x,
            y: robot.position.y,
            team_mate: robot.team_mate,
            age: self.moment.since(robot.seen_at).as_secs_f64(),
        });
        let robots: Vec<OtherRobot> = robots.collect();
        let distances = robots.iter().map(|robot| robot.position().coords.norm());
        let nearest = distances.fold(NO_ROBOT, f64::min);
        Robots { nearest, robots, opponents_stand: self.obstacles.opponents_stand() }
    }

    /// The pose; none before the first placement.
    pub fn pose(&self) -> Option<Pose> {
        self.localisation.as_ref().map(Pose::from_filter)
    }
}

impl PerceptionModel {
    /// The point at which the ball crosses the robot's lateral axis, if it certainly rolls and will
    /// pass within reach.
    fn approach(&self, ball: &BallEstimate) -> Option<Crossing> {
        let surely = self.least_speed.max(2.0 * ball.velocity_deviation);
        if -ball.velocity.x < surely {
            return None;
        }
        let crossing = crossing(ball.position, ball.velocity, self.ball.rolling_deceleration);
        crossing.filter(|crossing| crossing.y.abs() <= self.reach)
    }
}
