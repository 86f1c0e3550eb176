//! Monitoring properties allocates nothing in a cycle.
#![allow(clippy::unwrap_used)] // a test may fail

#[path = "../../../messages/narukom/tests/counting/mod.rs"]
mod counting;
#[path = "monas/kit.rs"]
mod kit;

use kit::{BALL, Ball, at};
use monas::{Agent, Blackboard, BoxError, Hz, Registry, Simulation, Talws, ViolationResponse};
use yase::Source;

/// A chart with two regions that goes round every 10 ms, and a ball that is there every other time.
fn simulation(properties: Option<&str>) -> Simulation {
    let text = "Liveness:\nm = (A . B)~ || C~\nTransitions:\nB -> END : [t] / StartTimeout(t, 10ms)\n\
                C -> C : [u] / StartTimeout(u, 10ms)";
    let (chart, findings) = aseme_models::statechart_of(&Source::new("m.srm", text));
    assert_eq!(findings, []);
    let registry = ["A", "B", "C"]
        .into_iter()
        .fold(Registry::linked(), |registry, name| registry.with(name, || |_: &mut Blackboard| ()));
    let mut agent = Agent::statechart("m", chart);
    if let Some(text) = properties {
        let (properties, findings) = aseme_verify::properties::parse(text);
        assert_eq!(findings, []);
        agent = agent.monitor(properties, ViolationResponse::Log);
    }
    let throw = |b: &mut Blackboard| -> Result<(), BoxError> {
        let x = b.now().as_secs_f64();
        Ok(b.publish(BALL, Ball { x, found: ((x * 100.0) as u64).is_multiple_of(2), ..Ball::default() })?)
    };
    let balls = Agent::new("z", Hz(100)).activity(throw);
    Talws::new().registry(registry).agent(agent).agent(balls).simulate(1).unwrap()
}

/// The allocations of one second after warm-up.
fn allocations(properties: Option<&str>) -> u64 {
    let mut simulation = simulation(properties);
    simulation.run_until(at(2_000)).unwrap();
    let count = counting::allocations(|| simulation.run_until(at(3_000)).unwrap()).0;
    assert!(simulation.statistics().agents[0].cycles > 200);
    count
}

#[test]
fn following_properties_allocates_nothing() {
    let followed = "property \"it goes round\": always (entering A implies eventually entering B within 1 s)\n\
                    property \"both\": always (in C implies (in A or in B or [ball.x >= 0] or not [ball.found]))\n\
                    property \"until\": always (entering B implies (in C until leaving B within 1 s))\n";
    let (without, with) = (allocations(None), allocations(Some(followed)));
    assert_eq!(with, without);
    // a violation is logged, which allocates its text
    let violated = "property \"never\": always not entering B\n";
    assert!(allocations(Some(violated)) > without, "who counts counts here too");
}
