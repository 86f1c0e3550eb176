//! Coverage of states and transitions by role, over all robots that play it.

use std::collections::BTreeSet;
use std::io::{self, Write};

use monas::ChartCoverage;
use serde_json::{Value, json};

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
    let paths = PathShortener::of(role);
    role.states_missed().try_for_each(|path| writeln!(out, "  never active: {}", paths.short(path)))?;
    role.transitions_missed()
        .try_for_each(|name| writeln!(out, "  never fired: {}", paths.short_transition(name)))
}

/// All paths in a role's chart, to find unambiguous short forms.
struct PathShortener<'a>(BTreeSet<&'a str>);

/// Separates source and target in a transition's name.
const ARROW: &str = " -> ";

impl<'a> PathShortener<'a> {
    fn of(role: &'a ChartCoverage) -> PathShortener<'a> {
        let ends = role.transitions.iter().flat_map(|transition| transition.name.split(ARROW));
        PathShortener(role.states.iter().map(|state| state.path.as_str()).chain(ends).collect())
    }

    /// The shortest unambiguous suffix of a path, in whole segments.
    fn short<'p>(&self, path: &'p str) -> &'p str {
        let starts = path.rmatch_indices('/').map(|(index, _)| index + 1);
        let mut ends = starts.map(|start| &path[start..]);
        ends.find(|end| self.0.iter().filter(|other| ends_with(other, end)).count() == 1).unwrap_or(path)
    }

    fn short_transition(&self, name: &str) -> String {
        name.split(ARROW).map(|path| self.short(path)).collect::<Vec<_>>().join(ARROW)
    }
}

fn ends_with(path: &str, end: &str) -> bool {
    path.strip_suffix(end).is_some_and(|before| before.is_empty() || before.ends_with('/'))
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
    fn paths_are_as_short_as_they_can_be() {
        let paths = PathShortener(["a/b/END", "a/c/END", "a/b", "a/b/kick", "d/c"].into());
        let short = ["a/b/END", "a/b/kick", "a/c/END", "d/c", "a/b"].map(|path| paths.short(path));
        assert_eq!(short, ["b/END", "kick", "c/END", "c", "b"]);
        assert_eq!(paths.short_transition("a/b/kick -> a/b/END"), "kick -> b/END");
    }

    #[test]
    fn missed_elements_are_printed_as_json() {
        let expected = json!({"kind": "coverage", "model": "goalie", "states": 2, "states_missed": ["state 1"],
            "transitions": 2, "transitions_missed": ["a -> 1"]});
        assert_eq!(object(&chart("goalie", [1, 0], [5, 0, 0])), expected);
    }
}
