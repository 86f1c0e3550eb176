//! The camera as a pinhole, and its pose over the ground.

use nalgebra::{Isometry3, Matrix3, Point2, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::image::check_size;
use crate::{Error, ErrorKind};

/// A pinhole camera with square pixels, and its pose over the ground.
///
/// The frame of the camera has its x axis along the optical axis, y to the left and z up. Pixels
/// are counted from the upper left corner; the centre of the first is at (0.5, 0.5).
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    width: usize,
    height: usize,
    /// Focal length, pixels.
    focal: f64,
    /// Rotation from the camera frame to the ground frame.
    rotation: Matrix3<f64>,
    position: Vector3<f64>,
}

impl Camera {
    /// A camera for images of `width` by `height` pixels, with its angle of view from left to
    /// right, rad, and its pose in a frame on the ground.
    ///
    /// # Errors
    /// [`Size`](ErrorKind::Size) if there is no image of this size,
    /// [`Camera`](ErrorKind::Camera) if the angle is not from 0.1 to 3.0, or the pose is not
    /// finite or not above the ground.
    pub fn new(
        width: usize,
        height: usize,
        angle_of_view: f64,
        ground_from_camera: &Isometry3<f64>,
    ) -> Result<Camera, Error> {
        check_size(width, height)?;
        if !(0.1..=3.0).contains(&angle_of_view) {
            let message = format!("an angle of view of {angle_of_view} rad, but it must be from 0.1 to 3.0");
            return Err(Error::new(ErrorKind::Camera, message));
        }
        let focal = width as f64 / 2.0 / libm::tan(angle_of_view / 2.0);
        let camera = Camera {
            width,
            height,
            focal,
            rotation: *ground_from_camera.rotation.to_rotation_matrix().matrix(),
            position: ground_from_camera.translation.vector,
        };
        let is_finite = camera.rotation.iter().chain(camera.position.iter()).all(|number| number.is_finite());
        match is_finite && camera.position.z > 0.0 {
            true => Ok(camera),
            false => Err(Error::new(ErrorKind::Camera, "the camera must be above the ground")),
        }
    }

    /// The width of its images, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The height of its images, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Its focal length, pixels.
    pub fn focal(&self) -> f64 {
        self.focal
    }

    /// Its position in the frame of the ground, m.
    pub fn position(&self) -> Point3<f64> {
        Point3::from(self.position)
    }

    /// The direction in which a pixel looks, in the frame of the ground; its component along the
    /// optical axis has length 1.
    pub fn ray(&self, x: f64, y: f64) -> Vector3<f64> {
        let left = (self.width as f64 / 2.0 - x) / self.focal;
        let up = (self.height as f64 / 2.0 - y) / self.focal;
        self.rotation * Vector3::new(1.0, left, up)
    }

    /// The point at a height above the ground that a pixel shows; none at or above the horizon.
    pub fn point_at_height(&self, x: f64, y: f64, height: f64) -> Option<Point2<f64>> {
        /// Sine of the flattest angle that is used: 60 m away from a height of half a metre.
        const MIN_ANGLE_SINE: f64 = 0.008;
        let ray = self.ray(x, y);
        let above = self.position.z - height;
        if above <= 0.0 || -ray.z < MIN_ANGLE_SINE * ray.norm() {
            return None;
        }
        let length = above / -ray.z;
        Some(Point2::new(self.position.x + length * ray.x, self.position.y + length * ray.y))
    }

    /// The pixel that shows a point, and its depth along the optical axis, m; none behind the
    /// camera. The pixel may lie outside the image.
    pub fn project(&self, point: &Point3<f64>) -> Option<(f64, f64, f64)> {
        /// Least depth, m.
        const MIN_DEPTH: f64 = 0.02;
        let seen = self.rotation.tr_mul(&(point.coords - self.position));
        (seen.x > MIN_DEPTH).then(|| {
            let scale = self.focal / seen.x;
            (self.width as f64 / 2.0 - scale * seen.y, self.height as f64 / 2.0 - scale * seen.z, seen.x)
        })
    }

    /// Pixels per metre of what a pixel shows at a height above the ground; zero at and above the
    /// horizon. It is linear in the coordinates of the pixel.
    pub fn scale(&self, x: f64, y: f64, height: f64) -> f64 {
        let above = self.position.z - height;
        if above <= 0.0 { 0.0 } else { (self.focal * -self.ray(x, y).z / above).max(0.0) }
    }

    /// Columns per row of the image of a vertical line at a pixel; zero for a camera that is rolled
    /// by more than an eighth of a turn.
    pub fn slope_of_vertical(&self, x: f64, y: f64) -> f64 {
        let left = (self.width as f64 / 2.0 - x) / self.focal;
        let up = (self.height as f64 / 2.0 - y) / self.focal;
        let (ahead, aside, above) = (self.rotation[(2, 0)], self.rotation[(2, 1)], self.rotation[(2, 2)]);
        let (across, along) = (aside - left * ahead, above - up * ahead);
        if along > across.abs() { across / along } else { 0.0 }
    }

    /// The row of the horizon in a column of pixels; it may lie outside the image. A camera that
    /// lies on its side has none, and then it is far above the image.
    pub fn horizon(&self, x: f64) -> f64 {
        let left = (self.width as f64 / 2.0 - x) / self.focal;
        let (ahead, aside, up) = (self.rotation[(2, 0)], self.rotation[(2, 1)], self.rotation[(2, 2)]);
        if up < 0.05 {
            return -1e6;
        }
        self.height as f64 / 2.0 + self.focal * (ahead + aside * left) / up
    }
}

/// The joints of a head and the inclination of the torso that carries it, at the time of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeadPose {
    /// Height of the camera above the ground while the torso is upright, m.
    pub height: f64,
    /// Inclination of the torso to the right, rad.
    pub torso_roll: f64,
    /// Inclination of the torso to the front, rad.
    pub torso_pitch: f64,
    /// Yaw of the head, rad, positive to the left.
    pub yaw: f64,
    /// Pitch of the camera, rad, positive downwards: that of the head and of the camera in it.
    pub pitch: f64,
}

impl HeadPose {
    /// The pose of the camera in the frame of the robot, whose origin is on the ground between the
    /// feet. The torso turns about this origin; the camera is above it.
    pub fn robot_from_camera(&self) -> Isometry3<f64> {
        let torso = turned(Vector3::y(), self.torso_pitch) * turned(Vector3::x(), self.torso_roll);
        let head = turned(Vector3::z(), self.yaw) * turned(Vector3::y(), self.pitch);
        let position = torso * Vector3::new(0.0, 0.0, self.height);
        let rotation = Rotation3::from_matrix_unchecked(torso * head);
        Isometry3::from_parts(Translation3::from(position), UnitQuaternion::from_rotation_matrix(&rotation))
    }
}

/// The rotation about an axis of the frame, with the sine of `libm`.
fn turned(axis: Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = libm::sincos(angle);
    Matrix3::identity() * cos + axis.cross_matrix() * sin + axis * axis.transpose() * (1.0 - cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(pose: HeadPose) -> Camera {
        Camera::new(640, 480, 0.8343, &pose.robot_from_camera()).unwrap()
    }

    #[test]
    fn a_point_is_found_again_from_its_pixel() {
        let pose = HeadPose { height: 0.5, torso_roll: 0.1, torso_pitch: -0.05, yaw: 0.7, pitch: 0.3 };
        let camera = camera(pose);
        for point in [Point3::new(1.0, 0.9, 0.0), Point3::new(2.0, 1.4, 0.05), Point3::new(0.8, 0.2, 0.03)] {
            let (x, y, depth) = camera.project(&point).unwrap();
            let back = camera.point_at_height(x, y, point.z).unwrap();
            assert!((back - point.xy()).norm() < 1e-9, "{point} {back}");
            assert!((camera.scale(x, y, point.z) - camera.focal() / depth).abs() < 1e-9);
        }
    }

    #[test]
    fn angles_have_their_signs() {
        let straight = HeadPose { height: 0.5, ..HeadPose::default() };
        assert!((camera(straight).horizon(0.0) - 240.0).abs() < 1e-9);
        let down = camera(HeadPose { pitch: 0.2, ..straight });
        assert!(down.horizon(320.0) < 100.0, "the horizon is above the middle");
        let left = camera(HeadPose { yaw: 0.3, ..straight });
        assert!(
            left.project(&Point3::new(2.0, 0.0, 0.5)).unwrap().0 > 400.0,
            "what is ahead is to the right"
        );
        let right = camera(HeadPose { torso_roll: 0.1, ..straight });
        assert!(right.horizon(639.0) < right.horizon(0.0), "the horizon rises to the right");
        assert!(right.position().y < 0.0);
        let forward = camera(HeadPose { torso_pitch: 0.1, ..straight });
        assert!(forward.horizon(320.0) < 240.0 && forward.position().x > 0.0);
    }

    #[test]
    fn what_is_upright_has_a_slope() {
        let pose = HeadPose { height: 0.5, torso_roll: 0.1, torso_pitch: -0.05, yaw: 0.7, pitch: 0.3 };
        for pose in [pose, HeadPose { torso_roll: -0.2, ..pose }] {
            let camera = camera(pose);
            let [foot, head] = [0.0, 0.4].map(|z| camera.project(&Point3::new(2.0, 1.4, z)).unwrap());
            let slope = (foot.0 - head.0) / (foot.1 - head.1);
            assert!(slope.abs() > 0.02, "{slope}");
            assert!((camera.slope_of_vertical(foot.0, foot.1) - slope).abs() < 1e-9);
            assert!((camera.slope_of_vertical(head.0, head.1) - slope).abs() < 1e-9);
        }
    }

    #[test]
    fn nothing_on_the_ground_is_above_the_horizon() {
        let camera = camera(HeadPose { height: 0.5, pitch: 0.1, ..HeadPose::default() });
        let horizon = camera.horizon(100.0);
        assert_eq!(camera.point_at_height(100.0, horizon - 1.0, 0.0), None);
        assert_eq!(camera.scale(100.0, horizon - 1.0, 0.0), 0.0);
        assert!(camera.point_at_height(100.0, horizon + 20.0, 0.0).unwrap().x > 5.0);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let pose = HeadPose { height: 0.5, ..HeadPose::default() };
        let kind = |angle, pose: HeadPose| {
            Camera::new(640, 480, angle, &pose.robot_from_camera()).map(|_| ()).map_err(|it| it.kind())
        };
        assert_eq!(kind(1.0, pose), Ok(()));
        assert_eq!(kind(f64::NAN, pose), Err(ErrorKind::Camera));
        assert_eq!(kind(1.0, HeadPose { height: -0.5, ..pose }), Err(ErrorKind::Camera));
        assert_eq!(kind(1.0, HeadPose { yaw: f64::NAN, ..pose }), Err(ErrorKind::Camera));
    }
}
