//! The field according to the rules.

use nalgebra::Point2;

/// The dimensions of a field, and positions derived from them, in the frame of the player's team:
/// origin in the centre, x towards the goal to attack.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FieldModel {
    /// From goal line to goal line, metres.
    pub length: f64,
    /// From touch line to touch line, metres.
    pub width: f64,
    /// Between the middles of a goal's posts, metres.
    pub goal_width: f64,
    /// A goal's area before the goal line, metres.
    pub area_depth: f64,
    /// A goal's area along the goal line, metres.
    pub area_width: f64,
    /// Radius of the centre circle, metres.
    pub circle_radius: f64,
}

/// One of the two goals.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Goal {
    /// The goal to defend, at -x.
    Own,
    /// The goal to attack, at +x.
    Opponent,
}

impl FieldModel {
    /// The field of the league in 2010: 6 m by 4 m, goals of 1.4 m, areas of 0.6 m by 2.2 m, a
    /// circle of 0.6 m.
    pub const LEAGUE_2010: FieldModel = FieldModel {
        length: 6.0,
        width: 4.0,
        goal_width: 1.4,
        area_depth: 0.6,
        area_width: 2.2,
        circle_radius: 0.6,
    };

    /// The middle of a goal.
    pub fn goal(&self, goal: Goal) -> Point2<f64> {
        Point2::new(self.goal_line(goal), 0.0)
    }

    /// The left and the right post of a goal, as seen from the field facing that goal.
    pub fn posts(&self, goal: Goal) -> [Point2<f64>; 2] {
        let (x, half) = (self.goal_line(goal), self.goal_width / 2.0);
        match goal {
            Goal::Opponent => [Point2::new(x, half), Point2::new(x, -half)],
            Goal::Own => [Point2::new(x, -half), Point2::new(x, half)],
        }
    }

    /// Whether a position is in the own goal area, or within a margin of it.
    pub fn in_own_area(&self, position: Point2<f64>, margin: f64) -> bool {
        position.x < self.area_front() + margin && position.y.abs() < self.area_width / 2.0 + margin
    }

    /// The x coordinate of the front of the own goal area.
    pub fn area_front(&self) -> f64 {
        self.goal_line(Goal::Own) + self.area_depth
    }

    fn goal_line(&self, goal: Goal) -> f64 {
        match goal {
            Goal::Opponent => self.length / 2.0,
            Goal::Own => -self.length / 2.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_and_right_are_relative_to_facing_the_goal() {
        let field = FieldModel::LEAGUE_2010;
        assert_eq!(field.posts(Goal::Opponent), [Point2::new(3.0, 0.7), Point2::new(3.0, -0.7)]);
        assert_eq!(field.posts(Goal::Own), [Point2::new(-3.0, -0.7), Point2::new(-3.0, 0.7)]);
        assert_eq!(field.goal(Goal::Own), Point2::new(-3.0, 0.0));
    }

    #[test]
    fn the_own_area_is_before_the_own_goal() {
        let field = FieldModel::LEAGUE_2010;
        assert!(field.in_own_area(Point2::new(-2.5, 1.0), 0.0));
        assert!(
            !field.in_own_area(Point2::new(-2.3, 1.0), 0.0) && field.in_own_area(Point2::new(-2.3, 1.0), 0.2)
        );
        assert!(
            !field.in_own_area(Point2::new(-2.5, 1.2), 0.0) && !field.in_own_area(Point2::new(2.5, 0.0), 0.0)
        );
    }
}
