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

pub mod dice;
#[cfg(doctest)]
mod readmes;
mod row;
mod season;

pub use row::{MatchRow, play};
pub use season::{SEASON_LENGTH, SEASON_SEEDS, SHORT_LENGTH, SHORT_SEEDS, SeasonTable, season, short_rows};

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

/// Every variant.
pub const VARIANTS: [Variant; 4] = [MATCH, STANDING, DICE, NO_GOALIE];

/// The root of the project.
pub fn root() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
