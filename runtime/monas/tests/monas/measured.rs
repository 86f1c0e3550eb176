//! Measurements of agents in simulated time, and charts that would never let time advance.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Barrier};
use std::time::Duration;

use crate::kit::{BALL, Ball, at};
use monas::{
    Agent, AgentStatistics, Blackboard, BoxError, ErrorKind, Hz, Progress, Registry, RunHash, Talws,
};
use yase::{Source, Statechart};

fn chart(formula: &str) -> Statechart {
    aseme_models::statechart_of(&Source::new("m.srm", formula)).0
}

fn publish(blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
    blackboard.publish(BALL, Ball { x: 1.0, ..Ball::default() })?;
    Ok(Progress::after(Duration::from_millis(10)))
}

/// Two seconds of a list and a chart: the hash of the run, and the statistics of both agents.
fn two_seconds(is_measured: bool) -> ((String, u64), [AgentStatistics; 2]) {
    let hash = RunHash::new();
    let list = Agent::new("list", Hz(100)).named_activity("Publish", Box::new(publish));
    let mut talws = Talws::new()
        .registry(Registry::empty().with("Publish", || publish))
        .agent(list)
        .agent(Agent::statechart("mind", chart("m = Publish")));
    talws.observe(Box::new(hash.clone()));
    let mut simulation = talws.simulate(1).unwrap();
    if is_measured {
        simulation.measure();
    }
    simulation.run_until(at(2000)).unwrap();
    let agents = simulation.statistics().agents.try_into().unwrap();
    (hash.finish(), agents)
}

#[test]
fn measurements_cover_each_cycle_and_call_and_leave_the_run_as_it_is() {
    let (hash, agents) = two_seconds(true);
    for agent in &agents {
        let [activity] = agent.activities.as_slice() else { panic!("{agent:?}") };
        assert_eq!(agent.cycle_time.unwrap().count(), agent.cycles, "{agent:?}");
        assert_eq!(activity.call_time.unwrap().count(), activity.calls, "{agent:?}");
        assert!(activity.calls >= 200, "{agent:?}");
        assert!(agent.cycle_percentiles.is_some() && activity.call_percentiles.is_some(), "{agent:?}");
        #[cfg(unix)]
        assert!(activity.call_cpu.unwrap().count() >= activity.calls / 64, "{agent:?}");
    }
    let (unmeasured_hash, unmeasured) = two_seconds(false);
    assert_eq!(hash, unmeasured_hash);
    for (agent, measured) in unmeasured.iter().zip(&agents) {
        assert_eq!((agent.cycle_time, agent.activities[0].call_time), (None, None));
        assert_eq!(
            (agent.cycles, agent.activities[0].calls),
            (measured.cycles, measured.activities[0].calls)
        );
    }
}

#[test]
fn an_agent_that_is_added_is_measured_too() {
    use monas::records::{Action, Change};
    let registry = Registry::empty().with("Publish", || publish);
    let talws =
        Talws::new().registry(registry).agent(Agent::new("z", Hz(1)).activity(|_: &mut Blackboard| {}));
    let mut simulation = talws.simulate(1).unwrap();
    simulation.measure();
    let text = "<agent frequency=\"100\"><name>new</name><activity>Publish</activity></agent>".into();
    let add = Change { text, action: Action::AddAgents.into(), ..Change::default() };
    let changed = simulation.change("local", add).unwrap();
    assert!(changed.done, "{changed:?}");
    simulation.run_until(at(100)).unwrap();
    let agent = &simulation.statistics().agents[0];
    assert_eq!(agent.activities[0].call_time.unwrap().count(), 10);
}

#[test]
fn a_loop_without_a_wait_stops_its_agent_and_is_named_with_a_remedy() {
    let registry =
        Registry::empty().with("A", || |_: &mut Blackboard| {}).with("B", || |_: &mut Blackboard| {});
    let list = Agent::new("other", Hz(10)).activity(|_: &mut Blackboard| {});
    let talws = Talws::new().registry(registry).agent(Agent::statechart("mind", chart("m = (A . B)~")));
    let mut simulation = talws.agent(list).simulate(1).unwrap();
    simulation.run_until(at(1000)).unwrap();
    let statistics = simulation.statistics();
    let reason = statistics.agents[0].stopped.as_deref().unwrap();
    let is_named =
        [": (A.B)/A -> (A.B)/B, ", ": (A.B)/B -> (A.B)/A, "].iter().any(|states| reason.contains(states));
    assert!(reason.starts_with("`m` loops without a wait") && is_named, "{reason}");
    assert!(reason.contains(" calls at 0.000000000 s; let an activity return `Ongoing`"), "{reason}");
    assert_eq!(statistics.agents[1].cycles, 10, "the others go on");
}

#[test]
fn a_simulation_is_given_up_only_after_it_is_cancelled() {
    let limit = Duration::from_millis(50);
    let (enter, leave) = (Arc::new(Barrier::new(2)), Arc::new(Barrier::new(2)));
    let (entered, left) = (enter.clone(), leave.clone());
    let waits = move |_: &mut Blackboard| {
        entered.wait();
        left.wait();
    };
    let agent = Agent::new("mind", Hz(10)).named_activity("Waits", Box::new(waits));
    let simulation = Talws::new().agent(agent).simulate(1).unwrap();
    let simulation = std::thread::scope(|threads| {
        let run = threads.spawn(|| simulation.run_until_cancelled(at(50), || false, limit));
        enter.wait();
        leave.wait();
        run.join().unwrap().unwrap()
    });
    assert_eq!(simulation.now(), at(50));
    let is_cancelled = AtomicBool::new(false);
    let error = std::thread::scope(|threads| {
        let look = || is_cancelled.load(Ordering::Relaxed);
        let run = threads.spawn(move || simulation.run_until_cancelled(at(150), look, limit));
        enter.wait();
        is_cancelled.store(true, Ordering::Relaxed);
        run.join().unwrap().unwrap_err()
    });
    let expected = "activity `Waits` of agent `mind` on `local` has not returned from `execute` within 0.1 s";
    assert_eq!((error.kind(), error.to_string().as_str()), (ErrorKind::Stuck, expected));
    leave.wait();
}
