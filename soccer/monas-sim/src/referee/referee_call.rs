//! Decisions of a person who watches the match, which the embedded referee adopts.

use super::{GameState, Penalty, Referee};
use crate::state::WorldView;
use crate::{Error, ErrorKind, EventKind, Offence};

/// A person's decision. Robots are indices into those of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefereeCall {
    /// READY: robots walk to their places for a kick-off.
    Ready,
    /// SET, without waiting for its time.
    Set,
    /// PLAYING, without waiting for its time.
    Play,
    /// The half is over.
    EndHalf,
    /// The game stops: robots stand still, and neither the clock nor penalties go on.
    Stop,
    /// A stopped game goes on.
    Resume,
    /// The ball is dropped as if no robot could reach it.
    DropBall,
    /// The robot leaves the field for the time of a penalty.
    Penalize(usize),
    /// A penalized robot comes back.
    Return(usize),
}

impl Referee {
    /// Whether a person has stopped the game.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Adopts a decision of a person; the world carries it out in its next step.
    pub(crate) fn call(&mut self, call: RefereeCall, scene: &WorldView<'_>) -> Result<(), Error> {
        use GameState::{Finished, Initial, Playing, Ready, Set};
        if self.order.is_some() {
            return Err(refused("a GameController decides this match"));
        }
        let mut events = std::mem::take(&mut self.called);
        let state = self.state;
        let decided = match call {
            RefereeCall::Ready if state.may_become(Ready) => {
                self.change_state(Ready, &mut events);
                Ok(())
            }
            RefereeCall::Set if state.may_become(Set) => {
                self.change_state(Set, &mut events);
                Ok(())
            }
            RefereeCall::Play if state.may_become(Playing) => {
                self.change_state(Playing, &mut events);
                events.push(EventKind::KickOff { team: self.kick_off });
                Ok(())
            }
            RefereeCall::EndHalf if state != Initial && state != Finished => {
                self.end_half(&mut events);
                Ok(())
            }
            RefereeCall::Stop if !self.is_stopped && state != Finished => {
                self.is_stopped = true;
                Ok(())
            }
            RefereeCall::Resume if self.is_stopped => {
                self.is_stopped = false;
                Ok(())
            }
            RefereeCall::DropBall if state == Playing => {
                self.drop_ball(scene, &mut events);
                Ok(())
            }
            RefereeCall::Penalize(robot) => self.penalize(robot, &mut events),
            RefereeCall::Return(robot) if self.penalty(robot).is_some() => {
                self.lift_penalty(robot, &mut events);
                Ok(())
            }
            RefereeCall::Return(_) => Err(refused("the robot serves no penalty")),
            _ => Err(refused(&format!("{call:?} cannot follow {state:?}").to_lowercase())),
        };
        self.called = events;
        decided
    }

    fn penalize(&mut self, robot: usize, events: &mut Vec<EventKind>) -> Result<(), Error> {
        let remaining = self.rules.penalty_duration;
        let offence = Offence::Announced;
        match self.penalties.get_mut(robot) {
            None => Err(refused("there is no such robot")),
            Some(Some(_)) => Err(refused("the robot serves a penalty already")),
            Some(penalty) => {
                *penalty = Some(Penalty { offence, remaining });
                events.push(EventKind::Penalty { robot, offence });
                Ok(())
            }
        }
    }
}

fn refused(reason: &str) -> Error {
    Error::new(ErrorKind::IllegalCall, reason)
}
