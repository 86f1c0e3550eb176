//! Detection of falls from the inclination of the torso.

/// Inclination of the torso above which the body has fallen, rad.
const FALLEN_ANGLE: f64 = 1.0;
/// Inclination of the torso below which the body is upright, rad.
const UPRIGHT_ANGLE: f64 = 0.4;

/// Detects whether a body lies, from the inclination of its torso as its inertial unit measures it.
///
/// A body has fallen from an inclination of 1 rad on, and counts as fallen until the inclination is
/// below 0.4 rad, so that noise does not make the state oscillate.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct FallDetector {
    tilt: f64,
    is_fallen: bool,
}

impl FallDetector {
    /// Takes the roll and the pitch of the torso, rad.
    pub fn measure(&mut self, roll: f64, pitch: f64) {
        self.tilt = roll.abs().max(pitch.abs());
        self.is_fallen = self.tilt > FALLEN_ANGLE || (self.is_fallen && self.tilt > UPRIGHT_ANGLE);
    }

    /// Whether the body lies.
    pub fn is_fallen(&self) -> bool {
        self.is_fallen
    }

    /// Whether the torso is too inclined to stand or walk: the body falls, lies, or gets up.
    pub fn is_inclined(&self) -> bool {
        self.tilt > UPRIGHT_ANGLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_lies_from_a_great_inclination_until_it_is_upright() {
        let mut detector = FallDetector::default();
        let mut measured = |roll, pitch| {
            detector.measure(roll, pitch);
            (detector.is_inclined(), detector.is_fallen())
        };
        assert_eq!(measured(0.1, -0.1), (false, false));
        assert_eq!(measured(0.0, 0.7), (true, false));
        assert_eq!(measured(-1.1, 0.0), (true, true));
        assert_eq!(measured(-0.9, 0.0), (true, true), "it does not get up by noise");
        assert_eq!(measured(0.0, 0.3), (false, false));
    }
}
