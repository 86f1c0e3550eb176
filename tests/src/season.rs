//! A season: every variant with many seeds, and bounds on the figures.

use std::fmt::Write as _;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::Duration;

use crate::{DICE, MATCH, MatchRow, NO_GOALIE, STANDING, VARIANTS, Variant, play};

/// The length of a match of the season.
pub const SEASON_LENGTH: Duration = Duration::from_secs(600);
/// The seeds of the season's matches.
pub const SEASON_SEEDS: std::ops::RangeInclusive<u64> = 1..=20;
/// The length of the short matches in the tests.
pub const SHORT_LENGTH: Duration = Duration::from_secs(120);
/// The seeds of the short matches.
pub const SHORT_SEEDS: std::ops::RangeInclusive<u64> = 1..=2;

/// The rows of a season.
#[derive(Clone, PartialEq, Debug)]
pub struct SeasonTable {
    rows: Vec<MatchRow>,
}

/// Plays every variant with every seed, two at a time.
///
/// # Errors
/// The diagnostics of the files of the season, or the failure.
pub fn season(report: impl Fn(&MatchRow) + Sync) -> Result<SeasonTable, String> {
    let games: Vec<(Variant, u64)> =
        VARIANTS.iter().flat_map(|variant| SEASON_SEEDS.map(move |seed| (*variant, seed))).collect();
    let next = Mutex::new(games.iter().enumerate());
    let results = Mutex::new(vec![Err(String::from("not played")); games.len()]);
    let play_on = || loop {
        let game = next.lock().unwrap_or_else(PoisonError::into_inner).next();
        let Some((index, (variant, seed))) = game else { return };
        let row = play(variant, *seed, SEASON_LENGTH);
        row.iter().for_each(&report);
        results.lock().unwrap_or_else(PoisonError::into_inner)[index] = row;
    };
    std::thread::scope(|scope| {
        let other = scope.spawn(play_on);
        play_on();
        // A panic of the other thread shows as matches that were not played.
        let _ = other.join();
    });
    let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(SeasonTable { rows: results.into_iter().collect::<Result<_, _>>()? })
}

/// The rows of the short matches, as text.
///
/// # Errors
/// The diagnostics of the files of the match, or the failure.
pub fn short_rows() -> Result<String, String> {
    let mut text = format!("{}\n", MatchRow::HEADER);
    for seed in SHORT_SEEDS {
        let _ = writeln!(text, "{}", play(&MATCH, seed, SHORT_LENGTH)?);
    }
    Ok(text)
}

/// A figure of a season and its bound.
struct FigureCheck {
    what: &'static str,
    value: f64,
    bound: f64,
    /// Whether the bound is a minimum, else a maximum.
    at_least: bool,
}

impl FigureCheck {
    fn holds(&self) -> bool {
        if self.at_least { self.value >= self.bound } else { self.value <= self.bound }
    }
}

impl SeasonTable {
    /// The rows and the verdicts as text.
    pub fn text(&self) -> String {
        let mut text = String::from("# What every seed comes to: 600 s a match, blue first.\n");
        let _ = writeln!(text, "{}", MatchRow::HEADER);
        self.rows.iter().for_each(|row| {
            let _ = writeln!(text, "{row}");
        });
        let _ = writeln!(text, "\n# Means over the seeds, and what they must come to.");
        for FigureCheck { what, value, bound, at_least } in self.verdicts() {
            let relation = if at_least { ">=" } else { "<=" };
            let _ = writeln!(text, "{what:<66} {value:>7.2} {relation} {bound:.2}");
        }
        text
    }

    /// The figures that violate their bounds.
    pub fn failures(&self) -> Vec<String> {
        let broken = |verdict: &FigureCheck| !verdict.holds();
        self.verdicts().iter().filter(|v| broken(v)).map(|v| format!("{}: {:.2}", v.what, v.value)).collect()
    }

    fn verdicts(&self) -> Vec<FigureCheck> {
        let at_least = |what, value, bound| FigureCheck { what, value, bound, at_least: true };
        let at_most = |what, value, bound| FigureCheck { what, value, bound, at_least: false };
        let standing = self.mean(&STANDING, |row| row.goals[0].into());
        let conceded = self.mean(&MATCH, |row| row.goals[1].into());
        let unguarded = self.mean(&NO_GOALIE, |row| row.goals[1].into());
        let actions = self.sum(&MATCH, |row| row.actions[0].into());
        let to_ball = self.sum(&MATCH, |row| row.actions[1].into());
        let returns = self.sum(&MATCH, |row| row.returns.0.into());
        let return_time = self.sum(&MATCH, |row| row.returns.1) / returns.max(1.0);
        vec![
            at_least(
                "goals of both teams in a match",
                self.mean(&MATCH, |row| f64::from(row.goals[0] + row.goals[1])),
                2.0,
            ),
            at_least("goals against a team that stands still", standing, 5.0),
            at_most(
                "the same by a team that decides by dice, as a part of that",
                self.mean(&DICE, |row| row.goals[0].into()) / standing.max(1e-9),
                0.5,
            ),
            at_least(
                "goals conceded without a goalie, as a multiple of those with one",
                unguarded / conceded.max(1e-9),
                1.5,
            ),
            at_least("part of dives and falls that go to the ball's side", to_ball / actions.max(1.0), 0.9),
            at_least(
                "part of dives and falls after which the goalie came back",
                returns / actions.max(1.0),
                0.8,
            ),
            at_most("seconds until the goalie is back between its posts", return_time, 15.0),
            at_most(
                "seconds to the first touch of the ball",
                self.mean(&MATCH, |row| row.first_touch.unwrap_or(600.0)),
                20.0,
            ),
        ]
    }

    fn of(&self, variant: &Variant) -> impl Iterator<Item = &MatchRow> {
        let name = variant.name;
        self.rows.iter().filter(move |row| row.variant == name)
    }

    fn sum(&self, variant: &Variant, figure: impl Fn(&MatchRow) -> f64) -> f64 {
        self.of(variant).map(figure).sum()
    }

    fn mean(&self, variant: &Variant, figure: impl Fn(&MatchRow) -> f64) -> f64 {
        self.sum(variant, figure) / (self.of(variant).count().max(1) as f64)
    }
}
