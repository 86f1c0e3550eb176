//! Both ends of the protocol over the loopback interface.
#![allow(clippy::unwrap_used, clippy::expect_used)] // tests may panic

use std::time::Duration;

use monas_gamecontroller::{
    Competition, Connection, ControlReceiver, ControlSender, Endpoint, ErrorKind, GameControlData,
    LeagueState, Received, ReturnData, RuleBook,
};
use narukom::Timestamp;

/// The next message; packets on the loopback interface arrive soon, but not always at once.
fn arrived<T>(mut receive: impl FnMut() -> std::io::Result<Option<T>>) -> T {
    let found = (0..10_000_000).find_map(|_| {
        std::thread::yield_now();
        receive().unwrap()
    });
    found.expect("a packet arrives")
}

fn report(player: u8) -> ReturnData {
    let pose = [1000.0, -500.0, 0.5];
    ReturnData { player, team: 5, is_fallen: false, pose, ball_age: Some(0.5), ball: [700.0, 10.0] }
}

#[test]
fn control_data_arrives_and_reports_come_back() {
    let robots = ControlReceiver::open(Endpoint::LOOPBACK).unwrap();
    let mut referee = ControlSender::open(robots.address().unwrap(), 0).unwrap();
    let mut robots = robots.with_return_port(referee.return_port().unwrap());
    assert!(robots.receive().unwrap().is_none(), "it does not wait");
    for rules in RuleBook::ALL {
        let mut control = GameControlData::new(Competition::of(rules), [5, 24]);
        control.state = LeagueState::Playing;
        referee.send(&control, Timestamp::ZERO).unwrap();
        let Received { from, content } = arrived(|| robots.receive());
        let read = content.unwrap();
        assert_eq!((read.state, read.competition.rules()), (LeagueState::Playing, rules));
        assert_eq!(u64::from(read.packet_number) + 1, referee.sent());
        let sources: Vec<String> = (2..=3)
            .map(|player| {
                robots.report(&report(player), from).unwrap();
                let received = arrived(|| referee.receive(Timestamp::ZERO));
                assert_eq!(received.content, Ok(report(player)));
                received.from.to_string()
            })
            .collect();
        // Only Linux has all of 127.0.0.0/8.
        assert_eq!(sources, ["127.0.0.2", "127.0.0.3"], "each robot has an address of its own");
    }
    let later = Timestamp::ZERO + Duration::from_secs(3);
    assert_eq!(referee.online().connection(5, 2, later), Connection::Bad);
    assert_eq!(referee.online().connection(5, 4, later), Connection::Offline);
}

#[test]
fn control_data_is_due_twice_a_second() {
    let robots = ControlReceiver::open(Endpoint::LOOPBACK).unwrap();
    let mut referee = ControlSender::open(robots.address().unwrap(), 0).unwrap();
    let control = GameControlData::new(Competition::default(), [1, 2]);
    let mut sent = 0;
    for step in 0..300 {
        let now = Timestamp::ZERO + Duration::from_millis(10 * step);
        if referee.is_due(now) {
            referee.send(&control, now).unwrap();
            sent += 1;
        }
    }
    assert_eq!(sent, 6, "in three seconds");
}

#[test]
fn a_malformed_packet_is_reported_and_the_next_is_read() {
    let mut robots = ControlReceiver::open(Endpoint::LOOPBACK).unwrap();
    let stranger = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let to = robots.address().unwrap().to_string();
    stranger.send_to(b"RGme", &to).unwrap();
    stranger.send_to(&[0; 1000], &to).unwrap();
    let control = GameControlData::new(Competition::default(), [1, 2]);
    stranger.send_to(&control.encode().unwrap(), &to).unwrap();
    let kinds: Vec<_> =
        (0..3).map(|_| arrived(|| robots.receive()).content.map_err(|error| error.kind())).collect();
    assert_eq!(kinds, [Err(ErrorKind::Length), Err(ErrorKind::Header), Ok(control)]);
}
