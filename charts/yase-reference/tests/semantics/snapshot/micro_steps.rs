//! A run-to-completion step, taken one micro-step at a time.

use std::num::NonZeroU32;

use yase::{Machine, MachineErrorKind, MicroStep, Semantics, Status, StepSummary, Timestamp};

use yase_reference::test_host::TestHost;

const RELAY: &str = "
    START
    a | exit=raise(f)
    b
    c | run
    START -> a
    a -> b : e
    b -> c : f
";

fn begun(semantics: Semantics) -> (Machine, TestHost) {
    let chart = yase_reference::chart(RELAY);
    let mut host = TestHost::new(&chart);
    let mut machine = Machine::new(yase_reference::script::compile_with(&chart, semantics));
    machine.start(Timestamp::ZERO, &mut host);
    (machine, host)
}

#[test]
fn micro_steps_one_by_one_are_the_step() {
    let (mut whole, mut whole_world) = begun(Semantics::yase());
    whole.dispatch_name("e");
    let summary = whole.run_to_completion(Timestamp::from_millis(5), &mut whole_world).unwrap();

    let (mut machine, mut host) = begun(Semantics::yase());
    machine.dispatch_name("e");
    let mut made = 0;
    let found = loop {
        // the time stands still from the first one on
        match machine.micro_step(Timestamp::from_millis(5 + made), &mut host).unwrap() {
            MicroStep::Progressed => made += 1,
            MicroStep::Stable(summary) => break summary,
        }
        assert!(machine.is_mid_step() && machine.needs_step(Timestamp::ZERO));
        assert!(!host.log.iter().any(|line| line.contains("start c")), "activities start at the end");
    };
    assert_eq!((made, found, &host.log), (3, summary, &whole_world.log));
    assert!(!machine.is_mid_step());
}

#[test]
fn the_rest_of_a_step_can_be_taken_in_one_go() {
    let (mut machine, mut host) = begun(Semantics::yase());
    machine.dispatch_name("e");
    assert_eq!(machine.micro_step(Timestamp::ZERO, &mut host), Ok(MicroStep::Progressed));
    let summary = machine.run_to_completion(Timestamp::from_millis(9), &mut host).unwrap();
    assert_eq!((summary.micro_steps, summary.transitions, summary.started), (3, 3, 1));
    assert!(host.log.iter().all(|line| line.starts_with("0.000 s") || line.starts_with("  ")));
}

#[test]
fn a_machine_that_does_not_run_has_no_micro_steps() {
    let (mut machine, mut host) = begun(Semantics::yase());
    assert_eq!(machine.micro_step(Timestamp::ZERO, &mut host), Ok(MicroStep::Progressed));
    machine.stop(&mut host);
    assert!(!machine.is_mid_step(), "the step is given up");
    let nothing = Ok(MicroStep::Stable(StepSummary::default()));
    assert_eq!(machine.micro_step(Timestamp::ZERO, &mut host), nothing);
}

#[test]
fn the_bound_on_micro_steps_is_that_of_the_step() {
    let mut semantics = Semantics::yase();
    semantics.limit = NonZeroU32::new(2).unwrap();
    let (mut machine, mut host) = begun(semantics);
    machine.dispatch_name("e");
    assert_eq!(machine.micro_step(Timestamp::ZERO, &mut host), Ok(MicroStep::Progressed));
    assert_eq!(machine.micro_step(Timestamp::ZERO, &mut host), Ok(MicroStep::Progressed));
    let error = machine.micro_step(Timestamp::ZERO, &mut host).unwrap_err();
    assert_eq!((error.kind(), machine.status()), (MachineErrorKind::NeverRests, Status::Stopped));
}
