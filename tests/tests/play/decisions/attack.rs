//! Tests of the attack protocol in matches: two field players of a team engage in it according to
//! its rules, and leave it by each of its outcomes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use monas::MicroStep;
use monas_match::{MatchOptions, MatchSource};
use monas_tests::root;
use yase::{CompiledChart, NodeKind, Timestamp, TransitionId};

/// The names of the protocol's parts in the chart.
const PARTS: [&str; 2] = ["center", "center_for"];

/// A robot enters or leaves a part.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Turn {
    at: Timestamp,
    host: String,
    part: &'static str,
    /// The guard by which the part is left, empty if it is completed; none if the part is entered.
    left_by: Option<String>,
}

/// The meaning of a segment in the protocol: from a CONDITION into a part, or from a part to an
/// END.
fn turn(chart: &CompiledChart, segment: TransitionId) -> Option<(&'static str, Option<String>)> {
    let statechart = chart.statechart();
    let transition = statechart.transition(segment);
    let (source, target) = (statechart.node(transition.source), statechart.node(transition.target));
    let part = |name: &str| PARTS.into_iter().find(|part| *part == name);
    match (source.kind, target.kind) {
        (NodeKind::Condition, NodeKind::Or) => Some((part(&target.name)?, None)),
        (NodeKind::Or, NodeKind::End) => Some((part(&source.name)?, Some(transition.expression.to_string()))),
        _ => None,
    }
}

/// All turns of blue's field players in a match.
fn played(file: &str, seed: u64, seconds: u64) -> Vec<Turn> {
    let turns = Arc::new(Mutex::new(Vec::new()));
    let noted = turns.clone();
    let plan = MatchSource::load(root().join(file), &monas::Registry::linked()).unwrap();
    let plan = plan.listen(Box::new(move |step: MicroStep<'_>| {
        let selected = step.record.selected.iter().flat_map(|&compound| step.chart.segments(compound));
        for (part, left_by) in selected.filter_map(|segment| turn(step.chart, *segment)) {
            noted.lock().unwrap().push(Turn {
                at: step.record.time,
                host: step.host.to_owned(),
                part,
                left_by,
            });
        }
    }));
    let mut running = plan.start(MatchOptions { seed, record: None }).unwrap();
    running.advance(Duration::from_secs(seconds)).unwrap();
    drop(running);
    std::mem::take(&mut *turns.lock().unwrap())
}

#[test]
fn two_players_engage_in_the_protocol_and_leave_it_by_each_outcome() {
    let mut left: BTreeMap<String, usize> = BTreeMap::new();
    let (seeds, seconds) = if crate::is_long() { (1..=2, 600) } else { (3..=3, 150) };
    for seed in seeds {
        let turns = played("config/match_attack.xml", seed, seconds);
        for part in PARTS {
            assert!(
                turns.iter().any(|turn| turn.part == part && turn.left_by.is_none()),
                "{seed}: no robot is {part}"
            );
        }
        for by in turns.iter().filter_map(|turn| turn.left_by.clone()) {
            *left.entry(by).or_default() += 1;
        }
    }
    for outcome in ["[Attack.shot_at_goal]", "[Attack.opponent_has_ball]", "[Attack.ball_is_out]"] {
        assert!(left.contains_key(outcome), "no robot leaves by {outcome}: {left:?}");
    }
    println!("{left:?}");
}

#[test]
fn the_same_seed_gives_the_same_attacks() {
    let turns = played("config/match_attack.xml", 1, 90);
    assert!(!turns.is_empty());
    assert_eq!(played("config/match_attack.xml", 1, 90), turns);
}
