//! Whole matches in simulated time, compared with golden files.
//!
//! A [`Variant`] is a match file with a name; [`play`] plays it with a seed and returns a
//! [`MatchRow`] of figures. [`season`] plays many of them and returns the [`SeasonTable`] of
//! `golden/season.txt`: `cargo xtask season` updates it, `cargo xtask season --check` compares it.
//! Since a match depends only on its files and its seed, equality is exact.
//!
//! ```no_run
//! let row = monas_tests::play(&monas_tests::MATCH, 7, std::time::Duration::from_secs(120))?;
//! println!("{row}");
//! # Ok::<(), String>(())
//! ```

mod ball_knowledge;
pub mod dice;
mod localisation;
#[cfg(doctest)]
mod readmes;
mod row;
mod season;
mod team_play;

pub use ball_knowledge::{BallKnowledge, TODAY};
pub use localisation::{Kidnappings, PoseErrors, kidnap, pose_errors, quantile};
pub use row::{MatchRow, play};
pub use season::{
    SEASON_LENGTH, SEASON_SEEDS, SHORT_LENGTH, SHORT_SEEDS, SeasonTable, check_season, season, short_rows,
};
pub use team_play::{PassCounts, StateTime, TeamPlay, TeamPlayObserver};

/// A match file of the season.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Variant {
    /// Its name in tables.
    pub name: &'static str,
    /// Its file, from the root of the project.
    pub file: &'static str,
}

/// The match of the quick start.
pub const MATCH: Variant = Variant { name: "match", file: "config/match.xml" };
/// Red stands still.
pub const STANDING: Variant = Variant { name: "standing", file: "tests/season/standing.xml" };
/// Red stands still, and blue's attackers decide by dice.
pub const DICE: Variant = Variant { name: "dice", file: "tests/season/dice.xml" };
/// Blue has no goalie.
pub const NO_GOALIE: Variant = Variant { name: "no_goalie", file: "tests/season/no_goalie.xml" };
/// Blue's field players execute the attack protocol.
pub const ATTACK: Variant = Variant { name: "attack", file: "config/match_attack.xml" };
/// Red's field players execute the attack protocol.
pub const ATTACK_RED: Variant = Variant { name: "attack_red", file: "tests/season/attack_red.xml" };
/// Blue's field players execute the attack protocol, and red stands still.
pub const ATTACK_STANDING: Variant =
    Variant { name: "attack_standing", file: "tests/season/attack_standing.xml" };

/// As [`ATTACK`], with a radio that loses 20 % of the messages.
pub const ATTACK_LOSS20: Variant =
    Variant { name: "attack_loss20", file: "tests/season/attack_loss20_blue.xml" };
/// As [`ATTACK_RED`], with a radio that loses 20 % of the messages.
pub const ATTACK_RED_LOSS20: Variant =
    Variant { name: "attack_red_loss20", file: "tests/season/attack_loss20_red.xml" };
/// As [`ATTACK`], with a radio that loses 50 % of the messages.
pub const ATTACK_LOSS50: Variant =
    Variant { name: "attack_loss50", file: "tests/season/attack_loss50_blue.xml" };
/// As [`ATTACK_RED`], with a radio that loses 50 % of the messages.
pub const ATTACK_RED_LOSS50: Variant =
    Variant { name: "attack_red_loss50", file: "tests/season/attack_loss50_red.xml" };

/// As [`MATCH`], with cameras without latency and errors of interpretation.
pub const IDEAL: Variant = Variant { name: "ideal", file: "tests/season/ideal.xml" };
/// As [`STANDING`], with cameras without latency and errors of interpretation.
pub const IDEAL_STANDING: Variant =
    Variant { name: "ideal_standing", file: "tests/season/ideal_standing.xml" };
/// As [`ATTACK`], with cameras without latency and errors of interpretation.
pub const IDEAL_ATTACK: Variant = Variant { name: "ideal_attack", file: "tests/season/ideal_attack.xml" };

/// The variants that are not part of the season.
pub const OTHER_VARIANTS: [Variant; 3] = [IDEAL, IDEAL_STANDING, IDEAL_ATTACK];

/// Every variant of the season.
pub const VARIANTS: [Variant; 11] = [
    MATCH,
    STANDING,
    DICE,
    NO_GOALIE,
    ATTACK,
    ATTACK_RED,
    ATTACK_STANDING,
    ATTACK_LOSS20,
    ATTACK_RED_LOSS20,
    ATTACK_LOSS50,
    ATTACK_RED_LOSS50,
];

/// The root of the project.
pub fn root() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
