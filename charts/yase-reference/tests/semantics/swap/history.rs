//! Migration of histories, of timers that belong to states, and of composites without an active
//! child.

use yase::{Semantics, TimerScope};

use crate::swap::stage::{Stage, findings};

const PAST: &str = "
    START
    w
      START
      h past
      H depth
      a
      b
      w/START -> w/a
      w/a -> w/b : e
    off
    START -> w
    w -> off : f
    off -> w/past : g
    off -> w/depth : d
";

#[test]
fn what_is_remembered_is_kept() {
    let mut stage = Stage::new(PAST, &["e", "f"]);
    let plan = stage.plan(&PAST.replace(": f", ": x"));
    let report = stage.swap(&plan).unwrap();
    assert!(findings(&report).ends_with("history `c/w/past`: kept\nhistory `c/w/depth`: kept"));
    stage.event("g");
    assert_eq!(stage.active(), "w w/b");
}

#[test]
fn a_composite_that_was_put_around_is_remembered_with_what_is_in_it_if_that_is_deep() {
    let new = "
        START
        w
          START
          h past
          H depth
          a
          around
            START
            b
            w/around/START -> w/around/b
          w/START -> w/a
        off
        START -> w
        off -> w/past : g
        off -> w/depth : d
    ";
    let mut stage = Stage::new(PAST, &["e", "f"]);
    let plan = stage.plan(new);
    assert_eq!(
        stage.refusal(&plan),
        "the history `c/w/past` would be lost: it cannot remember that any more"
    );
    let report = stage.swap(&plan.accepting_losses()).unwrap();
    assert!(findings(&report).ends_with(
        "history `c/w/past`: lost, it cannot remember that any more\n\
             history `c/w/depth`: moved to `c/w/around/b, c/w/around`"
    ));
    stage.event("d");
    assert_eq!(stage.active(), "w w/around w/around/b");
}

#[test]
fn what_is_no_more_is_not_remembered() {
    let new = PAST.replace("      b\n", "").replace("      w/a -> w/b : e\n", "");
    let mut stage = Stage::new(PAST, &["e", "f"]);
    let plan = stage.plan(&new);
    assert_eq!(stage.refusal(&plan).lines().count(), 2);
    stage.swap(&plan.accepting_losses()).unwrap();
    stage.event("g");
    stage.step(0);
    assert_eq!(stage.active(), "w w/a");
}

#[test]
fn a_timer_is_lost_with_the_state_that_it_belongs_to() {
    let mut semantics = Semantics::yase();
    semantics.timers = TimerScope::State;
    let old = "START\na | entry=StartTimeout(v, 50ms)\nb\nSTART -> a\na -> b : v";
    let new = "START\nb | entry=StartTimeout(v, 50ms)\nd\nSTART -> b\nb -> d : v";
    let mut stage = Stage::with(semantics, old, &[]);
    let plan = stage.plan(new);
    assert!(
        stage
            .refusal(&plan)
            .contains("the timer `c: v` would be lost: the state that it belongs to is no more")
    );
    let mut stage = Stage::with(semantics, old, &[]);
    let plan = stage.plan(new).with_replacement("a", "b").unwrap();
    stage.swap(&plan).unwrap();
    stage.step(50);
    assert_eq!(stage.active(), "d");
}

#[test]
fn what_has_arrived_at_a_join_goes_on_waiting() {
    let old = "
        START
        & both
          one
            START
            A
            both/one/START -> both/one/A
          two
            START
            C
            D
            both/two/START -> both/two/C
            both/two/C -> both/two/D : f
        > j
        off
        START -> both
        both/one/A -> j
        both/two/D -> j
        j -> off
    ";
    let mut stage = Stage::with(Semantics::uml(), old, &[]);
    assert_eq!(stage.active(), "both both/one both/two both/two/C");
    let plan = stage.plan(&old.replace("        off\n", "        z\n        off\n"));
    let report = stage.swap(&plan).unwrap();
    assert!(findings(&report).ends_with("arrival `c/both/one/A -> c/j`: kept"));
    stage.event("f");
    assert_eq!(stage.active(), "off");
}

#[test]
fn a_new_region_goes_on_from_its_start_at_once_where_that_is_meant() {
    let old = "
        START
        & both
          one
            START
            A
            both/one/START -> both/one/A
        START -> both
    ";
    let new = "
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
    let mut stage = Stage::with(Semantics::uml(), old, &[]);
    let plan = stage.plan(new);
    stage.swap(&plan).unwrap();
    stage.lines();
    stage.step(3);
    assert_eq!(stage.lines(), "0.003 s swap; then both/two/START -> both/two/B; enter both/two, both/two/B");
}
