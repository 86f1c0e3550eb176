//! Reasons to refuse a migration. Each test asserts that nothing has changed.

use std::num::NonZeroU32;

use yase::{MicroStep, Semantics, TimerScope};

use crate::swap::stage::Stage;
use yase_reference::script::compile_with;

const TWO: &str = "
    START
    a
    b
    START -> a
    a -> b : e
";

#[test]
fn an_active_state_that_is_gone() {
    let mut stage = Stage::new(TWO, &["e"]);
    let plan = stage.plan("START\na\nSTART -> a");
    assert_eq!(stage.refusal(&plan), "`c/b` is active, and there is nothing like it: say what replaces it");
    stage.swap(&plan.with_replacement("b", "a").unwrap()).unwrap();
    assert_eq!(stage.active(), "a");
}

#[test]
fn an_active_state_that_could_be_several() {
    let mut stage = Stage::new(TWO, &["e"]);
    let new = "START\na\nx\n  START\n  b\n  x/START -> x/b\ny\n  START\n  b\n  y/START -> y/b\nSTART -> a";
    let plan = stage.plan(new);
    assert_eq!(stage.refusal(&plan), "`c/b` is active, and several nodes could be it: say what replaces it");
    stage.swap(&plan.with_replacement("c/b", "y/b").unwrap()).unwrap();
    assert_eq!(stage.active(), "y y/b");
}

#[test]
fn an_active_state_that_is_no_state_any_more() {
    let mut stage = Stage::new(TWO, &["e"]);
    let plan = stage.plan("START\na\n? b\nSTART -> a\na -> b\nb -> a");
    assert_eq!(stage.refusal(&plan), "`c/b` is active, and it is of another kind now: say what replaces it");
}

#[test]
fn a_state_that_has_become_a_composite() {
    let mut stage = Stage::new(TWO, &["e"]);
    let new = "START\na\nb\n  START\n  x\n  b/START -> b/x\nSTART -> a";
    let plan = stage.plan(new);
    assert_eq!(stage.refusal(&plan), "configuration: `c/b` is active, but nothing in it");
    stage.swap(&plan.with_replacement("b", "b/START").unwrap()).unwrap();
    stage.step(0);
    assert_eq!(stage.active(), "b b/x");
}

#[test]
fn states_that_are_not_active_together_any_more() {
    let old = "
        START
        & both
          one
            START
            A
            both/one/START -> both/one/A
          two
            START
            B
            both/two/START -> both/two/B
        START -> both
    ";
    let new = "
        START
        & both
          one
            START
            A
            B
            both/one/START -> both/one/A
          two
            START
            C
            both/two/START -> both/two/C
        START -> both
    ";
    let mut stage = Stage::new(old, &[]);
    let plan = stage.plan(new);
    assert_eq!(
        stage.refusal(&plan),
        "configuration: in `c/both/one` one child is active, not `c/both/one/A`, `c/both/one/B`\n\
         configuration: `c/both/two` is active, but nothing in it"
    );
}

const WORK: &str = "START\na | run=work | for=20ms\nb\nSTART -> a\na -> b : e";

#[test]
fn an_activity_that_runs_and_has_no_state() {
    let mut stage = Stage::new(WORK, &[]);
    let plan = stage.plan("START\nz\nb\nSTART -> z").with_replacement("a", "b").unwrap();
    assert_eq!(stage.refusal(&plan), "`work` runs in `c/a`, which has no such activity now");
}

#[test]
fn an_activity_that_runs_and_has_changed() {
    let mut stage = Stage::new(WORK, &[]);
    let plan = stage.plan(&WORK.replace("work", "rest"));
    assert_eq!(stage.refusal(&plan), "`work` runs in `c/a`, which has no such activity now");
}

#[test]
fn a_state_with_an_activity_that_has_not_run() {
    let reason = "the activity of `c/a` is `rest` now, which has not run: have the state replaced by one that leads to it";
    let without = WORK.replace(" | run=work | for=20ms", "");
    for (old, returns) in [(WORK, true), (without.as_str(), false)] {
        let mut stage = Stage::new(old, &[]);
        if returns {
            stage.returns();
        }
        let plan = stage.plan(&WORK.replace("work", "rest"));
        assert_eq!(stage.refusal(&plan), reason);
        stage.swap(&plan.with_replacement("a", "START").unwrap()).unwrap();
        stage.step(0);
        assert!(stage.lines().ends_with("start rest"));
    }
}

#[test]
fn a_transition_that_waits_for_activities_and_is_no_more() {
    let old = "START\na | run=work | for=20ms\nb\nSTART -> a\na -> b {interrupts} : e";
    let mut stage = Stage::new(old, &["e"]);
    let plan = stage.plan(&old.replace(" : e", " : f"));
    assert_eq!(
        stage.refusal(&plan),
        "`c/a -> c/b` waits for activities that it has asked to return, and is no more: let it happen first"
    );
}

#[test]
fn a_step_that_is_under_way() {
    let mut stage = Stage::new(TWO, &[]);
    stage.machine.dispatch_name("e");
    let made = stage.machine.micro_step(stage.host.now, &mut stage.host);
    assert_eq!(made, Ok(MicroStep::Progressed));
    let plan = stage.plan(TWO);
    assert_eq!(stage.refusal(&plan), "a step is under way: a chart is swapped between steps");
}

#[test]
fn a_plan_for_another_chart() {
    let mut stage = Stage::new(TWO, &[]);
    let plan = Stage::new(TWO, &[]).plan(TWO);
    assert_eq!(stage.refusal(&plan), "the plan is not for the chart that runs");
}

#[test]
fn a_chart_that_is_read_in_another_way() {
    let mut stage = Stage::new(TWO, &[]);
    let mut semantics = Semantics::yase();
    semantics.timers = TimerScope::State;
    let other = compile_with(&yase_reference::chart(TWO), semantics);
    let plan = yase::migrate::plan(stage.machine.chart(), &other);
    assert_eq!(stage.refusal(&plan), "the new chart has other semantics");
    let mut semantics = Semantics::yase();
    semantics.limit = NonZeroU32::MIN;
    let other = compile_with(&yase_reference::chart(TWO), semantics);
    let plan = yase::migrate::plan(stage.machine.chart(), &other);
    assert!(stage.machine.swap(&plan).is_ok());
}

#[test]
fn everything_is_reported_at_once() {
    let old = "START\na | run=work | for=20ms | defer=e\nb\nSTART -> a : / StartTimeout(v, 1s)\nb -> a : e";
    let mut stage = Stage::new(old, &["e"]);
    let plan = stage.plan("START\nb\nSTART -> b");
    assert_eq!(
        stage.refusal(&plan),
        "`c/a` is active, and there is nothing like it: say what replaces it\n\
         `work` runs in `c/a`, which has no such activity now\n\
         the timer `c: v` would be lost: no action starts such a timer there\n\
         the deferred event `e` would be lost: nothing waits for it"
    );
}

#[test]
fn a_replacement_with_a_path_of_no_node() {
    let stage = Stage::new(TWO, &[]);
    let error = stage.plan(TWO).with_replacement("a", "nowhere").unwrap_err();
    assert_eq!(error.to_string(), "in the new chart: there is no state `nowhere`");
    let error = stage.plan(TWO).with_replacement("x", "b").unwrap_err();
    assert_eq!(error.to_string(), "in the old chart: there is no state `x`");
}
