//! R12: what a composite remembers.

use crate::rules::compare;

#[test]
fn r12_a_history_remembers_the_last_exit_of_its_composite() {
    // the first exit is from A, the second from B: each return is to where the composite was left
    // last
    let chart = yase_reference::chart(
        "
        START
        P
          START
          h h
          A
          B
        X
        c/START -> P
        P/START -> A
        A -> B : next
        P -> X : away
        X -> P/h : back
        ",
    );
    let log = yase_reference::script::play(&chart, "1 away; 2 back; 3 next; 4 away; 5 back; 6");
    compare(
        &log[3..],
        "
        0.001 s away: P -> X; exit P/A, P; enter X
        0.002 s back: X -> P/h; exit X; enter P, P/A
        0.003 s next: P/A -> P/B; exit P/A; enter P/B
        0.004 s away: P -> X; exit P/B, P; enter X
        0.005 s back: X -> P/h; exit X; enter P, P/B
        ",
    );
}
