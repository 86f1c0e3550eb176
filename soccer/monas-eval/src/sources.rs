//! Measures of the code of each methodology, from the sources that this crate was built from.
//!
//! - **Lines**: lines with code. Blank lines, comments and tests do not count.
//! - **Unit**: a file of the behaviour, or an activity of the roles. Modules that all ways share
//!   are no unit: perception, the arbiter of motions, game state and LEDs.
//! - **State variables**: fields that a unit keeps from one decision to the next. Algorithms with
//!   their parameters are none.
//! - **Coupling**: the names that a unit imports. **Cohesion**: how many decisions (`if`, `match`,
//!   `&&`, `||`, `filter`, `is_some_and`) the unit with the most of them takes.

use crate::Methodology;

/// Counts of the sources of one methodology.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct SourceFigures {
    /// Lines written for the goalie's decisions: its unit, or its role.
    pub goalie_lines: usize,
    /// Lines written for the decisions of both players.
    pub written_lines: usize,
    /// Lines of the activities that only behaviours use.
    pub activity_lines: usize,
    /// Lines that are generated from the models.
    pub generated_lines: usize,
    /// State variables kept by hand.
    pub state_variables: usize,
    /// Names that a unit imports, in the mean.
    pub coupling: f64,
    /// Decisions of the unit with the most of them.
    pub decisions: usize,
}

macro_rules! texts {
    ($folder:literal: $($file:literal),* $(,)?) => { &[$(include_str!(concat!($folder, $file))),*] };
}

const DIRECT: &[&str] = texts!("direct/": "goalie.rs", "player.rs");
const DIRECT_SHARED: &str = include_str!("direct.rs");
const AGENTS: &[&str] = texts!("agents/": "goalie.rs", "player.rs");
const AGENTS_SHARED: &str = include_str!("agents.rs");
/// Counted for both methodologies that share them.
const THRESHOLDS: &[&str] = texts!("thresholds/": "goalie.rs", "player.rs");
const AGENT_FILES: &[&str] = texts!("../../../config/evaluation/": "goalie_agents.xml", "player_agents.xml");
const ROLES: &[&str] = texts!("../../../models/": "goalie.srm", "attacker.srm");
const ACTIVITIES: &[&str] = texts!(
    "../../monas-soccer/src/activities/":
    "align_with_ball.rs", "keep_goal.rs", "look_at_goal.rs", "search_ball.rs", "send_calibration.rs",
    "skills.rs", "stand.rs", "support_mate.rs", "track_ball.rs", "turn_around.rs",
    "wait_for_ball_message.rs", "walk_towards_ball.rs", "walk_towards_centre.rs",
);

/// The crates generated of the roles, which `monas generate` keeps in step.
const GENERATED: [&[&str]; 2] = [
    texts!(
        "../../../statecharts/goalie/src/":
        "activities.rs", "chart.rs", "guards.rs", "lib.rs", "states.rs", "transitions.rs", "words.rs",
    ),
    texts!(
        "../../../statecharts/attacker/src/":
        "activities.rs", "chart.rs", "guards.rs", "lib.rs", "states.rs", "transitions.rs", "words.rs",
    ),
];

/// Counts the sources of a methodology.
pub fn of(methodology: Methodology) -> SourceFigures {
    match methodology {
        // The loop takes the place of agents, so its lines count.
        Methodology::Direct => {
            with_thresholds(units(DIRECT, rust_lines(DIRECT_SHARED), state_variables(DIRECT_SHARED)))
        }
        Methodology::Agents => {
            let agents = AGENT_FILES.iter().map(|text| xml_lines(text)).sum::<usize>();
            with_thresholds(units(AGENTS, rust_lines(AGENTS_SHARED) + agents, state_variables(AGENTS_SHARED)))
        }
        Methodology::Aseme => {
            let lines: Vec<usize> = ROLES.iter().map(|text| model_lines(text)).collect();
            let activities = units(ACTIVITIES, 0, 0);
            SourceFigures {
                goalie_lines: lines.first().copied().unwrap_or_default(),
                written_lines: lines.iter().sum(),
                activity_lines: activities.written_lines,
                generated_lines: GENERATED.iter().copied().flatten().map(|text| rust_lines(text)).sum(),
                ..activities
            }
        }
    }
}

/// Counts units of which the first is the goalie; the others are added.
fn units(units: &[&str], shared_lines: usize, shared_state: usize) -> SourceFigures {
    let count = |of: fn(&str) -> usize| units.iter().map(|text| of(text)).sum::<usize>();
    SourceFigures {
        goalie_lines: units.first().map_or(0, |text| rust_lines(text)),
        written_lines: count(rust_lines) + shared_lines,
        activity_lines: 0,
        generated_lines: 0,
        state_variables: count(state_variables) + shared_state,
        coupling: count(imported_names) as f64 / units.len().max(1) as f64,
        decisions: units.iter().map(|text| decisions(text)).max().unwrap_or_default(),
    }
}

fn with_thresholds(figures: SourceFigures) -> SourceFigures {
    let lines = |texts: &[&str]| texts.iter().map(|text| rust_lines(text)).sum::<usize>();
    SourceFigures {
        goalie_lines: figures.goalie_lines + lines(&THRESHOLDS[..1]),
        written_lines: figures.written_lines + lines(THRESHOLDS),
        ..figures
    }
}

/// The lines of code before the tests.
fn code(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().map(str::trim).take_while(|line| *line != "#[cfg(test)]");
    lines.filter(|line| !line.is_empty() && !line.starts_with("//"))
}

fn rust_lines(text: &str) -> usize {
    code(text).count()
}

fn model_lines(text: &str) -> usize {
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')).count()
}

/// Comments of the files that are counted are one line or end with `-->`.
fn xml_lines(text: &str) -> usize {
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("<!--")).count()
}

/// The algorithms of the functionalities and the identity of a body are no state of a behaviour.
const ALGORITHMS: [&str; 9] = [
    "HeadController",
    "GoalPositioning",
    "Approach",
    "Alignment",
    "GameTracker",
    "PerceptionModel",
    "MotionArbiter",
    "StartUp",
    "Box<dyn Robot>",
];

/// Fields of structs with a type that is not an algorithm and no generic behaviour.
fn state_variables(text: &str) -> usize {
    let mut inside = false;
    let mut count = 0;
    for line in code(text) {
        if line.contains("struct ") && line.ends_with('{') {
            inside = true;
        } else if line == "}" {
            inside = false;
        } else if inside && let Some((_, kind)) = line.trim_end_matches(',').split_once(": ") {
            let kind = kind.trim();
            count += usize::from(!ALGORITHMS.contains(&kind) && kind != "B" && kind != "f64");
        }
    }
    count
}

/// The names after `use`, where a list counts each of its names.
fn imported_names(text: &str) -> usize {
    let code: Vec<&str> = code(text).collect();
    let joined = code.join(" ");
    let uses = joined.split("use ").skip(1).filter_map(|rest| rest.split_once(';').map(|(used, _)| used));
    uses.map(|used| used.split(',').filter(|name| name.chars().any(char::is_alphabetic)).count()).sum()
}

fn decisions(text: &str) -> usize {
    const WORDS: [&str; 6] = ["if ", "match ", " && ", " || ", ".filter(", ".is_some_and("];
    code(text).map(|line| WORDS.iter().map(|word| line.matches(word).count()).sum::<usize>()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_with_code_count() {
        assert_eq!(rust_lines("//! A page.\n\nfn one() {}\n// no\n#[cfg(test)]\nmod tests {}\n"), 1);
        assert_eq!(model_lines("# a\nRole: r\n\nr = A\n"), 2);
        assert_eq!(xml_lines("<!-- a -->\n<agents/>\n"), 1);
    }

    #[test]
    fn state_is_what_a_unit_keeps() {
        let text =
            "struct Goalie {\n    head: HeadController,\n    diving: Option<u64>,\n}\nfn f(a: u8) {\n}\n";
        assert_eq!(state_variables(text), 1);
        assert_eq!(imported_names("use a::{B, C};\nuse d::E;\n"), 3);
        assert_eq!(decisions("if a && b {\n} else if c {\n}\n"), 3);
    }

    #[test]
    fn the_goalie_by_aseme_takes_at_most_66_lines() {
        let goalie = of(Methodology::Aseme).goalie_lines;
        assert!((10..=66).contains(&goalie), "{goalie}");
    }
}
