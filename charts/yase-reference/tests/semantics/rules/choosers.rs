//! R22: what the model leaves open.

use yase::{Chooser, ConflictResolution, Machine, Semantics};

use crate::rules::refusal;
use yase_reference::TestHost;
use yase_reference::{chart, script};

const WEIGHTS: &str = "
    START
    A
    ? c
    B
    C
    D
    E
    c/START -> A
    A -> c {w0.5} : e
    A -> D {w0.2} : e
    A -> E {w0.3} : e | f
    c -> B : [A.n > 0]
    c -> C : [A.n > 9]
";

/// The states that are reached, one run for each list of choices, and what the chooser has noted.
fn reached(
    text: &str,
    script_text: &str,
    semantics: Semantics,
    choices: &[&[u32]],
) -> Vec<(String, Vec<(u32, u32)>)> {
    let chart = chart(text);
    let run = |choices: &&[u32]| {
        let mut machine = Machine::new(script::compile_with(&chart, semantics));
        machine.set_chooser(Chooser::scripted(choices.to_vec()));
        let mut host = TestHost::new(&chart);
        script::run(&mut machine, &script::Script::parse(script_text), &mut host);
        let leaf = machine.configuration().pop().unwrap();
        (machine.chart().short_path(leaf), machine.chooser().choices().to_vec())
    };
    choices.iter().map(run).collect()
}

#[test]
fn r22_weighted_segments_are_drawn_and_drawn_again_until_one_is_open() {
    let found = reached(WEIGHTS, "1 e; 2", Semantics::yase(), &[&[1], &[2], &[0], &[0, 1], &[]]);
    let expected = [
        ("D", vec![(1, 3)]),
        ("E", vec![(2, 3)]),
        // the way through the CONDITION is closed: the rest is drawn
        ("D", vec![(0, 3), (0, 2)]),
        ("E", vec![(0, 3), (1, 2)]),
        ("D", vec![(0, 3), (0, 2)]),
    ];
    assert_eq!(found, expected.map(|(name, log)| (name.to_owned(), log)));
    let open = reached(WEIGHTS, "1 A=1; 2 e; 3", Semantics::yase(), &[&[0]]);
    assert_eq!(open, [("B".to_owned(), vec![(0, 3)])]);
}

#[test]
fn r22_only_segments_that_match_are_drawn_and_one_alone_is_not() {
    let found = reached(WEIGHTS, "1 f; 2", Semantics::yase(), &[&[7]]);
    assert_eq!(found, [("E".to_owned(), vec![])]);
}

#[test]
fn r22_a_segment_without_a_weight_keeps_its_place() {
    let text = "
        START
        A
        B
        C
        D
        c/START -> A
        A -> B {!1} : e [A.n > 0]
        A -> C {w0.5} : e
        A -> D {w0.5} : e
        A -> A {internal,!-1} : e
    ";
    let found = reached(text, "1 A=1; 2 e; 3", Semantics::yase(), &[&[1]]);
    assert_eq!(found, [("B".to_owned(), vec![])]);
    let found = reached(text, "1 A=0; 2 e; 3", Semantics::yase(), &[&[1]]);
    assert_eq!(found, [("D".to_owned(), vec![(1, 2)])]);
}

#[test]
fn r22_declared_takes_weighted_segments_in_their_order_and_seeds_draw_in_proportion() {
    let text = "
        START
        A
        c/START -> A
        A -> A {internal,w0.75} : e / raise(often)
        A -> A {internal,w0.25} : e / raise(seldom)
    ";
    let chart = chart(text);
    let seldom = |chooser: Chooser| {
        let mut machine = Machine::new(script::compile(&chart));
        machine.set_chooser(chooser);
        let mut host = TestHost::new(&chart);
        let events: Vec<String> = (1..=400).map(|time| format!("{time} e")).collect();
        script::run(&mut machine, &script::Script::parse(&events.join(";")), &mut host);
        host.log.iter().filter(|line| line.contains("seldom: dropped")).count()
    };
    assert_eq!(seldom(Chooser::declared()), 0);
    let drawn = seldom(Chooser::seeded(1));
    assert!((60..140).contains(&drawn), "{drawn} of 400");
    assert_eq!(drawn, seldom(Chooser::seeded(1)));
}

#[test]
fn r08_of_transitions_in_conflict_the_chooser_says_which_wins_if_that_is_meant() {
    let text = "
        START
        & both
          one
            START
            A
          two
            START
            B
        C
        D
        c/START -> both
        one/START -> A
        two/START -> B
        A -> C : e
        B -> D : e
    ";
    let mut random = Semantics::yase();
    random.conflict = ConflictResolution::Random;
    let found = reached(text, "1 e; 2", random, &[&[0], &[1]]);
    assert_eq!(found, [("C".to_owned(), vec![(0, 2)]), ("D".to_owned(), vec![(1, 2)])]);
    assert_eq!(reached(text, "1 e; 2", Semantics::yase(), &[&[1]]), [("C".to_owned(), vec![])]);
}

#[test]
fn r22_weights_that_are_no_shares_are_refused() {
    let text = |one: &str, other: &str| {
        format!("START\nA\nB\nc/START -> A\nA -> B {{w{one}}} : e\nA -> A {{w{other}}} : e")
    };
    assert_eq!(refusal(&text("0.5", "0.5")), "none");
    assert_eq!(
        refusal(&text("0.5", "0.25")),
        "error[M23]: the weights of the transitions out of `c/A` sum to 0.75 (they are shares, and sum to 1)"
    );
    assert_eq!(
        refusal(&text("0", "1")),
        "error[M23]: a transition out of `c/A` has weight 0 (a weight is more than 0 and at most 1)"
    );
}

#[test]
fn r22_what_is_drawn_at_a_node_stays_drawn_for_the_micro_step() {
    // both regions come by the same CONDITION in one micro-step, which one of them then loses
    let text = "
        START
        & both
          one
            START
            A
          two
            START
            B
        ? c
        D
        E
        c/START -> both
        one/START -> A
        two/START -> B
        A -> c : e
        B -> c : e
        c/c -> D {w0.5}
        c/c -> E {w0.5}
    ";
    let found = reached(text, "1 e; 2", Semantics::yase(), &[&[1, 0], &[0, 1]]);
    assert_eq!(found, [("E".to_owned(), vec![(1, 2)]), ("D".to_owned(), vec![(0, 2)])]);
}

#[test]
fn r22_what_leaves_a_connector_is_drawn_among_though_it_lies_on_several_blackboards() {
    // one way behind the CONDITION stays in the region, the other leaves the AND
    let text = "
        START
        & both
          one
            START
            A
            ? c
            B
          two
            START
            C
        D
        c/START -> both
        one/START -> A
        two/START -> C
        A -> one/c : e
        one/c -> B {w0.5}
        one/c -> D {w0.5} : [A.n == 1]
    ";
    let found = reached(text, "1 e; 2 A=1; 3", Semantics::yase(), &[&[0], &[1]]);
    // the one with a guard, which is tried first, is closed
    assert_eq!(found, [("both/two/C".to_owned(), vec![(0, 2)]), ("both/two/C".to_owned(), vec![(1, 2)])]);
    let open = reached(text, "1 A=1; 2 e; 3", Semantics::yase(), &[&[0], &[1]]);
    assert_eq!(open, [("D".to_owned(), vec![(0, 2)]), ("both/two/C".to_owned(), vec![(1, 2)])]);
}

/// With weights at a state and behind a connector.
const DEEP: &str = "
    START
    A
    ? c
    B
    C
    D
    E
    c/START -> A
    A -> c {w0.5} : e
    A -> D {w0.2} : e
    A -> E {w0.3} : e | f
    c -> B {w0.5} : [A.n != 3]
    c -> C {w0.5} : [A.n > 9]
";

#[test]
fn r22_what_is_drawn_at_a_state_and_behind_it_is_drawn_in_this_order() {
    let choices: [&[u32]; 4] = [&[0, 0], &[0, 1], &[1], &[2]];
    let found = reached(DEEP, "1 A=10; 2 e; 3", Semantics::yase(), &choices);
    let expected =
        [("B", vec![(0, 3), (0, 2)]), ("C", vec![(0, 3), (1, 2)]), ("D", vec![(1, 3)]), ("E", vec![(2, 3)])];
    assert_eq!(found, expected.map(|(name, log)| (name.to_owned(), log)));
    // nothing behind the connector is open: `D` and `E` are left
    let found = reached(DEEP, "1 A=3; 2 e; 3", Semantics::yase(), &[&[0, 1, 1]]);
    assert_eq!(found, [("E".to_owned(), vec![(0, 3), (1, 2), (1, 2)])]);
    let found = reached(DEEP, "1 f; 2", Semantics::yase(), &[&[7]]);
    assert_eq!(found, [("E".to_owned(), vec![])], "what does not match is not drawn");
}

#[test]
fn r22_behind_a_connector_that_is_not_come_by_nothing_is_drawn() {
    let text = "
        START
        A
        ? c
        B
        C
        D
        c/START -> A
        A -> c : e [A.n > 0]
        A -> D : e
        c -> B {w0.5}
        c -> C {w0.5}
    ";
    let found = reached(text, "1 A=0; 2 e; 3", Semantics::yase(), &[&[1]]);
    assert_eq!(found, [("D".to_owned(), vec![])]);
    let found = reached(text, "1 A=1; 2 e; 3", Semantics::yase(), &[&[1]]);
    assert_eq!(found, [("C".to_owned(), vec![(1, 2)])]);
}

#[test]
fn r22_weights_are_drawn_where_the_first_that_matches_stands() {
    let behind = "A -> k {w0.5} : e\nk -> D {w0.5}\nk -> E {w0.5}";
    for (node, weighted, last) in [("", "A -> D {w0.5} : e", "D"), ("? k", behind, "E")] {
        let text = format!(
            "START\nA\n{node}\nB\nC\nD\nE\nc/START -> A\nA -> B {{w0.5}} : f\nA -> C : e [A.n > 0]\n{weighted}"
        );
        let found = reached(&text, "1 A=1; 2 e; 3", Semantics::yase(), &[&[0, 1]]);
        assert_eq!(found, [("C".to_owned(), vec![])], "it is declared before");
        let found = reached(&text, "1 A=0; 2 e; 3", Semantics::yase(), &[&[1]]);
        assert_eq!(found[0].0, last);
    }
}

#[test]
fn r22_a_drawn_way_is_open_only_if_all_behind_it_is() {
    let text = "
        START
        A
        ? c
        ? k
        B
        C
        G
        c/START -> A
        A -> k {w0.5} : e
        A -> c {w0.5} : e
        k -> G : [A.n > 0]
        c -> B {w0.5}
        c -> C {w0.5}
    ";
    let found = reached(text, "1 A=0; 2 e; 3", Semantics::yase(), &[&[0, 1]]);
    assert_eq!(found, [("C".to_owned(), vec![(0, 2), (1, 2)])]);
    let found = reached(text, "1 A=1; 2 e; 3", Semantics::yase(), &[&[0]]);
    assert_eq!(found, [("G".to_owned(), vec![(0, 2)])]);
}

#[test]
fn r22_what_is_drawn_at_one_connector_says_nothing_of_another() {
    let text = "
        START
        & both
          one
            START
            A
            ? c
            B
            C
          two
            START
            D
            ? k
            E
            F
        c/START -> both
        one/START -> A
        two/START -> D
        A -> one/c : e
        D -> k : e
        one/c -> B {w0.5}
        one/c -> C {w0.5}
        k -> E {w0.5}
        k -> F {w0.5}
    ";
    let found = reached(text, "1 e; 2", Semantics::yase(), &[&[1, 1], &[0, 1], &[1, 0]]);
    let expected = [
        ("both/two/F", vec![(1, 2), (1, 2)]),
        ("both/two/F", vec![(0, 2), (1, 2)]),
        ("both/two/E", vec![(1, 2), (0, 2)]),
    ];
    assert_eq!(found, expected.map(|(name, log)| (name.to_owned(), log)));
}

#[test]
fn r22_if_nothing_drawn_is_open_nothing_happens() {
    let text = "
        START
        A
        c/START -> A
        A -> A {internal,w0.5} : e [A.n > 0]
        A -> A {internal,w0.5} : e [A.n > 0]
    ";
    let found = reached(text, "1 A=0; 2 e; 3", Semantics::yase(), &[&[1]]);
    assert_eq!(found, [("A".to_owned(), vec![(1, 2)])]);
}

#[test]
fn r22_what_was_drawn_in_vain_is_not_drawn_for_the_next_with_a_weight() {
    let text = "
        START
        A
        ? c
        B
        C
        D
        c/START -> A
        A -> c : e
        c -> B {w0.5} : [A.n == 1]
        c -> C {w0.5} : [A.n == 2]
        c -> D
    ";
    let chart = chart(text);
    let mut machine = Machine::new(script::compile(&chart));
    machine.set_chooser(Chooser::scripted(vec![1]));
    let mut host = TestHost { reads: true, ..TestHost::new(&chart) };
    script::run(&mut machine, &script::Script::parse("1 A=0; 2 e; 3"), &mut host);
    let expected = "0.002 s e: A -> c -> D; exit A; enter D; read c -> C = false, c -> B = false";
    crate::rules::compare(&host.log[2..], expected);
}
