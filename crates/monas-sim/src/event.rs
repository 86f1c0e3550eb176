//! What happens in a match, in words that the referee, the statistics and a commentator share.

use crate::{GameState, Offence, Side, Vector};

/// Something that happened. Teams and robots are indices into those of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Time since the world began, s.
    pub time: f64,
    /// What happened.
    pub kind: EventKind,
}

/// What happened.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// The game changed its state; in READY robots and ball are placed for a kick-off.
    StateChanged {
        /// The state before.
        from: GameState,
        /// The new state.
        to: GameState,
    },
    /// The second half begins, with sides switched.
    HalfTime,
    /// Play begins.
    KickOff {
        /// The team that may touch the ball first.
        team: usize,
    },
    /// A robot is the first to touch the ball after a kick-off.
    FirstTouch {
        /// The robot.
        robot: usize,
        /// Time since the kick-off, s.
        after: f64,
    },
    /// A robot's foot swings at the ball.
    Kick {
        /// The robot.
        robot: usize,
        /// The foot.
        foot: Side,
        /// Whether the ball was in reach and met.
        struck: bool,
    },
    /// A kick whose line meets the mouth of the opponents' goal.
    Shot {
        /// The robot that kicked.
        robot: usize,
    },
    /// A shot that the goalie touched and that is no goal.
    Save {
        /// The goalie.
        robot: usize,
    },
    /// A goal.
    Goal {
        /// The team that it counts for.
        team: usize,
        /// The robot whose shot it was, else the one that touched the ball last; none when nobody has touched it.
        robot: Option<usize>,
        /// Whether that robot is of the other team.
        own_goal: bool,
    },
    /// A robot loses balance.
    Fall {
        /// The robot.
        robot: usize,
    },
    /// A robot dives or falls to a side on purpose.
    Act {
        /// The robot.
        robot: usize,
        /// To which side.
        side: Side,
        /// A dive, else a fall from the knees.
        dive: bool,
        /// Whether it is the side on which the ball would pass or, of a ball that does not come, lies.
        to_ball: bool,
    },
    /// A goalie that acted is upright between its posts again.
    GoalieBack {
        /// The goalie.
        robot: usize,
        /// Time since it acted, s.
        after: f64,
    },
    /// The referee takes a robot off the field.
    Penalty {
        /// The robot.
        robot: usize,
        /// Why.
        offence: Offence,
    },
    /// A penalized robot comes back.
    Return {
        /// The robot.
        robot: usize,
    },
    /// The ball left the field and is put back.
    ThrowIn {
        /// The team that touched it last, if any has.
        against: Option<usize>,
        /// Where it is put, in the field frame.
        position: Vector,
    },
    /// Nobody touched the ball for long, so the referee drops it.
    DropBall {
        /// Where, in the field frame.
        position: Vector,
    },
}
