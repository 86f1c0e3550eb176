//! Runs in real time are repeated: each agent on what was recorded of its turns.

use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use monas::replay::Company;
use monas::{
    Agent, Blackboard, BoxError, HostConfig, Hz, LinkConfig, Policy, Progress, Registry, Talws, records,
};
use monas_link::{LinkSettings, Place, ReceiveRule};
use narukom::prost::Message as _;

use crate::kit::{BALL, Ball, GAME, Game, NEWS, Phase};
use crate::taped::{Kept, Tape, replay};
use crate::{PATIENCE, chart, next};

/// A list that throws balls to somewhere.
fn thrower() -> Agent {
    let throws = |b: &mut Blackboard| -> Result<(), BoxError> {
        let far = b.random().uniform() * 10.0;
        let before = b.read(BALL).map_or(0.0, |ball| ball.y);
        b.publish(BALL, Ball { x: far, y: before + 1.0, found: true })?;
        let phase = if far < 7.0 { Phase::Play } else { Phase::Wait };
        b.publish(GAME, Game { phase: phase.into() })?;
        b.publish(BALL, Ball { x: -far, y: before + 2.0, found: false }).map_err(Into::into)
    };
    Agent::new("thrower", Hz(2000)).activity(throws)
}

/// A chart with two regions: one answers balls that are near, the other one looks again and again whether one is far. What they publish
/// depends on what was delivered before which step, on when that was, on chance, on failures, and on what was written before.
fn keeper(near: f64, calls: &Sender<&'static str>) -> (Registry, Agent) {
    let (answered, looked) = (calls.clone(), calls.clone());
    let registry = Registry::linked()
        .with("Answer", move || {
            let answered = answered.clone();
            move |b: &mut Blackboard| -> Result<(), BoxError> {
                let share = b.random().uniform();
                let x = b.read(BALL).map_or(0.0, |ball| ball.x);
                let count = b.signals(NEWS).count() as f64;
                b.publish(NEWS, Ball { x, y: b.now().as_secs_f64() + share + count, found: false })?;
                // Nobody listens in a replay.
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
         Look -> Look : [thrower.Game.phase == PLAY]"
    );
    (registry, Agent::statechart("keeper", chart(&text)).on_failure(Policy::Restart))
}

/// Both agents for a while, as they were recorded.
fn recorded() -> Vec<Kept> {
    let tape = Tape::default();
    let (sender, calls) = channel();
    let (registry, keeper) = keeper(-3.0, &sender);
    let mut talws = Talws::new().registry(registry).agent(keeper).agent(thrower());
    talws.observe(Box::new(tape.clone()));
    let running = talws.start().unwrap();
    // on a machine that is busy with other things one of the two may do much while the other one waits
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
fn what_was_recorded_in_real_time_happens_again() {
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
fn what_a_link_brings_under_the_agents_own_name_is_not_the_agents() {
    let mut messages = recorded();
    for kept in messages.iter_mut().filter(|kept| kept.topic == "test/ball") {
        kept.publisher = "keeper".into();
    }
    let (registry, keeper) = keeper(-3.0, &channel().0);
    let rule = ReceiveRule { topics: "test/ball".into(), place: Place::Own };
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
    // no ball is so near: of thirty answers the first is left
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
    assert!(error.to_string().contains("does not tell what each turn of `"), "{error}");
}

#[test]
fn agents_whose_threads_share_a_name_are_refused() {
    let (registry, keeper) = keeper(-3.0, &channel().0);
    let both = keeper.every(Hz(10)).activity(|_: &mut Blackboard| {});
    let host = HostConfig { name: "local".into(), agents: vec![both], ..HostConfig::default() };
    let mut talws = Talws::new().registry(registry);
    talws.host(host);
    let thrower = Company { host: "local".into(), publisher: "thrower".into(), is_agent: true };
    let error = talws.replay_real_time(&[thrower]).err().unwrap();
    assert!(error.to_string().contains("`keeper` has several threads"), "{error}");
}

#[test]
fn an_activity_that_waits_to_be_asked_to_return_returns_in_a_replay() {
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
    started.recv_timeout(PATIENCE).unwrap();
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
