//! Penalties.

use crate::rule_book::codes;

codes! {
    /// Why a player is off the field. Number 0 of both rule books, no penalty, is not a value.
    Penalty, "penalty":
    /// Illegal contact with the ball, or holding it.
    BallHolding "ball holding" Some(1), Some(6);
    /// Pushing.
    Pushing "pushing" Some(2), Some(9);
    /// Motion in SET.
    MotionInSet "motion in set" Some(3), Some(2);
    /// Fallen or inactive (version 18).
    FallenOrInactive "fallen or inactive" Some(4), None;
    /// Incapable robot (version 19).
    IncapableRobot "incapable robot" None, Some(4);
    /// Illegal position.
    IllegalPosition "illegal position" Some(5), Some(1);
    /// Leaving the field.
    LeavingField "leaving the field" Some(6), Some(7);
    /// Request for pick-up.
    PickUp "pick-up" Some(7), Some(5);
    /// Local game stuck.
    LocalGameStuck "local game stuck" Some(8), Some(3);
    /// Illegal position in SET (version 18).
    IllegalPositionInSet "illegal position in set" Some(9), None;
    /// Stance of the player (version 18).
    PlayerStance "player stance" Some(10), None;
    /// Motion in STANDBY (version 18).
    MotionInStandby "motion in standby" Some(11), None;
    /// Playing with arms or hands (version 19).
    ArmsOrHands "playing with arms or hands" None, Some(8);
    /// Sent off (version 19).
    SentOff "sent off" None, Some(10);
    /// A substitute, which does not play.
    Substitute "substitute" Some(14), Some(11);
    /// Penalised by its team or by hand (version 18).
    Manual "manual" Some(15), None;
}
