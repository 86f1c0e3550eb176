//! Estimates position and velocity of the ball from noisy sightings.
//!
//! A Kalman filter with a model of constant velocity and white acceleration (Bar-Shalom, Li,
//! Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section 6.2), plus
//! the constant deceleration of a rolling ball. The state is kept in the robot's frame, so that
//! errors of localisation do not affect it; odometry transforms it. One outlier is ignored (an
//! orange shoe); the second in a row resets the filter (the ball was kicked or moved).

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
    /// The speed at which a ball has to start, m/s, to arrive after a way in metres at a speed in
    /// m/s. Zero, to be taken as the fastest, for no way at all.
    pub fn speed_for(&self, way: f64, arrival: f64) -> f64 {
        libm::sqrt((2.0 * self.rolling_deceleration * way + arrival * arrival).max(0.0))
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

/// The filter. [Predicted](BallFilter::predict) with every motion of the robot,
/// [corrected](BallFilter::correct) with every sighting.
#[derive(Clone, Debug)]
pub struct BallFilter {
    model: BallModel,
    /// Position and velocity with their covariance; none before the first sighting.
    belief: Option<(Vector4<f64>, Matrix4<f64>)>,
    /// Number of consecutive outliers.
    misfits: u32,
}

/// The square of the Mahalanobis distance beyond which a sighting is an outlier: 99.9 % of correct
/// ones are below (χ², 2 degrees of freedom).
const GATE: f64 = 13.8;
/// Least standard deviation of a position, metres.
const LEAST_NOISE: f64 = 0.01;

impl BallFilter {
    /// A filter without an estimate.
    pub fn new(model: BallModel) -> BallFilter {
        BallFilter { model, belief: None, misfits: 0 }
    }

    /// Forgets the ball.
    pub fn forget(&mut self) {
        self.belief = None;
        self.misfits = 0;
    }

    /// Predicts the state after `elapsed`, during which the robot moved to `old_from_new`, its new
    /// pose in its old frame.
    pub fn predict(&mut self, elapsed: Duration, old_from_new: &Isometry2<f64>) {
        let Some((state, covariance)) = self.belief else { return };
        let dt = elapsed.as_secs_f64();
        let transition = transition(dt);
        let rolled = self.braked(&(transition * state), dt);
        let covariance = transition * covariance * transition.transpose() + self.process_noise(dt);
        let turned = turn(old_from_new);
        let position = old_from_new.inverse_transform_point(&Point2::new(rolled[0], rolled[1]));
        let velocity = old_from_new.inverse_transform_vector(&Vector2::new(rolled[2], rolled[3]));
        let state = Vector4::new(position.x, position.y, velocity.x, velocity.y);
        self.belief = Some((state, turned * covariance * turned.transpose()));
    }

    /// Corrects the state with a sighting: distance in metres, bearing in radians.
    pub fn correct(&mut self, distance: f64, bearing: f64) {
        let seen = polar(distance, bearing);
        let noise = self.measurement_noise(distance, bearing);
        let Some((state, covariance)) = self.belief else { return self.restart(seen, noise) };
        let innovation = seen - state.fixed_rows::<2>(0);
        let spread = covariance.fixed_view::<2, 2>(0, 0) + noise;
        let Some(inverse) = spread.try_inverse() else { return self.restart(seen, noise) };
        if (innovation.transpose() * inverse * innovation).x > GATE {
            return self.misfit(seen, noise);
        }
        self.misfits = 0;
        let gain: Matrix4x2<f64> = covariance.fixed_columns::<2>(0) * inverse;
        let kept = Matrix4::identity() - gain * observation();
        self.belief = Some((state + gain * innovation, kept * covariance));
    }

    /// The current estimate; none before the first sighting.
    pub fn estimate(&self) -> Option<BallEstimate> {
        self.belief.map(|(state, covariance)| BallEstimate {
            position: Point2::new(state[0], state[1]),
            velocity: Vector2::new(state[2], state[3]),
            velocity_deviation: covariance[(2, 2)].max(covariance[(3, 3)]).max(0.0).sqrt(),
        })
    }

    fn misfit(&mut self, seen: Vector2<f64>, noise: Matrix2<f64>) {
        self.misfits += 1;
        if self.misfits >= 2 {
            self.restart(seen, noise);
        }
    }

    fn restart(&mut self, seen: Vector2<f64>, noise: Matrix2<f64>) {
        let mut covariance = Matrix4::zeros();
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&noise);
        let speed = self.model.first_speed * self.model.first_speed;
        covariance.fixed_view_mut::<2, 2>(2, 2).copy_from(&(Matrix2::identity() * speed));
        self.belief = Some((Vector4::new(seen.x, seen.y, 0.0, 0.0), covariance));
        self.misfits = 0;
    }

    /// The state after friction over `dt`: it stops the ball but does not reverse it.
    fn braked(&self, state: &Vector4<f64>, dt: f64) -> Vector4<f64> {
        let speed = libm::hypot(state[2], state[3]);
        let left = (speed - self.model.rolling_deceleration * dt).max(0.0);
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

    /// White acceleration, constant during the step.
    fn process_noise(&self, dt: f64) -> Matrix4<f64> {
        let variance = self.model.acceleration_noise * self.model.acceleration_noise;
        let (place, both, speed) = (dt * dt * dt * dt / 4.0, dt * dt * dt / 2.0, dt * dt);
        #[rustfmt::skip]
        let shape = Matrix4::new(
            place, 0.0,   both,  0.0,
            0.0,   place, 0.0,   both,
            both,  0.0,   speed, 0.0,
            0.0,   both,  0.0,   speed,
        );
        shape * variance
    }

    /// Noise along and across the line of sight, turned into the robot's frame.
    fn measurement_noise(&self, distance: f64, bearing: f64) -> Matrix2<f64> {
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

fn transition(dt: f64) -> Matrix4<f64> {
    let mut transition = Matrix4::identity();
    transition[(0, 2)] = dt;
    transition[(1, 3)] = dt;
    transition
}

fn observation() -> Matrix2x4<f64> {
    Matrix2x4::identity()
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

    fn see(filter: &mut BallFilter, ball: Point2<f64>) {
        filter.correct(libm::hypot(ball.x, ball.y), libm::atan2(ball.y, ball.x));
    }

    #[test]
    fn nothing_is_known_before_it_is_seen() {
        let mut filter = BallFilter::new(BallModel::default());
        filter.predict(FRAME, &Isometry2::identity());
        assert_eq!(filter.estimate(), None);
        filter.correct(1.0, 0.0);
        assert!(filter.estimate().is_some());
        filter.forget();
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
    fn one_outlier_is_ignored_and_two_restart() {
        let mut filter = BallFilter::new(BallModel::default());
        for _ in 0..10 {
            filter.correct(1.0, 0.0);
            filter.predict(FRAME, &Isometry2::identity());
        }
        filter.correct(3.0, 1.0);
        assert!((filter.estimate().unwrap().position - Point2::new(1.0, 0.0)).norm() < 0.01);
        filter.correct(3.0, 1.0);
        assert!((filter.estimate().unwrap().position - Point2::from(polar(3.0, 1.0))).norm() < 0.01);
    }

    proptest! {
        #[test]
        fn no_sighting_makes_it_lose_its_numbers(
            sightings in prop::collection::vec((0.0..12.0f64, -3.2..3.2f64, 0u64..2000, -0.5..0.5f64), 1..80)
        ) {
            let mut filter = BallFilter::new(BallModel::default());
            for (distance, bearing, millis, step) in sightings {
                filter.correct(distance, bearing);
                filter.predict(Duration::from_millis(millis), &pose(step, -step, step));
                let ball = filter.estimate().unwrap();
                prop_assert!(ball.position.x.is_finite() && ball.velocity.norm().is_finite());
                prop_assert!(ball.velocity_deviation.is_finite());
            }
        }
    }
}
