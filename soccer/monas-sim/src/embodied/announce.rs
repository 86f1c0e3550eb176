//! Converts the referee's announcements to those of `monas-robot`.

use monas_robot::{Announcement, Colour, GamePhase};

use super::SharedWorld;
use crate::{FieldSide, GameOrder, GameState, GoalColour, SimulatedWorld, TeamColour};

/// The referee's current announcement to a robot.
pub(super) fn announcement(ground: &SharedWorld, robot: usize) -> Option<Announcement> {
    let said = ground.world.announcement(robot).ok()?;
    let field = ground.world.field();
    let of_field = Announcement {
        team_colour: team_colour(said.colour) as i32,
        field_length: field.length,
        field_width: field.width,
        goal_width: field.goal_width,
        ..Announcement::default()
    };
    if let Some(league) = &ground.league {
        return league.get(robot).map(|announced| Announcement {
            team_colour: of_field.team_colour,
            field_length: of_field.field_length,
            field_width: of_field.field_width,
            goal_width: of_field.goal_width,
            ..*announced
        });
    }
    Some(Announcement {
        phase: phase(said.state) as i32,
        halted: said.halted,
        penalized: said.penalty.is_some(),
        penalty_left: said.penalty.map_or(0.0, |penalty| penalty.remaining),
        seconds_left: said.seconds_remaining,
        first_half: said.half == 1,
        team: said.team.into(),
        number: said.robot.into(),
        goal_to_attack: goal_colour(said.attacks) as i32,
        kick_off: said.kick_off_team == said.team,
        own_score: said.own_score,
        opponent_score: said.opponent_score,
        ..of_field
    })
}

/// The orders to the field that result from announcements to its robots.
pub(super) fn order(world: &SimulatedWorld, announcements: &[Announcement]) -> GameOrder {
    let mut order = world.referee().to_order();
    order.penalties = announcements.iter().map(|it| it.penalized.then_some(it.penalty_left)).collect();
    for (robot, announced) in world.robots().iter().zip(announcements) {
        let team = robot.team;
        order.state = state(announced.phase());
        order.is_halted = announced.halted;
        order.half = if announced.first_half { 1 } else { 2 };
        order.seconds_remaining = announced.seconds_left;
        order.score[team] = announced.own_score;
        order.score[1 - team] = announced.opponent_score;
        if announced.kick_off {
            order.kick_off = team;
        }
        let attacks = match announced.goal_to_attack() {
            Colour::Blue => FieldSide::Left,
            Colour::Yellow => FieldSide::Right,
            _ => continue,
        };
        order.defends[team] = attacks.opposite();
        order.defends[1 - team] = attacks;
    }
    order
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

fn state(phase: GamePhase) -> GameState {
    match phase {
        GamePhase::Initial => GameState::Initial,
        GamePhase::Ready => GameState::Ready,
        GamePhase::Set => GameState::Set,
        GamePhase::Playing => GameState::Playing,
        GamePhase::Finished => GameState::Finished,
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
