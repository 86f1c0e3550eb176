//! Random decisions as a baseline.

use monas::{Activity, Blackboard, BoxError, Progress};
use rand_core::Rng;

narukom::include_messages!("monas.season");

narukom::topic! {
    /// The current values of the dice.
    pub DICE: narukom::State<Dice> = "season/dice";
}

/// Throws the dice.
#[derive(Default)]
struct Throw;

impl Activity for Throw {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let number = blackboard.random().next_u32();
        // Bits of one random number for dice of two, three and four faces.
        let (two, three, four) = ((number >> 4) % 2, (number >> 8) % 3, (number >> 28) % 4);
        blackboard.publish(DICE, Dice { two, three, four })?;
        Ok(Progress::Done)
    }
}

monas::activity!(Throw as "Dice");
