//! Agents in simulated time: their order of execution, their inputs, and equal runs for equal
//! seeds.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::kit::{BALL, Ball, NEWS, at, recorder};
use monas::records::{Action, Change};
use monas::{
    Agent, Blackboard, BoxError, ChartSettings, ErrorKind, FailurePolicy, HostConfig, Hz, Parameters,
    Progress, Registry, RunHash, Talws, Timestamp, World,
};
use monas_robot::topics::{ACTUATORS, SAID, SENSORS};
use monas_robot::{Actuators, Anatomy, Percepts, Robot, Said};

fn hello(_: &mut Blackboard) {}

#[test]
fn ten_hertz_for_a_second_is_ten_calls_from_0_to_900_ms() {
    let (times, note) = recorder();
    let agent = Agent::new("greeter", Hz(10))
        .activity(move |b: &mut Blackboard| note(b.now().as_nanos() / 1_000_000));
    let mut simulation = Talws::new().agent(agent).simulate(1).unwrap();
    simulation.run_until(at(1000)).unwrap();
    assert_eq!(times.taken(), [0, 100, 200, 300, 400, 500, 600, 700, 800, 900]);
    assert_eq!(simulation.now(), at(1000));
    simulation.run_until(at(1001)).unwrap();
    assert_eq!(times.taken(), [1000], "what is due at the end belongs to the next call");
}

#[test]
fn running_in_pieces_is_running_at_once() {
    let run = |pieces: &[u64]| {
        let hash = RunHash::new();
        let mut talws = Talws::new().agent(Agent::new("a", Hz(30)).activity(counting()));
        talws.observe(Box::new(hash.clone()));
        let mut simulation = talws.simulate(1).unwrap();
        pieces.iter().for_each(|end| simulation.run_until(at(*end)).unwrap());
        hash.finish()
    };
    assert_eq!(run(&[1000]), run(&[1, 33, 34, 500, 500, 1000]));
}

#[test]
fn nothing_moves_within_a_cycle_and_everything_is_published_at_its_end() {
    let (seen, note) = recorder();
    let writer = Agent::new("a writer", Hz(10)).activity(|b: &mut Blackboard| -> Result<(), BoxError> {
        let count = b.read(BALL).map_or(0.0, |ball| ball.x) + 1.0;
        b.publish(BALL, Ball { x: count, ..Ball::default() })?;
        b.publish(NEWS, Ball { x: count, ..Ball::default() })?;
        Ok(())
    });
    let note2 = note.clone();
    let reader = Agent::new("b reader", Hz(10))
        .activity(move |b: &mut Blackboard| note(format!("{:?}", b.read(BALL).map(|ball| ball.x))))
        .activity(move |b: &mut Blackboard| note2(format!("{}", b.signals(NEWS).count())));
    let mut simulation = Talws::new().agent(reader).agent(writer).simulate(1).unwrap();
    simulation.run_until(at(300)).unwrap();
    // The writer's name comes first, so the reader sees in each cycle what was published just
    // before.
    assert_eq!(seen.taken(), ["Some(1.0)", "1", "Some(2.0)", "1", "Some(3.0)", "1"]);
}

#[test]
fn an_agent_reads_what_its_own_activities_wrote_in_the_same_cycle() {
    let (seen, note) = recorder();
    let agent = Agent::new("a", Hz(10))
        .activity(|b: &mut Blackboard| b.publish(BALL, Ball { x: 7.0, ..Ball::default() }))
        .activity(move |b: &mut Blackboard| note(b.read(BALL).map(|ball| ball.x)));
    let mut simulation = Talws::new().agent(agent).simulate(1).unwrap();
    simulation.run_until(at(1)).unwrap();
    assert_eq!(seen.taken(), [Some(7.0)]);
}

#[test]
fn hosts_do_not_hear_each_other() {
    let (seen, note) = recorder();
    let mut talws = Talws::new();
    let speaks = Agent::new("a", Hz(10)).activity(|b: &mut Blackboard| b.publish(BALL, Ball::default()));
    talws.host(HostConfig {
        name: "red-1".into(),
        team: 1,
        number: 1,
        agents: vec![speaks],
        ..HostConfig::default()
    });
    let listens = Agent::new("b", Hz(10)).activity(move |b: &mut Blackboard| note(b.read(BALL).is_some()));
    talws.host(HostConfig {
        name: "red-2".into(),
        team: 1,
        number: 2,
        agents: vec![listens],
        ..HostConfig::default()
    });
    talws.simulate(1).unwrap().run_until(at(500)).unwrap();
    assert_eq!(seen.taken(), [false; 5]);
}

#[test]
fn an_agents_list_calls_an_ongoing_activity_once_a_cycle() {
    let (calls, note) = recorder();
    let agent = Agent::new("a", Hz(10)).activity(move |b: &mut Blackboard| {
        note(b.now());
        Progress::after(Duration::from_millis(1))
    });
    Talws::new().agent(agent).simulate(1).unwrap().run_until(at(300)).unwrap();
    assert_eq!(calls.taken(), [at(0), at(100), at(200)]);
}

/// Publishes a count and a random number.
fn counting() -> impl FnMut(&mut Blackboard) -> Result<(), narukom::Error> + Send {
    let mut count = 0.0;
    move |b| {
        count += 1.0;
        let chance = b.random().uniform();
        b.publish(BALL, Ball { x: count, y: chance, ..Ball::default() })
    }
}

fn team(order: &[usize], seed: u64) -> (String, u64) {
    let hash = RunHash::new();
    let mut talws = Talws::new();
    talws.observe(Box::new(hash.clone()));
    for &number in order {
        let agent = |name: String| Agent::new(name, Hz(10)).activity(counting());
        let mut agents = vec![agent("sees".into()), agent("walks".into())];
        agents.rotate_left(number % 2);
        let name = format!("red-{number}");
        talws.host(HostConfig { name, team: 1, number: number as u32, agents, ..HostConfig::default() });
    }
    talws.simulate(seed).unwrap().run_until(at(2000)).unwrap();
    hash.finish()
}

#[test]
fn the_hash_does_not_depend_on_the_order_of_hosts_and_agents() {
    let (hash, messages) = team(&[0, 1, 2], 7);
    assert_eq!(hash.len(), 64);
    // Per host: one introduction, and 2 agents x 20 cycles x (a ball and a record).
    assert_eq!(messages, 3 * (1 + 2 * 20 * 2));
    assert_eq!(team(&[0, 1, 2], 7).0, hash);
    let permuted = |order: &[usize]| {
        let hash = RunHash::new();
        let mut talws = Talws::new();
        talws.observe(Box::new(hash.clone()));
        for &number in order {
            let mut agents = vec!["sees", "walks"];
            agents.rotate_left(number % 2);
            agents.reverse();
            let agents =
                agents.into_iter().map(|name| Agent::new(name, Hz(10)).activity(counting())).collect();
            talws.host(HostConfig {
                name: format!("red-{number}"),
                team: 1,
                number: number as u32,
                agents,
                ..HostConfig::default()
            });
        }
        talws.simulate(7).unwrap().run_until(at(2000)).unwrap();
        hash.finish().0
    };
    assert_eq!(permuted(&[2, 0, 1]), hash);
}

#[test]
fn another_seed_gives_another_hash() {
    assert_ne!(team(&[0, 1], 7).0, team(&[0, 1], 8).0);
}

#[test]
fn each_agent_has_a_stream_of_random_numbers_of_its_own() {
    let (numbers, note) = recorder();
    let draws = move || {
        let note = note.clone();
        move |b: &mut Blackboard| note(b.random().uniform().to_bits())
    };
    let agent = |name: &str| Agent::new(name, Hz(1)).activity(draws());
    Talws::new().agent(agent("a")).agent(agent("b")).simulate(1).unwrap().run_until(at(1)).unwrap();
    let drawn = numbers.taken();
    assert_ne!(drawn[0], drawn[1]);
}

#[test]
fn two_of_one_name_are_refused() {
    let agent = || Agent::new("a", Hz(1)).activity(hello);
    let error = Talws::new().agent(agent()).agent(agent()).simulate(1).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::DuplicateName);
    assert_eq!(error.to_string(), "two agents are named `a`");
    let mut talws = Talws::new();
    talws.host(HostConfig { name: "red".into(), ..HostConfig::default() });
    talws.host(HostConfig { name: "red".into(), number: 2, ..HostConfig::default() });
    assert_eq!(talws.simulate(1).unwrap_err().to_string(), "two hosts are named `red`");
}

#[test]
fn a_list_without_a_frequency_is_refused() {
    let chart = yase::Statechart::new("m");
    let error = Talws::new().agent(Agent::statechart("a", chart).activity(hello)).simulate(1).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::NoFrequency);
    assert_eq!(error.to_string(), "agent `a` has activities but no frequency");
}

/// A world that counts its steps, shared with the body in it.
struct CountingWorld(Arc<Mutex<Vec<String>>>);

impl World for CountingWorld {
    fn period(&self) -> Duration {
        Duration::from_millis(20)
    }
    fn advance(&mut self, now: Timestamp, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.0.lock().unwrap().push(format!("{} world", now.as_nanos() / 1_000_000));
        Ok(blackboard.publish(BALL, Ball::default())?)
    }
}

struct Body(Arc<Mutex<Vec<String>>>, Anatomy);

impl Robot for Body {
    fn anatomy(&self) -> &Anatomy {
        &self.1
    }
    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), monas_robot::Error> {
        self.0.lock().unwrap().push(format!("{} sense", now.as_nanos() / 1_000_000));
        percepts.sensors.measured_at = now.as_nanos();
        Ok(())
    }
    fn act(&mut self, now: Timestamp, actuators: &Actuators) -> Result<(), monas_robot::Error> {
        self.0.lock().unwrap().push(format!("{} act {}", now.as_nanos() / 1_000_000, actuators.walk_x));
        Ok(())
    }
}

type Log = Arc<Mutex<Vec<String>>>;

/// Agents on a host whose body writes a log.
fn embodied(agents: Vec<Agent>) -> (Talws, Log) {
    let log = Log::default();
    let body = Body(log.clone(), Anatomy::new("test", Duration::from_millis(10)));
    let mut talws = Talws::new();
    let body = Some(Box::new(body) as _);
    talws.host(HostConfig {
        name: "red-1".into(),
        team: 1,
        number: 1,
        body,
        agents,
        ..HostConfig::default()
    });
    (talws, log)
}

#[test]
fn at_one_moment_the_world_moves_bodies_sense_agents_run_and_bodies_act() {
    let walks = |b: &mut Blackboard| {
        let measured = b.read(SENSORS).map_or(0, |sensors| sensors.measured_at);
        b.publish(ACTUATORS, Actuators { walk_x: measured as f64 / 1e9, ..Actuators::default() })
    };
    let (mut talws, log) = embodied(vec![Agent::new("walker", Hz(50)).activity(walks)]);
    talws.world(Box::new(CountingWorld(log.clone())));
    let mut simulation = talws.simulate(1).unwrap();
    simulation.run_until(at(41)).unwrap();
    let happened = log.lock().unwrap().clone();
    let expected = [
        "0 sense",
        "0 act 0",
        "10 sense",
        "20 world",
        "20 sense",
        "20 act 0.02",
        "30 sense",
        "40 world",
        "40 sense",
        "40 act 0.04",
    ];
    assert_eq!(happened, expected);
    assert!(simulation.hub("world").is_some_and(|hub| hub.host() == "world"));
}

#[test]
fn the_safe_state_unloads_the_body_and_ignores_commands() {
    let walks = |b: &mut Blackboard| b.publish(ACTUATORS, Actuators { walk_x: 0.3, ..Actuators::default() });
    let fails = |b: &mut Blackboard| if b.now() < at(20) { Ok(()) } else { Err("broken leg") };
    let (talws, log) = embodied(vec![
        Agent::new("a", Hz(100)).activity(walks),
        Agent::new("b", Hz(100)).activity(fails).on_failure(FailurePolicy::SafeState),
    ]);
    let mut simulation = talws.simulate(1).unwrap();
    simulation.run_until(at(50)).unwrap();
    let acts: Vec<String> = log.lock().unwrap().iter().filter(|line| line.contains("act")).cloned().collect();
    assert_eq!(acts, ["0 act 0.3", "10 act 0.3", "20 act 0"], "a body that cannot sit stands still");
    let stopped = simulation.statistics().agents[1].stopped.clone();
    assert_eq!(stopped.as_deref(), Some("activity `closure` failed in cycle 3: broken leg"));
    let mut ask = |action: Action| {
        let change = Change { action: action.into(), agent: "a".into(), ..Change::default() };
        simulation.change("red-1", change).unwrap()
    };
    ask(Action::StopAgent);
    let started = ask(Action::StartAgent);
    let remarks: Vec<&str> = started.findings.iter().map(|finding| finding.message.as_str()).collect();
    let expected = "the body is in its safe state and ignores commands until the end of the run";
    assert_eq!((started.done, remarks), (true, vec![expected]));
}

#[test]
fn a_chart_and_its_activities_say_themselves_whether_the_body_rests_when_one_fails() {
    let walked = |own: ChartSettings| {
        let walks =
            |b: &mut Blackboard| b.publish(ACTUATORS, Actuators { walk_x: 0.3, ..Actuators::default() });
        let (chart, _) = aseme_models::statechart_of(&yase::Source::new("m.srm", "m = Limps"));
        let (talws, log) = embodied(vec![
            Agent::new("a", Hz(100)).activity(walks),
            Agent::statechart("b", chart).chart_settings(own),
        ]);
        let registry = Registry::empty().with("Limps", || {
            |_: &mut Blackboard| -> Result<Progress, BoxError> { Err("broken leg".into()) }
        });
        let mut simulation = talws.registry(registry).simulate(1).unwrap();
        simulation.run_until(at(15)).unwrap();
        let stopped = simulation.statistics().agents[1].stopped.is_some();
        let acts = log.lock().unwrap().iter().filter(|line| line.ends_with("act 0.3")).count();
        (stopped, acts > 1)
    };
    let safe = || ChartSettings::new().on_failure(FailurePolicy::SafeState);
    let limps = |own: ChartSettings, policy| own.activity("Limps", Parameters::new(), Some(policy));
    assert_eq!(walked(ChartSettings::new()), (false, true), "it is restarted");
    assert_eq!(walked(safe()), (true, false));
    assert_eq!(walked(limps(safe(), FailurePolicy::StopAgent)), (true, true));
    assert_eq!(walked(limps(ChartSettings::new(), FailurePolicy::SafeState)), (true, false));
}

#[test]
fn a_body_that_cannot_speak_still_walks() {
    let speaks = |b: &mut Blackboard| -> Result<(), BoxError> {
        b.publish(SAID, Said { words: vec![1] })?;
        Ok(b.publish(ACTUATORS, Actuators { walk_x: 0.3, ..Actuators::default() })?)
    };
    let (talws, log) = embodied(vec![Agent::new("a", Hz(100)).activity(speaks)]);
    talws.simulate(1).unwrap().run_until(at(15)).unwrap();
    assert_eq!(*log.lock().unwrap(), ["0 sense", "0 act 0.3", "10 sense", "10 act 0.3"]);
}
