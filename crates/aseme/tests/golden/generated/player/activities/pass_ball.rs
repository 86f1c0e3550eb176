//! The activity `passBall`.
//!
//! What it is about, by the model:
//!
//! - `mate`: `team.State.Mate`

use monas::{Activity, Blackboard, BoxError, Progress};

/// Has nothing to do so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassBall;

impl Activity for PassBall {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }
}

monas::activity!(PassBall as "passBall");
