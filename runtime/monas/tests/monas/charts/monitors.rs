//! Properties monitored while a chart runs.

use std::sync::{Arc, Mutex};

use aseme_verify::properties::{Property, parse};
use monas::generated::{GeneratedChart, Instance, NodeId, NodeKind, TypedChartBuilder};
use monas::records::Cycle;
use monas::{
    Agent, Blackboard, ChartSettings, FailurePolicy, Hz, Registry, Simulation, Talws, Timestamp,
    ViolationResponse,
};
use narukom::{Observer, Publication};

use super::{balls, chart, noting};
use crate::kit::at;
use crate::taped::{Tape, replay_simulated};

/// A loop that enters `A` at 0 ms, twice, and every 100 ms after.
const LOOP: &str = "Liveness:\nm = A~\nTransitions:\nA -> A : [t] / StartTimeout(t, 100ms)";

fn properties(text: &str) -> Vec<Property> {
    let (properties, findings) = parse(&format!("property \"p\": {text}"));
    assert_eq!(findings, []);
    properties
}

/// Violations: the time of the cycle, its number, and the name.
#[derive(Clone, Default)]
struct Violations(Arc<Mutex<Vec<(Timestamp, u64, String)>>>);

impl Observer for Violations {
    fn observe(&mut self, publication: Publication<'_>) {
        if let Some(cycle) = publication.sample.message.as_any().downcast_ref::<Cycle>() {
            let texts = cycle
                .violations
                .iter()
                .map(|it| (Timestamp::from_nanos(cycle.time), cycle.number, it.property.clone()));
            self.0.lock().unwrap().extend(texts);
        }
    }
}

fn simulated(agent: Agent, registry: Registry) -> (Simulation, Violations) {
    let violations = Violations::default();
    let mut talws = Talws::new().registry(registry).agent(agent).agent(balls(&[10, 20, 30, 40]));
    talws.observe(Box::new(violations.clone()));
    (talws.simulate(1).unwrap(), violations)
}

fn times(violations: &Violations) -> Vec<u64> {
    violations.0.lock().unwrap().iter().map(|(time, ..)| time.as_nanos()).collect()
}

#[test]
fn missed_deadlines_are_reported_each_time() {
    let agent = |bound: &str| {
        let text = format!("always eventually entering A within {bound}");
        Agent::statechart("m", chart(LOOP)).monitor(properties(&text), ViolationResponse::Log)
    };
    let (mut simulation, violations) = simulated(agent("100 ms"), noting().1);
    simulation.run_until(at(1_000)).unwrap();
    assert_eq!(times(&violations), [0; 0]);
    let (mut simulation, violations) = simulated(agent("50 ms"), noting().1);
    simulation.run_until(at(290)).unwrap();
    assert_eq!(times(&violations), [50_000_001, 150_000_001, 250_000_001]);
    assert_eq!(simulation.statistics().agents[0].stopped, None, "it is only reported");
    let (_, number, name) = violations.0.lock().unwrap()[0].clone();
    assert_eq!((number > 1, name.as_str()), (true, "p"));
}

#[test]
fn a_condition_is_read_from_what_the_step_sees() {
    let (_, registry) = noting();
    let role = "Liveness:\nm = A . B\nTransitions:\nA -> B : [ball.x >= 0.03]";
    let entering = |limit: &str| {
        let text = format!("always (entering B implies [ball.found && ball.x >= {limit}])");
        Agent::statechart("m", chart(role)).monitor(properties(&text), ViolationResponse::Log)
    };
    let (mut simulation, violations) = simulated(entering("0.03"), registry.clone());
    simulation.run_until(at(100)).unwrap();
    assert_eq!(times(&violations), [0; 0]);
    let (mut simulation, violations) = simulated(entering("0.035"), registry);
    simulation.run_until(at(100)).unwrap();
    assert_eq!(times(&violations), [30_000_000]);
}

#[test]
fn a_violation_may_have_the_agent_do_what_it_does_when_an_activity_fails() {
    let stopped = |policy, on_violation| {
        let agent = Agent::statechart("m", chart(LOOP)).on_failure(policy);
        let agent = agent.monitor(properties("always not leaving A"), on_violation);
        let (mut simulation, violations) = simulated(agent, noting().1);
        simulation.run_until(at(300)).unwrap();
        (times(&violations).len(), simulation.statistics().agents[0].stopped.clone())
    };
    let (count, reason) = stopped(FailurePolicy::StopAgent, ViolationResponse::Policy);
    assert_eq!(count, 1);
    assert!(reason.unwrap().starts_with("the property `p` was violated in cycle "));
    assert_eq!(stopped(FailurePolicy::SafeState, ViolationResponse::Policy).0, 1);
    for (policy, on_violation) in
        [(FailurePolicy::StopAgent, ViolationResponse::Log), (FailurePolicy::Skip, ViolationResponse::Policy)]
    {
        let (count, reason) = stopped(policy, on_violation);
        assert_eq!(reason, None);
        assert!(count > 1, "each violation is reported");
    }
}

#[test]
fn properties_without_always_are_decided_once() {
    let agent = Agent::statechart("m", chart(LOOP))
        .monitor(properties("not leaving A until [ball.found]"), ViolationResponse::Log);
    let (mut simulation, violations) = simulated(agent, noting().1);
    simulation.run_until(at(300)).unwrap();
    assert_eq!(times(&violations), [0]);
}

fn nothing(_: &mut Blackboard) {}

/// `A`, then `B`, as code.
fn generated() -> GeneratedChart {
    let mut chart = TypedChartBuilder::new("m");
    for (id, kind, name) in [(1, NodeKind::Start, ""), (2, NodeKind::Basic, "A"), (3, NodeKind::Basic, "B")] {
        chart.add(NodeId(id), NodeId(0), kind, name);
    }
    chart.activity(NodeId(2), "A");
    chart.activity(NodeId(3), "B");
    chart.connect(NodeId(1), NodeId(2), "");
    chart.connect(NodeId(2), NodeId(3), "");
    let instances = vec![Instance::new(NodeId(2), nothing), Instance::new(NodeId(3), nothing)];
    GeneratedChart::new(chart.finish().unwrap(), instances)
}

#[test]
fn a_generated_chart_is_followed_like_an_interpreted_one() {
    let never = || properties("always not (entering B and [ball.x != 7])");
    let interpreted = Agent::statechart("m", chart("Liveness:\nm = A . B"))
        .monitor(properties("always not entering B"), ViolationResponse::Log);
    let (mut simulation, expected) = simulated(interpreted, noting().1);
    simulation.run_until(at(100)).unwrap();
    let code = Agent::new("m", Hz(1))
        .generated(generated())
        .monitor(properties("always not entering B"), ViolationResponse::Log);
    let (mut simulation, violations) = simulated(code, Registry::linked());
    simulation.run_until(at(100)).unwrap();
    assert_eq!(times(&violations), times(&expected));
    assert_eq!(times(&violations), [0]);
    let unknown = Agent::new("m", Hz(1)).generated(generated()).monitor(never(), ViolationResponse::Log);
    let (mut simulation, violations) = simulated(unknown, Registry::linked());
    simulation.run_until(at(100)).unwrap();
    assert_eq!(times(&violations), [0; 0], "no ball has been heard of");
}

#[test]
fn a_replay_finds_the_same_violations() {
    let set_up = || {
        let text = "always eventually entering A within 50 ms";
        let agent = Agent::statechart("m", chart(LOOP)).monitor(properties(text), ViolationResponse::Log);
        Talws::new().registry(noting().1).agent(agent)
    };
    let (tape, violations) = (Tape::default(), Violations::default());
    let mut talws = set_up();
    talws.observe(Box::new(tape.clone()));
    talws.simulate(1).unwrap().run_until(at(300)).unwrap();
    let mut again = set_up();
    again.observe(Box::new(violations.clone()));
    let outcome = replay_simulated(again, 1, &tape.kept()).unwrap();
    assert_eq!(outcome.differences.len(), 0);
    assert!(outcome.compared("m", "monas/cycle") > 3);
    assert_eq!(times(&violations).len(), 3);
}

#[test]
fn each_of_several_charts_has_its_own_properties() {
    let rules = |text| ChartSettings::new().monitor(properties(text), ViolationResponse::Policy);
    let of = |first, second| {
        let agent = Agent::statechart("m", chart(LOOP))
            .chart_settings(rules(first).on_failure(FailurePolicy::StopAgent));
        let agent = agent.chart(chart(LOOP)).chart_settings(rules(second));
        let mut simulation = Talws::new().registry(noting().1).agent(agent).simulate(1).unwrap();
        simulation.run_until(at(300)).unwrap();
        simulation.statistics().agents[0].stopped.is_some()
    };
    let (kept, broken) = ("always true", "always eventually entering A within 50 ms");
    assert!(of(broken, kept), "the first does what its own policy says");
    assert!(!of(kept, broken), "the other goes by its agent's, which goes on");
}

#[test]
fn unknown_names_are_rejected_before_the_run() {
    let refused = |text: &str| {
        let agent = Agent::statechart("m", chart(LOOP)).monitor(properties(text), ViolationResponse::Log);
        Talws::new().registry(noting().1).agent(agent).simulate(1).unwrap_err().diagnostics()[0].code
    };
    assert_eq!(refused("always in B"), "E0845");
    assert_eq!(refused("always [ball.y_ > 0]"), "E0134");
    let none = Agent::new("m", Hz(1)).activity(nothing).monitor(properties("true"), ViolationResponse::Log);
    let error = Talws::new().agent(none).simulate(1).unwrap_err();
    assert_eq!(error.diagnostics()[0].code, "E0324");
}
