//! Agents in real time: threads, pools and clocks. The tests wait for events, never for time to
//! pass.

mod replayed;

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Barrier, Mutex};
use std::time::Duration;

use crate::kit::{BALL, Ball, NEWS};
use monas::records::Cycle;
use monas::{
    Agent, Blackboard, BoxError, FailurePolicy, HostConfig, Hz, Progress, Registry, StopHandle, Talws,
    Timestamp, ViolationResponse, World,
};
use monas_robot::topics::{ACTUATORS, SENSORS};
use monas_robot::{Actuators, Anatomy, Percepts, Robot};
use narukom::{Observer, Publication};
use yase::{Source, Statechart};

/// Longer than any successful operation takes.
const TIMEOUT: Duration = Duration::from_secs(20);

fn chart(text: &str) -> Statechart {
    let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("m.srm", text));
    assert_eq!(diagnostics, []);
    chart
}

fn news<T>() -> (Sender<T>, Receiver<T>) {
    channel()
}

/// The next `count` values.
fn next<T>(receiver: &Receiver<T>, count: usize) -> Vec<T> {
    (0..count).map(|_| receiver.recv_timeout(TIMEOUT).unwrap()).collect()
}

#[test]
fn a_list_runs_on_the_grid_of_its_frequency_until_it_is_stopped() {
    let (sender, times) = news();
    let agent = Agent::new("a", Hz(1000)).activity(move |b: &mut Blackboard| sender.send(b.now()));
    let running = Talws::new().agent(agent).start().unwrap();
    let times = next(&times, 20);
    let statistics = running.stop();
    // No cycle begins before its place on the grid.
    let early = times
        .iter()
        .zip(0..)
        .filter(|(time, number)| **time < Timestamp::from_nanos(number * 1_000_000))
        .count();
    assert_eq!(early, 0);
    assert!(statistics.calls("local", "closure") >= 20);
    assert!(statistics.agents[0].cycle_time.unwrap().count() >= 20);
    assert!(statistics.agents[0].activities[0].call_time.unwrap().count() >= 20);
}

#[test]
fn a_stopper_ends_a_run_from_another_thread() {
    let stopper: Arc<Mutex<Option<StopHandle>>> = Arc::default();
    let handle = stopper.clone();
    let stops = move |_: &mut Blackboard| {
        if let Some(stopper) = &*handle.lock().unwrap() {
            stopper.stop();
        }
    };
    let running = Talws::new().agent(Agent::new("a", Hz(1000)).activity(stops)).start().unwrap();
    *stopper.lock().unwrap() = Some(running.stopper());
    assert!(running.wait().cycles() >= 1);
}

/// Sends the violations in records of cycles.
struct ViolationObserver(Sender<String>);

impl Observer for ViolationObserver {
    fn observe(&mut self, publication: Publication<'_>) {
        let cycle = publication.sample.message.as_any().downcast_ref::<Cycle>();
        for violation in cycle.into_iter().flat_map(|cycle| &cycle.violations) {
            // the receiver may be gone
            let _ = self.0.send(violation.property.clone());
        }
    }
}

/// A chart that waits for what never comes, with a property, and what is violated of it.
fn waiting(property: &str, on_violation: ViolationResponse) -> (Talws, Receiver<String>) {
    let (properties, findings) = aseme_verify::properties::parse(&format!("property \"p\": {property}"));
    assert_eq!(findings, []);
    let (sender, violated) = news();
    let registry = Registry::linked().with("A", || |_: &mut Blackboard| ());
    let text = "Liveness:\nm = A . A\nTransitions:\nA -> A : [ball.found]";
    let agent = Agent::statechart("m", chart(text)).on_failure(FailurePolicy::StopAgent);
    let mut talws = Talws::new().registry(registry).agent(agent.monitor(properties, on_violation));
    talws.observe(Box::new(ViolationObserver(sender)));
    (talws, violated)
}

#[test]
fn a_time_bound_expires_by_the_clock_without_steps() {
    let (talws, violated) = waiting("eventually entering END within 20 ms", ViolationResponse::Log);
    let running = talws.start().unwrap();
    assert_eq!(next(&violated, 1), ["p"]);
    let statistics = running.stop();
    assert_eq!(statistics.agents[0].stopped, None, "it is only reported");
    let (talws, violated) = waiting("eventually entering END within 1 ms", ViolationResponse::Policy);
    // the run is over when its only agent is
    let statistics = talws.start().unwrap().wait();
    assert_eq!(next(&violated, 1), ["p"]);
    let reason = statistics.agents[0].stopped.clone().unwrap();
    assert!(reason.starts_with("the property `p` was violated in cycle "), "{reason}");
}

#[test]
fn activities_of_two_regions_run_at_the_same_time() {
    let (sender, done) = news();
    let barrier = Arc::new(Barrier::new(2));
    let registry = ["A", "B"].into_iter().fold(Registry::empty(), |registry, name| {
        let (sender, barrier) = (sender.clone(), barrier.clone());
        registry.with(name, move || {
            let (sender, barrier) = (sender.clone(), barrier.clone());
            move |_: &mut Blackboard| {
                // Requires all activities to run in parallel.
                barrier.wait();
                sender.send(name)
            }
        })
    });
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart("m = A || B")));
    let running = talws.start().unwrap();
    let mut both = next(&done, 2);
    both.sort_unstable();
    assert_eq!(both, ["A", "B"]);
    running.stop();
}

#[test]
fn no_wake_up_is_lost_between_an_agent_and_a_chart() {
    const ROUNDS: usize = 300;
    let (sender, rounds) = news();
    // The chart answers each ball with one that is not found; the list throws the next one then.
    let registry = Registry::linked().with("Answer", move || {
        let sender = sender.clone();
        move |b: &mut Blackboard| -> Result<(), BoxError> {
            let x = b.read(BALL).map_or(0.0, |ball| ball.x);
            b.publish(BALL, Ball { x, found: false, ..Ball::default() })?;
            Ok(sender.send(x)?)
        }
    });
    let text = "Liveness:\nm = Answer~\nTransitions:\nAnswer -> Answer : [ball.found]";
    let throws = |b: &mut Blackboard| -> Result<(), BoxError> {
        if let Some(ball) = b.read(BALL).filter(|ball| !ball.found) {
            let thrown = Ball { x: ball.x + 1.0, found: true, ..Ball::default() };
            b.publish(BALL, thrown)?;
        }
        Ok(())
    };
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(text)));
    let running = talws.agent(Agent::new("z", Hz(10_000)).activity(throws)).start().unwrap();
    let answered = next(&rounds, ROUNDS);
    running.stop();
    assert_eq!(answered, (0..ROUNDS).map(|round| round as f64).collect::<Vec<_>>());
}

#[test]
fn an_ongoing_activity_is_called_again_on_the_pool() {
    let (sender, calls) = news();
    let registry = Registry::empty().with("A", move || {
        let sender = sender.clone();
        let mut count = 0;
        move |_: &mut Blackboard| -> Result<Progress, BoxError> {
            count += 1;
            sender.send(count)?;
            Ok(Progress::after(Duration::from_millis(1)))
        }
    });
    let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart("m = A")));
    let running = talws.start().unwrap();
    assert_eq!(next(&calls, 5), [1, 2, 3, 4, 5]);
    assert!(running.stop().calls("local", "A") >= 5);
}

#[test]
fn a_panic_harms_only_its_own_agent() {
    let (sender, calls) = news();
    let panics = |_: &mut Blackboard| -> () { panic!("ouch") };
    let goes_on = move |_: &mut Blackboard| sender.send(());
    // printing a panic may take longer on a busy machine than the default limit
    let patient = Duration::from_secs(600);
    let stops = Agent::new("a", Hz(1000)).activity(panics).on_failure(FailurePolicy::StopAgent);
    let stops = stops.stuck_after(patient);
    let running =
        Talws::new().agent(stops).agent(Agent::new("b", Hz(1000)).activity(goes_on)).start().unwrap();
    next(&calls, 20);
    let statistics = running.stop();
    assert_eq!(statistics.agents[0].cycles, 1);
    assert_eq!(
        statistics.agents[0].stopped.as_deref(),
        Some("activity `closure` failed in cycle 1: panicked: ouch")
    );
    assert_eq!(statistics.agents[1].stopped, None);
}

struct Body(Sender<f64>, Anatomy);

impl Robot for Body {
    fn anatomy(&self) -> &Anatomy {
        &self.1
    }
    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), monas_robot::Error> {
        percepts.sensors.measured_at = now.as_nanos().max(1);
        Ok(())
    }
    fn act(&mut self, _: Timestamp, actuators: &Actuators) -> Result<(), monas_robot::Error> {
        // The receiver may be gone at the end of the run.
        let _ = self.0.send(actuators.walk_x);
        Ok(())
    }
}

/// A world that only reports its steps.
struct IdleWorld(Sender<Timestamp>);

impl World for IdleWorld {
    fn period(&self) -> Duration {
        Duration::from_millis(1)
    }
    fn advance(&mut self, now: Timestamp, _: &mut Blackboard) -> Result<(), BoxError> {
        let _ = self.0.send(now);
        Ok(())
    }
}

#[test]
fn a_body_senses_and_acts_and_the_world_moves_on() {
    let (acts, acted) = news();
    let (moves, moved) = news();
    let walks = |b: &mut Blackboard| -> Result<(), BoxError> {
        let sensed = b.read(SENSORS).is_some_and(|sensors| sensors.measured_at > 0);
        Ok(b.publish(
            ACTUATORS,
            Actuators { walk_x: if sensed { 1.0 } else { 0.0 }, ..Actuators::default() },
        )?)
    };
    let mut talws = Talws::new();
    talws.world(Box::new(IdleWorld(moves)));
    let body = Body(acts, Anatomy::new("test", Duration::from_millis(1)));
    let agents = vec![Agent::new("walker", Hz(1000)).activity(walks)];
    talws.host(HostConfig {
        name: "red-1".into(),
        team: 1,
        number: 1,
        body: Some(Box::new(body)),
        agents,
        ..HostConfig::default()
    });
    let running = talws.start().unwrap();
    while next(&acted, 1) != [1.0] {}
    let expected: Vec<Timestamp> = (1..=5).map(|millis| Timestamp::from_nanos(millis * 1_000_000)).collect();
    assert_eq!(next(&moved, 5), expected);
    running.stop();
}

#[test]
fn a_paced_simulation_is_the_same_run_and_not_faster_than_time() {
    let run = |paced: bool| {
        let hash = monas::RunHash::new();
        let agent = Agent::new("a", Hz(1000)).activity(|b: &mut Blackboard| b.publish(BALL, Ball::default()));
        let mut talws = Talws::new().agent(agent);
        talws.observe(Box::new(hash.clone()));
        let mut simulation = talws.simulate(1).unwrap();
        let end = Timestamp::from_nanos(20_000_000);
        match paced {
            true => simulation.run_paced(end, &StopHandle::new()).unwrap(),
            false => simulation.run_until(end).unwrap(),
        }
        hash.finish()
    };
    assert_eq!(run(true), run(false));
    let stopper = StopHandle::new();
    stopper.stop();
    let mut simulation =
        Talws::new().agent(Agent::new("a", Hz(1)).activity(|_: &mut Blackboard| {})).simulate(1).unwrap();
    simulation.run_paced(Timestamp::MAX, &stopper).unwrap();
    assert_eq!(simulation.statistics().cycles(), 0, "a stopped run does not begin");
}

/// Agents that start together: one publishes a signal in its first cycle only; a chart answers it,
/// and a list counts it. The names determine the order in which their threads are started.
fn starting_together([first, chart_name, list]: [&str; 3]) -> (Talws, Receiver<&'static str>) {
    let (sender, answers) = news();
    let counted = sender.clone();
    let registry = Registry::empty().with("Wait", || |_: &mut Blackboard| ()).with("Answer", move || {
        let sender = sender.clone();
        move |_: &mut Blackboard| _ = sender.send("chart")
    });
    let mut is_first = true;
    let requests = move |blackboard: &mut Blackboard| match std::mem::take(&mut is_first) {
        true => blackboard.publish(NEWS, Ball::default()),
        false => Ok(()),
    };
    let counts = move |blackboard: &mut Blackboard| {
        blackboard.signals(NEWS).for_each(|_| _ = counted.send("list"));
    };
    let text = "Liveness:\nm = Wait . Answer\nTransitions:\nWait -> Answer : news";
    let talws = Talws::new().registry(registry).agent(Agent::new(first, Hz(1000)).activity(requests));
    let talws = talws.agent(Agent::statechart(chart_name, chart(text)));
    (talws.agent(Agent::new(list, Hz(1000)).activity(counts)), answers)
}

#[test]
fn the_first_signal_reaches_all_agents_that_start_together() {
    for names in [["a", "b", "c"], ["c", "b", "a"], ["b", "a", "c"]] {
        for _ in 0..10 {
            let (talws, answers) = starting_together(names);
            let running = talws.start().unwrap();
            let mut both = next(&answers, 2);
            both.sort_unstable();
            assert_eq!(both, ["chart", "list"]);
            running.stop();
        }
        let (talws, answers) = starting_together(names);
        talws.simulate(1).unwrap().run_until(crate::kit::at(10)).unwrap();
        let mut both: Vec<&str> = answers.try_iter().collect();
        both.sort_unstable();
        assert_eq!(both, ["chart", "list"], "in simulated time");
    }
}
