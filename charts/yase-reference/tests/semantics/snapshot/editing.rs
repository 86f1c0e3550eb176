//! Snapshots are inspected, changed and restored.

use yase::snapshot::{ActivityPhase, EventName, Snapshot};
use yase::{Chooser, Timestamp};

use crate::snapshot::fixture::Stage;

const LAMP: &str = "
    START
    off
    on | defer=g
    dim | run=fade | for=20ms
    START -> off
    off -> on : e / StartTimeout(v, 50ms)
    on -> off : v
    on -> dim : f
    dim -> off : g
    off -> dim : g
";

#[test]
fn a_snapshot_is_text_that_a_person_can_read() {
    let mut stage = Stage::new(LAMP, &["e", "g"]);
    stage.machine.dispatch_name("x");
    let found = serde_json::to_value(stage.machine.snapshot()).unwrap();
    let occurrence = |name: &str, number: u64| {
        serde_json::json!({
            "event": { "name": name },
            "number": number,
            "raised": false,
            "expiry": null,
            "token": 0,
            "known": name != "?",
        })
    };
    let expected = serde_json::json!({
        "version": 1,
        "chart": "c",
        "semantics": stage.machine.semantics(),
        "status": "running",
        "now": 0,
        "due": false,
        "step": null,
        "configuration": ["c", "c/on"],
        "to_enter": [],
        "to_inherit": [],
        "waiting_starts": [],
        "vacated": [],
        "joined": [],
        "completions": [],
        "ending": false,
        "no_branch": null,
        "history": [],
        "timers": [{
            "timer": { "region": "c", "name": "v" },
            "deadline": 50_000_000,
            "expired": false,
            "owner": null,
        }],
        "activations": 0,
        "activities": [],
        "occurrences": 3,
        "raised": [],
        "arrived": [occurrence("?", 3)],
        "deferred": [occurrence("g", 2)],
        "held": [],
        "pending": [],
        "erred_guards": [],
        "written": [],
        "bound": {
            "micro_steps": 1,
            "instant": 0,
            "steps": 3,
            "recent": [["c/START -> c/off"], ["c/off -> c/on"]],
        },
        "chooser": "declared",
    });
    assert_eq!(found, expected);
}

#[test]
fn what_is_in_it_can_be_asked_for() {
    let mut stage = Stage::new(LAMP, &["e"]);
    let snapshot = stage.machine.snapshot();
    assert!(snapshot.is_active("c/on") && !snapshot.is_active("c/off"));
    let timer = snapshot.timer("c", "v").unwrap();
    assert_eq!((timer.deadline, timer.expired), (Timestamp::from_millis(50), false));
    assert_eq!((snapshot.timer("c", "w"), snapshot.timer("c/on", "v")), (None, None));
    stage.event("f");
    let snapshot = stage.machine.snapshot();
    let activity = snapshot.activity("c/dim").unwrap();
    assert_eq!((activity.activity.as_str(), activity.phase), ("fade", ActivityPhase::Running));
}

#[test]
fn a_timer_is_set_to_another_time() {
    let mut stage = Stage::new(LAMP, &["e"]);
    stage.edit(|snapshot| assert!(snapshot.set_timer("c", "v", Timestamp::from_millis(70))));
    assert_eq!(stage.machine.next_deadline(), Some(Timestamp::from_millis(70)));
    stage.step(69);
    assert_eq!(stage.active(), "on");
    stage.step(70);
    assert_eq!(stage.active(), "off");
}

#[test]
fn a_timer_that_is_set_again_or_unset_forgets_its_expiry() {
    // `held` keeps the expiry from being taken
    let chart = "
        START
        a | run=work | for=90ms
        b
        START -> a : / StartTimeout(v, 50ms)
        a -> b : v
    ";
    let held = |stage: &mut Stage| {
        stage.step(50);
        assert_eq!(stage.machine.snapshot().held.len(), 1);
    };
    let mut stage = Stage::new(chart, &[]);
    held(&mut stage);
    stage.edit(|snapshot| assert!(snapshot.set_timer("c", "v", Timestamp::from_millis(80))));
    stage.returns();
    assert_eq!(stage.active(), "a");
    stage.step(80);
    assert_eq!(stage.active(), "b");

    let mut stage = Stage::new(chart, &[]);
    held(&mut stage);
    stage.edit(|snapshot| assert!(snapshot.unset_timer("c", "v") && !snapshot.unset_timer("c", "v")));
    stage.returns();
    stage.step(1000);
    assert_eq!((stage.active().as_str(), stage.machine.next_deadline()), ("a", None));
}

#[test]
fn a_deferred_event_is_dropped_or_put_in() {
    let mut stage = Stage::new(LAMP, &["e", "g"]);
    stage.edit(|snapshot| snapshot.deferred.clear());
    stage.step(50);
    assert_eq!(stage.active(), "off");

    let mut stage = Stage::new(LAMP, &["e"]);
    stage.edit(|snapshot| {
        snapshot.occurrences += 1;
        let text = serde_json::json!(
            { "event": { "name": "g" }, "number": snapshot.occurrences, "raised": false, "expiry": null,
              "token": 0, "known": true }
        );
        snapshot.deferred.push(serde_json::from_value(text).unwrap());
        assert_eq!(snapshot.deferred[0].event, EventName::Name("g".into()));
    });
    stage.step(50);
    assert_eq!(stage.active(), "dim", "off is left again for g");
}

#[test]
fn another_state_is_made_active() {
    let mut stage = Stage::new(LAMP, &[]);
    stage.edit(|snapshot| snapshot.configuration[1] = "c/on".into());
    stage.event("f");
    assert_eq!(stage.active(), "dim");
}

#[test]
fn an_activity_is_given_up_and_queued_again() {
    let mut stage = Stage::new(LAMP, &["g"]);
    assert_eq!(stage.host.jobs.len(), 1);
    stage.host.jobs.clear();
    stage.edit(|snapshot| {
        let activity = &mut snapshot.activities[0];
        assert_eq!(activity.phase, ActivityPhase::Running);
        activity.phase = ActivityPhase::Queued;
        snapshot.due = true;
    });
    assert!(stage.machine.needs_step(Timestamp::ZERO));
    stage.step(0);
    let [job] = &stage.host.jobs[..] else { panic!("it was started once more") };
    assert_eq!((job.name.as_str(), job.activation.number), ("fade", 1));
}

#[test]
fn siblings_of_one_name_are_distinguished() {
    let chart = "
        START
        a
        a
        b
        START -> b
        b -> a : e
        b -> a : f
    ";
    let mut chart = yase_reference::chart(chart);
    let twins: Vec<_> = chart.nodes().filter(|(_, node)| node.name == "a").map(|(id, _)| id).collect();
    for (transition, twin) in [1, 2].into_iter().zip(&twins) {
        chart.transition_mut(yase::TransitionId(transition)).target = *twin;
    }
    let mut host = yase_reference::TestHost::new(&chart);
    let mut machine = yase::Machine::new(yase_reference::script::compile(&chart));
    machine.start(Timestamp::ZERO, &mut host);
    machine.dispatch_name("f");
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    let snapshot: Snapshot = machine.snapshot();
    assert_eq!(snapshot.configuration, ["c", "c/a#2"]);
    assert_eq!(snapshot.bound.recent, [["c/START -> c/b"], ["c/b -> c/a#2"]]);
    let restored = yase::Machine::restore(machine.chart().clone(), &snapshot).unwrap();
    assert!(restored.is_active(twins[1]));
}

/// Two timers that expire at one moment: the chooser says which is first.
const RACE: &str = "
    START
    a
    b
    START -> a : / StartTimeout(v, 10ms), StartTimeout(w, 10ms)
    a -> b : v / StartTimeout(v, 10ms), StartTimeout(w, 10ms)
    a -> b : w / StartTimeout(v, 10ms), StartTimeout(w, 10ms)
    b -> a : v / StartTimeout(v, 10ms), StartTimeout(w, 10ms)
    b -> a : w / StartTimeout(v, 10ms), StartTimeout(w, 10ms)
";

#[test]
fn a_chooser_goes_on_choosing_where_it_was() {
    for chooser in [Chooser::seeded(7), Chooser::scripted(vec![1, 0, 1, 1, 0, 0, 1, 0]), Chooser::declared()]
    {
        let play = |cut: bool| {
            let mut stage = Stage::new(RACE, &[]);
            stage.machine.set_chooser(chooser.clone());
            for time in 1..=30 {
                stage.step(10 * time);
                if cut {
                    let text = serde_json::to_string(&stage.machine.snapshot()).unwrap();
                    stage.machine = stage.restore(&serde_json::from_str(&text).unwrap()).unwrap();
                }
            }
            (stage.host.log, stage.machine.chooser().choices().to_vec())
        };
        assert_eq!(play(true), play(false));
    }
}

#[test]
fn tokens_and_unknown_names_are_kept() {
    let mut stage = Stage::new(LAMP, &[]);
    stage.machine.dispatch_with("x", 7);
    stage.machine.dispatch_with("e", 8);
    let kept: Vec<_> =
        stage.machine.snapshot().arrived.iter().map(|event| (event.token, event.known)).collect();
    assert_eq!(kept, [(7, false), (8, true)]);
    let restored = stage.restore(&stage.machine.snapshot()).unwrap();
    assert_eq!(restored.snapshot(), stage.machine.snapshot());
}
