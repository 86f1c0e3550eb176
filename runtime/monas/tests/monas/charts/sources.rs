//! Message sources of a chart: named publishers, other hosts, and activities executed elsewhere.

use std::sync::{Arc, Mutex};

use monas::{Agent, Blackboard, BoxError, ErrorKind, Hz, LinkConfig, LinkTransport, Talws};
use narukom::RemoteHeader;

use crate::charts::{balls, chart, noting, simulate};
use crate::kit::{BALL, Ball, GAME, Game, Phase, at};

#[test]
fn a_guard_reads_the_newest_message_of_the_named_publisher() {
    // Each plays from a certain moment on. Of the three that publish in each moment, `z` is the
    // last.
    let plays = |name: &str, from: u64| {
        Agent::new(name, Hz(100)).activity(move |b: &mut Blackboard| -> Result<(), BoxError> {
            let phase = if b.now() >= at(from) { Phase::Play } else { Phase::Wait };
            Ok(b.publish(GAME, Game { phase: phase.into() })?)
        })
    };
    let run = |guard: &str| {
        let (calls, registry) = noting();
        let text = format!("Liveness:\nm = A . B\nTransitions:\nA -> B : [{guard}]");
        let talws = Talws::new().registry(registry).agent(Agent::statechart("m", chart(&text)));
        let talws = talws.agent(plays("x", 50)).agent(plays("y", 30)).agent(plays("z", 1000));
        talws.simulate(1).unwrap().run_until(at(100)).unwrap();
        calls.taken()
    };
    assert_eq!(run("y.Game.phase == PLAY"), ["A 0", "B 30"]);
    assert_eq!(run("x.Game.phase == PLAY && z.Game.phase == WAIT"), ["A 0", "B 50"]);
    assert_eq!(run("z.Game.phase == PLAY"), ["A 0"]);
}

#[test]
fn a_guard_reads_what_its_own_chart_has_written_under_its_name() {
    let (calls, registry) = noting();
    let text = "Liveness:\nm = A . B . C\nTransitions:\nA -> B : / game.phase = PLAY\nB -> C : [m.Game.phase == PLAY]";
    simulate(registry, text).run_until(at(10)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "B 0", "C 0"]);
}

#[test]
fn a_guard_reads_what_a_link_brings_from_another_host() {
    let folder = tempfile::tempdir().unwrap();
    let settings = monas_link::LinkSettings::default().receiving("test/*");
    let link = LinkConfig {
        settings,
        transport: LinkTransport::Local { folder: Some(folder.path().join("links")) },
        clock: None,
    };
    let (calls, registry) = noting();
    let text = "Liveness:\nm = A . B . C\nTransitions:\nA -> B : [striker.ball.State.Ball.x > 1]\n\
                B -> C : [striker.Vision.Game.phase == PLAY]";
    let talws = Talws::new().registry(registry).link(link).agent(Agent::statechart("m", chart(text)));
    let mut talws = talws.agent(balls(&[5]));
    let records = Arc::new(Mutex::new(Vec::new()));
    let noted = records.clone();
    talws.observe(Box::new(move |publication: narukom::Publication<'_>| {
        let text = format!("{:?}", publication.sample.message);
        if publication.topic.path() == "monas/cycle" && text.contains("striker") {
            noted.lock().unwrap().push(text);
        }
    }));
    let mut simulation = talws.simulate_linked(1).unwrap();
    let hub = simulation.hub("local").unwrap().clone();
    let arrives =
        |millis| RemoteHeader { sequence: millis, published: at(0), local: at(millis), received: at(millis) };
    let mut ball = hub.receiver("striker", "Vision", "test/ball").unwrap();
    let game = |publisher| hub.receiver("striker", publisher, "test/game").unwrap();
    let (mut vision, mut referee) = (game("Vision"), game("Referee"));
    let phase = |phase: Phase| Box::new(Game { phase: phase.into() });

    simulation.run_until(at(10)).unwrap();
    ball.receive(Box::new(Ball { x: 2.0, ..Ball::default() }), arrives(10)).unwrap();
    simulation.run_until(at(20)).unwrap();
    referee.receive(phase(Phase::Play), arrives(20)).unwrap();
    simulation.run_until(at(30)).unwrap();
    assert_eq!(
        calls.taken(),
        ["A 0", "B 10"],
        "the own ball is not the striker's, the referee is not Vision"
    );
    vision.receive(phase(Phase::Play), arrives(30)).unwrap();
    referee.receive(phase(Phase::default()), arrives(30)).unwrap();
    simulation.run_until(at(40)).unwrap();
    assert_eq!(calls.taken(), ["C 30"]);
    let of = |topic: &str, sequence: u64, publisher: &str| {
        let topic = narukom::topic_hash(topic);
        format!(
            "topic: {topic}, sequence: {sequence}, region: 0, host: \"striker\", publisher: \"{publisher}\""
        )
    };
    let records = records.lock().unwrap();
    for (record, read) in records.iter().zip([of("test/ball", 10, ""), of("test/game", 30, "Vision")]) {
        assert!(record.contains(&read), "{record} contains nothing of {read}");
    }
    assert_eq!(records.len(), 2, "the referee's game is nothing that a guard reads: {records:?}");
}

#[test]
fn a_trigger_is_fired_by_messages_of_the_own_host_unless_it_names_another() {
    let folder = tempfile::tempdir().unwrap();
    let calls_of = |trigger: &str| {
        let link = LinkConfig {
            settings: monas_link::LinkSettings::default().receiving("test/*"),
            transport: LinkTransport::Local { folder: Some(folder.path().join("links")) },
            clock: None,
        };
        let (calls, registry) = noting();
        let text = format!("Liveness:\nm = A~\nTransitions:\nA -> A : {trigger}");
        let talws = Talws::new().registry(registry).link(link);
        let mut simulation = talws.agent(Agent::statechart("m", chart(&text))).simulate_linked(1).unwrap();
        let hub = simulation.hub("local").unwrap().clone();
        for (millis, host) in [(10, "striker"), (20, "goalie")] {
            simulation.run_until(at(millis)).unwrap();
            let arrival =
                RemoteHeader { sequence: 1, published: at(0), local: at(millis), received: at(millis) };
            let mut ball = hub.receiver(host, "Vision", "test/ball").unwrap();
            ball.receive(Box::new(Ball::default()), arrival).unwrap();
        }
        simulation.run_until(at(30)).unwrap();
        hub.publisher(BALL, "Vision").unwrap().publish(Ball::default(), at(30));
        simulation.run_until(at(40)).unwrap();
        calls.taken()
    };
    assert_eq!(calls_of("ball.State.Ball"), ["A 0", "A 30"]);
    assert_eq!(calls_of("striker.ball.State.Ball"), ["A 0", "A 10"]);
    assert_eq!(calls_of("goalie.ball.State.Ball | ball.State.Ball"), ["A 0", "A 20", "A 30"]);
}

#[test]
fn a_signal_of_another_host_is_there_for_one_step() {
    let folder = tempfile::tempdir().unwrap();
    let settings = monas_link::LinkSettings::default().receiving("test/news");
    let transport = LinkTransport::Local { folder: Some(folder.path().join("links")) };
    let (calls, registry) = noting();
    let text = "Liveness:\nm = A~\nTransitions:\nA -> A : [striker.news.Signal.Ball.x == 0]";
    let talws = Talws::new().registry(registry).link(LinkConfig { settings, transport, clock: None });
    let mut simulation = talws.agent(Agent::statechart("m", chart(text))).simulate_linked(1).unwrap();
    let mut news = simulation.hub("local").unwrap().receiver("striker", "Vision", "test/news").unwrap();
    for millis in [10, 20] {
        simulation.run_until(at(millis)).unwrap();
        let arrival =
            RemoteHeader { sequence: millis, published: at(0), local: at(millis), received: at(millis) };
        news.receive(Box::new(Ball::default()), arrival).unwrap();
    }
    simulation.run_until(at(100)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "A 10", "A 20"]);
}

#[test]
fn hosts_with_links_do_not_run_in_simulated_time_unawares() {
    let talws = Talws::new().link(LinkConfig::default()).agent(balls(&[]));
    let error = talws.simulate(1).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Link);
    assert_eq!(error.to_string(), "`local` has links, and other processes do not wait for simulated time");
}

#[test]
fn an_activity_that_runs_elsewhere_is_not_called_and_its_state_is_passed() {
    let (calls, registry) = noting();
    let agent = Agent::statechart("m", chart("m = A . B . C")).elsewhere("B");
    Talws::new().registry(registry).agent(agent).simulate(1).unwrap().run_until(at(10)).unwrap();
    assert_eq!(calls.taken(), ["A 0", "C 0"]);
}
