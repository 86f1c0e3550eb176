//! States and phases of a game.

use crate::rule_book::codes;

codes! {
    /// The state of the game.
    LeagueState, "state":
    /// Robots are switched on and wait.
    Initial "initial" Some(0), Some(0);
    /// Robots walk to their positions.
    Ready "ready" Some(1), Some(1);
    /// Robots wait for the kick-off.
    Set "set" Some(2), Some(2);
    /// The ball is in play.
    Playing "playing" Some(3), Some(3);
    /// The half is over.
    Finished "finished" Some(4), Some(4);
    /// Robots stand and wait for the referee's gesture (version 18).
    Standby "standby" Some(5), None;
}

codes! {
    /// The phase of the game.
    LeaguePhase, "game phase":
    /// One of the two halves.
    Normal "normal" Some(0), Some(0);
    /// Penalty shoot-out.
    PenaltyShootOut "penalty shoot-out" Some(1), Some(1);
    /// Extra time, or overtime.
    ExtraTime "extra time" Some(2), Some(2);
    /// A timeout, in which the state is INITIAL.
    Timeout "timeout" Some(3), Some(3);
}
