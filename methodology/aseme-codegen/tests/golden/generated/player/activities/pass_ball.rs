//! The activity `passBall`.
//!
//! Its variables in the model:
//!
//! - `mate`: `team.State.Mate`
//! - `ball`: `ball.State.Ball`
//! - `game`: `game_state.State.GameState`

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use soccer::topics::{BALL, GAME_STATE};

/// To be implemented.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassBall;

impl Activity for PassBall {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(BALL).reads(GAME_STATE)
    }
}

monas::activity!(PassBall as "passBall");
