//! R1, R6, R12: connectors that cannot be followed are refused, each by name.

use yase::{Machine, MachineErrorKind, Status, Timestamp};

use crate::rules::refusal;
use yase_reference::{TestHost, chart, script};

const BOTH: &str = "
    START
    A
    & both
      one
        START
        B
        C
      two
        START
        D
    c/START -> A
    one/START -> B
    two/START -> D
";

fn with(lines: &str) -> String {
    // nodes stand before transitions only for those who read it
    refusal(&format!("{BOTH}{lines}"))
}

#[test]
fn r12_forks_that_do_not_lead_into_different_regions_are_refused() {
    let apart = "the branches of a FORK lead to different regions of one AND";
    assert_eq!(
        with("    < f\n    A -> f : e\n    f -> B\n    f -> C"),
        format!(
            "error[M04]: a FORK leads to `c/both/one/B` and `c/both/one/C`, which cannot be active together ({apart})"
        )
    );
    assert_eq!(
        with("    < f\n    A -> f : e\n    f -> B\n    f -> both"),
        format!(
            "error[M04]: a FORK leads to `c/both/one/B` and `c/both`, which cannot be active together ({apart})"
        )
    );
    assert_eq!(
        with("    < f\n    ! ch\n    A -> f : e\n    f -> D\n    f -> ch\n    ch -> B\n    ch -> A"),
        format!(
            "error[M04]: a FORK leads to `c/both/two/D` and `c/ch`, which cannot be active together ({apart})"
        )
    );
    assert_eq!(
        with("    < f\n    A -> f : e\n    f -> B"),
        "error[M04]: FORK `c/f` has fewer than two outgoing transitions"
    );
    assert_eq!(
        with("    < f\n    A -> f : e\n    f -> B : [true]\n    f -> D : g"),
        "error[M04]: a transition out of `c/f` cannot wait for an event (write the trigger where the path begins)"
    );
    assert_eq!(
        with("    < f\n    A -> f : e\n    f -> B : [true]\n    f -> D"),
        "error[M04]: an outgoing transition of FORK `c/f` has a guard (all outgoing transitions of a FORK are taken)"
    );
}

#[test]
fn r12_joins_of_what_is_not_active_together_are_refused() {
    let sources = "its two or more sources lie in different regions of one AND";
    let refused = format!("error[M04]: JOIN `c/j` does not join states that are active together ({sources})");
    assert_eq!(with("    > j\n    B -> j\n    C -> j\n    j -> A"), refused);
    assert_eq!(with("    > j\n    B -> j\n    A -> j\n    j -> A"), refused);
    assert_eq!(with("    > j\n    B -> j\n    B -> j\n    D -> j\n    j -> A"), refused);
    assert_eq!(with("    > j\n    B -> j\n    j -> A"), refused);
    assert_eq!(
        with("    > j\n    B -> j : e\n    D -> j\n    j -> A\n    j -> D"),
        "error[M04]: a transition into JOIN `c/j` waits for an event (a JOIN waits until its sources have completed)"
    );
    assert_eq!(
        with("    > j\n    B -> j\n    D -> j\n    j -> A\n    j -> D"),
        "error[M04]: JOIN `c/j` does not have exactly one outgoing transition"
    );
}

#[test]
fn r06_connectors_of_every_kind_that_lead_in_a_circle_or_nowhere_are_refused() {
    assert_eq!(
        with("    ! p\n    ! q\n    A -> p : e\n    p -> q\n    q -> p"),
        "error[M06]: connectors lead in a circle: `c/p` -> `c/q` -> `c/p`"
    );
    assert_eq!(with("    i in\n    A -> in : e"), "error[M06]: no path continues from `c/in`");
    assert_eq!(with("    h h\n    both -> h : e"), "none", "a HISTORY may lead to START");
}

#[test]
fn r10_a_history_that_leads_out_of_its_composite_is_refused() {
    assert_eq!(
        with("    P\n      START\n      h h\n      E\n    P/START -> E\n    A -> h : e\n    h -> A"),
        "error[M03]: `c/P/h` leads out of its composite, to `c/A` \
         (it stands for what is in its composite, and so does what it leads to)"
    );
}

#[test]
fn r12_a_choice_without_an_else_is_warned_of_and_stops_with_its_name() {
    let text = "START\nA | run | for=5ms\nB\n! ch\nc/START -> A\nA -> ch {interrupts} : e / A.n = 1\nch -> B : [A.n > 1]";
    let warnings: Vec<String> = chart(text).check().iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        ["warning[M05]: every outgoing transition of `c/ch` has a guard: the chart may fail there"]
    );

    let chart = chart(text);
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    let job = host.jobs.remove(0);
    machine.activity_returned(job.activation, yase::Outcome::Done);
    machine.dispatch_name("e");
    let before = machine.configuration();
    let error = machine.run_to_completion(Timestamp::from_millis(9), &mut host).unwrap_err();
    assert_eq!(error.kind(), MachineErrorKind::NoBranch);
    assert_eq!(error.node().map(|node| machine.chart().short_path(node)).as_deref(), Some("ch"));
    assert_eq!(error.to_string(), "no outgoing transition of CHOICE `ch` is enabled");
    assert_eq!((machine.status(), machine.configuration()), (Status::Stopped, before));
}

#[test]
fn r12_a_choice_that_fails_while_the_chart_starts_is_reported_by_the_first_step() {
    let chart = chart("START\nA\n! ch\nc/START -> ch\nch -> A : [A.n > 1]");
    let mut machine = Machine::new(script::compile_with(&chart, yase::Semantics::uml()));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    assert!(machine.needs_step(Timestamp::ZERO));
    let error = machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap_err();
    assert_eq!(error.kind(), MachineErrorKind::NoBranch);
    assert_eq!((machine.status(), machine.configuration().len()), (Status::Stopped, 0));
}
