//! A season: every variant with many seeds, and bounds on the figures.

use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::Duration;

use crate::{
    ATTACK, ATTACK_LOSS20, ATTACK_LOSS50, ATTACK_RED, ATTACK_RED_LOSS20, ATTACK_RED_LOSS50, ATTACK_STANDING,
    DICE, Kidnappings, MATCH, MatchRow, NO_GOALIE, PassCounts, PoseErrors, STANDING, VARIANTS, Variant,
    kidnap, play, pose_errors, quantile, root,
};

/// The length of a match of the season.
pub const SEASON_LENGTH: Duration = Duration::from_secs(600);
/// The seeds of the season's matches.
pub const SEASON_SEEDS: RangeInclusive<u64> = 1..=20;
/// The length of the short matches in the tests.
pub const SHORT_LENGTH: Duration = Duration::from_secs(120);
/// The seeds of the short matches.
pub const SHORT_SEEDS: RangeInclusive<u64> = 1..=2;

/// The seeds of the matches whose poses are compared with the truth.
const POSE_SEEDS: RangeInclusive<u64> = 1..=4;
/// The time that counts for a robot that did not find itself, seconds.
const NOT_FOUND: f64 = 30.0;

/// The rows of a season, and how well its robots know where they are.
#[derive(Clone, PartialEq, Debug)]
pub struct SeasonTable {
    rows: Vec<MatchRow>,
    poses: Option<SeasonPoses>,
}

/// The poses of robots compared with the truth.
#[derive(Clone, PartialEq, Debug, Default)]
struct SeasonPoses {
    errors: PoseErrors,
    kidnappings: Kidnappings,
}

/// Plays every variant with every seed, two at a time, and then the matches whose poses are
/// compared.
///
/// # Errors
/// The diagnostics of the files of the season, or the failure.
pub fn season(report: impl Fn(&MatchRow) + Sync) -> Result<SeasonTable, String> {
    let table = SeasonTable::play(&VARIANTS, SEASON_SEEDS, SEASON_LENGTH, report)?;
    let seeds: Vec<u64> = POSE_SEEDS.collect();
    let halves = seeds.split_at(seeds.len() / 2);
    let (first, second) = std::thread::scope(|threads| {
        let other = threads.spawn(|| SeasonPoses::of(halves.1));
        (SeasonPoses::of(halves.0), other.join())
    });
    let mut poses = first?;
    poses.append(second.map_err(|_| "a match with kidnapped robots panicked")??);
    Ok(SeasonTable { poses: Some(poses), ..table })
}

/// Plays a season and compares it with its golden table; returns its text.
///
/// # Errors
/// The first line that differs, the figures that violate their bounds, or why it cannot be played.
pub fn check_season(report: impl Fn(&MatchRow) + Sync) -> Result<String, String> {
    let path = root().join("tests/golden/season.txt");
    let golden = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let text = season(report)?.checked_text()?;
    let differs = |(now, before): &(&str, &str)| now != before;
    match text.lines().zip(golden.lines()).find(differs) {
        Some((now, before)) => Err(format!("the season differs:\n  was {before}\n  is  {now}")),
        None if text.len() != golden.len() => {
            Err("the season has more or fewer lines than its golden table".into())
        }
        None => Ok(text),
    }
}

fn play_all(
    variants: &[Variant],
    seeds: RangeInclusive<u64>,
    length: Duration,
    report: impl Fn(&MatchRow) + Sync,
) -> Result<SeasonTable, String> {
    let games: Vec<(Variant, u64)> =
        variants.iter().flat_map(|variant| seeds.clone().map(move |seed| (*variant, seed))).collect();
    let next = Mutex::new(games.iter().enumerate());
    let results = Mutex::new(vec![Err(String::from("not played")); games.len()]);
    let play_on = || loop {
        let game = next.lock().unwrap_or_else(PoisonError::into_inner).next();
        let Some((index, (variant, seed))) = game else { return };
        let row = play(variant, *seed, length);
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
    Ok(SeasonTable { rows: results.into_iter().collect::<Result<_, _>>()?, poses: None })
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

impl SeasonPoses {
    /// Plays the matches with these seeds.
    fn of(seeds: &[u64]) -> Result<SeasonPoses, String> {
        let mut poses = SeasonPoses::default();
        for &seed in seeds {
            let errors = pose_errors(&MATCH, seed, SEASON_LENGTH)?;
            poses.append(SeasonPoses { errors, kidnappings: kidnap(&MATCH, seed, SEASON_LENGTH)? });
        }
        Ok(poses)
    }

    fn append(&mut self, other: SeasonPoses) {
        self.errors.distances.extend(other.errors.distances);
        self.errors.turns.extend(other.errors.turns);
        self.kidnappings.recoveries.extend(other.kidnappings.recoveries);
        self.kidnappings.lost += other.kidnappings.lost;
    }

    fn verdicts(&self) -> Vec<FigureCheck> {
        let at_most = |what, value: Option<f64>, bound| {
            // Without a value the bound does not hold.
            FigureCheck { what, value: value.unwrap_or(f64::INFINITY), bound, at_least: false }
        };
        let mut recoveries = self.kidnappings.recoveries.clone();
        recoveries.resize(recoveries.len() + self.kidnappings.lost, NOT_FOUND);
        vec![
            at_most("pose error: metres, 95 % of the time", quantile(&self.errors.distances, 0.95), 0.25),
            at_most("pose error: radians, 95 % of the time", quantile(&self.errors.turns, 0.95), 0.25),
            at_most("recovery: seconds, nine of ten kidnapped robots", quantile(&recoveries, 0.9), 10.0),
        ]
    }
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
    /// Plays variants with every seed, two at a time.
    ///
    /// # Errors
    /// The diagnostics of the files of the matches, or the failure.
    pub fn play(
        variants: &[Variant],
        seeds: RangeInclusive<u64>,
        length: Duration,
        report: impl Fn(&MatchRow) + Sync,
    ) -> Result<SeasonTable, String> {
        play_all(variants, seeds, length, report)
    }

    /// The sums of a variant over its seeds.
    pub fn sums(&self, variant: &Variant) -> String {
        let both = |figure: fn(&MatchRow) -> [u32; 2]| {
            let sum = |team: usize| self.sum(variant, |row| f64::from(figure(row)[team]));
            format!("{}:{}", sum(0), sum(1))
        };
        let passes = |figure: fn(&PassCounts) -> u32| {
            let sum = |team: usize| self.sum(variant, |row| f64::from(figure(&row.team_play.passes[team])));
            format!("{}:{}", sum(0), sum(1))
        };
        let kept = self.sum(variant, |row| row.team_play.kick_offs_kept.into());
        let kick_offs = self.sum(variant, |row| row.team_play.kick_offs.into());
        format!(
            "goals {}, kicks {}, shots {}, falls {}; passes attempted {}, completed {}, shots after them {}; \
             kick-offs kept {kept} of {kick_offs}; ball rolls {:.0} %, robots crowd {:.0} %",
            both(|row| row.goals),
            both(|row| row.kicks),
            both(|row| row.shots),
            both(|row| row.falls),
            passes(|it| it.attempts),
            passes(|it| it.completed),
            passes(|it| it.shots),
            self.mean(variant, |row| row.team_play.rolling * 100.0),
            self.mean(variant, |row| row.team_play.crowded * 100.0),
        )
    }

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
        if let Some(SeasonPoses { errors, kidnappings }) = &self.poses {
            let (compared, found) = (errors.distances.len(), kidnappings.recoveries.len());
            let _ = writeln!(
                text,
                "\n# Poses compared: {compared}. Robots carried away: {}, of which {} were lost for 30 s.",
                found + kidnappings.lost,
                kidnappings.lost
            );
        }
        text
    }

    /// The text of a season whose figures are all within their bounds.
    ///
    /// # Errors
    /// The text, and the figures that violate their bounds.
    pub fn checked_text(&self) -> Result<String, String> {
        let (text, failures) = (self.text(), self.failures());
        match failures.is_empty() {
            true => Ok(text),
            false => Err(format!("{text}\nnot what it must come to:\n{}", failures.join("\n"))),
        }
    }

    /// The figures that violate their bounds.
    pub fn failures(&self) -> Vec<String> {
        let broken = |verdict: &FigureCheck| !verdict.holds();
        self.verdicts().iter().filter(|v| broken(v)).map(|v| format!("{}: {:.2}", v.what, v.value)).collect()
    }

    fn verdicts(&self) -> Vec<FigureCheck> {
        let mut verdicts = self.play_verdicts();
        verdicts.extend(self.poses.iter().flat_map(SeasonPoses::verdicts));
        verdicts
    }

    fn play_verdicts(&self) -> Vec<FigureCheck> {
        let at_least = |what, value, bound| FigureCheck { what, value, bound, at_least: true };
        let at_most = |what, value, bound| FigureCheck { what, value, bound, at_least: false };
        let standing = self.mean(&STANDING, |row| row.goals[0].into());
        let conceded = self.mean(&MATCH, |row| row.goals[1].into());
        let unguarded = self.mean(&NO_GOALIE, |row| row.goals[1].into());
        let actions = self.sum(&MATCH, |row| row.actions[0].into());
        let to_ball = self.sum(&MATCH, |row| row.actions[1].into());
        let returns = self.sum(&MATCH, |row| row.returns.0.into());
        let return_time = self.sum(&MATCH, |row| row.returns.1) / returns.max(1.0);
        let with_pass = |variant: &Variant, team: usize| {
            self.of(variant).filter(|row| row.team_play.passes[team].completed > 0).count() as f64
        };
        let shots =
            |variant: &Variant, team: usize| self.sum(variant, |row| row.team_play.passes[team].shots.into());
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
            at_least(
                "part of kick-offs after which the team that took it was the first to kick",
                self.sum(&MATCH, |row| row.team_play.kick_offs_kept.into())
                    / self.sum(&MATCH, |row| row.team_play.kick_offs.into()).max(1.0),
                0.5,
            ),
            at_most(
                "part of the time in which two robots crowd",
                self.mean(&MATCH, |row| row.team_play.crowded),
                0.4,
            ),
            at_least(
                "part of the goals that extended attackers score against plain ones",
                self.share(&ATTACK, &ATTACK_RED),
                0.55,
            ),
            at_least(
                "matches of 40 in which extended attackers completed a pass",
                with_pass(&ATTACK, 0) + with_pass(&ATTACK_RED, 1),
                30.0,
            ),
            at_least("shots after these passes", shots(&ATTACK, 0) + shots(&ATTACK_RED, 1), 10.0),
            at_least(
                "goals of extended attackers against a team that stands still, as a part of plain ones'",
                self.mean(&ATTACK_STANDING, |row| row.goals[0].into()) / standing.max(1e-9),
                1.0,
            ),
            at_least(
                "part of the goals of extended attackers, with 20 % of the messages lost",
                self.share(&ATTACK_LOSS20, &ATTACK_RED_LOSS20),
                0.5,
            ),
            at_least(
                "part of the goals of extended attackers, with 50 % of the messages lost",
                self.share(&ATTACK_LOSS50, &ATTACK_RED_LOSS50),
                0.45,
            ),
        ]
    }

    /// The part of the goals that fall for a team which plays blue in one variant and red in
    /// another.
    fn share(&self, blue: &Variant, red: &Variant) -> f64 {
        let goals = |variant, team: usize| self.sum(variant, |row| f64::from(row.goals[team]));
        let own = goals(blue, 0) + goals(red, 1);
        own / (own + goals(blue, 1) + goals(red, 0)).max(1.0)
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
