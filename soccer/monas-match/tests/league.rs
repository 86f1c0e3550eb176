//! The league's protocol in both directions over the loopback interface: the referee of one match
//! decides another, whose robots report.
#![allow(clippy::unwrap_used, clippy::panic)] // tests may panic

use std::time::Duration;

use monas_gamecontroller::{
    Competition, ControlReceiver, ControlSender, Endpoint, GameControlData, LeagueState, Penalty, RuleBook,
    SetPlay,
};
use monas_match::{MatchOptions, MatchPlan, MatchSource, RunningMatch};
use monas_sim::GameState;
use narukom::Timestamp;

/// Longer than a packet needs on the loopback interface, in steps of the test.
const MAX_DELIVERY_STEPS: u32 = 2000;

fn plan() -> MatchPlan {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/match.xml");
    MatchSource::load(file, &monas::Registry::linked()).unwrap()
}

/// A sender, and the receiver that it reaches.
fn network() -> (ControlSender, ControlReceiver) {
    let receiver = ControlReceiver::open(Endpoint::LOOPBACK).unwrap();
    let sender = ControlSender::open(receiver.address().unwrap(), 0).unwrap();
    let receiver = receiver.with_return_port(sender.return_port().unwrap());
    (sender, receiver)
}

fn advance(running: &mut RunningMatch, by: Duration) {
    running.advance(running.now() + by).unwrap();
}

/// Advances a match in small steps until something holds.
fn until(running: &mut RunningMatch, holds: impl Fn(&RunningMatch) -> bool) {
    for _ in 0..MAX_DELIVERY_STEPS {
        if holds(running) {
            return;
        }
        advance(running, Duration::from_millis(10));
    }
    panic!("it never holds; {:?} in {}", running.league(), running.score().phase);
}

fn state(running: &RunningMatch) -> GameState {
    running.pitch().with_world(|world| world.referee().state())
}

#[test]
fn the_referee_of_one_match_decides_another_whose_robots_report() {
    for rules in RuleBook::ALL {
        let (sender, receiver) = network();
        let mut ours =
            plan().referee_others(sender, rules, Duration::ZERO).start(MatchOptions::default()).unwrap();
        let other = MatchOptions { seed: 9, ..MatchOptions::default() };
        let mut others = plan().follow_gamecontroller(receiver).start(other).unwrap();
        advance(&mut others, Duration::from_secs(8));
        assert_eq!(state(&others), GameState::Initial, "{rules}: it waits for the GameController");
        for expected in [GameState::Initial, GameState::Ready, GameState::Set, GameState::Playing] {
            until(&mut ours, |ours| state(ours) == expected);
            advance(&mut ours, Duration::from_millis(20));
            until(&mut others, |others| state(others) == expected);
        }
        until(&mut others, |others| others.league().unwrap().reports >= 12);
        until(&mut ours, |ours| ours.league().unwrap().reports >= 6);
        let texts: Vec<&str> = ours.events().iter().map(|event| event.text.as_str()).collect();
        for robot in ["player 1 of team 1 is online", "player 3 of team 2 is online"] {
            assert!(texts.contains(&robot), "{texts:?}");
        }
        let decided =
            others.events().iter().any(|event| event.text == "the GameController at 127.0.0.1 decides");
        assert!(decided, "{:?}", others.events());
        assert_eq!(others.finish().unwrap().league.unwrap().refused, 0);
    }
}

#[test]
fn a_gamecontroller_penalises_and_awards_goals() {
    let (mut sender, receiver) = network();
    let mut running = plan().follow_gamecontroller(receiver).start(MatchOptions::default()).unwrap();
    let mut control = GameControlData::new(Competition::default(), [1, 2]);
    control.state = LeagueState::Playing;
    control.set_play = Some(SetPlay::CornerKick);
    control.kicking_team = Some(2);
    control.teams[1].score = 1;
    let player = control.teams[0].player_mut(2).unwrap();
    (player.penalty, player.seconds_left) = (Some(Penalty::Pushing), 45);
    sender.send(&control, Timestamp::ZERO).unwrap();
    until(&mut running, |running| state(running) == GameState::Playing);
    running.pitch().with_world(|world| {
        assert_eq!(world.referee().score(), [0, 1]);
        let off: Vec<u8> =
            world.robots().iter().filter(|robot| !robot.on_field).map(|robot| robot.number).collect();
        assert_eq!(off, [2], "the penalised robot has left the field");
    });
    // Vision runs in PLAYING only: the packet has reached the agents if the goalie knows its pose.
    advance(&mut running, Duration::from_secs(3));
    let sent = running.league().unwrap().reports;
    let reports = (0..sent).map(|_| {
        let mut receive = || sender.receive(Timestamp::ZERO).unwrap();
        std::iter::repeat_with(&mut receive).flatten().next().unwrap().content.unwrap()
    });
    let report = reports.filter(|report| (report.team, report.player) == (1, 1)).last().unwrap();
    assert!(report.pose[0] < -2000.0, "the goalie knows, in mm, that it is at its own goal: {report:?}");
    assert!(!report.is_fallen, "{report:?}");

    control.teams[0].number = 7;
    sender.send(&control, Timestamp::ZERO).unwrap();
    until(&mut running, |running| running.league().unwrap().refused == 1);
    let foreign = "a GameController announces teams 7 and 2, not team 1 of this match";
    assert!(running.events().iter().any(|event| event.text == foreign), "{:?}", running.events());

    advance(&mut running, Duration::from_secs(5));
    assert!(running.events().iter().any(|event| event.text.contains("silent")), "{:?}", running.events());
    assert_eq!(state(&running), GameState::Playing, "the last decision holds");
}
