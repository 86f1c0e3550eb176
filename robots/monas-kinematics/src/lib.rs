//! Forward kinematics: the poses of a robot's links and its centre of mass, from its joint angles.
//!
//! A [`LinkTree`] is built once from the links of an [`Anatomy`]. Frames are those of the links;
//! the first link is the torso. Trigonometric functions come from `libm`, so that results are equal
//! on all machines. It is a separate crate, since programs without joints do not need `nalgebra`.
//!
//! ```
//! use std::time::Duration;
//! use monas_kinematics::LinkTree;
//! use monas_robot::{Anatomy, Joint, Limits, Link, LinkMotion};
//! use nalgebra::Point3;
//!
//! let link = |name: &str, parent, motion| Link {
//!     name: name.into(),
//!     parent,
//!     offset: [0.0, 0.0, 0.1],
//!     rotation: [0.0; 3],
//!     motion,
//!     mass: 1.0,
//!     centre: [0.0; 3],
//! };
//! let tilt = LinkMotion::turn(0, [0.0, 1.0, 0.0]);
//! let lamp = Anatomy {
//!     joints: vec![Joint { name: "Tilt".into(), limits: Limits::symmetric(1.6), speed: None }],
//!     links: vec![link("base", None, None), link("arm", Some(0), Some(tilt))],
//!     ..Anatomy::new("lamp", Duration::from_millis(10))
//! };
//! let tree = LinkTree::new(&lamp);
//! let tip = tree.in_torso(1, Point3::new(0.0, 0.0, 0.3), &[std::f64::consts::FRAC_PI_2]);
//! assert!((tip - Point3::new(0.3, 0.0, 0.2)).norm() < 1e-12);
//! ```

use monas_robot::{Anatomy, Link, LinkMotion};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, UnitVector3, Vector3};

/// The links of an anatomy, in its order.
#[derive(Clone, PartialEq, Debug)]
pub struct LinkTree {
    links: Vec<PlacedLink>,
}

#[derive(Clone, PartialEq, Debug)]
struct PlacedLink {
    parent: Option<usize>,
    placement: Isometry3<f64>,
    motion: Option<LinkMotion>,
    axis: UnitVector3<f64>,
    mass: f64,
    centre: Point3<f64>,
}

impl LinkTree {
    /// The links of an anatomy.
    pub fn new(anatomy: &Anatomy) -> LinkTree {
        LinkTree { links: anatomy.links.iter().map(PlacedLink::new).collect() }
    }

    /// A point in the frame of a link, in that of the torso, with the joints at `angles`; metres.
    ///
    /// # Panics
    /// There is no such link, or an angle is missing.
    pub fn in_torso(&self, link: usize, point: Point3<f64>, angles: &[f64]) -> Point3<f64> {
        self.carriers(link).fold(point, |point, link| link.placement * link.move_point(point, angles))
    }

    /// A pose in the frame of a link, in that of the torso, with the joints at `angles`.
    ///
    /// # Panics
    /// There is no such link, or an angle is missing.
    pub fn pose_in_torso(&self, link: usize, pose: Isometry3<f64>, angles: &[f64]) -> Isometry3<f64> {
        self.carriers(link).fold(pose, |pose, link| link.placement * link.motion(angles) * pose)
    }

    /// The mass of all links, kg.
    pub fn mass(&self) -> f64 {
        self.links.iter().map(|link| link.mass).sum()
    }

    /// The centre of mass in the frame of the torso, with the joints at `angles`; metres. It is not
    /// finite for a robot without mass.
    ///
    /// # Panics
    /// An angle is missing.
    pub fn centre_of_mass(&self, angles: &[f64]) -> Point3<f64> {
        let moment = |(index, link): (usize, &PlacedLink)| {
            self.in_torso(index, link.centre, angles).coords * link.mass
        };
        let sum: Vector3<f64> = self.links.iter().enumerate().map(moment).sum();
        Point3::from(sum / self.mass())
    }

    /// A link, the one that carries it, and so on up to the torso.
    fn carriers(&self, link: usize) -> impl Iterator<Item = &PlacedLink> {
        let parent = |link: &&PlacedLink| link.parent.map(|parent| &self.links[parent]);
        std::iter::successors(Some(&self.links[link]), parent)
    }
}

impl PlacedLink {
    fn new(link: &Link) -> PlacedLink {
        let [roll, pitch, yaw] = link.rotation;
        let axis = link.motion.map_or([1.0, 0.0, 0.0], |motion| motion.axis);
        PlacedLink {
            parent: link.parent,
            placement: Isometry3::from_parts(
                Translation3::from(link.offset),
                UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            ),
            motion: link.motion,
            axis: Unit::new_unchecked(Vector3::from(axis)),
            mass: link.mass,
            centre: Point3::from(link.centre),
        }
    }

    fn motion(&self, angles: &[f64]) -> Isometry3<f64> {
        let Some(motion) = self.motion else { return Isometry3::identity() };
        let by = self.axis.into_inner() * travel(motion, angles);
        match motion.is_shift {
            true => Translation3::from(by).into(),
            false => Isometry3::from_parts(Translation3::identity(), UnitQuaternion::new(by)),
        }
    }

    fn move_point(&self, point: Point3<f64>, angles: &[f64]) -> Point3<f64> {
        let Some(motion) = self.motion else { return point };
        let by = travel(motion, angles);
        match motion.is_shift {
            true => point + self.axis.into_inner() * by,
            false => Rotation3::from_axis_angle(&self.axis, by) * point,
        }
    }
}

/// The angle, radians, or the shift, metres.
fn travel(motion: LinkMotion, angles: &[f64]) -> f64 {
    motion.factor * angles[motion.joint] + motion.offset
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may panic")]
mod tests {
    use std::time::Duration;

    use monas_robot::{Joint, Limits};

    use super::*;

    /// A pole on the torso that turns about z, a slide along it, and a link that turns half as far
    /// the other way.
    fn crane() -> Anatomy {
        let joint = |name: &str| Joint { name: name.to_owned(), limits: Limits::symmetric(2.0), speed: None };
        let link = |name: &str, parent, offset, motion, mass| Link {
            name: name.to_owned(),
            parent,
            offset,
            rotation: [0.0; 3],
            motion,
            mass,
            centre: [0.5, 0.0, 0.0],
        };
        let pole = LinkMotion::turn(0, [0.0, 0.0, 1.0]);
        let slide = LinkMotion { is_shift: true, ..LinkMotion::turn(1, [1.0, 0.0, 0.0]) };
        let counter = LinkMotion { factor: -0.5, offset: 0.1, ..pole };
        Anatomy {
            joints: vec![joint("pole"), joint("slide")],
            links: vec![
                link("torso", None, [0.0; 3], None, 2.0),
                link("pole", Some(0), [0.0, 0.0, 1.0], Some(pole), 0.0),
                link("slide", Some(1), [1.0, 0.0, 0.0], Some(slide), 2.0),
                link("counter", Some(0), [0.0, 0.0, 1.0], Some(counter), 0.0),
            ],
            ..Anatomy::new("crane", Duration::from_millis(10))
        }
    }

    #[test]
    fn links_are_where_the_joints_move_them() {
        let anatomy = crane();
        let crane = LinkTree::new(&anatomy);
        let angles = [std::f64::consts::FRAC_PI_2, 0.25];
        let slide = anatomy.link("slide").unwrap();
        let tip = crane.in_torso(slide, Point3::new(0.0, 0.1, 0.0), &angles);
        assert!((tip - Point3::new(-0.1, 1.25, 1.0)).norm() < 1e-12, "{tip}");
        let pose = crane.pose_in_torso(slide, Isometry3::identity(), &angles);
        assert!((tip - pose * Point3::new(0.0, 0.1, 0.0)).norm() < 1e-12, "{pose}");
        let counter = anatomy.link("counter").unwrap();
        let counter = crane.pose_in_torso(counter, Isometry3::identity(), &[0.6, 0.0]);
        assert!((counter.rotation.euler_angles().2 + 0.2).abs() < 1e-12, "{counter}");
        assert_eq!((crane.mass(), anatomy.joint("slide"), anatomy.link("hook")), (4.0, Some(1), None));
        let centre = crane.centre_of_mass(&angles);
        assert!((centre - Point3::new(0.25, 0.875, 0.5)).norm() < 1e-12, "{centre}");
    }
}
