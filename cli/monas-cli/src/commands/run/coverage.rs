//! Coverage of states and transitions by role, over all robots that play it.

use std::io::{self, Write};

use monas::ChartCoverage;
use serde_json::{Value, json};
use yase::StateNames;

/// The coverage of each role, in order of first occurrence.
pub(crate) fn by_role(charts: &[ChartCoverage]) -> Vec<ChartCoverage> {
    let mut roles: Vec<ChartCoverage> = Vec::new();
    for chart in charts {
        match roles.iter_mut().find(|role| is_same(role, chart)) {
            Some(role) => role.add(chart),
            None => roles.push(chart.clone()),
        }
    }
    roles
}

/// Whether two agents run the same chart; charts with one name may differ.
fn is_same(a: &ChartCoverage, b: &ChartCoverage) -> bool {
    a.model == b.model
        && a.states.iter().map(|state| &state.path).eq(b.states.iter().map(|state| &state.path))
        && a.transitions.iter().map(|one| &one.name).eq(b.transitions.iter().map(|one| &one.name))
}

/// One line per role, and one for each element that was not covered.
pub(crate) fn write(out: &mut dyn Write, role: &ChartCoverage) -> io::Result<()> {
    let counts = RoleCounts::of(role);
    writeln!(
        out,
        "{}: {} of {} states were active, {} of {} transitions fired",
        role.model, counts.states_met, counts.states, counts.transitions_met, counts.transitions
    )?;
    let names = names(role);
    role.states_missed().try_for_each(|path| writeln!(out, "  never active: {}", names.short(path)))?;
    role.transitions_missed()
        .try_for_each(|name| writeln!(out, "  never fired: {}", names.short_transition(name)))
}

/// The short names of a role's states, by their paths, which are without the root.
fn names(role: &ChartCoverage) -> StateNames {
    let ends = role.transitions.iter().flat_map(|transition| transition.name.split(" -> "));
    let below_root = role.states.iter().map(|state| state.path.as_str()).chain(ends);
    let paths: Vec<String> = below_root.map(|path| format!("/{path}")).collect();
    StateNames::from_some(paths.iter().map(String::as_str))
}

/// A role's coverage as JSON.
pub(crate) fn object(role: &ChartCoverage) -> Value {
    let counts = RoleCounts::of(role);
    json!({
        "kind": "coverage",
        "model": role.model,
        "states": counts.states,
        "states_missed": role.states_missed().collect::<Vec<_>>(),
        "transitions": counts.transitions,
        "transitions_missed": role.transitions_missed().collect::<Vec<_>>(),
    })
}

/// Counts of a role; transitions that are marked as never firing are not counted.
struct RoleCounts {
    states: usize,
    states_met: usize,
    transitions: usize,
    transitions_met: usize,
}

impl RoleCounts {
    fn of(role: &ChartCoverage) -> RoleCounts {
        let states = role.states.len();
        let transitions = role.transitions.iter().filter(|transition| !transition.never).count();
        let states_met = states - role.states_missed().count();
        let transitions_met = transitions - role.transitions_missed().count();
        RoleCounts { states, states_met, transitions, transitions_met }
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
    fn programs_are_reported_what_was_missed() {
        let expected = json!({"kind": "coverage", "model": "goalie", "states": 2, "states_missed": ["state 1"],
            "transitions": 2, "transitions_missed": ["a -> 1"]});
        assert_eq!(object(&chart("goalie", [1, 0], [5, 0, 0])), expected);
    }
}
