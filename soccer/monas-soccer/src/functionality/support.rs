//! The waiting position of a player while a team mate goes to the ball.

use nalgebra::Point2;

use super::field::{FieldModel, Goal};

/// Distance ahead of the ball of a supporter, metres.
pub const DISTANCE_AHEAD: f64 = 1.0;
const DISTANCE_ASIDE: f64 = 0.85;
/// Distance kept from the opponents' goal line, metres.
const FROM_GOAL_LINE: f64 = 0.8;
const FROM_TOUCH_LINE: f64 = 0.5;

/// The position `ahead` metres before the ball, on the player's side of it, where a rebound from
/// the goalkeeper can be reached and a shot is not blocked. All in the field frame.
pub fn support_position(
    field: &FieldModel,
    ball: Point2<f64>,
    player: Point2<f64>,
    ahead: f64,
) -> Point2<f64> {
    let x = (ball.x + ahead).min(field.length / 2.0 - FROM_GOAL_LINE);
    let reach = (field.width / 2.0 - FROM_TOUCH_LINE).max(0.0);
    let y = ball.y + DISTANCE_ASIDE.copysign(player.y - ball.y);
    Point2::new(x, y.clamp(-reach, reach))
}

/// Distance that a cover keeps from the ball, and from the own goal area, metres.
const FROM_BALL: f64 = 0.8;
const FROM_AREA: f64 = 0.2;

/// The position between the ball and the own goal, outside its area, where a shot of an opponent is
/// blocked. All in the field frame.
pub fn cover_position(field: &FieldModel, ball: Point2<f64>) -> Point2<f64> {
    let to_goal = field.goal(Goal::Own) - ball;
    let position = ball + to_goal.try_normalize(1e-6).unwrap_or_default() * FROM_BALL;
    Point2::new(position.x.max(field.area_front() + FROM_AREA), position.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: FieldModel = FieldModel::LEAGUE_2010;

    #[test]
    fn it_is_ahead_of_the_ball_on_the_players_side() {
        let position =
            support_position(&FIELD, Point2::new(0.0, 0.0), Point2::new(-1.0, 0.2), DISTANCE_AHEAD);
        assert_eq!(position, Point2::new(DISTANCE_AHEAD, DISTANCE_ASIDE));
        let position =
            support_position(&FIELD, Point2::new(0.0, 0.0), Point2::new(-1.0, -0.2), DISTANCE_AHEAD);
        assert_eq!(position, Point2::new(DISTANCE_AHEAD, -DISTANCE_ASIDE));
    }

    #[test]
    fn the_cover_is_between_ball_and_goal_and_not_in_the_area() {
        let position = cover_position(&FIELD, Point2::origin());
        assert!((position - Point2::new(-FROM_BALL, 0.0)).norm() < 1e-9);
        let position = cover_position(&FIELD, Point2::new(-2.0, 1.0));
        assert!((position.x + 2.2).abs() < 1e-9 && (0.2..0.9).contains(&position.y), "{position}");
    }

    #[test]
    fn it_is_on_the_field_and_not_in_the_goal() {
        let position = support_position(&FIELD, Point2::new(2.8, 1.9), Point2::new(1.0, 2.0), DISTANCE_AHEAD);
        assert_eq!(position, Point2::new(2.2, 1.5));
    }
}
