//! The module `eyes` after a faulty change: its constructor fails.

use monas::{Activity, Blackboard, BoxError, Progress};

monas::module!(name = eyes);

struct Eyes;

impl Default for Eyes {
    #[expect(clippy::panic, reason = "that is what is wrong with them")]
    fn default() -> Eyes {
        panic!("no lens")
    }
}

impl Activity for Eyes {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }
}

monas::activity!(Eyes);
