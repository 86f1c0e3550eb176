//! Guards that are evaluated for inspection.

use yase::{GuardValue, Machine, Timestamp, Transition};
use yase_reference::script::{Script, compile_with, run};
use yase_reference::{TestHost, chart};

#[test]
fn guards_of_active_states_and_of_connectors_are_evaluated_without_an_effect() {
    let written = chart(
        "
        START
        S
        T
        ? q
        c/START -> S
        S -> q : [A.n > 2]
        S -> T : [B.n > 1]
        S -> T : [fail() > 0]
        q -> T : [A.n > 9]
        T -> S : [A.n > 0]
        ",
    );
    let mut host = TestHost::new(&written);
    let mut machine = Machine::new(compile_with(&written, yase::Semantics::yase()));
    run(&mut machine, &Script::parse("10 A=5"), &mut host);
    let (log, before) = (host.log.clone(), machine.configuration());
    let named = |value: &GuardValue| {
        let Transition { source, target, .. } = written.transition(value.transition);
        (format!("{} -> {}", written.path(*source), written.path(*target)), value.holds)
    };
    let seen: Vec<_> = machine.guard_values(&host).iter().map(named).collect();
    let expected = [
        ("c/S -> c/q", Some(true)),
        ("c/q -> c/T", Some(false)),
        ("c/S -> c/T", Some(false)),
        ("c/S -> c/T", None),
    ];
    assert_eq!(seen, expected.map(|(name, holds)| (name.to_owned(), holds)));
    assert_eq!((host.log, machine.configuration()), (log, before));
    assert!(!machine.needs_step(Timestamp::from_millis(20)));
}
