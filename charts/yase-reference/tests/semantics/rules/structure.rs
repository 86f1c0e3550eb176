//! R1 to R3: nodes, scopes, order.

use yase::statechart::{Node, NodeKind, Statechart, Transition};
use yase::{Machine, NodeId, Timestamp};

use crate::rules::{check, refusal};
use yase_reference::test_host::{TestHost, vocabulary};
use yase_reference::{chart, script};

const REGIONS: &str = "
    START
    & both
      one
        START
        A
        B
      two
        START
        C
    out
    c/START -> both
    both/one/START -> A
    both/two/START -> C
";

#[test]
fn r01_a_configuration_is_closed_and_has_one_child_for_each_or_and_all_for_each_and() {
    let chart = chart(REGIONS);
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    for _ in 0..3 {
        let configuration = machine.configuration();
        for &node in &configuration {
            assert!(chart.node(node).parent.is_none_or(|parent| machine.is_active(parent)));
            let active = chart.children(node).iter().filter(|&&child| machine.is_active(child)).count();
            match chart.node(node).kind {
                NodeKind::Or => assert_eq!(active, 1),
                NodeKind::And => assert_eq!(active, chart.children(node).len()),
                _ => assert_eq!(active, 0),
            }
        }
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    }
    let names: Vec<String> =
        machine.configuration().into_iter().map(|node| machine.chart().short_path(node)).collect();
    assert_eq!(names, ["c", "both", "both/one", "both/one/A", "both/two", "both/two/C"]);
}

#[test]
fn r01_a_start_without_an_open_way_is_a_resting_place_and_reported_once() {
    check(
        "
        START
        A
        c/START -> A : [A.n > 0]
        ",
        "10 A=0; 20 A=1; 30",
        "
        0.000 s start; enter c, START
        waits at START
        0.020 s -: START -> A; exit START; enter A
        ",
    );
}

#[test]
fn r01_composites_without_exactly_one_start_are_refused() {
    assert_eq!(
        refusal("START\ninner\n  A\n& both\nc/START -> A"),
        "error[M01]: composite `c/inner` has no START (a composite has exactly one START)\n\
         error[M01]: AND `c/both` has no regions"
    );
    assert_eq!(
        refusal("START\nSTART\nA\nc/A -> A"),
        "error[M01]: composite `c` has 2 STARTs (a composite has exactly one START)"
    );
    assert_eq!(
        refusal("START\n& both\n  START\n  A\n  END\nc/START -> both"),
        "error[M01]: START `c/both/START` stands in an AND (the regions of an AND begin and end, each by itself)\n\
         error[M01]: END `c/both/END` stands in an AND (the regions of an AND begin and end, each by itself)"
    );
    assert_eq!(
        refusal("START\ninner\n  START\nA\nc/START -> A\ninner/START -> A"),
        "error[M01]: `c/inner/START` leads out of its composite, to `c/A`"
    );
}

#[test]
fn r01_what_stands_where_it_cannot_is_refused() {
    assert_eq!(
        refusal("START\nEND\nA\nc/START -> A\nc/END -> A\nA -> c/START\nc/START -> A : e"),
        "error[M02]: no transition can leave `c/END`\n\
         error[M02]: no transition can enter `c/START` (enter the composite: it begins at its START)\n\
         error[M02]: a transition out of `c/START` cannot wait for an event (write the trigger where the path begins)"
    );
    let mut chart = Statechart::new("c");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let a = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "A"));
    chart.node_mut(start).activity = Some("act".into());
    chart.add(start, Node::new(NodeKind::Basic, "in START"));
    chart.connect(Transition::new(start, a));
    chart.connect(Transition::new(a, NodeId(99)));
    let found: Vec<String> =
        chart.compile(&vocabulary()).unwrap_err().iter().map(ToString::to_string).collect();
    assert_eq!(
        found,
        [
            "error[E0502]: `c/START` is a START and cannot hold states",
            "error[E0503]: `c/START` is a START and cannot have an activity",
            "error[M03]: transition 1 names a node that does not exist",
        ]
    );
}

#[test]
fn r01_a_chart_that_is_no_tree_is_refused() {
    let refused = |spoil: fn(&mut Statechart)| {
        let mut chart = chart("START\nP\n  START\n  A\nc/START -> P\nP/START -> A\n");
        spoil(&mut chart);
        chart.compile(&vocabulary()).unwrap_err().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(
        refused(|chart| chart.node_mut(Statechart::ROOT).kind = NodeKind::And),
        ["error[E0504]: the root of `c` is not an OR without parent"]
    );
    assert_eq!(
        refused(|chart| chart.node_mut(NodeId(2)).parent = Some(NodeId(4))),
        ["error[E0504]: node 2 lies in node 0, which is not its parent"]
    );
}

#[test]
fn r02_the_scope_is_the_lowest_or_that_properly_contains_both_ends() {
    check(
        "
        START
        outer
          START
          inner
            START
            A
            B
        c/START -> outer
        outer/START -> inner
        inner/START -> A
        A -> B : near
        B -> outer/inner : around
        inner -> A : own
        outer -> B : child
        ",
        "1 near; 2 around; 3 near; 4 own; 5 near; 6 child; 7",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> outer; exit START; enter outer, outer/START
        0.000 s -: outer/START -> outer/inner; exit outer/START; enter outer/inner, outer/inner/START
        0.000 s -: outer/inner/START -> outer/inner/A; exit outer/inner/START; enter outer/inner/A
        0.001 s near: outer/inner/A -> outer/inner/B; exit outer/inner/A; enter outer/inner/B
        0.002 s around: outer/inner/B -> outer/inner; exit outer/inner/B, outer/inner; enter outer/inner, outer/inner/START
        0.002 s -: outer/inner/START -> outer/inner/A; exit outer/inner/START; enter outer/inner/A
        0.003 s near: outer/inner/A -> outer/inner/B; exit outer/inner/A; enter outer/inner/B
        0.004 s own: outer/inner -> outer/inner/A; exit outer/inner/B, outer/inner; enter outer/inner, outer/inner/A
        0.005 s near: outer/inner/A -> outer/inner/B; exit outer/inner/A; enter outer/inner/B
        0.006 s child: outer -> outer/inner/B; exit outer/inner/B, outer/inner, outer; enter outer, outer/inner, outer/inner/B
        ",
    );
}

#[test]
fn r02_a_scope_is_never_an_and() {
    check(
        "
        START
        & both
          one
            START
            A
          two
            START
            B
        c/START -> both
        one/START -> A
        two/START -> B
        both/one -> both/one : again
        ",
        "1 again; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s again: both/one -> both/one; exit both/one/A, both/one, both/two/B, both/two, both; enter both, both/one, both/one/START, both/two, both/two/START
        0.001 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        ",
    );
}

#[test]
fn r02_an_external_self_transition_exits_and_enters_an_internal_one_does_not() {
    check(
        "
        START
        A | entry=raise(entered) | exit=raise(left)
        c/START -> A
        A -> A : outside / raise(done)
        A -> A {internal} : inside / raise(done)
        ",
        "1 outside; 2 inside; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; do raise(entered) (entry A); enter A
        0.000 s entered: dropped
        0.001 s outside: A -> A; exit A; do raise(left) (exit A), raise(done) (A -> A), raise(entered) (entry A); enter A
        0.001 s left: dropped
        0.001 s done: dropped
        0.001 s entered: dropped
        0.002 s inside: A -> A; do raise(done) (A -> A)
        0.002 s done: dropped
        ",
    );
}

#[test]
fn r02_a_local_transition_uses_its_source() {
    check(
        "
        START
        outer
          START
          A
          B
        c/START -> outer
        outer/START -> A
        outer -> B {internal} : e
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> outer; exit START; enter outer, outer/START
        0.000 s -: outer/START -> outer/A; exit outer/START; enter outer/A
        0.001 s e: outer -> outer/B; exit outer/A; enter outer/B
        ",
    );
}

#[test]
fn r02_what_is_internal_stays_inside() {
    assert_eq!(
        refusal("START\nA\nB\nc/START -> A\nA -> B {internal}"),
        "error[M03]: `c/B` does not lie in `c/A` (an internal transition stays inside its source)"
    );
    assert_eq!(
        refusal("START\nA\nc/START -> A\nA -> c\nc -> A"),
        "error[M03]: no transition can enter the root `c`\n\
         error[M03]: no transition can leave `c`"
    );
}

#[test]
fn r03_priority_comes_first_then_a_guard_then_the_order_in_the_model() {
    let order = |ways: &str| {
        let chart = chart(&format!("START\nA\nB\nC\nD\nc/START -> A\n{ways}"));
        let log = script::play(&chart, "1 A=1; 2 e; 3");
        log.into_iter().find(|line| line.contains(" e: ")).unwrap()
    };
    let taken = |line: String, target: &str| assert!(line.contains(&format!("A -> {target};")), "{line}");
    taken(order("A -> B : e\nA -> C : e\nA -> D : e"), "B");
    taken(order("A -> B : e\nA -> C : e [A.n == 1]\nA -> D : e [A.n == 1]"), "C");
    taken(order("A -> B : e\nA -> C : e [A.n == 1]\nA -> D {!1} : e"), "D");
    taken(order("A -> B {!-1} : e [A.n == 1]\nA -> C : e\nA -> D {!-2} : e"), "C");
}

#[test]
fn r03_connectors_are_tried_depth_first_and_the_first_complete_path_is_taken() {
    check(
        "
        START
        A
        ? c1
        ? c2
        B
        C
        D
        c/START -> A
        A -> c1 : e
        c1 -> c2 : [A.n > 0]
        c1 -> B
        c2 -> C : [A.n > 5]
        c2 -> D : [A.n > 9]
        B -> A : back
        C -> A : back
        ",
        "0 A=1; 1 e; 2 back; 2 A=7; 3 e; 4 back; 4 A=0; 5 e; 6",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> c1 -> B; exit A; enter B
        0.002 s back: B -> A; exit B; enter A
        0.003 s e: A -> c1 -> c2 -> C; exit A; enter C
        0.004 s back: C -> A; exit C; enter A
        0.005 s e: A -> c1 -> B; exit A; enter B
        ",
    );
}
