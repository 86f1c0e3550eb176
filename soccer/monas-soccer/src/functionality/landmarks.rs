//! Landmarks of a field: posts of the goals, places of the lines, and the lines.

use nalgebra::{Point2, Vector2};

use super::field::{FieldModel, Goal};
use super::geometry::polar;

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

/// The landmark that a sighting shows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Landmark {
    /// A post of a goal.
    Post(Goal, GoalPost),
    /// A post of a goal whose colour does not identify the goal.
    PostOfEitherGoal(GoalPost),
    /// The corner of two lines: of the field or of a goal area.
    Corner,
    /// A place where a line ends at another: at the halfway line or at a goal area.
    Junction,
    /// The middle of the centre circle.
    CentreCircle,
}

/// A sighting of a landmark.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LandmarkSighting {
    /// The landmark.
    pub landmark: Landmark,
    /// Distance along the ground, metres.
    pub distance: f64,
    /// Bearing from the robot, radians.
    pub bearing: f64,
}

impl LandmarkSighting {
    /// Its position in the robot's frame.
    pub fn position(&self) -> Point2<f64> {
        polar(self.distance, self.bearing).into()
    }
}

/// The largest number of places of a kind of landmark.
const MOST_PLACES: usize = 8;

/// The places in the field at which a landmark can be.
#[derive(Clone, Copy, Debug)]
pub struct LandmarkPlaces {
    positions: [Point2<f64>; MOST_PLACES],
    count: usize,
}

impl LandmarkPlaces {
    /// The places of a landmark on a field.
    pub fn new(landmark: Landmark, field: &FieldModel) -> LandmarkPlaces {
        let mut all = LandmarkPlaces { positions: [Point2::origin(); MOST_PLACES], count: 0 };
        let (end, side) = (field.length / 2.0, field.width / 2.0);
        let (front, beside) = (end - field.area_depth, field.area_width / 2.0);
        match landmark {
            Landmark::Post(goal, post) => all.add_posts(field, goal, post),
            Landmark::PostOfEitherGoal(post) => {
                all.add_posts(field, Goal::Own, post);
                all.add_posts(field, Goal::Opponent, post);
            }
            Landmark::Corner => {
                all.add_mirrored(end, side);
                all.add_mirrored(front, beside);
            }
            Landmark::Junction => {
                all.add_mirrored(end, beside);
                all.add(Point2::new(0.0, side));
                all.add(Point2::new(0.0, -side));
            }
            Landmark::CentreCircle => all.add(Point2::origin()),
        }
        all
    }

    /// The places.
    pub fn as_slice(&self) -> &[Point2<f64>] {
        &self.positions[..self.count]
    }

    fn add_posts(&mut self, field: &FieldModel, goal: Goal, post: GoalPost) {
        let [left, right] = field.posts(goal);
        if post != GoalPost::Right {
            self.add(left);
        }
        if post != GoalPost::Left {
            self.add(right);
        }
    }

    fn add(&mut self, position: Point2<f64>) {
        self.positions[self.count] = position;
        self.count += 1;
    }

    fn add_mirrored(&mut self, x: f64, y: f64) {
        for (x, y) in [(x, y), (x, -y), (-x, y), (-x, -y)] {
            self.add(Point2::new(x, y));
        }
    }
}

/// A straight part of a line, seen in the robot's frame or known in the field's.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LineSighting {
    /// Its ends, metres.
    pub ends: [Point2<f64>; 2],
}

impl LineSighting {
    /// Its middle.
    pub fn middle(&self) -> Point2<f64> {
        nalgebra::center(&self.ends[0], &self.ends[1])
    }

    /// From its first end to its second.
    pub fn along(&self) -> Vector2<f64> {
        self.ends[1] - self.ends[0]
    }
}

/// The straight lines of a field.
pub fn field_lines(field: &FieldModel) -> [LineSighting; 11] {
    let (end, side) = (field.length / 2.0, field.width / 2.0);
    let (front, beside) = (end - field.area_depth, field.area_width / 2.0);
    let line = |x1, y1, x2, y2| LineSighting { ends: [Point2::new(x1, y1), Point2::new(x2, y2)] };
    [
        line(-end, side, end, side),
        line(-end, -side, end, -side),
        line(-end, -side, -end, side),
        line(end, -side, end, side),
        line(0.0, -side, 0.0, side),
        line(-front, -beside, -front, beside),
        line(front, -beside, front, beside),
        line(-end, beside, -front, beside),
        line(-end, -beside, -front, -beside),
        line(front, beside, end, beside),
        line(front, -beside, end, -beside),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_landmark_has_its_places() {
        let field = FieldModel::LEAGUE_2010;
        let count = |landmark| LandmarkPlaces::new(landmark, &field).as_slice().len();
        assert_eq!(count(Landmark::Post(Goal::Own, GoalPost::Left)), 1);
        assert_eq!(count(Landmark::Post(Goal::Opponent, GoalPost::Either)), 2);
        assert_eq!((count(Landmark::Corner), count(Landmark::Junction)), (8, 6));
        assert_eq!(count(Landmark::CentreCircle), 1);
        assert_eq!(count(Landmark::PostOfEitherGoal(GoalPost::Left)), 2);
        assert_eq!(count(Landmark::PostOfEitherGoal(GoalPost::Either)), 4);
        let corners = LandmarkPlaces::new(Landmark::Corner, &field);
        assert!(corners.as_slice().contains(&Point2::new(-3.0, 2.0)));
        assert!(corners.as_slice().contains(&Point2::new(2.4, -1.1)));
    }
}
