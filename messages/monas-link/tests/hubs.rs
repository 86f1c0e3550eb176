//! Linked hubs: messages published on one are read on the other, for all three retention kinds.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::time::Duration;

use monas_link::example::{Ball, Command};
use monas_link::{
    AccessList, ErrorKind, HubBridge, LinkSettings, MessageBytes, Packet, PublishAs, ReceiveRule,
};
use narukom::prost::Message as _;
use narukom::{Data, Hub, Signal, State, Timestamp, Topic, TopicDeclaration, topic};

topic! {
    /// Position of the ball.
    BALL: State<Ball> = "soccer/ball";
    /// The command for the robot.
    COMMAND: Signal<Command> = "soccer/command";
    /// Past positions of the ball.
    TRACK: Data<Ball, 16> = "soccer/track";
}

/// Two ends, and a line with a latency of a millisecond each way. The clock of the second is ahead.
struct Line {
    ends: [HubBridge; 2],
    flying: [Vec<Packet>; 2],
    ahead: [Duration; 2],
    millis: u64,
}

impl Line {
    fn new(ends: [HubBridge; 2]) -> Line {
        let ahead = [Duration::ZERO, Duration::from_secs(500)];
        Line { ends, flying: [Vec::new(), Vec::new()], ahead, millis: 0 }
    }

    fn now(&self, end: usize) -> Timestamp {
        Timestamp::ZERO + Duration::from_millis(self.millis) + self.ahead[end]
    }

    fn run(&mut self, millis: u64) {
        for _ in 0..millis {
            self.millis += 1;
            let arrived = std::mem::take(&mut self.flying);
            for (end, packets) in arrived.iter().enumerate() {
                let now = self.now(end);
                packets.iter().for_each(|packet| self.ends[end].handle(packet, now));
            }
            for end in 0..2 {
                let now = self.now(end);
                while let Some(packet) = self.ends[end].poll(now) {
                    self.flying[1 - end].push(packet);
                }
            }
        }
    }
}

fn ball(distance: f64) -> Ball {
    Ball { distance, bearing: 0.0 }
}

fn hubs() -> [Hub; 2] {
    ["robot_1", "robot_2"].map(|name| Hub::with_linked_topics(name).unwrap())
}

fn everything() -> LinkSettings {
    LinkSettings::default().sending("soccer/**").receiving("soccer/**")
}

fn line(hubs: &[Hub; 2], settings: [LinkSettings; 2]) -> Line {
    let [first, second] = settings;
    Line::new([HubBridge::new(&hubs[0], first, 1).unwrap(), HubBridge::new(&hubs[1], second, 2).unwrap()])
}

#[test]
fn every_way_of_keeping_stays_what_it_is() {
    let hubs = hubs();
    hubs[0].publisher(BALL, "vision").unwrap().publish(ball(1.0), Timestamp::ZERO);
    hubs[0].publisher(COMMAND, "coach").unwrap().publish(Command { text: "early".into() }, Timestamp::ZERO);
    let mut line = line(&hubs, [everything(), everything()]);
    let mut mate = hubs[1].blackboard("mate");
    let host = hubs[1].host_id("robot_1").unwrap();
    mate.process_messages(line.now(1));
    assert_eq!(mate.from(host).read(TRACK), None);
    line.run(1000);
    mate.process_messages(line.now(1));
    assert_eq!(
        mate.from(host).read(BALL).map(|ball| ball.distance),
        Some(1.0),
        "a state is for who comes late"
    );
    assert_eq!(mate.from(host).signals(COMMAND).count(), 0, "a signal is not");
    assert_eq!(mate.read(BALL), None, "another host's is not one's own");

    let mut track = hubs[0].publisher(TRACK, "vision").unwrap();
    for number in 0..3 {
        track.publish(ball(f64::from(number)), line.now(0));
        line.run(100);
    }
    hubs[0].publisher(COMMAND, "coach").unwrap().publish(Command { text: "kick".into() }, line.now(0));
    line.run(5);
    mate.process_messages(line.now(1));
    let texts: Vec<&str> =
        mate.from(host).signals(COMMAND).map(|command| command.message.text.as_str()).collect();
    assert_eq!(texts, ["kick"]);
    let view = mate.from(host);
    assert_eq!(view.recent(TRACK, Duration::MAX).count(), 3);
    let sample = view.sample(BALL).unwrap();
    assert_eq!(&*hubs[1].publisher_name(sample.header.publisher).unwrap(), "vision");
    assert_eq!(sample.header.sequence, 1);
}

#[test]
fn histories_of_other_hosts_are_read_by_this_hosts_time() {
    let hubs = hubs();
    let mut line = line(&hubs, [everything(), everything()]);
    let mut mate = hubs[1].blackboard("mate");
    let host = hubs[1].host_id("robot_1").unwrap();
    line.run(1000);
    mate.process_messages(line.now(1));
    assert_eq!(mate.from(host).read(TRACK), None);
    let mut track = hubs[0].publisher(TRACK, "vision").unwrap();
    for number in 0..4 {
        track.publish(ball(f64::from(number)), line.now(0));
        line.run(100);
    }
    mate.process_messages(line.now(1));
    // Published at 1.1 s of a clock that is 500 s behind this one.
    let sample = mate.from(host).nearest(TRACK, Timestamp::from_secs_f64(501.11)).unwrap();
    assert_eq!(sample.distance, 1.0);
    assert_eq!(sample.header.published, Timestamp::from_secs_f64(1.1));
    let error = sample.header.local.distance(Timestamp::from_secs_f64(501.1));
    assert!(error <= Duration::from_millis(1), "{error:?}");
}

#[test]
fn a_second_process_of_the_same_robot_publishes_as_if_it_were_here() {
    let hubs = hubs();
    let own = ReceiveRule { topics: "soccer/ball".into(), publish_as: PublishAs::Own };
    let here =
        LinkSettings { receive: vec![own.clone()], ..LinkSettings::default() }.sending("soccer/command");
    let there = LinkSettings::default().sending("soccer/ball").receiving("soccer/command");
    let mut line = line(&hubs, [here.clone(), there]);
    let mut behaviour = hubs[0].blackboard("behaviour");
    line.run(1000);
    hubs[1].publisher(BALL, "vision").unwrap().publish(ball(2.0), line.now(1));
    line.run(5);
    behaviour.process_messages(line.now(0));
    let sample = behaviour.sample(BALL).unwrap();
    assert_eq!(sample.distance, 2.0);
    assert_eq!(&*hubs[0].publisher_name(sample.header.publisher).unwrap(), "vision");
    let error = HubBridge::new(&hubs[0], here.sending("soccer/**"), 3).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Settings);
    assert!(error.to_string().contains("`soccer/ball` is received as this host's own"), "{error}");
}

#[test]
fn access_violations_are_rejected_and_counted() {
    let hubs = hubs();
    let (access, errors) = AccessList::parse("robot_1 publish soccer/ball");
    assert_eq!(errors, []);
    let mut line = line(&hubs, [everything(), LinkSettings { access, ..everything() }]);
    line.run(500);
    hubs[0].publisher(BALL, "vision").unwrap().publish(ball(1.0), line.now(0));
    hubs[0].publisher(COMMAND, "coach").unwrap().publish(Command::default(), line.now(0));
    line.run(500);
    let counters = line.ends[1].node().counters();
    let of = |path: &str| counters.received.iter().find(|one| one.1 == path).unwrap().2;
    assert_eq!((of("soccer/ball").delivered, of("soccer/ball").refused), (1, 0));
    assert_eq!((of("soccer/command").delivered, of("soccer/command").refused), (0, 1));
    let mut mate = hubs[1].blackboard("mate");
    mate.process_messages(line.now(1));
    assert_eq!(mate.from(hubs[1].host_id("robot_1").unwrap()).signals(COMMAND).count(), 0);
}

/// A hub that declares `soccer/ball` differently.
fn stranger<K: narukom::Retention>(_: Topic<K>) -> Hub {
    Hub::new("robot_2", [&TopicDeclaration::new::<K>("soccer/ball", "elsewhere")]).unwrap()
}

#[test]
fn a_topic_that_differs_is_not_read_and_both_sides_say_how() {
    let here = Hub::with_linked_topics("robot_1").unwrap();
    let there = stranger(COMMAND);
    let settings = LinkSettings::default().sending("soccer/ball").receiving("soccer/ball");
    let ends =
        [HubBridge::new(&here, settings.clone(), 1).unwrap(), HubBridge::new(&there, settings, 2).unwrap()];
    let mut line = Line::new(ends);
    line.run(3000);
    here.publisher(BALL, "vision").unwrap().publish(ball(1.0), line.now(0));
    line.run(100);
    for end in &line.ends {
        let mismatches = end.node().mismatches();
        assert_eq!(mismatches.len(), 1, "{mismatches:?}");
        assert_eq!(mismatches[0].path.as_deref(), Some("soccer/ball"));
    }
    let text = &line.ends[1].node().mismatches()[0].text;
    assert!(text.contains("state there, signal here"), "{text}");
    assert!(text.contains("- monas.link.example.Command: string text = 1"), "{text}");
    assert!(text.contains("+ monas.link.example.Ball: double distance = 1"), "{text}");
    let refused = line.ends[1].node().counters().received[0].2;
    assert_eq!((refused.arrived, refused.refused, refused.delivered), (1, 1, 0));
}

#[test]
fn bytes_that_are_no_message_any_more_or_never_were_are_refused_and_counted() {
    let hubs = hubs();
    let settings =
        LinkSettings { accepts_unlinked: true, ..LinkSettings::default() }.receiving("soccer/ball");
    let mut end = HubBridge::new(&hubs[0], settings, 1).unwrap();
    let packet = |payload: MessageBytes| Packet {
        from: "laptop".into(),
        to: None,
        path: Some("soccer/ball".into()),
        stamp: [].into(),
        payload,
        priority: 4,
        is_reliable: true,
    };
    end.handle(&packet(vec![0xff, 0xff, 0xff].into()), Timestamp::ZERO);
    end.handle(&packet(MessageBytes::default()), Timestamp::ZERO);
    // Memory of another process, which has reclaimed it from the second byte on.
    let far = || Ball { distance: 9.0, bearing: 0.0 }.encode_to_vec();
    end.handle(&packet(MessageBytes::from_shared_memory(Vec::new(), || true)), Timestamp::ZERO);
    end.handle(&packet(MessageBytes::from_shared_memory(far(), || false)), Timestamp::ZERO);
    let counted = end.node().counters().received[0].2;
    assert_eq!((counted.arrived, counted.delivered, counted.refused), (4, 2, 2));
    let mut reader = hubs[0].blackboard("reader");
    reader.process_messages(Timestamp::ZERO);
    let host = hubs[0].host_id("laptop").unwrap();
    assert_eq!(
        reader.from(host).read(BALL),
        Some(&Ball::default()),
        "a guest's message is one of the guest's host"
    );
}

#[test]
fn messages_under_a_links_own_name_are_rejected() {
    let hub = &hubs()[0];
    let settings = LinkSettings { accepts_unlinked: true, name: "vision".into(), ..LinkSettings::default() };
    let mut end = HubBridge::new(hub, settings.receiving("soccer/ball"), 1).unwrap();
    let packet = |from: &str| Packet {
        from: from.into(),
        to: None,
        path: Some("soccer/ball".into()),
        stamp: [].into(),
        payload: Vec::new().into(),
        priority: 4,
        is_reliable: true,
    };
    end.handle(&packet("vision"), Timestamp::ZERO);
    assert!(end.node().counters().received.is_empty());
    end.handle(&packet("laptop"), Timestamp::ZERO);
    assert_eq!(end.node().counters().received[0].2.delivered, 1);
}

#[test]
fn settings_that_do_not_fit_are_refused() {
    let hub = &hubs()[0];
    let error = HubBridge::new(hub, LinkSettings::default().sending("soccer/bal"), 1).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Settings);
    assert!(error.to_string().contains("soccer/bal"), "{error}");
    let mut settings = everything();
    settings.send[0].priority = 8;
    let error = HubBridge::new(hub, settings, 1).unwrap_err();
    assert!(error.to_string().contains("not 1 to 7"), "{error}");
}
