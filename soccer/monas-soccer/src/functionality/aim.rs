//! Selection of the direction of a kick.

use nalgebra::{Point2, Vector2};

use super::field::{FieldModel, Goal};

/// Half the width of the goal line that a robot in the way of a shot covers, metres: robot, ball
/// and a margin.
const BLOCKED_HALF_WIDTH: f64 = 0.25;
/// Distance from a post that a shot keeps, metres.
const FROM_POST: f64 = 0.15;

/// The middle of the widest part of the opponents' goal that no opponent covers, as seen from the
/// ball; the middle of the goal if it is free or completely covered. All in the field frame.
pub fn shot_target(field: &FieldModel, ball: Point2<f64>, opponents: &[Point2<f64>]) -> Point2<f64> {
    let goal = field.goal(Goal::Opponent);
    let reach = (field.goal_width / 2.0 - FROM_POST).max(0.0);
    let mut shadows: Vec<(f64, f64)> =
        opponents.iter().filter_map(|robot| shadow(goal.x, ball, *robot)).collect();
    shadows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let gap = widest_gap(-reach, reach, &shadows);
    Point2::new(goal.x, gap.map_or(goal.y, |(low, high)| (low + high) / 2.0))
}

/// The target of a field player's kick, given the target of a shot: the same or, if the player
/// would have to stand in its own goal area, along the area towards the nearer touch line. All in
/// the field frame.
pub fn kick_target(field: &FieldModel, ball: Point2<f64>, shot: Point2<f64>) -> Point2<f64> {
    let direction = (shot - ball).try_normalize(1e-6).unwrap_or(Vector2::x());
    if field.in_own_area(ball - direction * BEHIND_BALL, 0.0) {
        Point2::new(ball.x, (field.width / 2.0 + 1.0).copysign(ball.y))
    } else {
        shot
    }
}

/// Distance behind the ball from which a robot kicks it, metres, with a margin.
const BEHIND_BALL: f64 = 0.3;

/// The part of the goal line that a robot covers from a ball: from, to.
fn shadow(goal_x: f64, ball: Point2<f64>, robot: Point2<f64>) -> Option<(f64, f64)> {
    let (to_goal, to_robot) = (goal_x - ball.x, robot.x - ball.x);
    // Robots beside or behind the ball, or behind the goal line, cover nothing.
    if to_robot <= 0.2 || to_robot > to_goal + 0.3 {
        return None;
    }
    let stretch = to_goal / to_robot;
    let middle = ball.y + (robot.y - ball.y) * stretch;
    Some((middle - BLOCKED_HALF_WIDTH * stretch, middle + BLOCKED_HALF_WIDTH * stretch))
}

/// The widest part between `low` and `high` that none of the shadows, sorted by their beginning,
/// covers.
fn widest_gap(low: f64, high: f64, shadows: &[(f64, f64)]) -> Option<(f64, f64)> {
    let mut widest: Option<(f64, f64)> = None;
    let mut free_from = low;
    for &(from, to) in shadows.iter().chain(&[(high, high)]) {
        let gap = (free_from, from.min(high));
        if gap.1 - gap.0 > widest.map_or(0.0, |(a, b)| b - a) {
            widest = Some(gap);
        }
        free_from = free_from.max(to);
    }
    widest
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: FieldModel = FieldModel::LEAGUE_2010;

    #[test]
    fn a_ball_at_the_own_area_is_kicked_along_it() {
        let shot = Point2::new(3.0, 0.0);
        assert_eq!(kick_target(&FIELD, Point2::new(0.0, 0.0), shot), shot);
        assert_eq!(kick_target(&FIELD, Point2::new(-2.3, -0.5), shot), Point2::new(-2.3, -3.0));
        assert_eq!(kick_target(&FIELD, Point2::new(-2.3, 1.9), shot), shot, "beside the area");
    }

    #[test]
    fn an_empty_goal_is_shot_at_in_the_middle() {
        assert_eq!(shot_target(&FIELD, Point2::new(1.0, 1.0), &[]), Point2::new(3.0, 0.0));
        let behind = [Point2::new(0.5, 1.0), Point2::new(3.5, 0.0)];
        assert_eq!(shot_target(&FIELD, Point2::new(1.0, 1.0), &behind), Point2::new(3.0, 0.0));
    }

    #[test]
    fn a_goalie_is_shot_past_on_the_wider_side() {
        let ball = Point2::new(1.5, 0.0);
        assert!(shot_target(&FIELD, ball, &[Point2::new(2.9, 0.2)]).y < -0.2);
        assert!(shot_target(&FIELD, ball, &[Point2::new(2.9, -0.2)]).y > 0.2);
    }

    #[test]
    fn a_covered_goal_is_shot_at_in_the_middle() {
        let ball = Point2::new(1.5, 0.0);
        assert_eq!(shot_target(&FIELD, ball, &[Point2::new(1.8, 0.0)]), Point2::new(3.0, 0.0));
    }

    #[test]
    fn the_target_lies_between_the_posts() {
        for step in -20..=20 {
            let robot = Point2::new(2.8, f64::from(step) * 0.05);
            let target = shot_target(&FIELD, Point2::new(0.0, 1.5), &[robot]);
            assert!(target.y.abs() <= 0.55, "{robot}: {target}");
        }
    }
}
