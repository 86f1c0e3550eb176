//! Localisation of the robot from odometry and goal posts.
//!
//! An extended Kalman filter over the pose with known landmarks (Thrun, Burgard, Fox,
//! *Probabilistic Robotics*, 2005, table 7.2). A post that matches no landmark is ignored; after
//! many such posts the filter increases its uncertainty step by step, similar to sensor resetting
//! (Lenser, Veloso, ICRA 2000), until posts match again.

use std::f64::consts::PI;

use nalgebra::{Isometry2, Matrix2, Matrix2x3, Matrix3, Matrix3x2, Point2, Vector2, Vector3};

use super::field::{FieldModel, Goal};
use super::geometry::{heading, pose, wrap};

/// Noise of the robot's measurements.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LocalisationModel {
    /// Drift of the odometry: standard deviation in metres after one metre. It grows with the
    /// square root of the distance.
    pub drift: f64,
    /// Drift of the heading: standard deviation in radians after turning one radian, and the same
    /// for each metre walked.
    pub turn_drift: f64,
    /// Standard deviation of a measured distance, relative to the distance.
    pub distance_noise: f64,
    /// Standard deviation of a measured bearing, radians.
    pub bearing_noise: f64,
}

impl Default for LocalisationModel {
    fn default() -> LocalisationModel {
        LocalisationModel { drift: 0.1, turn_drift: 0.15, distance_noise: 0.1, bearing_noise: 0.025 }
    }
}

/// Which of a goal's posts was seen, when facing that goal.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum GoalPost {
    /// The left one.
    Left,
    /// The right one.
    Right,
    /// One of the two.
    Either,
}

/// A sighting of a goal post.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PostSighting {
    /// The goal it belongs to.
    pub goal: Goal,
    /// Which of the two it is.
    pub post: GoalPost,
    /// Distance along the ground, metres.
    pub distance: f64,
    /// Bearing from the robot, radians.
    pub bearing: f64,
}

/// The filter. [Placed](Localisation::place) by the referee, [advanced](Localisation::advance) by
/// odometry, [corrected](Localisation::correct) by posts.
#[derive(Clone, Debug)]
pub struct Localisation {
    model: LocalisationModel,
    field_from_robot: Isometry2<f64>,
    /// Of x, y and heading.
    covariance: Matrix3<f64>,
    misfits: u32,
}

/// The square of the Mahalanobis distance beyond which a post does not match: 99.9 % of correct
/// ones are below (χ², 2 degrees of freedom).
const GATE: f64 = 13.8;
/// Number of consecutive mismatches after which the filter increases its uncertainty.
const DOUBT: u32 = 8;
/// Unmodelled change between two sightings, metres and radians; prevents overconfidence.
const UNMODELLED: (f64, f64) = (0.01, 0.005);
/// Standard deviation after a placement by hand: metres and radians.
const PLACED: (f64, f64) = (0.05, 0.05);

impl Localisation {
    /// A filter for a robot that was placed at a pose.
    pub fn new(model: LocalisationModel, field_from_robot: Isometry2<f64>) -> Localisation {
        let mut filter = Localisation { model, field_from_robot, covariance: Matrix3::zeros(), misfits: 0 };
        filter.place(field_from_robot);
        filter
    }

    /// Resets the pose after a placement by hand.
    pub fn place(&mut self, field_from_robot: Isometry2<f64>) {
        let (place, turn) = (PLACED.0 * PLACED.0, PLACED.1 * PLACED.1);
        self.field_from_robot = field_from_robot;
        self.covariance = Matrix3::from_diagonal(&Vector3::new(place, place, turn));
        self.misfits = 0;
    }

    /// Moves the robot to `old_from_new`, its new pose in its old frame.
    pub fn advance(&mut self, old_from_new: &Isometry2<f64>) {
        let step = self.field_from_robot.transform_vector(&old_from_new.translation.vector);
        #[rustfmt::skip]
        let jacobian = Matrix3::new(
            1.0, 0.0, -step.y,
            0.0, 1.0, step.x,
            0.0, 0.0, 1.0,
        );
        let (way, turned) = (step.norm(), heading(old_from_new).abs());
        let place = self.model.drift * self.model.drift * way;
        let turn = self.model.turn_drift * self.model.turn_drift * (turned + way);
        self.covariance = jacobian * self.covariance * jacobian.transpose();
        self.covariance += Matrix3::from_diagonal(&Vector3::new(place, place, turn));
        self.field_from_robot *= old_from_new;
    }

    /// Adds uncertainty of `place` metres and `turn` radians (standard deviations), as after a
    /// fall.
    pub fn disturb(&mut self, place: f64, turn: f64) {
        self.covariance += Matrix3::from_diagonal(&Vector3::new(place * place, place * place, turn * turn));
        self.covariance[(2, 2)] = self.covariance[(2, 2)].min(PI * PI);
    }

    /// Corrects the pose with a sighting of a post. A post that matches no landmark does not change
    /// the pose.
    pub fn correct(&mut self, field: &FieldModel, seen: &PostSighting) {
        self.disturb(UNMODELLED.0, UNMODELLED.1);
        let [left, right] = field.posts(seen.goal);
        let fit = match seen.post {
            GoalPost::Left => self.fit(left, seen),
            GoalPost::Right => self.fit(right, seen),
            GoalPost::Either => better(self.fit(left, seen), self.fit(right, seen)),
        };
        match fit {
            Some(fit) if fit.mismatch <= GATE => self.apply(&fit),
            _ => self.misfit(),
        }
    }

    /// The pose of the robot in the field.
    pub fn field_from_robot(&self) -> Isometry2<f64> {
        self.field_from_robot
    }

    /// Confidence of the position: 1 if exact, 0.5 at a standard deviation of half a metre, near 0
    /// if unknown.
    pub fn confidence(&self) -> f64 {
        let variance = self.covariance[(0, 0)] + self.covariance[(1, 1)];
        1.0 / (1.0 + variance.max(0.0) / 0.25)
    }

    /// The match of a sighting with a landmark; none if the robot would stand on it.
    fn fit(&self, landmark: Point2<f64>, seen: &PostSighting) -> Option<LandmarkMatch> {
        let offset = landmark - Point2::from(self.field_from_robot.translation.vector);
        let distance = offset.norm();
        if distance < 0.05 {
            return None;
        }
        let bearing = libm::atan2(offset.y, offset.x) - heading(&self.field_from_robot);
        let innovation = Vector2::new(seen.distance - distance, wrap(seen.bearing - bearing));
        let (x, y) = (offset.x / distance, offset.y / distance);
        #[rustfmt::skip]
        let jacobian = Matrix2x3::new(
            -x,            -y,           0.0,
            y / distance, -x / distance, -1.0,
        );
        let spread = jacobian * self.covariance * jacobian.transpose() + self.noise(distance);
        let inverse = spread.try_inverse()?;
        let mismatch = (innovation.transpose() * inverse * innovation).x;
        let gain = self.covariance * jacobian.transpose() * inverse;
        Some(LandmarkMatch { innovation, jacobian, gain, mismatch })
    }

    fn noise(&self, distance: f64) -> Matrix2<f64> {
        let far = self.model.distance_noise * distance + 0.02;
        Matrix2::new(far * far, 0.0, 0.0, self.model.bearing_noise * self.model.bearing_noise)
    }

    fn apply(&mut self, fit: &LandmarkMatch) {
        let change = fit.gain * fit.innovation;
        let place = self.field_from_robot.translation.vector + change.fixed_rows::<2>(0);
        let turned = heading(&self.field_from_robot) + change.z;
        self.field_from_robot = pose(place.x, place.y, turned);
        let covariance = (Matrix3::identity() - fit.gain * fit.jacobian) * self.covariance;
        self.covariance = (covariance + covariance.transpose()) / 2.0;
        self.misfits = 0;
    }

    fn misfit(&mut self) {
        self.misfits += 1;
        if self.misfits >= DOUBT {
            self.misfits = 0;
            self.disturb(0.5, 0.5);
        }
    }
}

/// The match of a sighting with a landmark, and the resulting correction.
struct LandmarkMatch {
    innovation: Vector2<f64>,
    jacobian: Matrix2x3<f64>,
    gain: Matrix3x2<f64>,
    mismatch: f64,
}

fn better(one: Option<LandmarkMatch>, other: Option<LandmarkMatch>) -> Option<LandmarkMatch> {
    match (one, other) {
        (Some(one), Some(other)) => Some(if other.mismatch < one.mismatch { other } else { one }),
        (one, other) => one.or(other),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FIELD: FieldModel = FieldModel::LEAGUE_2010;

    fn sighting(truth: &Isometry2<f64>, goal: Goal, post: GoalPost) -> PostSighting {
        let [left, right] = FIELD.posts(goal);
        let landmark = truth.inverse_transform_point(if post == GoalPost::Right { &right } else { &left });
        let (distance, bearing) = (libm::hypot(landmark.x, landmark.y), libm::atan2(landmark.y, landmark.x));
        PostSighting { goal, post, distance, bearing }
    }

    fn error(filter: &Localisation, truth: &Isometry2<f64>) -> f64 {
        let difference = truth.inverse() * filter.field_from_robot();
        difference.translation.vector.norm() + heading(&difference).abs()
    }

    #[test]
    fn odometry_carries_it_and_makes_it_less_certain() {
        let mut filter = Localisation::new(LocalisationModel::default(), pose(-1.0, 0.0, PI / 2.0));
        let before = filter.confidence();
        for _ in 0..100 {
            filter.advance(&pose(0.01, 0.0, 0.0));
        }
        assert!(error(&filter, &pose(-1.0, 1.0, PI / 2.0)) < 1e-9);
        assert!(filter.confidence() < before);
    }

    #[test]
    fn posts_pull_a_robot_back_that_was_put_down_askew() {
        let truth = pose(0.5, -0.4, 0.2);
        let mut filter = Localisation::new(LocalisationModel::default(), pose(0.4, -0.3, 0.1));
        filter.disturb(0.2, 0.2);
        for _ in 0..40 {
            filter.correct(&FIELD, &sighting(&truth, Goal::Opponent, GoalPost::Left));
            filter.correct(&FIELD, &sighting(&truth, Goal::Opponent, GoalPost::Right));
        }
        assert!(error(&filter, &truth) < 0.06, "{:?}", filter.field_from_robot());
        assert!(filter.confidence() > 0.9, "{}", filter.confidence());
    }

    #[test]
    fn a_post_of_unknown_side_is_taken_for_the_one_that_fits() {
        let truth = pose(1.0, 0.3, 0.05);
        let mut filter = Localisation::new(LocalisationModel::default(), pose(1.05, 0.25, 0.0));
        for _ in 0..60 {
            for side in [GoalPost::Left, GoalPost::Right] {
                let seen = PostSighting { post: GoalPost::Either, ..sighting(&truth, Goal::Opponent, side) };
                filter.correct(&FIELD, &seen);
            }
        }
        assert!(error(&filter, &truth) < 0.03, "{:?}", filter.field_from_robot());
    }

    #[test]
    fn a_post_out_of_place_changes_nothing() {
        let truth = pose(1.0, 0.0, 0.0);
        let mut filter = Localisation::new(LocalisationModel::default(), truth);
        let seen = PostSighting { distance: 0.5, ..sighting(&truth, Goal::Opponent, GoalPost::Left) };
        filter.correct(&FIELD, &seen);
        assert_eq!(filter.field_from_robot(), truth);
        filter.correct(&FIELD, &sighting(&pose(1.2, 0.0, 0.0), Goal::Opponent, GoalPost::Left));
        assert!(filter.field_from_robot().translation.x > 1.0, "one that fits does");
    }

    #[test]
    fn a_robot_carried_away_finds_itself_again() {
        let truth = pose(-0.8, 0.6, 0.5);
        let mut filter = Localisation::new(LocalisationModel::default(), pose(1.0, -0.8, -0.4));
        for _ in 0..600 {
            filter.correct(&FIELD, &sighting(&truth, Goal::Opponent, GoalPost::Left));
            filter.correct(&FIELD, &sighting(&truth, Goal::Opponent, GoalPost::Right));
        }
        assert!(error(&filter, &truth) < 0.3, "{:?}", filter.field_from_robot());
    }

    proptest! {
        #[test]
        fn no_sighting_makes_it_lose_its_numbers(
            seen in prop::collection::vec((0.0..20.0f64, -3.2..3.2f64, 0..3u8, any::<bool>(), -0.3..0.3f64), 1..100)
        ) {
            let mut filter = Localisation::new(LocalisationModel::default(), pose(0.0, 0.0, 0.0));
            for (distance, bearing, post, own, step) in seen {
                let goal = if own { Goal::Own } else { Goal::Opponent };
                let post = [GoalPost::Left, GoalPost::Right, GoalPost::Either][usize::from(post)];
                filter.correct(&FIELD, &PostSighting { goal, post, distance, bearing });
                filter.advance(&pose(step, -step, step));
                let pose = filter.field_from_robot();
                prop_assert!(pose.translation.vector.norm().is_finite() && heading(&pose).is_finite());
                prop_assert!((0.0..=1.0).contains(&filter.confidence()));
            }
        }
    }
}
