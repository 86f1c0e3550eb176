//! The competition that a game belongs to, whose rule book determines the version of the packets.

use crate::RuleBook;
use crate::rule_book::codes;

codes! {
    /// The phase of a competition of the Standard Platform League.
    CompetitionPhase, "competition phase":
    /// Round robin.
    RoundRobin "round robin" Some(0), None;
    /// Play-off.
    PlayOff "play-off" Some(1), None;
}

codes! {
    /// The type of a competition of the Standard Platform League.
    CompetitionType, "competition type":
    /// A usual competition.
    Normal "normal" Some(0), None;
    /// The competition for the most passes.
    MostPasses "most passes" Some(1), None;
}

codes! {
    /// The size of robots in the Humanoid Soccer League.
    RobotSize, "competition type":
    /// Small.
    Small "small" None, Some(0);
    /// Middle.
    Middle "middle" None, Some(1);
    /// Large.
    Large "large" None, Some(2);
}

/// The competition, with what only its rule book has.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Competition {
    /// Standard Platform League.
    StandardPlatform {
        /// Round robin or play-off.
        phase: CompetitionPhase,
        /// The type of the competition.
        kind: CompetitionType,
    },
    /// Humanoid Soccer League.
    HumanoidSoccer {
        /// The size of the robots.
        size: RobotSize,
        /// Whether the referee has stopped the game: robots stand still.
        is_stopped: bool,
    },
}

impl Competition {
    /// A usual competition of a rule book.
    pub fn of(rules: RuleBook) -> Competition {
        match rules {
            RuleBook::StandardPlatform => Competition::StandardPlatform {
                phase: CompetitionPhase::RoundRobin,
                kind: CompetitionType::Normal,
            },
            RuleBook::HumanoidSoccer => {
                Competition::HumanoidSoccer { size: RobotSize::Small, is_stopped: false }
            }
        }
    }

    /// The rule book.
    pub fn rules(self) -> RuleBook {
        match self {
            Competition::StandardPlatform { .. } => RuleBook::StandardPlatform,
            Competition::HumanoidSoccer { .. } => RuleBook::HumanoidSoccer,
        }
    }

    /// Whether the referee has stopped the game.
    pub fn is_stopped(self) -> bool {
        matches!(self, Competition::HumanoidSoccer { is_stopped: true, .. })
    }
}

impl Default for Competition {
    fn default() -> Competition {
        Competition::of(RuleBook::StandardPlatform)
    }
}
