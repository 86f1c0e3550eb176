//! Parameters of the rules that the referee enforces.

use crate::parameters::parameters;
use crate::{Error, ErrorKind};

parameters! {
    /// Times and limits of the rules (SPL 2010 unless said otherwise).
    pub struct MatchRules {
        /// Length of a half. Its clock runs from INITIAL on and never stops, so a match of two
        /// halves takes exactly twice this time (600 s in the league; here 300 s).
        half_duration: "s" = 300.0 in 5.0 to 36000.0;
        /// Time in INITIAL before each half (chosen).
        initial_duration: "s" = 1.0 in 0.0 to 600.0;
        /// The most time in READY, in which robots walk to their places; at its end the referee
        /// places by hand those that stand where they must not.
        ready_duration: "s" = 45.0 in 0.0 to 600.0;
        /// Time without a moving robot after which the referee ends READY (chosen; in the league he
        /// ends it when there is no significant progress).
        ready_still: "s" = 3.0 in 0.0 to 600.0;
        /// Time in SET (chosen).
        set_duration: "s" = 2.0 in 0.0 to 600.0;
        /// Time a penalized robot stays off the field.
        penalty_duration: "s" = 30.0 in 0.0 to 600.0;
        /// Time a robot may press towards an opponent it touches.
        pushing_time: "s" = 3.0 in 0.1 to 600.0;
        /// Speed towards an opponent that counts as pressing (chosen).
        pushing_speed: "m/s" = 0.05 in 0.0 to 10.0;
        /// Time a robot may hold the ball.
        holding_time: "s" = 3.0 in 0.1 to 600.0;
        /// Time a goalie may hold the ball in its own goal area.
        goalie_holding_time: "s" = 10.0 in 0.1 to 600.0;
        /// Time a field player may be in its own goal area (chosen; long enough to be pushed
        /// through a corner).
        defender_time: "s" = 1.0 in 0.0 to 600.0;
        /// Time without a touch of the ball after which the referee drops it.
        stuck_time: "s" = 30.0 in 1.0 to 3600.0;
        /// How far a ball out of play is put back against the team that touched it last.
        throw_in_setback: "m" = 1.0 in 0.0 to 10.0;
        /// 1 when teams also change shirts at half time, so that blue always defends the blue goal;
        /// 0 when they keep them.
        switch_colours: "0 or 1" = 1.0 in 0.0 to 1.0;
    }
}

impl MatchRules {
    /// Whether the teams change shirts at half time.
    pub fn switches_colours(&self) -> bool {
        self.switch_colours >= 0.5
    }

    /// Checks ranges and that a half is longer than what precedes its play.
    ///
    /// # Errors
    /// [`OutOfRange`](crate::ErrorKind::OutOfRange) and
    /// [`Inconsistent`](crate::ErrorKind::Inconsistent).
    pub fn validate(&self) -> Result<(), Error> {
        self.check_ranges()?;
        let ready = self.ready_duration.min(self.ready_still);
        if self.initial_duration + ready + self.set_duration >= self.half_duration {
            return Err(Error::new(ErrorKind::Inconsistent, "a half ends before its play begins"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_holds_and_a_half_without_play_does_not() {
        assert!(MatchRules::default().validate().is_ok());
        assert!(MatchRules { half_duration: 6.0, ..MatchRules::default() }.validate().is_err());
    }
}
