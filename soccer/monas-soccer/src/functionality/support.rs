//! Where a player waits while a team mate has the ball.

use nalgebra::Point2;

use super::field::FieldModel;

/// Distance ahead of the ball, metres.
const AHEAD: f64 = 1.0;
const ASIDE: f64 = 0.85;
/// Distance kept from the opponents' goal line, metres.
const FROM_GOAL_LINE: f64 = 0.8;
const FROM_TOUCH_LINE: f64 = 0.5;

/// The position ahead of the ball, on the player's side of it, where a rebound from the goalkeeper
/// can be reached and a shot is not blocked. All in the field frame.
pub fn support_place(field: &FieldModel, ball: Point2<f64>, player: Point2<f64>) -> Point2<f64> {
    let x = (ball.x + AHEAD).min(field.length / 2.0 - FROM_GOAL_LINE);
    let reach = (field.width / 2.0 - FROM_TOUCH_LINE).max(0.0);
    let y = ball.y + ASIDE.copysign(player.y - ball.y);
    Point2::new(x, y.clamp(-reach, reach))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: FieldModel = FieldModel::LEAGUE_2010;

    #[test]
    fn it_is_ahead_of_the_ball_on_the_players_side() {
        let place = support_place(&FIELD, Point2::new(0.0, 0.0), Point2::new(-1.0, 0.2));
        assert_eq!(place, Point2::new(AHEAD, ASIDE));
        let place = support_place(&FIELD, Point2::new(0.0, 0.0), Point2::new(-1.0, -0.2));
        assert_eq!(place, Point2::new(AHEAD, -ASIDE));
    }

    #[test]
    fn it_is_on_the_field_and_not_in_the_goal() {
        let place = support_place(&FIELD, Point2::new(2.8, 1.9), Point2::new(1.0, 2.0));
        assert_eq!(place, Point2::new(2.2, 1.5));
    }
}
