//! Set plays.

use crate::rule_book::codes;

codes! {
    /// The restart of play. Number 0 of both rule books, no set play, is not a value.
    SetPlay, "set play":
    /// Goal kick.
    GoalKick "goal kick" Some(1), Some(5);
    /// Free kick for pushing (version 18).
    PushingFreeKick "pushing free kick" Some(2), None;
    /// Corner kick.
    CornerKick "corner kick" Some(3), Some(6);
    /// Kick-in (version 18).
    KickIn "kick-in" Some(4), None;
    /// Penalty kick.
    PenaltyKick "penalty kick" Some(5), Some(3);
    /// Direct free kick (version 19).
    DirectFreeKick "direct free kick" None, Some(1);
    /// Indirect free kick (version 19).
    IndirectFreeKick "indirect free kick" None, Some(2);
    /// Throw-in (version 19).
    ThrowIn "throw-in" None, Some(4);
}
