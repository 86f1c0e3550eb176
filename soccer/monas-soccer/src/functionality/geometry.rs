//! Points and poses in the plane, in nalgebra's types.
//!
//! `a_from_b` is the pose of frame `b` in frame `a`; it maps a point given in `b` to the same point
//! given in `a`.

use std::f64::consts::{PI, TAU};

use nalgebra::{Isometry2, Point2, UnitComplex, Vector2};

/// The pose at a position, turned by `heading` (radians, counterclockwise from the x axis).
pub fn pose(x: f64, y: f64, heading: f64) -> Isometry2<f64> {
    Isometry2::from_parts(Vector2::new(x, y).into(), rotation(heading))
}

/// A turn by an angle.
pub fn rotation(angle: f64) -> UnitComplex<f64> {
    let (sin, cos) = libm::sincos(angle);
    UnitComplex::from_cos_sin_unchecked(cos, sin)
}

/// The heading of a pose, in (-π, π].
pub fn heading(pose: &Isometry2<f64>) -> f64 {
    libm::atan2(pose.rotation.im, pose.rotation.re)
}

/// The direction of a vector, in (-π, π].
pub fn angle_of(vector: &Vector2<f64>) -> f64 {
    libm::atan2(vector.y, vector.x)
}

/// The vector of a length in a direction.
pub fn polar(length: f64, angle: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(length * cos, length * sin)
}

/// The same angle in (-π, π].
pub fn wrap(angle: f64) -> f64 {
    let turned = angle - TAU * libm::floor((angle + PI) / TAU);
    if turned <= -PI { turned + TAU } else { turned }
}

/// The distance from a point to the segment between two others, and the position of the nearest
/// point along the segment (0 to 1).
pub fn distance_to_segment(point: Point2<f64>, from: Point2<f64>, to: Point2<f64>) -> (f64, f64) {
    let along = to - from;
    let length_squared = along.norm_squared();
    let part = if length_squared > 0.0 {
        ((point - from).dot(&along) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    ((point - (from + along * part)).norm(), part)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_pose_maps_from_its_own_frame() {
        let field_from_robot = pose(1.0, 2.0, PI / 2.0);
        let ball_in_field = field_from_robot * Point2::new(0.5, 0.0);
        assert!((ball_in_field - Point2::new(1.0, 2.5)).norm() < 1e-12);
        assert!((heading(&field_from_robot) - PI / 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_nearest_point_of_a_segment_is_not_beyond_its_ends() {
        let (from, to) = (Point2::new(0.0, 0.0), Point2::new(2.0, 0.0));
        assert_eq!(distance_to_segment(Point2::new(1.0, 0.5), from, to), (0.5, 0.5));
        assert_eq!(distance_to_segment(Point2::new(3.0, 0.0), from, to), (1.0, 1.0));
        assert_eq!(distance_to_segment(Point2::new(3.0, 0.0), from, from), (3.0, 0.0));
    }

    proptest! {
        #[test]
        fn a_wrapped_angle_is_the_same_direction(angle in -1e3..1e3f64) {
            let wrapped = wrap(angle);
            prop_assert!(-PI < wrapped && wrapped <= PI);
            prop_assert!((polar(1.0, angle) - polar(1.0, wrapped)).norm() < 1e-9);
        }
    }
}
