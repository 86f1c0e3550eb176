//! Poses and velocities in the plane.

/// A point or direction in the plane, in metres or metres per second.
pub type Vector = nalgebra::Vector2<f64>;

/// Position and heading: the transform from an object's own frame to the outer frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Position in the outer frame, metres.
    pub position: Vector,
    /// Direction of its x axis in the outer frame, radians, counter-clockwise, from -pi to pi.
    pub heading: f64,
}

impl Default for Pose {
    fn default() -> Self {
        Self { position: Vector::zeros(), heading: 0.0 }
    }
}

impl Pose {
    /// A pose from its parts; the heading is normalized to -pi to pi.
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { position: Vector::new(x, y), heading: normalize_angle(heading) }
    }

    /// The point at `position`, facing `target`.
    pub fn facing(position: Vector, target: Vector) -> Self {
        Self { position, heading: direction_of(target - position) }
    }

    /// A point of the own frame in the outer frame.
    pub fn to_outer(&self, point: Vector) -> Vector {
        self.position + rotate(point, self.heading)
    }

    /// A point of the outer frame in the own frame.
    pub fn to_own(&self, point: Vector) -> Vector {
        rotate(point - self.position, -self.heading)
    }

    /// The pose `step`, given in the own frame, in the outer frame.
    pub fn compose(&self, step: &Pose) -> Pose {
        Pose { position: self.to_outer(step.position), heading: normalize_angle(self.heading + step.heading) }
    }
}

/// A velocity of a walking robot in its own frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Velocity {
    /// Forward, m/s.
    pub forward: f64,
    /// To the left, m/s.
    pub left: f64,
    /// Counter-clockwise, rad/s.
    pub turn: f64,
}

impl Velocity {
    /// A velocity from its parts.
    pub fn new(forward: f64, left: f64, turn: f64) -> Self {
        Self { forward, left, turn }
    }

    pub(crate) fn linear(&self) -> Vector {
        Vector::new(self.forward, self.left)
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.forward.is_finite() && self.left.is_finite() && self.turn.is_finite()
    }

    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self::new(self.forward * factor, self.left * factor, self.turn * factor)
    }
}

/// `angle` plus a multiple of a full turn, from -pi to pi.
pub fn normalize_angle(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    (angle + PI).rem_euclid(TAU) - PI
}

/// The direction of a vector, radians; zero for the zero vector.
pub(crate) fn direction_of(vector: Vector) -> f64 {
    libm::atan2(vector.y, vector.x)
}

/// `vector` turned counter-clockwise.
pub(crate) fn rotate(vector: Vector, angle: f64) -> Vector {
    let (sin, cos) = libm::sincos(angle);
    Vector::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}

/// `vector`, shortened to `length` when it is longer.
pub(crate) fn shortened(vector: Vector, length: f64) -> Vector {
    let norm = vector.norm();
    if norm > length { vector * (length / norm) } else { vector }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn frames_there_and_back() {
        let pose = Pose::new(1.0, -2.0, 2.5);
        let point = Vector::new(0.3, 0.7);
        assert!((pose.to_own(pose.to_outer(point)) - point).norm() < 1e-12);
        let left = Pose::new(1.0, 0.0, FRAC_PI_2).to_outer(Vector::new(1.0, 0.0));
        assert!((left - Vector::new(1.0, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn angles_are_normalized() {
        assert!((normalize_angle(3.0 * PI / 2.0) + FRAC_PI_2).abs() < 1e-12);
        assert!((normalize_angle(-7.0) - (2.0 * PI - 7.0)).abs() < 1e-12);
    }

    #[test]
    fn composition_walks_in_the_own_frame() {
        let end = Pose::new(0.0, 0.0, FRAC_PI_2).compose(&Pose::new(1.0, 0.0, FRAC_PI_2));
        assert!((end.position - Vector::new(0.0, 1.0)).norm() < 1e-12);
        assert!((end.heading.abs() - PI).abs() < 1e-12);
    }
}
