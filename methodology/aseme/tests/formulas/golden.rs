//! The charts of the thesis's two roles as trees in `tests/golden`. `MONAS_BLESS=1` rewrites the
//! files.

use std::path::{Path, PathBuf};

use yase::{NodeKind, Source, Statechart};

fn root(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

fn model(name: &str) -> Statechart {
    let path = root("../../models").join(name);
    let source = Source::new(name, std::fs::read_to_string(path).expect("a model"));
    let (chart, findings) = aseme::statechart_of_role(&source);
    assert_eq!(findings, []);
    chart
}

fn check(name: &str, actual: &str) {
    let golden = root("tests/golden").join(name);
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(&golden, actual).expect("writable");
    }
    let expected = std::fs::read_to_string(&golden).expect("a golden file");
    assert!(actual == expected, "{name} differs from its golden file; MONAS_BLESS=1 accepts it:\n{actual}");
}

#[test]
fn the_goalie_as_a_tree() {
    check("goalie.txt", &aseme::to_text(&model("goalie.srm")));
}

#[test]
fn the_attacker_as_a_tree() {
    check("attacker.txt", &aseme::to_text(&model("attacker.srm")));
}

#[test]
fn every_choice_is_guarded_and_every_exit_of_an_endless_term_is_closed() {
    for name in ["goalie.srm", "attacker.srm"] {
        let chart = model(name);
        for (id, node) in chart.nodes().filter(|(_, node)| node.kind == NodeKind::Condition) {
            let choices = chart.transitions().filter(|(_, transition)| transition.source == id);
            let unguarded = choices.filter(|(_, transition)| transition.expression.guard.is_none()).count();
            assert!(unguarded <= 1, "{name}: {unguarded} choices of {node:?} are taken otherwise");
        }
        for (_, transition) in chart.transitions() {
            let source = chart.node(transition.source);
            let forever = source.name.ends_with('~') || source.kind == NodeKind::And;
            assert!(!forever || transition.expression.is_never(), "{name}: {}", source.name);
        }
    }
}

#[test]
fn loops_wait_and_set_their_timer_again() {
    for name in ["goalie.srm", "attacker.srm"] {
        let chart = model(name);
        let loops = chart.transitions().filter(|(_, transition)| transition.source == transition.target);
        let timers: Vec<String> = loops
            .flat_map(|(_, transition)| transition.expression.started_timers().collect::<Vec<_>>())
            .collect();
        let expected = ["robot", "led", "motion", "sensors", "vision", "place", "decision"]
            .map(|timer| format!("{timer}_timeout"));
        assert_eq!(timers, expected, "{name}");
    }
}
