//! Replay of runs in real time: each agent on the recorded inputs of its turns.

use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use monas::{
    Agent, Blackboard, BoxError, FailurePolicy, HostConfig, Hz, LinkConfig, Progress, Registry, Talws,
    records,
};
use monas_link::{LinkSettings, PublishAs, ReceiveRule};
use narukom::prost::Message as _;
use yase::Statechart;

use crate::kit::{BALL, Ball, GAME, Game, NEWS, Phase};
use crate::real_time::{TIMEOUT, chart, next};
use crate::taped::{Kept, Tape, replay};

/// Throws balls to somewhere.
fn throws(b: &mut Blackboard) -> Result<(), BoxError> {
    let far = b.random().uniform() * 10.0;
    let before = b.read(BALL).map_or(0.0, |ball| ball.y);
    b.publish(BALL, Ball { x: far, y: before + 1.0, found: true })?;
    let phase = if far < 7.0 { Phase::Play } else { Phase::Wait };
    b.publish(GAME, Game { phase: phase.into() })?;
    b.publish(BALL, Ball { x: -far, y: before + 2.0, found: false }).map_err(Into::into)
}

fn thrower() -> Agent {
    Agent::new("thrower", Hz(2000)).activity(throws)
}

/// A chart with two regions: one answers balls that are near, the other one looks again and again
/// whether one is far. What they publish depends on what was delivered before which step, on when
/// that was, on chance, on failures, and on what was written before.
fn keeper(near: f64, calls: &Sender<&'static str>) -> (Registry, Agent) {
    let (registry, chart) = keeping(near, "thrower", calls);
    (registry, Agent::statechart("keeper", chart).on_failure(FailurePolicy::Restart))
}

fn keeping(near: f64, thrower: &str, calls: &Sender<&'static str>) -> (Registry, Statechart) {
    let (answered, looked) = (calls.clone(), calls.clone());
    let registry = Registry::linked()
        .with("Answer", move || {
            let answered = answered.clone();
            move |b: &mut Blackboard| -> Result<(), BoxError> {
                let share = b.random().uniform();
                let x = b.read(BALL).map_or(0.0, |ball| ball.x);
                let count = b.signals(NEWS).count() as f64;
                b.publish(NEWS, Ball { x, y: b.now().as_secs_f64() + share + count, found: false })?;
                // No receiver exists in a replay.
                let _ = answered.send("answer");
                if x < -9.0 { Err("too far".into()) } else { Ok(()) }
            }
        })
        .with("Look", move || {
            let (looked, mut times) = (looked.clone(), 0);
            move |b: &mut Blackboard| -> Result<Progress, BoxError> {
                times += 1;
                let last = b.signals(NEWS).map(|news| news.y).fold(0.0, f64::max);
                b.publish(NEWS, Ball { x: f64::from(times), y: last, found: true })?;
                let _ = looked.send("look");
                Ok(if times % 3 == 0 { Progress::Done } else { Progress::after(Duration::from_millis(1)) })
            }
        });
    let text = format!(
        "Liveness:\nm = Answer~ || Look~\nTransitions:\nAnswer -> Answer : [ball.State.Ball.x < {near:?}]\n\
         Look -> Look : [{thrower}.Game.phase == PLAY]"
    );
    (registry, chart(&text))
}

/// Both agents for a while, as they were recorded.
fn recorded() -> Vec<Kept> {
    let tape = Tape::default();
    let (sender, calls) = channel();
    let (registry, keeper) = keeper(-3.0, &sender);
    let mut talws = Talws::new().registry(registry).agent(keeper).agent(thrower());
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    // on a busy machine one of the two agents may run far ahead of the other
    let thrown = || tape.kept().iter().filter(|kept| kept.topic == "test/ball").count();
    let mut answers = 0;
    while answers < 30 || thrown() < 60 {
        answers += usize::from(next(&calls, 1) == ["answer"]);
    }
    running.stop();
    tape.kept()
}

fn again(near: f64) -> Talws {
    let (registry, keeper) = keeper(near, &channel().0);
    Talws::new().registry(registry).agent(keeper).agent(thrower())
}

#[test]
fn recorded_real_time_runs_are_repeated() {
    let messages = recorded();
    let outcome = replay(again(-3.0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    let turns = messages.iter().filter(|kept| is_turn(kept)).count() as u64;
    for (agent, topic) in [
        ("keeper", "test/news"),
        ("keeper", "monas/chart"),
        ("keeper", "monas/cycle"),
        ("thrower", "test/ball"),
    ] {
        let published = messages.iter().filter(|kept| kept.publisher == agent && kept.topic == topic);
        let published =
            published.count() as u64 - if (agent, topic) == ("keeper", "monas/cycle") { turns } else { 0 };
        assert_eq!(outcome.compared(agent, topic), published, "{agent} {topic}");
        assert!(published > 10, "{agent} {topic}: {published}");
    }
    assert!(turns > 10, "{turns}");
}

#[test]
fn one_agent_is_replayed_without_the_other() {
    let messages = recorded();
    let (registry, keeper) = keeper(-3.0, &channel().0);
    let outcome = replay(Talws::new().registry(registry).agent(keeper), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert!(outcome.compared("keeper", "test/news") > 10);
    assert_eq!(outcome.compared("thrower", "test/ball"), 0);
}

#[test]
fn linked_messages_under_the_agents_name_are_not_its_own() {
    let mut messages = recorded();
    for kept in messages.iter_mut().filter(|kept| kept.topic == "test/ball") {
        kept.publisher = "keeper".into();
    }
    let (registry, keeper) = keeper(-3.0, &channel().0);
    let rule = ReceiveRule { topics: "test/ball".into(), publish_as: PublishAs::Own };
    let settings = LinkSettings { receive: vec![rule], ..LinkSettings::default() };
    let talws = Talws::new().registry(registry).agent(keeper);
    let outcome = replay(talws.link(LinkConfig { settings, ..LinkConfig::default() }), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert!(outcome.compared("keeper", "test/news") > 10);
    assert_eq!(outcome.compared("keeper", "test/ball"), 0);
}

#[test]
fn a_changed_threshold_shows_at_the_agent_that_has_it_alone() {
    let messages = recorded();
    // no ball is so near: the first of thirty outputs is missing
    let outcome = replay(again(-100.0), &messages).unwrap();
    let first = outcome.differences.first().unwrap();
    assert_eq!((first.host.as_str(), first.agent.as_str()), ("local", "keeper"));
    assert!(outcome.differences.iter().all(|difference| difference.agent == "keeper"));
    assert!(outcome.compared("thrower", "test/ball") > 10);
}

#[test]
fn a_recording_that_lacks_messages_is_refused() {
    let messages: Vec<Kept> = recorded().into_iter().filter(|kept| kept.topic != "test/ball").collect();
    let error = replay(again(-3.0), &messages).err().unwrap();
    assert!(error.to_string().contains("lacks messages of `local`"), "{error}");
}

#[test]
fn a_recording_without_turns_is_refused() {
    let mut messages = recorded();
    for kept in messages.iter_mut().filter(|kept| kept.topic == "monas/cycle") {
        let records::Cycle { number, time, delivered, .. } = records::Cycle::decode(&kept.bytes[..]).unwrap();
        kept.bytes = records::Cycle { number, time, delivered, ..records::Cycle::default() }.encode_to_vec();
    }
    let error = replay(again(-3.0), &messages).err().unwrap();
    assert!(error.to_string().contains("lacks the inputs of the turns of `"), "{error}");
}

/// One agent with the list and with two charts: the keeper's, and one that counts what that one
/// says. All publish under one name, both charts on one topic.
fn player(near: f64, calls: &Sender<&'static str>) -> Talws {
    let (registry, keeping) = keeping(near, "player", calls);
    let registry = registry.with("Count", || {
        let mut count = 0.0;
        move |b: &mut Blackboard| {
            count += b.signals(NEWS).count() as f64;
            b.publish(NEWS, Ball { x: -1.0, y: count, found: false })
        }
    });
    let counting = chart("Liveness:\nn = Count~\nTransitions:\nCount -> Count : [news.Signal.Ball.found]");
    let player = Agent::new("player", Hz(1000)).activity(throws).chart(keeping).chart(counting);
    Talws::new().registry(registry).agent(player.on_failure(FailurePolicy::Restart))
}

fn recorded_player() -> Vec<Kept> {
    let tape = Tape::default();
    let (sender, calls) = channel();
    let mut talws = player(-3.0, &sender);
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    let count = |part, topic: &str| {
        let kept = tape.kept();
        kept.iter().filter(|kept| (kept.part, kept.topic.as_str()) == (part, topic)).count()
    };
    while count(0, "test/news") < 30 || count(1, "test/news") < 10 || count(2, "test/ball") < 60 {
        next(&calls, 1);
    }
    running.stop();
    tape.kept()
}

#[test]
fn each_thread_of_an_agent_repeats_its_own_turns() {
    let messages = recorded_player();
    let outcome = replay(player(-3.0, &channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    let turns = messages.iter().filter(|kept| is_turn(kept)).count() as u64;
    for topic in ["test/news", "test/ball", "test/game", "monas/chart", "monas/model", "monas/cycle"] {
        let of_player = messages.iter().filter(|kept| kept.publisher == "player" && kept.topic == topic);
        let published = of_player.count() as u64 - if topic == "monas/cycle" { turns } else { 0 };
        assert_eq!(outcome.compared("player", topic), published, "{topic}");
    }
}

#[test]
fn a_changed_threshold_shows_at_the_thread_that_has_it_alone() {
    let messages = recorded_player();
    let outcome = replay(player(-100.0, &channel().0), &messages).unwrap();
    assert!(!outcome.differences.is_empty());
    let of_keeping = |topic: &str| ["test/news", "monas/chart", "monas/cycle"].contains(&topic);
    let other = outcome.differences.iter().find(|difference| !of_keeping(&difference.topic));
    assert_eq!(other, None);
    // The list has as many cycles as it had, and the other chart counts what was said then.
    assert!(outcome.compared("player", "test/ball") >= 60);
}

#[test]
fn a_recording_with_ambiguous_threads_is_rejected() {
    let mut messages = recorded_player();
    messages.iter_mut().for_each(|kept| kept.part = 0);
    let error = replay(player(-3.0, &channel().0), &messages).err().unwrap();
    assert!(error.to_string().contains("lacks the inputs of the turns of `player`"), "{error}");
}

#[test]
fn an_agent_that_begins_with_nothing_is_refused() {
    let host = HostConfig {
        name: "local".into(),
        agents: vec![Agent::new("idle", Hz(10))],
        ..HostConfig::default()
    };
    let mut talws = Talws::new();
    talws.host(host);
    let error = talws.replay_real_time(&[]).err().unwrap();
    assert!(error.to_string().contains("`idle` has neither charts nor activities"), "{error}");
}

#[test]
fn an_activity_that_waits_for_cancellation_returns_in_a_replay() {
    let talws = |started: Sender<()>| {
        let registry = Registry::linked().with("Wait", move || {
            let started = started.clone();
            move |b: &mut Blackboard| {
                let _ = started.send(());
                while !b.is_cancelled() {
                    std::thread::yield_now();
                }
                b.publish(NEWS, Ball { x: 1.0, ..Ball::default() })
            }
        });
        Talws::new().registry(registry).agent(Agent::statechart("m", chart("m = Wait")))
    };
    let tape = Tape::default();
    let (sender, started) = channel();
    let mut first = talws(sender);
    first.observe(Box::new(tape.clone()));
    let running = first.start().unwrap();
    started.recv_timeout(TIMEOUT).unwrap();
    running.stop();
    let messages = tape.kept();
    let outcome = replay(talws(channel().0), &messages).unwrap();
    assert_eq!(outcome.differences, []);
    assert!(outcome.compared("m", "monas/chart") > 0);
}

fn is_turn(kept: &Kept) -> bool {
    kept.topic == "monas/cycle"
        && records::Cycle::decode(&kept.bytes[..]).unwrap().turn() != records::Turn::None
}
