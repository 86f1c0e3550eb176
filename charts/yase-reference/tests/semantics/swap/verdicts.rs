//! Dispositions of a successful migration.

use yase::migrate::{Disposition, MigratedItem};

use crate::swap::stage::{Stage, findings};

const TWO: &str = "
    START
    a
    b
    START -> a
    a -> b : e
";

#[test]
fn what_is_active_stays_active_without_entries_and_exits() {
    let mut stage = Stage::new(TWO, &["e"]);
    stage.lines();
    let new = "
        START
        c
        b | entry=raise(x) | exit=raise(y)
        START -> c
        b -> c : f
    ";
    let plan = stage.plan(new);
    assert!(!plan.is_same());
    let report = stage.swap(&plan).unwrap();
    assert_eq!(findings(&report), "state `c`: kept\nstate `c/b`: kept");
    assert!(stage.machine.needs_step(stage.host.now), "new guards may be open");
    stage.step(0);
    assert_eq!((stage.lines().as_str(), stage.active().as_str()), ("", "b"));
    stage.event("f");
    assert_eq!(stage.active(), "c");
}

#[test]
fn the_name_of_the_root_does_not_matter() {
    let mut stage = Stage::new(TWO, &[]);
    let mut new = yase_reference::chart(TWO);
    new.name = "other".into();
    new.node_mut(yase::Statechart::ROOT).name = "other".into();
    let plan = yase::migrate::plan(stage.machine.chart(), &yase_reference::script::compile(&new));
    assert!(plan.is_same());
    assert_eq!(findings(&stage.swap(&plan).unwrap()), "state `c`: kept\nstate `c/a`: kept");
    assert_eq!(stage.machine.snapshot().configuration, ["other", "other/a"]);
}

#[test]
fn a_state_around_which_a_composite_was_put_has_moved() {
    let mut stage = Stage::new(TWO, &["e"]);
    let new = "
        START
        a
        outer | entry=raise(x)
          START
          b
          outer/START -> outer/b
        START -> a
        a -> outer : e
    ";
    let plan = stage.plan(new);
    let report = stage.swap(&plan).unwrap();
    assert_eq!(
        findings(&report),
        "state `c`: kept\nstate `c/b`: moved to `c/outer/b`\nstate `c/outer`: added"
    );
    stage.lines();
    stage.step(0);
    assert_eq!((stage.lines().as_str(), stage.active().as_str()), ("", "outer outer/b"));
}

#[test]
fn a_composite_may_be_taken_away_if_it_is_said_what_is_in_its_place() {
    let old = "
        START
        outer
          START
          b
          outer/START -> outer/b
        START -> outer
    ";
    let new = "
        START
        b
        START -> b
    ";
    let mut stage = Stage::new(old, &[]);
    let plan = stage.plan(new);
    assert_eq!(
        stage.refusal(&plan),
        "`c/outer` is active, and there is nothing like it: say what replaces it"
    );
    let plan = plan.with_replacement("outer", "c").unwrap();
    stage.swap(&plan).unwrap();
    assert_eq!(stage.active(), "b");
}

#[test]
fn a_replacement_takes_what_is_inside_along() {
    let old = "
        START
        head
          START
          look
          turn
          head/START -> head/look
        START -> head
    ";
    let new = &old.replace("head", "kopf");
    let mut stage = Stage::new(old, &[]);
    let plan = stage.plan(new).with_replacement("head", "kopf").unwrap();
    let report = stage.swap(&plan).unwrap();
    assert_eq!(
        findings(&report),
        "state `c`: kept\nstate `c/head`: replaced by `c/kopf`\nstate `c/head/look`: moved to `c/kopf/look`"
    );
    assert_eq!(stage.active(), "kopf kopf/look");
}

const BOTH: &str = "
    START
    & both
      one
        START
        A
        both/one/START -> both/one/A
    START -> both
";

const THREE: &str = "
    START
    & both
      one
        START
        A
        both/one/START -> both/one/A
      more | entry=raise(hello)
        START
        B
        C
        both/more/START -> both/more/B : [A.n == 3]
        both/more/START -> both/more/C
    START -> both
";

#[test]
fn a_new_region_of_an_active_and_is_entered_by_its_start_in_the_next_step() {
    let mut stage = Stage::new(BOTH, &[]);
    stage.host.verbose = true;
    let plan = stage.plan(THREE);
    let report = stage.swap(&plan).unwrap();
    assert_eq!(report.to_enter, ["c/both/more"]);
    assert_eq!(stage.active(), "both both/one both/one/A", "not before the next step");
    // what is kept of it in between is not lost
    let kept = stage.machine.snapshot();
    assert_eq!(kept.to_enter, ["c/both/more"]);
    let chart = stage.machine.chart().clone();
    stage.machine = yase::Machine::restore(chart, &kept).unwrap();
    stage.lines();
    stage.step(7);
    assert_eq!(
        stage.lines(),
        "inherit 2 from 0\n\
         0.007 s swap; do raise(hello) (entry both/more); enter both/more, both/more/START\n\
         deliver 0\ndeliver 1\ndeliver 2\n\
         0.007 s -: both/more/START -> both/more/C; exit both/more/START; enter both/more/C\n\
         0.007 s hello: dropped"
    );
    assert_eq!(stage.active(), "both both/one both/one/A both/more both/more/C");
}

#[test]
fn a_new_region_can_be_taken_away_again_before_it_was_entered() {
    let mut stage = Stage::new(BOTH, &[]);
    let there = stage.plan(THREE);
    stage.swap(&there).unwrap();
    let back = stage.plan(BOTH);
    let report = stage.swap(&back).unwrap();
    assert_eq!((report.to_enter.len(), stage.machine.snapshot().to_enter.len()), (0, 0));
    assert_eq!(stage.active(), "both both/one both/one/A");
}

#[test]
fn there_and_back_again_is_as_before() {
    let mut stage = Stage::new(TWO, &["e"]);
    let before = stage.machine.snapshot();
    let there =
        stage.plan("START\nouter\n  START\n  b\n  outer/START -> outer/b\nSTART -> outer\nb -> outer : g");
    stage.swap(&there).unwrap();
    let back = stage.plan(TWO).with_replacement("outer", "c").unwrap();
    stage.swap(&back).unwrap();
    stage.step(0);
    let mut after = stage.machine.snapshot();
    after.bound = before.bound.clone(); // there was one more step, in which nothing was done
    assert_eq!(after, before);
}

#[test]
fn an_and_put_around_has_its_other_regions_entered_and_its_blackboards_filled() {
    let mut stage = Stage::new(TWO, &["e"]);
    stage.host.verbose = true;
    let new = "
        START
        a
        & both
          one
            START
            b
            both/one/START -> both/one/b
          two
            START
            d
            both/two/START -> both/two/d
        START -> a
        a -> both : e
    ";
    let plan = stage.plan(new);
    stage.swap(&plan).unwrap();
    stage.lines();
    stage.step(0);
    assert_eq!(
        stage.lines(),
        "inherit 1 from 0\ninherit 2 from 0\n0.000 s swap; enter both/two, both/two/START\n\
         deliver 0\ndeliver 1\ndeliver 2\n0.000 s -: both/two/START -> both/two/d; exit both/two/START; enter both/two/d"
    );
    assert_eq!(stage.active(), "both both/one both/one/b both/two both/two/d");
}

const WORK: &str = "
    START
    a | run=work | for=20ms
    b
    START -> a
    a -> b
";

#[test]
fn an_activity_that_runs_goes_on_under_its_new_number() {
    let mut stage = Stage::new(WORK, &[]);
    let new = "
        START
        z
        b
        outer
          START
          a | run=work | for=20ms
          outer/START -> outer/a
        START -> outer
        a -> b
    ";
    let plan = stage.plan(new);
    let report = stage.swap(&plan).unwrap();
    let [(old, new)] = report.activations[..] else { panic!("there is one") };
    assert!(old.number == new.number && old.node != new.node);
    assert_eq!(
        findings(&report),
        "state `c`: kept\nstate `c/a`: moved to `c/outer/a`\nstate `c/outer`: added\n\
         activity `c/a: work`: moved to `c/outer/a`"
    );
    stage.returns();
    assert_eq!(stage.active(), "b");
}

#[test]
fn a_state_that_is_done_may_lose_its_activity() {
    let old = "START\na | run=work\nb\nSTART -> a\na -> b : e";
    let mut stage = Stage::new(old, &[]);
    stage.returns();
    let plan = stage.plan("START\na\nb\nSTART -> a\na -> b : e");
    assert!(findings(&stage.swap(&plan).unwrap()).contains("activity `c/a: work`: kept"));
    stage.event("e");
    assert_eq!(stage.active(), "b");
}

const TIMED: &str = "
    START
    a
    b
    START -> a : / StartTimeout(v, 50ms), StartTimeout(w, 50ms)
    a -> b : v
    b -> a : w
";

#[test]
fn timers_are_kept_by_region_and_name_and_lost_with_consent() {
    let mut stage = Stage::new(TIMED, &[]);
    let plan = stage.plan("START\na\nb\nSTART -> a : / StartTimeout(v, 1s)\na -> b : v");
    assert_eq!(stage.refusal(&plan), "the timer `c: w` would be lost: no action starts such a timer there");
    let report = stage.swap(&plan.accepting_losses()).unwrap();
    assert_eq!(report.losses().count(), 1);
    assert!(findings(&report).contains("timer `c: v`: kept\ntimer `c: w`: lost, no action"));
    stage.step(50);
    assert_eq!(stage.active(), "b", "the deadline is the old one");
}

#[test]
fn events_are_kept_by_name() {
    let old = "START\na\nb\nSTART -> a\na -> b : e\na -> b : f";
    let mut stage = Stage::new(old, &[]);
    stage.machine.dispatch_name("e");
    stage.machine.dispatch_name("f");
    let plan = stage.plan("START\na\nb\nSTART -> a\na -> b : f");
    assert_eq!(stage.refusal(&plan), "the event `e` would be lost: nothing waits for it");
    let report = stage.swap(&plan.accepting_losses()).unwrap();
    assert!(findings(&report).ends_with("event `e`: lost, nothing waits for it\nevent `f`: kept"));
    stage.lines();
    stage.step(0);
    assert_eq!(stage.lines(), "0.000 s f: a -> b; exit a; enter b");
}

#[test]
fn an_event_that_only_any_trigger_takes_now_has_lost_its_name() {
    let mut stage = Stage::new(TWO, &[]);
    stage.machine.dispatch_name("e");
    let plan = stage.plan("START\na\nb\nSTART -> a\na -> b : *");
    assert!(findings(&stage.swap(&plan).unwrap()).ends_with("event `e`: moved to `?`"));
    stage.step(0);
    assert_eq!(stage.active(), "b");
}

#[test]
fn deferred_events_are_kept_by_name() {
    let old = "START\na | defer=e,f\nb\nSTART -> a\na -> b : g\nb -> a : e\nb -> a : f";
    let mut stage = Stage::new(old, &["e", "f"]);
    let plan = stage.plan("START\na | defer=f\nb\nSTART -> a\na -> b : g\nb -> a : f");
    assert_eq!(stage.refusal(&plan), "the deferred event `e` would be lost: nothing waits for it");
    let report = stage.swap(&plan.accepting_losses()).unwrap();
    assert!(findings(&report).ends_with("deferred event `f`: kept"));
    stage.event("g");
    assert_eq!(stage.active(), "a", "b is left again for f");
}

#[test]
fn held_events_are_offered_again() {
    let old = "START\na | run=work | for=20ms\nb\nd\nSTART -> a\na -> b : e";
    let mut stage = Stage::new(old, &["e"]);
    let plan = stage.plan("START\na | run=work | for=20ms\nb\nd\nSTART -> a\na -> d : e");
    let report = stage.swap(&plan).unwrap();
    assert!(findings(&report).ends_with("held event `e`: kept"));
    stage.lines();
    stage.step(0);
    assert_eq!(stage.lines(), "0.000 s e: nothing; hold a -> d");
    stage.returns();
    assert_eq!(stage.active(), "d");
}

#[test]
fn a_transition_that_waits_for_activities_goes_on_waiting() {
    let old = "START\na | run=work | for=20ms\nb\nSTART -> a\na -> b {interrupts} : e";
    let mut stage = Stage::new(old, &["e"]);
    let new = "START\nz\na | run=work | for=20ms\nb\nSTART -> a\na -> b {interrupts} : e\na -> z : f";
    let plan = stage.plan(new);
    let report = stage.swap(&plan).unwrap();
    assert!(findings(&report).ends_with("pending transition `c/a -> c/b`: kept"));
    stage.returns();
    assert_eq!(stage.active(), "b");
}

#[test]
fn a_plan_lists_every_node() {
    let stage = Stage::new(TWO, &[]);
    let plan = stage.plan("START\na\nouter\n  START\n  d\n  outer/START -> outer/d\nSTART -> a");
    let verdicts: Vec<String> = plan.nodes().map(|(path, verdict)| format!("{path} {verdict}")).collect();
    assert_eq!(verdicts, ["c kept", "c/START kept", "c/a kept", "c/b there is nothing like it"]);
}

#[test]
fn a_name_is_looked_for_inside_the_nearest_composite_around_it() {
    let old = "
        START
        head
          START
          scan
          head/START -> head/scan
        body
          START
          scan
          body/START -> body/scan
        START -> head
    ";
    let new = "
        START
        head
          START
          deeper
            START
            scan
            head/deeper/START -> head/deeper/scan
          head/START -> head/deeper
        body
          START
          scan
          body/START -> body/scan
        START -> head
    ";
    let mut stage = Stage::new(old, &[]);
    let plan = stage.plan(new);
    let report = stage.swap(&plan).unwrap();
    let moved =
        report.findings.iter().find(|finding| matches!(finding.verdict, Disposition::Moved(_))).unwrap();
    assert_eq!((moved.subject, moved.name.as_str()), (MigratedItem::State, "c/head/scan"));
    assert_eq!(stage.active(), "head head/deeper head/deeper/scan");
}

#[test]
fn a_machine_that_was_not_started_takes_any_chart() {
    let chart = yase_reference::script::compile(&yase_reference::chart(TWO));
    let other = yase_reference::script::compile(&yase_reference::chart(WORK));
    let mut machine = yase::Machine::new(chart.clone());
    let report = machine.swap(&yase::migrate::plan(&chart, &other)).unwrap();
    assert_eq!(report.findings, []);
    assert!(std::sync::Arc::ptr_eq(machine.chart(), &other));
}
