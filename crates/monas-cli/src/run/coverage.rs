//! Which states of each role were active and which of its transitions fired, over all the robots that play it.

use std::io::{self, Write};

use monas::ChartCoverage;
use serde_json::{Value, json};

/// The coverage of each role, in the order in which they were first met.
pub(super) fn by_role(charts: &[ChartCoverage]) -> Vec<ChartCoverage> {
    let mut roles: Vec<ChartCoverage> = Vec::new();
    for chart in charts {
        match roles.iter_mut().find(|role| role.model == chart.model) {
            Some(role) => role.add(chart),
            None => roles.push(chart.clone()),
        }
    }
    roles
}

/// One line for a role, and one for each thing that it missed.
pub(super) fn write(out: &mut dyn Write, role: &ChartCoverage) -> io::Result<()> {
    let counts = Counts::of(role);
    writeln!(
        out,
        "{}: {} of {} states were active, {} of {} transitions fired",
        role.model, counts.states_met, counts.states, counts.transitions_met, counts.transitions
    )?;
    role.states_missed().try_for_each(|path| writeln!(out, "  never active: {path}"))?;
    role.transitions_missed().try_for_each(|name| writeln!(out, "  never fired: {name}"))
}

/// A role's coverage for programs.
pub(super) fn object(role: &ChartCoverage) -> Value {
    let counts = Counts::of(role);
    json!({
        "kind": "coverage",
        "model": role.model,
        "states": counts.states,
        "states_missed": role.states_missed().collect::<Vec<_>>(),
        "transitions": counts.transitions,
        "transitions_missed": role.transitions_missed().collect::<Vec<_>>(),
    })
}

/// Transitions that are meant never to fire are not counted.
struct Counts {
    states: usize,
    states_met: usize,
    transitions: usize,
    transitions_met: usize,
}

impl Counts {
    fn of(role: &ChartCoverage) -> Counts {
        let states = role.states.len();
        let transitions = role.transitions.iter().filter(|transition| !transition.never).count();
        let states_met = states - role.states_missed().count();
        let transitions_met = transitions - role.transitions_missed().count();
        Counts { states, states_met, transitions, transitions_met }
    }
}

#[cfg(test)]
mod tests {
    use monas::{StateCoverage, TransitionCoverage};

    use super::*;

    fn chart(model: &str, entered: [u64; 2], fired: [u64; 3]) -> ChartCoverage {
        let state = |(index, entered)| StateCoverage { path: format!("state {index}"), entered };
        let transition =
            |(index, fired)| TransitionCoverage { name: format!("a -> {index}"), fired, never: index == 2 };
        ChartCoverage {
            model: model.into(),
            states: entered.into_iter().enumerate().map(state).collect(),
            transitions: fired.into_iter().enumerate().map(transition).collect(),
            ..ChartCoverage::default()
        }
    }

    #[test]
    fn robots_of_one_role_are_added_up() {
        let charts = [
            chart("goalie", [1, 0], [5, 0, 0]),
            chart("player", [1, 1], [1, 1, 0]),
            chart("goalie", [0, 0], [0, 0, 0]),
        ];
        let roles = by_role(&charts);
        let mut out = Vec::new();
        roles.iter().try_for_each(|role| write(&mut out, role)).unwrap();
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "goalie: 1 of 2 states were active, 1 of 2 transitions fired\n  never active: state 1\n  never fired: a -> 1\n\
             player: 2 of 2 states were active, 2 of 2 transitions fired\n"
        );
    }

    #[test]
    fn programs_are_told_what_was_missed() {
        let expected = json!({"kind": "coverage", "model": "goalie", "states": 2, "states_missed": ["state 1"],
            "transitions": 2, "transitions_missed": ["a -> 1"]});
        assert_eq!(object(&chart("goalie", [1, 0], [5, 0, 0])), expected);
    }
}
