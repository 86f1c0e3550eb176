//! Estimates position and velocity of the ball from noisy sightings.
//!
//! A Kalman filter with a model of constant velocity and white acceleration (Bar-Shalom, Li,
//! Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section 6.2), plus
//! the constant deceleration of a rolling ball. The state is kept in the robot's frame, so that
//! errors of localisation do not affect it; odometry transforms it.
//!
//! A sighting that does not fit the ball is a candidate. It is accepted when a second sighting fits
//! it within a few pictures, and replaces a ball that was not seen meanwhile (the ball was kicked
//! or moved). A single false sighting (an orange shoe) thus changes nothing.

use std::time::Duration;

use nalgebra::{Isometry2, Matrix2, Matrix2x4, Matrix4, Matrix4x2, Point2, Vector2, Vector4};

use super::geometry::polar;

/// Parameters of the ball, the ground and the camera.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BallModel {
    /// Deceleration of the rolling ball, m/s².
    pub rolling_deceleration: f64,
    /// Standard deviation of unmodelled accelerations, m/s².
    pub acceleration_noise: f64,
    /// Standard deviation of the measured elevation of the ball, radians: errors of the distance
    /// grow with distance.
    pub elevation_noise: f64,
    /// Standard deviation of a measured bearing, radians.
    pub bearing_noise: f64,
    /// Height of the camera above the ground, metres.
    pub eye_height: f64,
    /// Standard deviation of the velocity of a ball seen for the first time, m/s.
    pub first_speed: f64,
}

impl BallModel {
    /// The initial speed of a ball, m/s, that arrives at a given distance, in metres, with a given
    /// speed, in m/s. Zero, which requests the fastest kick, for a distance of zero.
    pub fn speed_for(&self, distance: f64, arrival: f64) -> f64 {
        libm::sqrt((2.0 * self.rolling_deceleration * distance + arrival * arrival).max(0.0))
    }
}

impl Default for BallModel {
    /// The carpet and the orange ball of the league in 2010.
    fn default() -> BallModel {
        BallModel {
            rolling_deceleration: 0.25,
            acceleration_noise: 3.0,
            elevation_noise: 0.01,
            bearing_noise: 0.015,
            eye_height: 0.5,
            first_speed: 0.6,
        }
    }
}

/// The estimate of the ball in the robot's frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BallEstimate {
    /// Position, metres.
    pub position: Point2<f64>,
    /// Velocity over the ground, m/s.
    pub velocity: Vector2<f64>,
    /// Standard deviation of the velocity in its less certain direction, m/s.
    pub velocity_deviation: f64,
}

/// A sighting of the ball: distance in metres, bearing in radians.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BallSighting {
    /// Distance along the ground, metres.
    pub distance: f64,
    /// Bearing from the robot, radians.
    pub bearing: f64,
}

/// The filter. [Predicted](BallFilter::predict) with every motion of the robot,
/// [corrected](BallFilter::correct) with every picture.
#[derive(Clone, Debug)]
pub struct BallFilter {
    model: BallModel,
    /// The ball; none before it was seen twice.
    ball: Option<Track>,
    /// A track that may become the ball.
    candidate: Option<Track>,
}

/// Position and velocity of something that was seen, with their covariance.
#[derive(Clone, Copy, Debug)]
struct Track {
    state: Vector4<f64>,
    covariance: Matrix4<f64>,
    /// Number of pictures since it was last seen.
    unseen: u32,
}

/// A match of a sighting with a track.
struct TrackMatch {
    innovation: Vector2<f64>,
    gain: Matrix4x2<f64>,
    observation: Matrix2x4<f64>,
    mismatch: f64,
}

/// The square of the Mahalanobis distance beyond which a sighting is an outlier: 99.9 % of correct
/// ones are below (χ², 2 degrees of freedom).
const GATE_DISTANCE: f64 = 13.8;
/// Least standard deviation of a position, metres.
const LEAST_NOISE: f64 = 0.01;
/// Number of pictures in which a candidate must be seen again.
const CONFIRMING_PICTURES: u32 = 4;
/// Number of pictures without the ball after which it must be seen twice again: its position is so
/// uncertain that false sightings fit.
const UNSEEN_PICTURES: u32 = 30;

impl BallFilter {
    /// A filter without an estimate.
    pub fn new(model: BallModel) -> BallFilter {
        BallFilter { model, ball: None, candidate: None }
    }

    /// Forgets the ball.
    pub fn forget(&mut self) {
        (self.ball, self.candidate) = (None, None);
    }

    /// Predicts the state after `elapsed`, during which the robot moved to `old_from_new`, its new
    /// pose in its old frame.
    pub fn predict(&mut self, elapsed: Duration, old_from_new: &Isometry2<f64>) {
        let dt = elapsed.as_secs_f64();
        let noise = self.process_noise(dt);
        for track in [&mut self.ball, &mut self.candidate].into_iter().flatten() {
            track.predict(dt, &noise, self.model.rolling_deceleration, old_from_new);
        }
    }

    /// Corrects the state with the balls in a picture, which was taken `age` before the time of the
    /// state. Their positions are relative to the robot at the time of the state. Returns whether
    /// the ball was seen.
    pub fn correct(&mut self, seen: impl Iterator<Item = BallSighting> + Clone, age: Duration) -> bool {
        for track in [&mut self.ball, &mut self.candidate].into_iter().flatten() {
            track.unseen += 1;
        }
        self.candidate = self.candidate.filter(|candidate| candidate.unseen <= CONFIRMING_PICTURES);
        let fit = |track: &Track| {
            let fits = seen.clone().filter_map(|sighting| self.fit(track, sighting, age));
            let best = fits.min_by(|one, other| one.mismatch.total_cmp(&other.mismatch));
            best.filter(|best| best.mismatch <= GATE_DISTANCE)
        };
        let certain = self.ball.filter(|ball| ball.unseen <= UNSEEN_PICTURES);
        let seen_again = |track: Option<Track>| track.and_then(|track| Some(track.corrected(&fit(&track)?)));
        if let Some(ball) = seen_again(certain).or_else(|| seen_again(self.candidate)) {
            (self.ball, self.candidate) = (Some(ball), None);
            return true;
        }
        if let Some(sighting) = seen.clone().next() {
            self.candidate = Some(self.start(sighting));
        }
        false
    }

    /// The current estimate; none before the ball was seen twice.
    pub fn estimate(&self) -> Option<BallEstimate> {
        self.ball.map(|Track { state, covariance, .. }| BallEstimate {
            position: Point2::new(state[0], state[1]),
            velocity: Vector2::new(state[2], state[3]),
            velocity_deviation: covariance[(2, 2)].max(covariance[(3, 3)]).max(0.0).sqrt(),
        })
    }

    fn fit(&self, track: &Track, sighting: BallSighting, age: Duration) -> Option<TrackMatch> {
        let seen = polar(sighting.distance, sighting.bearing);
        let observation = observation(age);
        let innovation = seen - observation * track.state;
        let noise = self.measurement_noise(sighting);
        let spread = observation * track.covariance * observation.transpose() + noise;
        let inverse = spread.try_inverse()?;
        let mismatch = (innovation.transpose() * inverse * innovation).x;
        let gain = track.covariance * observation.transpose() * inverse;
        Some(TrackMatch { innovation, gain, observation, mismatch })
    }

    /// The track of something that is seen for the first time.
    fn start(&self, sighting: BallSighting) -> Track {
        let seen = polar(sighting.distance, sighting.bearing);
        let mut covariance = Matrix4::zeros();
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&self.measurement_noise(sighting));
        let speed = self.model.first_speed * self.model.first_speed;
        covariance.fixed_view_mut::<2, 2>(2, 2).copy_from(&(Matrix2::identity() * speed));
        Track { state: Vector4::new(seen.x, seen.y, 0.0, 0.0), covariance, unseen: 0 }
    }

    /// White acceleration, constant during the step.
    fn process_noise(&self, dt: f64) -> Matrix4<f64> {
        let variance = self.model.acceleration_noise * self.model.acceleration_noise;
        let (position, both, speed) = (dt * dt * dt * dt / 4.0, dt * dt * dt / 2.0, dt * dt);
        #[rustfmt::skip]
        let shape = Matrix4::new(
            position, 0.0,   both,  0.0,
            0.0,   position, 0.0,   both,
            both,  0.0,   speed, 0.0,
            0.0,   both,  0.0,   speed,
        );
        shape * variance
    }

    /// Noise along and across the line of sight, turned into the robot's frame.
    fn measurement_noise(&self, BallSighting { distance, bearing }: BallSighting) -> Matrix2<f64> {
        // A ball on the ground at distance d is seen at the elevation atan(h/d): δd = δe (d² + h²)
        // / h.
        let height = self.model.eye_height;
        let along =
            self.model.elevation_noise * (distance * distance + height * height) / height + LEAST_NOISE;
        let across = self.model.bearing_noise * distance + LEAST_NOISE;
        let sight = *super::geometry::rotation(bearing).to_rotation_matrix().matrix();
        sight * Matrix2::new(along * along, 0.0, 0.0, across * across) * sight.transpose()
    }
}

impl Track {
    fn predict(&mut self, dt: f64, noise: &Matrix4<f64>, deceleration: f64, old_from_new: &Isometry2<f64>) {
        let transition = transition(dt);
        let rolled = braked(&(transition * self.state), dt, deceleration);
        let covariance = transition * self.covariance * transition.transpose() + noise;
        let turned = turn(old_from_new);
        let position = old_from_new.inverse_transform_point(&Point2::new(rolled[0], rolled[1]));
        let velocity = old_from_new.inverse_transform_vector(&Vector2::new(rolled[2], rolled[3]));
        self.state = Vector4::new(position.x, position.y, velocity.x, velocity.y);
        self.covariance = turned * covariance * turned.transpose();
    }

    fn corrected(&self, fit: &TrackMatch) -> Track {
        let kept = Matrix4::identity() - fit.gain * fit.observation;
        let state = self.state + fit.gain * fit.innovation;
        Track { state, covariance: kept * self.covariance, unseen: 0 }
    }
}

/// The state after friction over `dt`: it stops the ball but does not reverse it.
fn braked(state: &Vector4<f64>, dt: f64, deceleration: f64) -> Vector4<f64> {
    let speed = libm::hypot(state[2], state[3]);
    let left = (speed - deceleration * dt).max(0.0);
    let part = if speed > 0.0 { left / speed } else { 0.0 };
    let mut braked = *state;
    // Corrects the displacement to the mean velocity: the step was computed with the initial
    // velocity.
    braked[0] -= state[2] * (1.0 - part) / 2.0 * dt;
    braked[1] -= state[3] * (1.0 - part) / 2.0 * dt;
    braked[2] *= part;
    braked[3] *= part;
    braked
}

fn transition(dt: f64) -> Matrix4<f64> {
    let mut transition = Matrix4::identity();
    transition[(0, 2)] = dt;
    transition[(1, 3)] = dt;
    transition
}

/// The observation model: the position of the ball `age` before the time of the state.
fn observation(age: Duration) -> Matrix2x4<f64> {
    let mut observation = Matrix2x4::identity();
    let age = age.as_secs_f64();
    (observation[(0, 2)], observation[(1, 3)]) = (-age, -age);
    observation
}

/// Turns position and velocity into the frame of a robot that has turned.
fn turn(old_from_new: &Isometry2<f64>) -> Matrix4<f64> {
    let inverse = *old_from_new.rotation.inverse().to_rotation_matrix().matrix();
    let mut turn = Matrix4::zeros();
    turn.fixed_view_mut::<2, 2>(0, 0).copy_from(&inverse);
    turn.fixed_view_mut::<2, 2>(2, 2).copy_from(&inverse);
    turn
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::functionality::geometry::pose;

    const FRAME: Duration = Duration::from_millis(100);

    fn sighting(ball: Point2<f64>) -> BallSighting {
        BallSighting { distance: libm::hypot(ball.x, ball.y), bearing: libm::atan2(ball.y, ball.x) }
    }

    /// Shows a picture with these balls.
    fn show(filter: &mut BallFilter, balls: &[Point2<f64>]) -> bool {
        filter.correct(balls.iter().copied().map(sighting), Duration::ZERO)
    }

    fn see(filter: &mut BallFilter, ball: Point2<f64>) {
        show(filter, &[ball]);
    }

    /// Asserts that the ball is at a place.
    fn assert_at(filter: &BallFilter, position: Point2<f64>) {
        let ball = filter.estimate().unwrap();
        assert!((ball.position - position).norm() < 0.02, "{ball:?}");
    }

    /// A filter that has seen a ball at a place in ten pictures.
    fn believer(ball: Point2<f64>) -> BallFilter {
        let mut filter = BallFilter::new(BallModel::default());
        (0..10).for_each(|_| see(&mut filter, ball));
        filter
    }

    #[test]
    fn nothing_is_known_before_it_is_seen_twice() {
        let (ball, nothing) = (Point2::new(1.0, 0.0), &[][..]);
        let mut filter = BallFilter::new(BallModel::default());
        filter.predict(FRAME, &Isometry2::identity());
        assert!(!show(&mut filter, &[ball]));
        assert_eq!(filter.estimate(), None);
        (1..CONFIRMING_PICTURES).for_each(|_| assert!(!show(&mut filter, nothing)));
        assert!(show(&mut filter, &[ball]), "seen again within a few pictures");
        assert_at(&filter, ball);
        filter.forget();
        assert_eq!(filter.estimate(), None);
        assert!(!show(&mut filter, &[ball]));
        (0..CONFIRMING_PICTURES).for_each(|_| assert!(!show(&mut filter, nothing)));
        assert!(!show(&mut filter, &[ball]), "too late");
        assert!(!show(&mut filter, &[Point2::new(2.0, 1.0)]), "elsewhere");
        assert_eq!(filter.estimate(), None);
    }

    #[test]
    fn a_rolling_ball_shows_its_velocity() {
        let model = BallModel { rolling_deceleration: 0.0, ..BallModel::default() };
        let mut filter = BallFilter::new(model);
        for step in 0..12 {
            see(&mut filter, Point2::new(2.0 - 0.1 * f64::from(step), 0.3));
            filter.predict(FRAME, &Isometry2::identity());
        }
        let ball = filter.estimate().unwrap();
        assert!((ball.velocity - Vector2::new(-1.0, 0.0)).norm() < 0.05, "{ball:?}");
        assert!((ball.position - Point2::new(0.8, 0.3)).norm() < 0.03, "{ball:?}");
    }

    #[test]
    fn an_unseen_ball_rolls_out_and_stays() {
        let mut filter = BallFilter::new(BallModel { rolling_deceleration: 0.5, ..BallModel::default() });
        for step in 0..12 {
            let t = 0.1 * f64::from(step);
            see(&mut filter, Point2::new(1.0 + t - 0.25 * t * t, 0.0));
            filter.predict(FRAME, &Isometry2::identity());
        }
        for _ in 0..40 {
            filter.predict(FRAME, &Isometry2::identity());
        }
        let ball = filter.estimate().unwrap();
        assert!(ball.velocity.norm() < 1e-9);
        assert!((ball.position - Point2::new(2.0, 0.0)).norm() < 0.15, "stops after v²/2a: {ball:?}");
    }

    #[test]
    fn a_resting_ball_rests_while_the_robot_walks_and_turns() {
        let ball_in_field = Point2::new(2.0, 0.5);
        let step = pose(0.02, 0.01, 0.05);
        let mut field_from_robot = Isometry2::identity();
        let mut filter = BallFilter::new(BallModel::default());
        for _ in 0..30 {
            see(&mut filter, field_from_robot.inverse_transform_point(&ball_in_field));
            filter.predict(FRAME, &step);
            field_from_robot *= step;
        }
        let ball = filter.estimate().unwrap();
        assert!(ball.velocity.norm() < 0.02, "{ball:?}");
        assert!((field_from_robot * ball.position - ball_in_field).norm() < 0.01, "{ball:?}");
    }

    #[test]
    fn outliers_are_ignored_unless_they_agree() {
        let (ball, moved) = (Point2::new(1.0, 0.0), Point2::from(polar(3.0, 1.0)));
        let mut filter = believer(ball);
        for outlier in [moved, Point2::new(0.5, -2.0), Point2::new(3.0, -1.0)] {
            assert!(!show(&mut filter, &[outlier]));
            assert_at(&filter, ball);
        }
        see(&mut filter, moved);
        assert!(show(&mut filter, &[moved]), "a contradicted ball is replaced");
        assert_at(&filter, moved);
    }

    #[test]
    fn a_ball_that_is_seen_is_not_replaced() {
        let (ball, shoe) = (Point2::new(1.0, 0.0), Point2::new(1.5, 1.0));
        let mut filter = believer(ball);
        for _ in 0..20 {
            assert!(show(&mut filter, &[shoe, ball]));
            assert_at(&filter, ball);
        }
        // The shoe alone, between pictures of the ball.
        for _ in 0..20 {
            assert!(!show(&mut filter, &[shoe]));
            assert!(show(&mut filter, &[ball]));
            assert_at(&filter, ball);
        }
    }

    #[test]
    fn a_ball_out_of_sight_is_believed_again_when_it_is_seen_twice() {
        let ball = Point2::new(1.0, 0.0);
        let mut filter = believer(ball);
        for _ in 0..=UNSEEN_PICTURES {
            show(&mut filter, &[]);
            filter.predict(FRAME, &Isometry2::identity());
        }
        // It fits the uncertain ball, but may be false.
        let near = Point2::new(1.3, 0.2);
        assert!(!show(&mut filter, &[near]));
        assert_at(&filter, ball);
        assert!(show(&mut filter, &[near]));
        assert_at(&filter, near);
    }

    #[test]
    fn a_late_picture_shows_where_a_rolling_ball_was() {
        let model = BallModel { rolling_deceleration: 0.0, ..BallModel::default() };
        let mut filter = BallFilter::new(model);
        let (at, age) = (|time: f64| Point2::new(2.0 - time, 0.3), Duration::from_millis(60));
        for step in 1..=15 {
            filter.predict(FRAME, &Isometry2::identity());
            let exposed_at = 0.1 * f64::from(step) - age.as_secs_f64();
            filter.correct([sighting(at(exposed_at))].into_iter(), age);
        }
        let ball = filter.estimate().unwrap();
        assert!((ball.position - at(1.5)).norm() < 0.02, "{ball:?}");
        assert!((ball.velocity - Vector2::new(-1.0, 0.0)).norm() < 0.05, "{ball:?}");
    }

    proptest! {
        #[test]
        fn no_sighting_makes_it_lose_its_numbers(
            sightings in prop::collection::vec((0.0..12.0f64, -3.2..3.2f64, 0u64..2000, -0.5..0.5f64), 1..80)
        ) {
            let mut filter = BallFilter::new(BallModel::default());
            for (distance, bearing, millis, step) in sightings {
                let sighting = BallSighting { distance, bearing };
                for _ in 0..2 {
                    filter.correct([sighting].into_iter(), Duration::from_millis(millis / 10));
                }
                filter.predict(Duration::from_millis(millis), &pose(step, -step, step));
                let ball = filter.estimate().unwrap();
                prop_assert!(ball.position.x.is_finite() && ball.velocity.norm().is_finite());
                prop_assert!(ball.velocity_deviation.is_finite());
            }
        }
    }
}
