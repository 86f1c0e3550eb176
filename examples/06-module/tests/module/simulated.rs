//! Modules in simulated time.

use monas::{Agent, Hz, Module, Moment, Registry, Talws};
use monas_soccer::Ball;
use monas_soccer::topics::BALL;

use crate::built::{blind_eyes, eyes};

#[test]
fn what_a_module_publishes_is_read_as_what_it_is() {
    let module = Module::load(eyes()).expect("it fits");
    assert_eq!((module.name(), module.activity_names().collect::<Vec<_>>()), ("eyes", vec!["Eyes"]));
    let registry = Registry::linked().with_module(module).expect("no name is taken");
    let eyes = registry.activity("Eyes").expect("it is made");
    let talws = Talws::new().agent(Agent::new("Head", Hz(10)).named_activity("Eyes", eyes));
    let mut simulation = talws.simulate(7).expect("it starts");
    simulation.run_until(Moment::from_secs_f64(1.0)).expect("it runs");
    let mut board = simulation.hub(Talws::LOCAL).expect("the host").blackboard("test");
    board.process_messages(simulation.now());
    let ball: &Ball = board.read(BALL).expect("it was published");
    assert_eq!((ball.found, ball.distance), (true, 2.0));
}

#[test]
fn a_constructor_that_panics_is_told_and_harms_nobody() {
    let module = Module::load(blind_eyes()).expect("it fits");
    let registry = Registry::linked().with_module(module).expect("no name is taken");
    let error = registry.activity("Eyes").err().expect("it cannot be made");
    assert!(error.to_string().ends_with("cannot be made: panicked: no lens"), "{error}");
}
