//! Solids, and where rays meet them.

use nalgebra::{Point2, Point3, Vector3};

use super::Rgb;

/// The colours of a sphere.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pattern {
    Plain(Rgb),
    /// One colour with round patches of another at the corners of an icosahedron, turned about z
    /// and x.
    Patches(Rgb, Rgb, [f64; 2]),
}

/// A solid on the field.
#[derive(Clone, Copy, Debug)]
pub(super) enum Solid {
    Sphere {
        centre: Point3<f64>,
        radius: f64,
        pattern: Pattern,
    },
    /// An upright cylinder.
    Column {
        foot: Point2<f64>,
        radius: f64,
        from: f64,
        to: f64,
        colour: Rgb,
    },
    /// A box along the axes.
    Block {
        low: Point3<f64>,
        high: Point3<f64>,
        colour: Rgb,
    },
}

/// Where a ray meets a solid.
pub(super) struct Hit {
    /// In multiples of the ray.
    pub(super) length: f64,
    pub(super) normal: Vector3<f64>,
    pub(super) colour: Rgb,
}

impl Solid {
    /// The corners of a box around it.
    pub(super) fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        match *self {
            Solid::Sphere { centre, radius, .. } => {
                let around = Vector3::repeat(radius);
                (centre - around, centre + around)
            }
            Solid::Column { foot, radius, from, to, .. } => (
                Point3::new(foot.x - radius, foot.y - radius, from),
                Point3::new(foot.x + radius, foot.y + radius, to),
            ),
            Solid::Block { low, high, .. } => (low, high),
        }
    }

    pub(super) fn hit(&self, origin: &Point3<f64>, ray: &Vector3<f64>) -> Option<Hit> {
        match *self {
            Solid::Sphere { centre, radius, pattern } => {
                let from = origin - centre;
                let length =
                    nearest_root(ray.norm_squared(), from.dot(ray), from.norm_squared() - radius * radius)?;
                let normal = (from + ray * length) / radius;
                Some(Hit { length, normal, colour: pattern.at(&normal) })
            }
            Solid::Column { foot, radius, from, to, colour } => {
                let away = origin.xy() - foot;
                let across = ray.xy();
                let side = nearest_root(
                    across.norm_squared(),
                    away.dot(&across),
                    away.norm_squared() - radius * radius,
                );
                let side = side.filter(|length| (from..=to).contains(&(origin.z + ray.z * length)));
                let top = (to - origin.z) / ray.z;
                let lid = (top > 0.0 && (away + across * top).norm() <= radius).then_some(top);
                match (side, lid) {
                    (Some(length), lid) if lid.is_none_or(|lid| length < lid) => {
                        let normal = (away + across * length) / radius;
                        Some(Hit { length, normal: Vector3::new(normal.x, normal.y, 0.0), colour })
                    }
                    (_, Some(length)) => Some(Hit { length, normal: Vector3::z(), colour }),
                    _ => None,
                }
            }
            Solid::Block { low, high, colour } => {
                let (mut enter, mut leave, mut axis) = (0.0f64, f64::MAX, 0);
                for k in 0..3 {
                    let (a, b) = ((low[k] - origin[k]) / ray[k], (high[k] - origin[k]) / ray[k]);
                    if a.min(b) > enter {
                        (enter, axis) = (a.min(b), k);
                    }
                    leave = leave.min(a.max(b));
                }
                let mut normal = Vector3::zeros();
                normal[axis] = -ray[axis].signum();
                (enter > 0.0 && enter <= leave).then_some(Hit { length: enter, normal, colour })
            }
        }
    }
}

/// The least positive solution of `a t² + 2 b t + c = 0`.
fn nearest_root(a: f64, b: f64, c: f64) -> Option<f64> {
    let under = b * b - a * c;
    if under < 0.0 || a <= 0.0 {
        return None;
    }
    let length = (-b - under.sqrt()) / a;
    (length > 0.0).then_some(length)
}

impl Pattern {
    fn at(&self, normal: &Vector3<f64>) -> Rgb {
        match *self {
            Pattern::Plain(colour) => colour,
            Pattern::Patches(base, patch, turn) => {
                /// Cosine of the radius of a patch: 20 degrees.
                const PATCH_COSINE: f64 = 0.94;
                let [about_z, about_x] = turn.map(libm::sincos);
                let (x, y) = (
                    about_z.1 * normal.x - about_z.0 * normal.y,
                    about_z.0 * normal.x + about_z.1 * normal.y,
                );
                let (y, z) = (about_x.1 * y - about_x.0 * normal.z, about_x.0 * y + about_x.1 * normal.z);
                if nearest_corner(x, y, z) > PATCH_COSINE { patch } else { base }
            }
        }
    }
}

/// The cosine of the angle to the nearest corner of an icosahedron: the corners are at
/// (0, ±1, ±φ) and their rotations.
fn nearest_corner(x: f64, y: f64, z: f64) -> f64 {
    const LONG: f64 = 0.850_650_808_352_04;
    const SHORT: f64 = 0.525_731_112_119_13;
    let (x, y, z) = (x.abs(), y.abs(), z.abs());
    (SHORT * y + LONG * z).max(SHORT * z + LONG * x).max(SHORT * x + LONG * y)
}
