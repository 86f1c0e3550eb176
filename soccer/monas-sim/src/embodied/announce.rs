//! Converts the referee's announcements to those of `monas-robot`.

use monas_robot::{Announcement, Colour, GamePhase};

use super::SharedWorld;
use crate::{FieldSide, GameState, GoalColour, Pose, TeamColour};

/// The referee's current announcement to a robot.
pub(super) fn announcement(ground: &SharedWorld, robot: usize) -> Option<Announcement> {
    let said = ground.world.announcement(robot).ok()?;
    let placement = ground.placements.get(robot)?;
    let own = in_frame_of_team(placement.pose, said.attacks);
    let field = ground.world.field();
    Some(Announcement {
        phase: phase(said.state) as i32,
        penalized: said.penalty.is_some(),
        penalty_left: said.penalty.map_or(0.0, |penalty| penalty.remaining),
        seconds_left: said.seconds_remaining,
        first_half: said.half == 1,
        team: said.team.into(),
        number: said.robot.into(),
        team_colour: team_colour(said.colour) as i32,
        goal_to_attack: goal_colour(said.attacks) as i32,
        kick_off: said.kick_off_team == said.team,
        own_score: said.own_score,
        opponent_score: said.opponent_score,
        placements: placement.count,
        placed_x: own.position.x,
        placed_y: own.position.y,
        placed_heading: own.heading,
        field_length: field.length,
        field_width: field.width,
        goal_width: field.goal_width,
    })
}

/// Converts a pose to the frame of a team, with x towards the goal that it attacks.
fn in_frame_of_team(pose: Pose, attacks: GoalColour) -> Pose {
    match attacks == FieldSide::Right.goal_colour() {
        true => pose,
        false => Pose::new(0.0, 0.0, std::f64::consts::PI).compose(&pose),
    }
}

/// Whether an announcement differs from the previous one, apart from its clocks.
pub(super) fn is_news(now: &Announcement, before: &Announcement) -> bool {
    let timeless =
        |announcement: &Announcement| Announcement { seconds_left: 0.0, penalty_left: 0.0, ..*announcement };
    timeless(now) != timeless(before)
}

fn phase(state: GameState) -> GamePhase {
    match state {
        GameState::Initial => GamePhase::Initial,
        GameState::Ready => GamePhase::Ready,
        GameState::Set => GamePhase::Set,
        GameState::Playing => GamePhase::Playing,
        GameState::Finished => GamePhase::Finished,
    }
}

pub(super) fn goal_colour(goal: GoalColour) -> Colour {
    match goal {
        GoalColour::Blue => Colour::Blue,
        GoalColour::Yellow => Colour::Yellow,
    }
}

pub(super) fn team_colour(team: TeamColour) -> Colour {
    match team {
        TeamColour::Blue => Colour::Blue,
        TeamColour::Red => Colour::Red,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vector;

    #[test]
    fn a_team_that_attacks_to_the_left_sees_the_field_rotated() {
        let pose = in_frame_of_team(Pose::new(1.0, 2.0, 0.5), GoalColour::Blue);
        assert!((pose.position - Vector::new(-1.0, -2.0)).norm() < 1e-12);
        assert!((pose.heading - (0.5 - std::f64::consts::PI)).abs() < 1e-12);
        assert_eq!(in_frame_of_team(pose, GoalColour::Yellow), pose);
    }
}
