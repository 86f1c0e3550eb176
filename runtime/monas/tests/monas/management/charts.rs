//! Statecharts that are changed while they run.

use monas::records::{Action, Change, Changed};
use monas::{Agent, Blackboard, Progress, Registry, Simulation, Talws};
use yase::Source;

use crate::kit::{Recorder, at, recorder};
use crate::management::{change, made, settings};

/// A chart whose activities record their calls: A is done at once, B continues every 100 ms.
fn simulation(text: &str) -> (Simulation, Recorder<&'static str>) {
    let (notes, note) = recorder();
    let (a, b) = (note.clone(), note);
    let registry = Registry::empty()
        .with("A", move || {
            let note = a.clone();
            move |_: &mut Blackboard| note("A")
        })
        .with("B", move || {
            let (note, mut calls) = (b.clone(), 0);
            move |_: &mut Blackboard| {
                calls += 1;
                note(if calls == 1 { "B first" } else { "B again" });
                Progress::after(std::time::Duration::from_millis(100))
            }
        });
    let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", text));
    assert_eq!(diagnostics, []);
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart));
    let mut simulation = talws.simulate(1).unwrap();
    simulation.run_until(at(150)).unwrap();
    (simulation, notes)
}

/// The first reason of a rejection.
fn refused_first(changed: &Changed) -> (String, String) {
    assert!(!changed.done);
    (changed.findings[0].code.clone(), changed.findings[0].message.clone())
}

fn swap(text: &str) -> Change {
    Change { file: "new.srm".into(), text: text.into(), ..change(Action::SwapModel, "m") }
}

#[test]
fn active_states_survive_a_model_exchange() {
    let (mut simulation, notes) = simulation("m = A . B");
    assert_eq!(notes.taken(), ["A", "B first", "B again"]);
    // Another activity comes before, and one after; B is where it was, with what it remembers.
    let changed = simulation.change("local", swap("m = A . A . B . A")).unwrap();
    made(&changed);
    assert!(!changed.findings.is_empty(), "what became of what was active is said");
    simulation.run_until(at(250)).unwrap();
    assert_eq!(notes.taken(), ["B again"], "it is the same instance, at its own time");
    made(&simulation.change("local", swap("m = A . (B | A)")).unwrap());
    simulation.run_until(at(450)).unwrap();
    assert_eq!(notes.taken(), ["B again", "B again"]);
}

#[test]
fn an_invalid_model_is_rejected_with_positions_and_the_chart_continues() {
    let (mut simulation, notes) = simulation("m = A . B");
    notes.taken();
    for (text, code) in [("m = A . . B", "E0"), ("m = A . C", "E0318"), ("m = A", "E0356")] {
        let changed = simulation.change("local", swap(text)).unwrap();
        assert!(
            !changed.done && changed.findings[0].code.starts_with(code),
            "{text}: {:?}",
            changed.findings
        );
    }
    simulation.run_until(at(350)).unwrap();
    assert_eq!(notes.taken(), ["B again", "B again"]);
    assert_eq!(simulation.statistics().agents[0].stopped, None);
}

#[test]
fn a_removed_state_is_replaced_by_the_mapped_one() {
    let (mut simulation, notes) = simulation("m = A . B");
    notes.taken();
    let text = "Liveness:\nm = A . Late\nStates:\nLate : activity = B";
    let (code, reason) = refused_first(&simulation.change("local", swap(text)).unwrap());
    assert_eq!(
        (code.as_str(), reason.as_str()),
        ("E0356", "`m/B` is active, and there is nothing like it: say what replaces it")
    );
    let states = settings(&[("m/B", "m/Late")]);
    made(&simulation.change("local", Change { states, ..swap(text) }).unwrap());
    simulation.run_until(at(250)).unwrap();
    assert_eq!(notes.taken(), ["B again"], "its activity is the same");
}

#[test]
fn a_dry_run_says_what_a_swap_would_do_and_changes_nothing() {
    let (mut simulation, notes) = simulation("m = A . B");
    notes.taken();
    let dry = |text: &str| Change { dry_run: true, ..swap(text) };
    let lines = |changed: &Changed| -> Vec<String> {
        changed.findings.iter().map(|finding| finding.message.clone()).collect()
    };
    let judged = simulation.change("local", dry("m = A . A . B . A")).unwrap();
    made(&judged);
    assert!(lines(&judged).contains(&"state `m/B`: kept".to_owned()), "{:?}", lines(&judged));
    let judged = simulation.change("local", dry("m = B")).unwrap();
    made(&judged);
    let gone = lines(&judged).into_iter().find(|line| line.starts_with("state `m/A`, not active: lost"));
    assert!(gone.is_some(), "{:?}", lines(&judged));
    // what a swap would refuse
    assert_eq!(refused_first(&simulation.change("local", dry("m = A")).unwrap()).0, "E0356");
    let pause = Change { dry_run: true, ..change(Action::PauseAgent, "m") };
    assert_eq!(refused_first(&simulation.change("local", pause).unwrap()).0, "E0352");
    // the chart is still the first
    made(&simulation.change("local", swap("m = A . B . A")).unwrap());
    simulation.run_until(at(250)).unwrap();
    assert_eq!(notes.taken(), ["B again"]);
}

#[test]
fn a_chart_pauses_steps_stops_and_restarts() {
    let (mut simulation, notes) = simulation("m = (A . B)~");
    notes.taken();
    let mut ask = |action| made(&simulation.change("local", change(action, "m")).unwrap());
    ask(Action::PauseAgent);
    ask(Action::StopAgent);
    ask(Action::StartAgent);
    simulation.run_until(at(200)).unwrap();
    assert_eq!(notes.taken(), ["A", "B first"], "it begins at its START, with new activities");
    simulation.change("local", change(Action::PauseAgent, "m")).unwrap();
    simulation.run_until(at(1000)).unwrap();
    assert_eq!(notes.taken(), [""; 0]);
    made(&simulation.change("local", change(Action::StepAgent, "m")).unwrap());
    assert_eq!(notes.taken(), ["B again"]);
}
