//! Parameters of the radio between the robots of a team.

use crate::parameters::parameters;
use crate::{Error, ErrorKind};

parameters! {
    /// The losses and delays of the radio, and the messages that a team may send. The defaults are
    /// an ideal radio with the limits of the league.
    pub struct Radio {
        /// Probability that a receiver misses a message (an ideal radio; crowded halls lose up to a
        /// half).
        loss: "1" = 0.0 in 0.0 to 1.0;
        /// Time from sending to the earliest reception (an ideal radio).
        delay: "s" = 0.0 in 0.0 to 60.0;
        /// The most by which a message is later than that, equally distributed; messages that are
        /// sent within this time may arrive in another order (an ideal radio).
        delay_spread: "s" = 0.0 in 0.0 to 60.0;
        /// Probability that a received message arrives a second time (an ideal radio).
        duplication: "1" = 0.0 in 0.0 to 1.0;
        /// The longest message (the league's rules since 2024).
        longest_message: "bytes" = 512.0 in 1.0 to 65507.0;
        /// The messages that a team may send in a match; later ones are not carried (the league's
        /// rules since 2022).
        message_budget: "1" = 1200.0 in 0.0 to 1000000000.0;
    }
}

impl Radio {
    /// Checks ranges, and that lengths and numbers are whole.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::ErrorKind::OutOfRange) and
    /// [`Inconsistent`](crate::ErrorKind::Inconsistent).
    pub fn validate(&self) -> Result<(), Error> {
        self.check_ranges()?;
        let is_whole = |value: f64| value == libm::floor(value);
        if !is_whole(self.longest_message) || !is_whole(self.message_budget) {
            let message = "the longest message and the budget of messages are whole numbers";
            return Err(Error::new(ErrorKind::Inconsistent, message));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_holds_and_half_a_message_does_not() {
        assert!(Radio::default().validate().is_ok());
        assert!(Radio { message_budget: 0.5, ..Radio::default() }.validate().is_err());
    }
}
