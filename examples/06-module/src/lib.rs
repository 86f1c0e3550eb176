//! A module that detects a ball two metres ahead, for a robot that was built without vision.
//!
//! This crate is a **module**: `monas::module!` in its root, and the crate type `cdylib`. It must
//! be built together with the program that loads it:
//!
//! ```sh
//! cargo build -p monas-cli -p example-module       # target/debug/monas, and target/debug/libeyes.so
//! target/debug/monas module show target/debug/libeyes.so
//! target/debug/monas run examples/06-module/robot.xml
//! ```
//!
//! and from another terminal, while the robot runs:
//!
//! ```sh
//! target/debug/monas module load target/debug/libeyes.so --agent Head
//! target/debug/monas topic echo soccer/ball --count 1
//! ```
//!
//! Now change `DISTANCE`, then `target/debug/monas module build eyes` and `target/debug/monas
//! module reload eyes`: the robot continues with the new module. If it is rejected, the robot
//! continues with the old one, and the reply states the reason.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress};
use monas_soccer::Ball;
use monas_soccer::topics::BALL;

monas::module!();

/// Distance of the ball, m.
const DISTANCE: f64 = 2.0;

/// Detects the ball within a range.
struct Eyes {
    /// Range, m.
    range: f64,
}

impl Default for Eyes {
    fn default() -> Eyes {
        Eyes { range: 4.0 }
    }
}

impl Activity for Eyes {
    fn configure(&mut self, parameters: &Parameters) {
        self.range = parameters.number("range").unwrap_or(4.0);
    }

    fn start(&mut self, _: &mut Blackboard) -> Result<(), BoxError> {
        tracing::info!(range = self.range, "eyes open");
        Ok(())
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let found = DISTANCE <= self.range;
        blackboard.publish(BALL, Ball { found, distance: DISTANCE, ..Ball::default() })?;
        Ok(Progress::ongoing())
    }
}

monas::activity!(Eyes);
