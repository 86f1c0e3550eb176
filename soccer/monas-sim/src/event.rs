//! The events of a match, shared by referee, statistics and commentary.

use crate::{GameState, Offence, Side, Vector};

/// An event. Teams and robots are indices into those of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulationEvent {
    /// Time since the world began, s.
    pub time: f64,
    /// Its kind.
    pub kind: EventKind,
}

/// The kind of an event.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// The state of the game changed; in READY robots and ball are placed for a kick-off.
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
        /// Whether the foot hit the ball.
        struck: bool,
    },
    /// A kick whose line crosses the mouth of the opponents' goal.
    Shot {
        /// The robot that kicked.
        robot: usize,
    },
    /// A ball that a robot kicked is touched next by a team mate.
    Pass {
        /// The robot that kicked.
        from: usize,
        /// The robot that received it.
        to: usize,
        /// Time since the kick, s.
        after: f64,
        /// Distance from the place of the kick, m.
        length: f64,
    },
    /// The shot that was just reported was made by a robot that had received a pass.
    ShotAfterPass {
        /// The robot that shot.
        robot: usize,
    },
    /// A shot that the goalie touched and that is not a goal.
    Save {
        /// The goalie.
        robot: usize,
    },
    /// A goal.
    Goal {
        /// The team that it counts for.
        team: usize,
        /// The robot whose shot it was, else the one that touched the ball last; none if no robot
        /// touched it.
        robot: Option<usize>,
        /// Whether that robot belongs to the other team.
        own_goal: bool,
    },
    /// A robot loses balance.
    Fall {
        /// The robot.
        robot: usize,
    },
    /// A robot intentionally dives or falls to a side.
    Act {
        /// The robot.
        robot: usize,
        /// The side.
        side: Side,
        /// True for a dive, false for a fall from the knees.
        dive: bool,
        /// Whether it is the side on which the ball would pass or, if it does not approach, lies.
        to_ball: bool,
    },
    /// A goalie is upright between its posts again after a dive or fall.
    GoalieBack {
        /// The goalie.
        robot: usize,
        /// Time since the dive or fall, s.
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
        /// Its new position, in the field frame.
        position: Vector,
    },
    /// No robot touched the ball for long, so the referee drops it.
    DropBall {
        /// Its position, in the field frame.
        position: Vector,
    },
}
