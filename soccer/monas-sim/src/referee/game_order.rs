//! A referee outside the simulation, whose decisions the embedded one carries out.

use super::{GameState, Penalty, Referee, goal_side};
use crate::state::WorldView;
use crate::{EventKind, FieldSide, Offence};

/// Decisions of a referee outside the simulation. Teams and robots are indices into those of the
/// world.
#[derive(Debug, Clone, PartialEq)]
pub struct GameOrder {
    /// The state of the game.
    pub state: GameState,
    /// Whether robots must stand still, whatever the state.
    pub is_halted: bool,
    /// The half, 1 or 2.
    pub half: u8,
    /// Time left in this half, s.
    pub seconds_remaining: f64,
    /// The team that has the kick-off, or had the last one.
    pub kick_off: usize,
    /// The end that each team defends.
    pub defends: [FieldSide; 2],
    /// Goals of each team.
    pub score: [u32; 2],
    /// For each robot, the remaining time of its penalty, s.
    pub penalties: Vec<Option<f64>>,
}

impl Referee {
    /// The present state of the game as an order.
    pub fn to_order(&self) -> GameOrder {
        GameOrder {
            state: self.state,
            is_halted: self.is_stopped || self.order.as_ref().is_some_and(|order| order.is_halted),
            half: self.half,
            seconds_remaining: self.seconds_remaining(),
            kick_off: self.kick_off,
            defends: self.defends,
            score: self.score,
            penalties: self.penalties.iter().map(|penalty| penalty.map(|it| it.remaining)).collect(),
        }
    }

    /// Carries out what has changed in the order, and lets the ball be put back when it is out. A
    /// ball in a goal lies there until the order is READY.
    pub(super) fn apply(&mut self, order: &GameOrder, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        self.kick_off = order.kick_off;
        self.defends = order.defends;
        if self.half != order.half {
            self.half = order.half;
            events.push(EventKind::HalfTime);
        }
        for team in 0..2 {
            if order.score[team] > self.score[team] {
                let robot = self.last_touch;
                let own_goal = robot.is_some_and(|robot| self.team_of[robot] != team);
                events.push(EventKind::Goal { team, robot, own_goal });
            }
        }
        self.score = order.score;
        for (robot, remaining) in order.penalties.iter().enumerate() {
            self.set_penalty(robot, *remaining, events);
        }
        if self.state != order.state {
            let is_kick_off = self.state == GameState::Set && order.state == GameState::Playing;
            self.change_state(order.state, events);
            if is_kick_off {
                events.push(EventKind::KickOff { team: self.kick_off });
            }
        }
        if self.state == GameState::Playing {
            self.watch_touches(scene, events);
            if self.is_out(scene) && goal_side(scene).is_none() {
                self.throw_in(scene, events);
            }
        }
    }

    fn set_penalty(&mut self, robot: usize, remaining: Option<f64>, events: &mut Vec<EventKind>) {
        let offence = Offence::Announced;
        match (self.penalties[robot].is_some(), remaining) {
            (false, Some(_)) => events.push(EventKind::Penalty { robot, offence }),
            (true, None) => events.push(EventKind::Return { robot }),
            _ => {}
        }
        self.penalties[robot] = remaining.map(|remaining| Penalty { offence, remaining });
    }
}
