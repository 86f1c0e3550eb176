//! Players as Monas agents, one an activity with a frequency of its own: all decisions are in one
//! activity, [`BehaviorGoalie`] or [`BehaviorPlayer`].

mod goalie;
mod player;

use monas::{Activity, Blackboard, BoxError};
use monas_soccer::activities::WalkToKickOff;
use monas_soccer::activities::motion_requests::request_stand;
use monas_soccer::{MotionPhase, PlayerState, topics};
use narukom::PublisherId;

pub use goalie::BehaviorGoalie;
pub use player::BehaviorPlayer;

/// The start of the robot and the messages used so far, for both behaviours.
#[derive(Clone, Copy, Debug, Default)]
struct StartUp {
    has_stood_up: bool,
    used_ball: Option<(PublisherId, u64)>,
    kick_off: WalkToKickOff,
}

impl StartUp {
    /// Whether the behaviour decides now: the robot has stood up, it plays, and the ball is news.
    /// In READY the robot walks to its place.
    fn is_ready(&mut self, blackboard: &mut Blackboard) -> Result<bool, BoxError> {
        if !self.has_stood_up {
            let phase = blackboard.read(topics::MOTION_STATE).map(|state| state.phase());
            if phase != Some(MotionPhase::Standing) {
                request_stand(blackboard)?;
                return Ok(false);
            }
            self.has_stood_up = true;
        }
        let state = blackboard.read(topics::GAME_STATE).map(|game| game.player_state());
        if state == Some(PlayerState::Ready) {
            _ = self.kick_off.execute(blackboard)?;
        }
        if state != Some(PlayerState::Playing) {
            return Ok(false);
        }
        let newest =
            blackboard.sample(topics::BALL).map(|ball| (ball.header.publisher, ball.header.sequence));
        let is_news = newest.is_some() && newest != self.used_ball;
        self.used_ball = newest;
        Ok(is_news)
    }
}

/// Whether a motion is under way that was requested under this number.
fn is_executing(blackboard: &Blackboard, number: Option<u64>) -> bool {
    let done = blackboard.read(topics::MOTION_STATE).map_or(0, |state| state.done);
    number.is_some_and(|number| done < number)
}

#[cfg(test)]
mod tests;
