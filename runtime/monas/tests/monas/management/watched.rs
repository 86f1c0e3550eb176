//! Agents that are stuck, fail or request more of the system than it grants.

use std::sync::mpsc::channel;
use std::sync::{Arc, Barrier, Mutex};
use std::time::Duration;

use monas::records::{Action, Change};
use monas::{Agent, Blackboard, FailurePolicy, HostConfig, Hz, Registry, Talws};
use monas_robot::{Actuators, Anatomy, Percepts, Robot};
use narukom::Timestamp;

use crate::kit::{BALL, Ball};
use crate::management::{change, made, refused, settings};

const TIMEOUT: Duration = Duration::from_secs(20);

/// A body that records its walking speed.
struct Body<F>(F, Anatomy);

impl<F: Fn(f64) + Send> Robot for Body<F> {
    fn anatomy(&self) -> &Anatomy {
        &self.1
    }

    fn sense(&mut self, _: Timestamp, _: &mut Percepts) -> Result<(), monas_robot::Error> {
        Ok(())
    }

    fn act(&mut self, _: Timestamp, actuators: &Actuators) -> Result<(), monas_robot::Error> {
        (self.0)(actuators.walk_x);
        Ok(())
    }
}

#[test]
fn a_stuck_cycle_is_reported_and_ends_the_run_with_the_body_unloaded() {
    let (enter, leave) = (Arc::new(Barrier::new(2)), Arc::new(Barrier::new(2)));
    let (here, there) = (enter.clone(), leave.clone());
    let mut calls = 0;
    let hangs = move |blackboard: &mut Blackboard| {
        calls += 1;
        if calls == 3 {
            blackboard.publish(BALL, Ball { x: 3.0, ..Ball::default() }).unwrap();
            here.wait();
            there.wait();
        }
    };
    let walks = |blackboard: &mut Blackboard| {
        blackboard
            .publish(monas_robot::topics::ACTUATORS, Actuators { walk_x: 1.0, ..Actuators::default() })
            .unwrap();
    };
    let (sender, acted) = channel();
    let body = Body(move |speed| _ = sender.send(speed), Anatomy::new("test", Duration::from_millis(1)));
    let agent = Agent::new("a", Hz(1000)).named_activity("Walks", Box::new(walks));
    let agent = agent.named_activity("Hangs", Box::new(hangs)).stuck_after(Duration::from_millis(50));
    let mut talws = Talws::new();
    let published = Arc::new(Mutex::new(0));
    let count = published.clone();
    talws.observe(Box::new(move |publication: narukom::Publication<'_>| {
        if publication.topic.path() == BALL.path() {
            *count.lock().unwrap() += 1;
        }
    }));
    talws.host(HostConfig {
        name: "robot".into(),
        body: Some(Box::new(body)),
        agents: vec![agent],
        ..HostConfig::default()
    });
    let running = talws.start().unwrap();
    while acted.recv_timeout(TIMEOUT).unwrap() != 1.0 {}
    enter.wait();
    // The body receives the command to stand still, and the run ends, although the thread hangs.
    while acted.recv_timeout(TIMEOUT).unwrap() != 0.0 {}
    let statistics = running.wait();
    let stopped = statistics.agents[0].stopped.clone().unwrap();
    assert_eq!(stopped, "activity `Hangs` is stuck in cycle 3");
    leave.wait();
    // The thread drops its references when it ends.
    while Arc::strong_count(&leave) > 1 {
        std::thread::yield_now();
    }
    assert_eq!(*published.lock().unwrap(), 0, "nothing of the cycle is published, however late it ends");
}

#[test]
fn a_stuck_agent_that_returns_has_stopped_and_can_restart() {
    let (enter, leave) = (Arc::new(Barrier::new(2)), Arc::new(Barrier::new(2)));
    let (here, there) = (enter.clone(), leave.clone());
    let (sender, called) = channel();
    let mut calls = 0;
    let hangs = move |_: &mut Blackboard| {
        calls += 1;
        _ = sender.send(calls);
        if calls == 1 {
            here.wait();
            there.wait();
        }
    };
    let agent = Agent::new("a", Hz(1000)).activity(hangs).stuck_after(Duration::from_millis(50));
    let idle = Agent::new("b", Hz(10)).activity(|_: &mut Blackboard| {});
    let running = Talws::new().agent(agent).agent(idle).start().unwrap();
    let run = running.run_handle();
    enter.wait();
    let state = || run.agents(None).unwrap()[0].clone();
    while state().state != "stuck" {
        std::thread::yield_now();
    }
    assert_eq!(state().reason, "activity `closure` is stuck in cycle 1");
    let pause = run.change("local", change(Action::PauseAgent, "a")).unwrap();
    assert_eq!(refused(&pause), ("E0352".into(), "`a` is stuck".into()));
    leave.wait();
    while state().state != "stopped" {
        std::thread::yield_now();
    }
    assert_eq!(state().reason, "activity `closure` was stuck in cycle 1");
    made(&run.change("local", change(Action::StartAgent, "a")).unwrap());
    while called.recv_timeout(TIMEOUT).unwrap() != 3 {}
    assert_eq!(running.stop().agents[0].stopped, None);
}

#[test]
fn denied_scheduling_is_reported_and_the_agent_runs() {
    let (sender, called) = channel();
    let agent = Agent::new("a", Hz(1000)).activity(move |_: &mut Blackboard| _ = sender.send(()));
    let running = Talws::new().agent(agent.urgency(5, true).cores([0])).start().unwrap();
    called.recv_timeout(TIMEOUT).unwrap();
    let given = settings(&[("priority", "7"), ("is_real_time", "0")]);
    let changed =
        running.run_handle().change("local", Change { settings: given, ..change(Action::Set, "a") }).unwrap();
    made(&changed);
    called.recv_timeout(TIMEOUT).unwrap();
    assert_eq!(running.run_handle().agents(None).unwrap()[0].priority, 7);
    running.stop();
}

#[test]
fn overruns_at_ten_kilohertz_cost_only_the_cycles_they_cover() {
    let (sender, called) = channel();
    let mut calls = 0_u64;
    let works = move |blackboard: &mut Blackboard| {
        calls += 1;
        let began = blackboard.now();
        _ = sender.send((calls, began));
    };
    let running = Talws::new().agent(Agent::new("a", Hz(10_000)).activity(works)).start().unwrap();
    let times: Vec<(u64, Timestamp)> = (0..2000).map(|_| called.recv_timeout(TIMEOUT).unwrap()).collect();
    let statistics = running.stop();
    let agent = &statistics.agents[0];
    // However busy the machine is: each place on the grid had its cycle, or is counted as missed.
    let (first, last) = (times[0].1.as_nanos(), times[1999].1.as_nanos());
    let cycles = (last - first) / 100_000;
    assert!(cycles <= 2000 + agent.missed + agent.overruns, "{cycles} cycles, {} missed", agent.missed);
    assert!(agent.missed == 0 || agent.overruns > 0);
    let percentiles = agent.cycle_percentiles.unwrap();
    assert!(percentiles.p50 > Duration::ZERO && percentiles.p50 <= percentiles.p99);
    let activity = &agent.activities[0];
    assert!(activity.call_percentiles.is_some() && activity.call_time.is_some());
    assert!(agent.cycle_cpu.unwrap().count() >= 2000 / 64, "the processor's time is read of one cycle in 64");
    assert!(activity.call_cpu.unwrap().count() >= 2000 / 64);
}

#[test]
fn statistics_are_published_as_often_as_they_are_wanted() {
    let (sender, notes) = channel();
    let mut talws = Talws::new();
    talws.observe(Box::new(move |publication: narukom::Publication<'_>| {
        if let Some(sample) = publication.sample.downcast::<monas::records::AgentEntry>() {
            _ = sender.send(sample.message.clone());
        }
    }));
    let agent = Agent::new("a", Hz(1000)).activity(|_: &mut Blackboard| {}).statistics_every(5);
    let running = talws.agent(agent).start().unwrap();
    let cycles: Vec<u64> = (0..3).map(|_| notes.recv_timeout(TIMEOUT).unwrap().cycles).collect();
    assert_eq!(cycles, [5, 10, 15]);
    let entry = notes.recv_timeout(TIMEOUT).unwrap();
    assert_eq!((entry.name.as_str(), entry.activities.len()), ("a", 1));
    assert!(entry.cycle_time.unwrap().p99 > 0.0);
    running.stop();
}

#[test]
fn a_chart_that_ends_ends_the_run_and_its_failure_is_reported() {
    let chart = aseme_models::statechart_of(&yase::Source::new("m.srm", "m = A")).0;
    let fails = || |_: &mut Blackboard| -> Result<(), std::fmt::Error> { Err(std::fmt::Error) };
    let agent = Agent::statechart("m", chart).on_failure(FailurePolicy::StopAgent);
    let statistics = Talws::new().registry(Registry::empty().with("A", fails)).agent(agent).run().unwrap();
    let stopped = statistics.agents[0].stopped.as_deref().unwrap();
    assert!(stopped.starts_with("activity `A` failed in cycle "), "{stopped}");
}

#[test]
fn an_agent_that_runs_freely_has_one_cycle_after_the_other() {
    let (sender, called) = channel();
    let agent = Agent::new("a", Hz(0)).activity(move |_: &mut Blackboard| _ = sender.send(()));
    let running = Talws::new().agent(agent).start().unwrap();
    (0..1000).for_each(|_| called.recv_timeout(TIMEOUT).unwrap());
    let statistics = running.stop();
    assert_eq!((statistics.agents[0].overruns, statistics.agents[0].missed), (0, 0));
    let counted = Talws::new().agent(Agent::new("a", Hz(0)).activity(|_: &mut Blackboard| {}));
    let mut simulation = counted.simulate(1).unwrap();
    simulation.run_until(crate::kit::at(100)).unwrap();
    assert_eq!(
        simulation.statistics().agents[0].cycles,
        100,
        "a thousand times a second where nothing takes time"
    );
}

#[test]
fn an_activity_has_a_policy_of_its_own() {
    let fails = || |_: &mut Blackboard| -> Result<(), std::fmt::Error> { Err(std::fmt::Error) };
    let registry = Registry::empty().with("F", fails).with("G", || |_: &mut Blackboard| {});
    let text = "<agent frequency='10' on_failure='stop-agent'><name>a</name>\
                <activity on_failure='skip'>F</activity><activity>G</activity></agent>";
    let source = yase::Source::new("a.xml", text);
    let (setup, diagnostics) = monas::config::read(&source, "a.xml".as_ref(), &registry);
    assert_eq!(diagnostics, []);
    let mut simulation = Talws::new().registry(registry).setup(setup).simulate(1).unwrap();
    simulation.run_until(crate::kit::at(1000)).unwrap();
    assert_eq!(
        (simulation.statistics().calls("local", "F"), simulation.statistics().calls("local", "G")),
        (10, 10)
    );
    let given = settings(&[("F.on_failure", "stop-agent")]);
    made(&simulation.change("local", Change { settings: given, ..change(Action::Set, "a") }).unwrap());
    simulation.run_until(crate::kit::at(2000)).unwrap();
    let stopped = simulation.statistics().agents[0].stopped.clone().unwrap();
    assert!(stopped.starts_with("activity `F` failed in cycle 11"), "{stopped}");
    let wrong = settings(&[("F.on_failure", "sometimes")]);
    let changed = simulation.change("local", Change { settings: wrong, ..change(Action::Set, "a") }).unwrap();
    assert_eq!(refused(&changed).0, "E0306");
}
