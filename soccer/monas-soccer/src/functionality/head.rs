//! Control of the head's gaze.

use std::time::Duration;

use nalgebra::Point2;

/// A direction of the head, radians: yaw positive to the left, pitch positive downwards.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Gaze {
    /// To the left.
    pub yaw: f64,
    /// Downwards.
    pub pitch: f64,
}

/// Parameters of the head and its cameras.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HeadController {
    /// Height of the camera above the ground, metres.
    pub eye_height: f64,
    /// Angle of the centre of view below the direction of the head, radians. It lies between the
    /// two cameras.
    pub view_below: f64,
    /// Amplitude of the sweep of a search to each side, radians.
    pub sweep: f64,
    /// Period of the sweep.
    pub sweep_time: Duration,
}

impl Default for HeadController {
    /// The head of a Nao.
    fn default() -> HeadController {
        HeadController {
            eye_height: 0.5,
            view_below: 0.32,
            sweep: 1.6,
            sweep_time: Duration::from_millis(3000),
        }
    }
}

/// Limits of the neck joints.
const MAX_YAW: f64 = 2.0;
const PITCH_RANGE: (f64, f64) = (-0.6, 0.5);

impl HeadController {
    /// The gaze that centres the view on a point of the ground, given in the robot's frame.
    pub fn look_at(&self, point: Point2<f64>) -> Gaze {
        let distance = point.coords.norm();
        let below = libm::atan2(self.eye_height, distance);
        Gaze {
            yaw: libm::atan2(point.y, point.x).clamp(-MAX_YAW, MAX_YAW),
            pitch: (below - self.view_below).clamp(PITCH_RANGE.0, PITCH_RANGE.1),
        }
    }

    /// The gaze at a time of a search: from side to side at constant speed, alternating between
    /// near and far. Near comes first: this view also shows the field up to its border, while the
    /// far one does not show a ball before the feet, where it lies at a kick-off.
    pub fn scan(&self, since_start: Duration) -> Gaze {
        let sweeps = since_start.as_secs_f64() / self.sweep_time.as_secs_f64().max(0.1);
        let part = sweeps - libm::floor(sweeps);
        let far = libm::fmod(libm::floor(sweeps), 2.0) == 1.0;
        // A triangle wave from the middle: 0, 1, 0, -1, 0.
        let swing = if part < 0.25 {
            4.0 * part
        } else if part < 0.75 {
            2.0 - 4.0 * part
        } else {
            4.0 * part - 4.0
        };
        Gaze { yaw: self.sweep * swing, pitch: if far { -0.1 } else { 0.35 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_looks_at_what_is_near_and_far() {
        let head = HeadController::default();
        let near = head.look_at(Point2::new(0.15, 0.05));
        let far = head.look_at(Point2::new(3.0, 1.0));
        assert!(near.pitch > 0.45 && far.pitch < 0.0, "{near:?} {far:?}");
        assert!((far.yaw - libm::atan2(1.0, 3.0)).abs() < 1e-12);
        assert_eq!(head.look_at(Point2::new(-1.0, 0.0)).yaw, MAX_YAW);
    }

    #[test]
    fn a_search_sweeps_both_sides_near_and_far() {
        let head = HeadController::default();
        let gazes: Vec<Gaze> = (0..60).map(|step| head.scan(Duration::from_millis(100 * step))).collect();
        let yaw = |pick: fn(f64, f64) -> f64| gazes.iter().map(|gaze| gaze.yaw).fold(0.0, pick);
        assert!(yaw(f64::max) > 1.4 && yaw(f64::min) < -1.4);
        assert!(gazes[..30].iter().all(|gaze| gaze.pitch > 0.3));
        assert!(gazes[30..].iter().all(|gaze| gaze.pitch < 0.0));
        let jump = gazes.windows(2).map(|pair| (pair[1].yaw - pair[0].yaw).abs()).fold(0.0, f64::max);
        assert!(jump < 0.3, "the head moves evenly: {jump}");
    }
}
