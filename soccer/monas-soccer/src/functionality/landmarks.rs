//! Landmarks of a field: posts of the goals and places of the lines.

use nalgebra::Point2;

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

/// What a sighting shows of the field.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Landmark {
    /// A post of a goal.
    Post(Goal, GoalPost),
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
    /// What it is.
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

/// The most places at which one landmark can be.
const MOST_PLACES: usize = 8;

/// The places in the field at which a landmark can be.
#[derive(Clone, Copy, Debug)]
pub struct LandmarkPlaces {
    places: [Point2<f64>; MOST_PLACES],
    count: usize,
}

impl LandmarkPlaces {
    /// The places of a landmark on a field.
    pub fn new(landmark: Landmark, field: &FieldModel) -> LandmarkPlaces {
        let mut all = LandmarkPlaces { places: [Point2::origin(); MOST_PLACES], count: 0 };
        let (end, side) = (field.length / 2.0, field.width / 2.0);
        let (front, beside) = (end - field.area_depth, field.area_width / 2.0);
        match landmark {
            Landmark::Post(goal, post) => {
                let [left, right] = field.posts(goal);
                if post != GoalPost::Right {
                    all.add(left);
                }
                if post != GoalPost::Left {
                    all.add(right);
                }
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
        &self.places[..self.count]
    }

    fn add(&mut self, place: Point2<f64>) {
        self.places[self.count] = place;
        self.count += 1;
    }

    fn add_mirrored(&mut self, x: f64, y: f64) {
        for (x, y) in [(x, y), (x, -y), (-x, y), (-x, -y)] {
            self.add(Point2::new(x, y));
        }
    }
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
        let corners = LandmarkPlaces::new(Landmark::Corner, &field);
        assert!(corners.as_slice().contains(&Point2::new(-3.0, 2.0)));
        assert!(corners.as_slice().contains(&Point2::new(2.4, -1.1)));
    }
}
