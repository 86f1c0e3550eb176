//! The module `eyes` after a change: it detects the ball one metre ahead.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress};
use monas_soccer::Ball;
use monas_soccer::topics::BALL;

monas::module!(name = eyes);

#[derive(Default)]
struct Eyes {
    range: f64,
}

impl Activity for Eyes {
    fn configure(&mut self, parameters: &Parameters) {
        self.range = parameters.number("range").unwrap_or(4.0);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        tracing::warn!("sharp");
        blackboard.publish(BALL, Ball { found: 1.0 <= self.range, distance: 1.0, ..Ball::default() })?;
        Ok(Progress::ongoing())
    }
}

monas::activity!(Eyes);
