//! One estimate of the pose of the robot, from odometry and landmarks.
//!
//! An extended Kalman filter over the pose with known landmarks and, where a landmark has several
//! places, the most likely of them (Thrun, Burgard, Fox, *Probabilistic Robotics*, 2005, tables 7.2
//! and 7.3).

use std::f64::consts::PI;

use nalgebra::{Isometry2, Matrix2, Matrix2x3, Matrix3, Matrix3x2, Point2, Vector2, Vector3};

use super::field::FieldModel;
use super::geometry::{angle_of, heading, pose, wrap};
use super::landmarks::{Landmark, LandmarkPlaces, LandmarkSighting, LineSighting, field_lines};

/// Noise of the robot's measurements.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LocalisationModel {
    /// Drift of the odometry: standard deviation in metres after one metre. It grows with the
    /// square root of the distance.
    pub drift: f64,
    /// Drift of the heading: standard deviation in radians after turning one radian, and the same
    /// for each metre walked.
    pub turn_drift: f64,
    /// Standard deviation of the distance of a post, relative to the distance.
    pub distance_noise: f64,
    /// Standard deviation of a measured bearing, radians.
    pub bearing_noise: f64,
    /// Standard deviation of the measured elevation of a place on the ground, radians: errors of
    /// its distance grow with the distance.
    pub elevation_noise: f64,
    /// Height of the camera above the ground, metres.
    pub eye_height: f64,
}

impl Default for LocalisationModel {
    fn default() -> LocalisationModel {
        LocalisationModel {
            drift: 0.1,
            turn_drift: 0.15,
            distance_noise: 0.1,
            bearing_noise: 0.025,
            elevation_noise: 0.015,
            eye_height: 0.5,
        }
    }
}

impl LocalisationModel {
    /// Standard deviation of the distance of a landmark, metres.
    pub(super) fn distance_deviation(&self, landmark: Landmark, distance: f64) -> f64 {
        match landmark {
            Landmark::Post(..) | Landmark::PostOfEitherGoal(_) => self.distance_noise * distance + 0.02,
            Landmark::Corner | Landmark::Junction | Landmark::CentreCircle => self.ground_deviation(distance),
        }
    }

    /// Standard deviation of the distance of a place on the ground, metres: at the distance d it is
    /// seen at the elevation atan(h/d).
    fn ground_deviation(&self, distance: f64) -> f64 {
        let height = self.eye_height;
        self.elevation_noise * (distance * distance + height * height) / height + 0.03
    }
}

/// A pose and how certain it is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PoseEstimate {
    /// The pose in the field frame.
    pub field_from_robot: Isometry2<f64>,
    /// Standard deviation of the position on either axis, metres.
    pub place_deviation: f64,
    /// Standard deviation of the heading, radians.
    pub turn_deviation: f64,
}

/// The filter. [Advanced](PoseFilter::advance) by odometry, [corrected](PoseFilter::correct) by
/// landmarks.
#[derive(Clone, Debug)]
pub(super) struct PoseFilter {
    field_from_robot: Isometry2<f64>,
    /// Of x, y and heading.
    covariance: Matrix3<f64>,
    misfits: u32,
}

/// The square of the Mahalanobis distance beyond which a landmark does not match: 99.9 % of correct
/// ones are below (χ², 2 degrees of freedom).
const GATE_DISTANCE: f64 = 13.8;
/// The same distance by which the best place of a line must match better than the next.
const AMBIGUITY_DISTANCE: f64 = 4.0;
/// The length by which a line may be seen beyond the ends of the line of the field, metres.
const MAX_OVERSHOOT: f64 = 0.3;
/// Number of consecutive mismatches after which the filter increases its uncertainty.
const MAX_MISMATCHES: u32 = 8;
/// Unmodelled change between two sightings, metres and radians; prevents overconfidence.
const PROCESS_NOISE: (f64, f64) = (0.01, 0.005);

impl PoseFilter {
    pub(super) fn new(start: &PoseEstimate) -> PoseFilter {
        let variance = start.place_deviation * start.place_deviation;
        let turn_variance = start.turn_deviation * start.turn_deviation;
        PoseFilter {
            field_from_robot: start.field_from_robot,
            covariance: Matrix3::from_diagonal(&Vector3::new(variance, variance, turn_variance)),
            misfits: 0,
        }
    }

    pub(super) fn field_from_robot(&self) -> &Isometry2<f64> {
        &self.field_from_robot
    }

    /// Part of the sightings that match, of the last ones, from 1 to 0: less the nearer the filter
    /// is to doubting its pose.
    pub(super) fn trust(&self) -> f64 {
        1.0 - f64::from(self.misfits) / f64::from(MAX_MISMATCHES)
    }

    /// The variance of the position, square metres.
    pub(super) fn position_variance(&self) -> f64 {
        (self.covariance[(0, 0)] + self.covariance[(1, 1)]).max(0.0)
    }

    /// Moves the robot to `old_from_new`, its new pose in its old frame.
    pub(super) fn advance(&mut self, model: &LocalisationModel, old_from_new: &Isometry2<f64>) {
        let step = self.field_from_robot.transform_vector(&old_from_new.translation.vector);
        #[rustfmt::skip]
        let jacobian = Matrix3::new(
            1.0, 0.0, -step.y,
            0.0, 1.0, step.x,
            0.0, 0.0, 1.0,
        );
        let (distance, turned) = (step.norm(), heading(old_from_new).abs());
        let variance = model.drift * model.drift * distance;
        let turn_variance = model.turn_drift * model.turn_drift * (turned + distance);
        self.covariance = jacobian * self.covariance * jacobian.transpose();
        self.covariance += Matrix3::from_diagonal(&Vector3::new(variance, variance, turn_variance));
        self.field_from_robot *= old_from_new;
    }

    /// Adds uncertainty of `position` metres and `turn` radians (standard deviations).
    pub(super) fn disturb(&mut self, position: f64, turn: f64) {
        self.covariance +=
            Matrix3::from_diagonal(&Vector3::new(position * position, position * position, turn * turn));
        self.covariance[(2, 2)] = self.covariance[(2, 2)].min(PI * PI);
    }

    /// Corrects the pose with a sighting, and returns how likely it was: 1 for what an exact filter
    /// expects, near 0 for what does not match. A landmark that matches no place does not change
    /// the pose, and neither does a place of the lines that matches two of them.
    pub(super) fn correct(
        &mut self,
        model: &LocalisationModel,
        field: &FieldModel,
        seen: &LandmarkSighting,
    ) -> f64 {
        self.disturb(PROCESS_NOISE.0, PROCESS_NOISE.1);
        let positions = LandmarkPlaces::new(seen.landmark, field);
        let matches = positions.as_slice().iter().filter_map(|position| self.fit(model, *position, seen));
        let must_be_unique = !matches!(seen.landmark, Landmark::Post(..));
        match best_match(matches) {
            Some((fit, next)) => {
                if !must_be_unique || next >= fit.mismatch + AMBIGUITY_DISTANCE {
                    self.apply(&fit);
                }
                fit.likelihood
            }
            None => {
                self.misfit();
                0.0
            }
        }
    }

    /// Corrects the pose with a line or a short part of the centre circle, and returns how likely
    /// it was. One that matches no line of the field, or two of them, does not change the pose.
    pub(super) fn correct_by_line(
        &mut self,
        model: &LocalisationModel,
        field: &FieldModel,
        seen: &LineSighting,
    ) -> f64 {
        self.disturb(PROCESS_NOISE.0, PROCESS_NOISE.1);
        let circle = self.tangent(field.circle_radius, seen);
        let lines = field_lines(field).into_iter().chain(circle);
        let matches = lines.filter_map(|line| self.fit_line(model, &line, seen));
        let Some((fit, next)) = best_match(matches) else { return 0.0 };
        if next >= fit.mismatch + AMBIGUITY_DISTANCE {
            self.apply(&fit);
        }
        fit.likelihood
    }

    /// The match of a sighting with a landmark; none if the robot would stand on it.
    fn fit(
        &self,
        model: &LocalisationModel,
        position: Point2<f64>,
        seen: &LandmarkSighting,
    ) -> Option<LandmarkMatch> {
        let offset = position - Point2::from(self.field_from_robot.translation.vector);
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
        let far = model.distance_deviation(seen.landmark, distance);
        let aside = model.bearing_noise;
        let noise = Matrix2::new(far * far, 0.0, 0.0, aside * aside);
        self.matching(innovation, jacobian, noise)
    }

    /// The tangent of the centre circle where a line is seen, as long as a part of the circle that
    /// looks straight.
    fn tangent(&self, radius: f64, seen: &LineSighting) -> Option<LineSighting> {
        let out = self.field_from_robot.transform_point(&seen.middle()).coords.try_normalize(1e-6)?;
        let (middle, half) = (Point2::from(out * radius), Vector2::new(-out.y, out.x) * (radius / 2.0));
        Some(LineSighting { ends: [middle - half, middle + half] })
    }

    /// The match of a line that is seen with a line of the field: of the distance of its middle
    /// from that line, and of the direction. None if it would extend beyond the ends.
    fn fit_line(
        &self,
        model: &LocalisationModel,
        line: &LineSighting,
        seen: &LineSighting,
    ) -> Option<LandmarkMatch> {
        let (middle, along) = (seen.middle().coords, seen.along());
        let (distance, length) = (middle.norm(), along.norm());
        let at = self.field_from_robot.transform_point(&seen.middle());
        // A league may have no centre circle or no goal area.
        let direction = line.along().try_normalize(1e-6)?;
        let normal = Vector2::new(-direction.y, direction.x);
        let position = direction.dot(&(at - line.ends[0]));
        let half = length / 2.0 - MAX_OVERSHOOT;
        if position < half || position > line.along().norm() - half {
            return None;
        }
        // The direction of a line is known up to half a turn.
        let turn = angle_of(&direction) - angle_of(&along) - heading(&self.field_from_robot);
        let innovation = Vector2::new(normal.dot(&(line.ends[0] - at)), wrap(2.0 * turn) / 2.0);
        let ahead = self.field_from_robot.transform_vector(&middle);
        #[rustfmt::skip]
        let jacobian = Matrix2x3::new(
            normal.x, normal.y, normal.dot(&Vector2::new(-ahead.y, ahead.x)),
            0.0,      0.0,      1.0,
        );
        let ray = ahead / distance.max(1e-9);
        let (far, aside) = (model.ground_deviation(distance), model.bearing_noise * distance);
        let off = libm::hypot(far * normal.dot(&ray), aside * normal.perp(&ray));
        let turned = model.bearing_noise + 2.0 * off / length.max(1e-9);
        self.matching(innovation, jacobian, Matrix2::new(off * off, 0.0, 0.0, turned * turned))
    }

    fn matching(
        &self,
        innovation: Vector2<f64>,
        jacobian: Matrix2x3<f64>,
        noise: Matrix2<f64>,
    ) -> Option<LandmarkMatch> {
        let spread = jacobian * self.covariance * jacobian.transpose() + noise;
        let inverse = spread.try_inverse()?;
        let mismatch = (innovation.transpose() * inverse * innovation).x;
        let sharpness = (noise.determinant() / spread.determinant()).max(0.0).sqrt();
        let likelihood = sharpness * libm::exp(-mismatch / 2.0);
        let gain = self.covariance * jacobian.transpose() * inverse;
        Some(LandmarkMatch { innovation, jacobian, gain, mismatch, likelihood })
    }

    fn apply(&mut self, fit: &LandmarkMatch) {
        let change = fit.gain * fit.innovation;
        let position = self.field_from_robot.translation.vector + change.fixed_rows::<2>(0);
        let turned = heading(&self.field_from_robot) + change.z;
        self.field_from_robot = pose(position.x, position.y, turned);
        let covariance = (Matrix3::identity() - fit.gain * fit.jacobian) * self.covariance;
        self.covariance = (covariance + covariance.transpose()) / 2.0;
        self.misfits = 0;
    }

    fn misfit(&mut self) {
        self.misfits += 1;
        if self.misfits >= MAX_MISMATCHES {
            self.misfits = 0;
            self.disturb(0.5, 0.5);
        }
    }
}

/// The best of the matches within the gate, and the mismatch of the second best.
fn best_match(matches: impl Iterator<Item = LandmarkMatch>) -> Option<(LandmarkMatch, f64)> {
    let (mut best, mut next): (Option<LandmarkMatch>, f64) = (None, f64::INFINITY);
    for fit in matches {
        match &best {
            Some(known) if known.mismatch <= fit.mismatch => next = next.min(fit.mismatch),
            _ => {
                next = next.min(best.map_or(f64::INFINITY, |known| known.mismatch));
                best = Some(fit);
            }
        }
    }
    best.filter(|fit| fit.mismatch <= GATE_DISTANCE).map(|fit| (fit, next))
}

/// The match of a sighting with a landmark, and the resulting correction.
struct LandmarkMatch {
    innovation: Vector2<f64>,
    jacobian: Matrix2x3<f64>,
    gain: Matrix3x2<f64>,
    mismatch: f64,
    likelihood: f64,
}
