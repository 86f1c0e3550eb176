//! Contents of snapshots of only some charts and semantics: HISTORY, timers of states, composites
//! without an active child, JOINs that wait.

use yase::{MicroStep, Semantics, TimerScope, Timestamp};

use crate::snapshot::fixture::Stage;

const PAST: &str = "
    START
    w
      START
      h past
      H depth
      a
      b
        START
        x
        y
        w/b/START -> w/b/x
        w/b/x -> w/b/y : n
      w/START -> w/a
      w/a -> w/b : e
    off
    START -> w
    w -> off : f
    off -> w/past : g
    off -> w/depth : d
";

#[test]
fn what_histories_remember_is_reported_and_can_be_set() {
    let mut stage = Stage::new(PAST, &["e", "n"]);
    assert_eq!(stage.machine.snapshot().history("c/w/past"), None);
    stage.event("f");
    let snapshot = stage.machine.snapshot();
    assert_eq!(snapshot.history("c/w/past").unwrap(), ["c/w/b"]);
    assert_eq!(snapshot.history("c/w/depth").unwrap(), ["c/w/b/y", "c/w/b"]);
    assert_eq!(stage.restore(&snapshot).unwrap().snapshot(), snapshot);

    stage.edit(|snapshot| {
        snapshot.set_history("c/w/past", &["c/w/a"]);
        snapshot.set_history("c/w/depth", &["c/w/b", "c/w/b/x"]);
    });
    let kept = stage.machine.clone();
    stage.event("g");
    assert_eq!(stage.active(), "w w/a");
    stage.machine = kept;
    stage.event("d");
    assert_eq!(stage.active(), "w w/b w/b/x");
}

#[test]
fn a_history_is_set_before_there_is_one_or_forgotten() {
    let mut stage = Stage::new(PAST, &["f"]);
    stage.edit(|snapshot| {
        snapshot.history.clear();
        snapshot.set_history("c/w/past", &["c/w/b"]);
    });
    assert_eq!(stage.machine.snapshot().history.len(), 1);
    stage.event("g");
    assert_eq!(stage.active(), "w w/b w/b/x");
}

#[test]
fn a_history_remembers_what_was_active_together_inside_its_composite() {
    let stage = Stage::new(PAST, &["f"]);
    let wrong = |history: &str, nodes: &[&str]| {
        let mut snapshot = stage.machine.snapshot();
        snapshot.set_history(history, nodes);
        match stage.restore(&snapshot) {
            Ok(_) => String::new(),
            Err(error) => error.issues()[0].to_string(),
        }
    };
    assert_eq!(wrong("c/w/past", &["c/w/b"]), "");
    assert_eq!(wrong("c/w/depth", &["c/w/b", "c/w/b/START"]), "");
    let shallow = "history: what `c/w/past` remembers was never active together";
    let deep = "history: what `c/w/depth` remembers was never active together";
    for nodes in [&[][..], &["c/off"], &["c/w"], &["c/w/a", "c/w/b"], &["c/w/b/x"], &["c/w/past"]] {
        assert_eq!(wrong("c/w/past", nodes), shallow, "{nodes:?}");
    }
    for nodes in [&[][..], &["c/off"], &["c/w/b"], &["c/w/b/x"], &["c/w/a", "c/w/b", "c/w/b/x"], &["c/w"]] {
        assert_eq!(wrong("c/w/depth", nodes), deep, "{nodes:?}");
    }
    assert_eq!(wrong("c/w/a", &[]), "history[2].history: `c/w/a` is not a HISTORY");
    assert_eq!(wrong("c/w/past", &["c/w/z"]), "history[0].nodes[0]: the chart has no node `c/w/z`");
}

#[test]
fn timers_of_states_keep_their_state() {
    let mut semantics = Semantics::yase();
    semantics.timers = TimerScope::State;
    let chart = "
        START
        a | entry=StartTimeout(v, 50ms)
        b
        d
        START -> a
        a -> b : e
        b -> d : v
    ";
    let mut stage = Stage::with(semantics, chart, &[]);
    assert_eq!(stage.machine.snapshot().timers[0].owner.as_deref(), Some("c/a"));
    stage.edit(|_| {});
    let kept = stage.machine.clone();
    stage.event("e");
    assert_eq!(stage.machine.next_deadline(), None, "it is forgotten with its state");

    stage.machine = kept;
    stage.edit(|snapshot| snapshot.timers[0].owner = None);
    stage.event("e");
    assert_eq!(stage.machine.next_deadline(), Some(Timestamp::from_millis(50)));
}

const JOINED: &str = "
    START
    & both
      one
        START
        A
        B
        both/one/START -> both/one/A
        both/one/A -> both/one/B : e
      two
        START
        C
        D
        both/two/START -> both/two/C
        both/two/C -> both/two/D : f
    > j
    off
    START -> both
    both/one/B -> j
    both/two/D -> j
    j -> off
";

#[test]
fn what_has_arrived_at_a_join_is_kept() {
    let mut stage = Stage::with(Semantics::uml(), JOINED, &["e"]);
    let snapshot = stage.machine.snapshot();
    assert_eq!(snapshot.vacated, ["c/both/one"]);
    assert_eq!(snapshot.joined, [["c/both/one/B -> c/j"]]);
    assert_eq!(stage.active(), "both both/one both/two both/two/C");
    stage.edit(|_| {});
    assert_eq!(stage.machine.snapshot(), snapshot);
    stage.event("f");
    assert_eq!(stage.active(), "off");
}

#[test]
fn what_has_not_arrived_has_a_child() {
    let stage = Stage::with(Semantics::uml(), JOINED, &["e"]);
    let wrong = |change: &dyn Fn(&mut yase::snapshot::Snapshot)| {
        let mut snapshot = stage.machine.snapshot();
        change(&mut snapshot);
        let error = stage.restore(&snapshot).map(|_| ()).unwrap_err();
        error.issues().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(
        wrong(&|snapshot| snapshot.vacated.clear()),
        "configuration: `c/both/one` is active, but nothing in it\n\
         joined: `c/both/one` has arrived where regions are joined, but was not vacated"
    );
    assert_eq!(
        wrong(&|snapshot| snapshot.vacated.push("c/both/two".into())),
        "configuration: `c/both/two` was vacated, but `c/both/two/C` is active"
    );
    assert_eq!(wrong(&|snapshot| snapshot.vacated.push("c/off".into())), "vacated: `c/off` is not active");
    assert_eq!(
        wrong(&|snapshot| snapshot.completions.push("c/off".into())),
        "completions: `c/off` is not active"
    );
    assert_eq!(
        wrong(&|snapshot| snapshot.joined.push(vec!["c/both/one/A -> c/both/one/B".into()])),
        "joined[1]: `c/both/one/A -> c/both/one/B` leads to nothing that joins regions"
    );
}

#[test]
fn a_step_in_which_the_root_has_ended_goes_on_to_leave_everything() {
    let chart = "
        START
        a | exit=raise(bye)
        END
        START -> a
        a -> END : e
    ";
    let mut whole = Stage::with(Semantics::scxml(), chart, &["e"]);
    let mut stage = Stage::with(Semantics::scxml(), chart, &[]);
    stage.machine.dispatch_name("e");
    while stage.machine.micro_step(Timestamp::ZERO, &mut stage.host) == Ok(MicroStep::Progressed) {
        stage.edit(|_| {});
    }
    assert_eq!(stage.host.log, whole.host.log);
    assert!(stage.machine.is_finished());
    whole.edit(|_| {});
    assert!(whole.machine.is_finished() && whole.active().is_empty());
}

#[test]
fn a_machine_that_could_not_be_started_says_so_after_all() {
    let chart = "
        START
        ! c
        a
        START -> c
        c -> a : [false]
    ";
    let chart = yase_reference::chart(chart);
    let mut host = yase_reference::TestHost::new(&chart);
    let mut machine = yase::Machine::new(yase_reference::script::compile_with(&chart, Semantics::uml()));
    machine.start(Timestamp::ZERO, &mut host);
    let snapshot = machine.snapshot();
    assert_eq!(snapshot.no_branch.as_deref(), Some("c/c"));
    let mut restored = yase::Machine::restore(machine.chart().clone(), &snapshot).unwrap();
    let expected = machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap_err();
    assert_eq!(restored.run_to_completion(Timestamp::ZERO, &mut host).unwrap_err(), expected);
}
