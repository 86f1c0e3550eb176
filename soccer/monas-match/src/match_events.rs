//! Text for the field's events.

use std::time::Duration;

use monas_sim::{EventKind, GameState, Offence, SimulatedWorld};

use crate::summary::MatchEvent;

/// The notable events from index `first` on. Frequent ones (kicks, touches, falls) are only
/// counted.
pub(crate) fn since(world: &SimulatedWorld, first: usize) -> impl Iterator<Item = MatchEvent> {
    let events = world.events().get(first..).unwrap_or_default();
    events.iter().filter_map(move |event| {
        let text = text(world, &event.kind)?;
        Some(MatchEvent { time: Duration::from_secs_f64(event.time.max(0.0)), text })
    })
}

fn text(world: &SimulatedWorld, event: &EventKind) -> Option<String> {
    let team = |index: usize| world.teams()[index].name.as_str();
    let robot = |index: usize| {
        let robot = &world.robots()[index];
        format!("{} {}", team(robot.team), robot.number)
    };
    Some(match event {
        EventKind::StateChanged { to: GameState::Finished, .. } => "the match is over".into(),
        EventKind::HalfTime => "half time: the teams switch sides".into(),
        EventKind::KickOff { team: index } => format!("kick-off for {}", team(*index)),
        EventKind::Goal { team: index, robot: scorer, own_goal } => {
            let by = match scorer {
                Some(scorer) if *own_goal => format!(", an own goal of {}", robot(*scorer)),
                Some(scorer) => format!(" by {}", robot(*scorer)),
                None => String::new(),
            };
            format!("goal for {}{by}", team(*index))
        }
        EventKind::Shot { robot: index } => format!("shot by {}", robot(*index)),
        EventKind::Save { robot: index } => format!("save by {}", robot(*index)),
        EventKind::Penalty { robot: index, offence } => {
            format!("penalty for {}: {}", robot(*index), offence_name(*offence))
        }
        EventKind::DropBall { .. } => "nobody gets at the ball: it is dropped".into(),
        _ => return None,
    })
}

fn offence_name(offence: Offence) -> &'static str {
    match offence {
        Offence::Pushing => "pushing",
        Offence::BallHolding => "ball holding",
        Offence::IllegalDefender => "illegal defender",
        Offence::Announced => "decided by a person",
    }
}

/// The name of the referee's state in the rules of the league.
pub(crate) fn phase(state: GameState) -> &'static str {
    match state {
        GameState::Initial => "INITIAL",
        GameState::Ready => "READY",
        GameState::Set => "SET",
        GameState::Playing => "PLAYING",
        GameState::Finished => "FINISHED",
    }
}
