//! The field: positions of lines, goals and marks.

use crate::parameters::parameters;
use crate::pose::Vector;
use crate::{Error, ErrorKind, FieldSide, LineFeature};

parameters! {
    /// The measures of a field.
    ///
    /// The field frame has its origin at the centre mark, x points to the middle of the right
    /// (yellow) goal and y to the left when facing that goal. The default is the field of the
    /// Standard Platform League of 2010.
    pub struct FieldGeometry {
        /// From goal line to goal line (SPL 2010).
        length: "m" = 6.0 in 2.0 to 120.0;
        /// From touch line to touch line (SPL 2010).
        width: "m" = 4.0 in 1.5 to 90.0;
        /// Carpet outside the lines on every side; robots cannot leave it (SPL 2010: 7.4 m by 5.4 m
        /// of carpet).
        border: "m" = 0.7 in 0.3 to 10.0;
        /// Between the middles of the posts of a goal (SPL 2010).
        goal_width: "m" = 1.4 in 0.5 to 8.0;
        /// Height of the posts, for the camera (SPL 2010).
        goal_height: "m" = 0.8 in 0.2 to 3.0;
        /// Depth of the net behind the goal line, for pictures (SPL 2010).
        goal_depth: "m" = 0.4 in 0.1 to 3.0;
        /// Radius of a post (SPL 2010: diameter 100 mm).
        post_radius: "m" = 0.05 in 0.01 to 0.2;
        /// Depth of the goal area (in 2010 the only area before a goal, called penalty area).
        goal_area_depth: "m" = 0.6 in 0.1 to 10.0;
        /// Width of the goal area (SPL 2010).
        goal_area_width: "m" = 2.2 in 0.5 to 30.0;
        /// Radius of the centre circle (SPL 2010).
        centre_circle_radius: "m" = 0.6 in 0.1 to 15.0;
        /// Distance of the penalty marks from the centre (the field file of the thesis's team).
        mark_distance: "m" = 1.2 in 0.1 to 50.0;
        /// Width of the lines, for pictures (SPL 2010: 50 mm).
        line_width: "m" = 0.05 in 0.01 to 0.2;
        /// Distance of the lines of throw-ins from the touch lines (SPL 2010: 0.4 m inside).
        throw_in_inset: "m" = 0.4 in 0.0 to 2.0;
        /// 1 when walls stand on the lines, so that a ball bounces; 0 when it leaves and is thrown
        /// in.
        walls: "0 or 1" = 0.0 in 0.0 to 1.0;
    }
}

impl FieldGeometry {
    /// Half the length: x of the right goal line.
    pub fn half_length(&self) -> f64 {
        self.length / 2.0
    }

    /// Half the width: y of the upper touch line.
    pub fn half_width(&self) -> f64 {
        self.width / 2.0
    }

    /// Whether walls stand on the lines.
    pub fn has_walls(&self) -> bool {
        self.walls >= 0.5
    }

    /// The middle of the goal on `side`.
    pub fn goal(&self, side: FieldSide) -> Vector {
        Vector::new(side.sign() * self.half_length(), 0.0)
    }

    /// The posts of the goal on `side`: the left one first, as seen from the field facing the goal.
    pub fn posts(&self, side: FieldSide) -> [Vector; 2] {
        let x = side.sign() * self.half_length();
        let y = side.sign() * self.goal_width / 2.0;
        [Vector::new(x, y), Vector::new(x, -y)]
    }

    /// The places of the lines that a picture can show as such.
    pub(crate) fn line_features(&self) -> [(LineFeature, Vector); 15] {
        let (end, side) = (self.half_length(), self.half_width());
        let (front, beside) = (end - self.goal_area_depth, self.goal_area_width / 2.0);
        let quarter = |feature, x: f64, y: f64| {
            [(x, y), (x, -y), (-x, y), (-x, -y)].map(|(x, y)| (feature, Vector::new(x, y)))
        };
        let [a, b, c, d] = quarter(LineFeature::Corner, end, side);
        let [e, f, g, h] = quarter(LineFeature::Corner, front, beside);
        let [i, j, k, l] = quarter(LineFeature::Junction, end, beside);
        let halfway = [side, -side].map(|y| (LineFeature::Junction, Vector::new(0.0, y)));
        let centre = (LineFeature::CentreCircle, Vector::zeros());
        [a, b, c, d, e, f, g, h, i, j, k, l, halfway[0], halfway[1], centre]
    }

    /// Whether a point is in the goal area of `side`.
    pub fn in_goal_area(&self, side: FieldSide, point: Vector) -> bool {
        let depth = self.half_length() - side.sign() * point.x;
        (0.0..=self.goal_area_depth).contains(&depth) && point.y.abs() <= self.goal_area_width / 2.0
    }

    /// Whether a point is inside the lines.
    pub fn contains(&self, point: Vector) -> bool {
        point.x.abs() <= self.half_length() && point.y.abs() <= self.half_width()
    }

    /// Checks the ranges and that all parts fit on the field.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::ErrorKind::OutOfRange) and
    /// [`Inconsistent`](crate::ErrorKind::Inconsistent).
    pub fn validate(&self) -> Result<(), Error> {
        self.check_ranges()?;
        let fits = [
            (self.goal_width + 0.2 <= self.width, "the goal is wider than the field"),
            (self.goal_area_width <= self.width, "the goal area is wider than the field"),
            (self.goal_area_depth < self.half_length(), "the goal areas overlap"),
            (self.centre_circle_radius < self.half_width(), "the centre circle does not fit on the field"),
            (self.mark_distance < self.half_length(), "the penalty marks are off the field"),
            (self.throw_in_inset < self.half_width().min(self.half_length()), "the lines of throw-ins cross"),
        ];
        fits.iter()
            .find(|(holds, _)| !holds)
            .map_or(Ok(()), |(_, message)| Err(Error::new(ErrorKind::Inconsistent, *message)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_the_field_of_the_thesis() {
        let field = FieldGeometry::default();
        assert!(field.validate().is_ok());
        assert_eq!((field.length, field.width, field.goal_width), (6.0, 4.0, 1.4));
        assert_eq!(field.goal(FieldSide::Left), Vector::new(-3.0, 0.0));
    }

    #[test]
    fn the_left_post_is_left_for_someone_facing_the_goal() {
        let field = FieldGeometry::default();
        assert!(field.posts(FieldSide::Right)[0].y > 0.0);
        assert!(field.posts(FieldSide::Left)[0].y < 0.0);
    }

    #[test]
    fn the_goal_area_reaches_from_the_goal_line_into_the_field() {
        let field = FieldGeometry::default();
        assert!(field.in_goal_area(FieldSide::Left, Vector::new(-2.5, 1.0)));
        assert!(!field.in_goal_area(FieldSide::Left, Vector::new(-2.3, 1.0)));
        assert!(!field.in_goal_area(FieldSide::Left, Vector::new(-2.5, 1.2)));
        assert!(!field.in_goal_area(FieldSide::Left, Vector::new(-3.1, 0.0)));
        assert!(!field.in_goal_area(FieldSide::Left, Vector::new(2.5, 0.0)));
    }

    #[test]
    fn parameters_are_set_by_name_and_checked() {
        let mut field = FieldGeometry::default();
        assert!(field.set("length", 9.0).is_ok());
        assert_eq!(field.get("length"), Some(9.0));
        assert_eq!(field.set("lenght", 9.0).map_err(|e| e.kind()), Err(ErrorKind::UnknownParameter));
        for bad in [f64::NAN, f64::INFINITY, -1.0] {
            assert_eq!(field.set("length", bad).map_err(|e| e.kind()), Err(ErrorKind::OutOfRange));
        }
        assert_eq!(field.length, 9.0);
    }

    #[test]
    fn a_goal_wider_than_the_field_is_refused() {
        let field = FieldGeometry { goal_width: 4.0, ..FieldGeometry::default() };
        assert_eq!(field.validate().map_err(|e| e.kind()), Err(ErrorKind::Inconsistent));
    }

    #[test]
    fn every_key_is_documented_and_holds_its_default() {
        let field = FieldGeometry::default();
        for parameter in FieldGeometry::keys() {
            assert!(parameter.doc.len() > 10 && parameter.allows(parameter.default), "{}", parameter.key);
            assert_eq!(field.get(parameter.key), Some(parameter.default));
        }
    }
}
