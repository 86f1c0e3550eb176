//! A referee outside the simulation: the field carries out what it announces, and nothing else.
#![allow(clippy::unwrap_used)] // tests may panic

use std::time::Duration;

use monas_robot::{Announcement, Colour, GamePhase, Percepts, Robot};
use monas_sim::{EventKind, GameState, Setup, SharedField, SimulatedWorld, Vector};
use narukom::Timestamp;

fn field() -> SharedField {
    let field = SharedField::new(SimulatedWorld::new(Setup::three_against_three(3)).unwrap());
    field.await_league();
    field
}

/// Announcements to the six robots, of which the first three attack the yellow goal.
fn announced(phase: GamePhase) -> Vec<Announcement> {
    let robot = |index: u32| Announcement {
        phase: phase.into(),
        seconds_left: 599.0,
        first_half: true,
        team: index / 3 + 1,
        number: index % 3 + 1,
        team_colour: Colour::Gray.into(),
        goal_to_attack: if index < 3 { Colour::Yellow } else { Colour::Blue }.into(),
        kick_off: index >= 3,
        ..Announcement::default()
    };
    (0..6).map(robot).collect()
}

fn steps(field: &SharedField, count: usize) {
    (0..count).for_each(|_| field.step());
}

fn state(field: &SharedField) -> GameState {
    field.with_world(|world| world.referee().state())
}

#[test]
fn robots_wait_without_an_announcement() {
    let field = field();
    steps(&field, 2000);
    assert_eq!(state(&field), GameState::Initial);
    let mut percepts = Percepts::default();
    field.body(0).unwrap().sense(Timestamp::ZERO, &mut percepts).unwrap();
    assert_eq!(percepts.announcement, None);
    assert!(field.follow(announced(GamePhase::Ready)[..5].to_vec()).is_err(), "five for six robots");
}

#[test]
fn states_penalties_and_goals_follow_the_announcements() {
    let field = field();
    let mut body = field.body(1).unwrap();
    let mut percepts = Percepts::default();
    for (phase, expected) in [
        (GamePhase::Ready, GameState::Ready),
        (GamePhase::Set, GameState::Set),
        (GamePhase::Playing, GameState::Playing),
    ] {
        field.follow(announced(phase)).unwrap();
        steps(&field, 1000);
        assert_eq!(state(&field), expected, "it stays for ten seconds");
        let now = Timestamp::ZERO + Duration::from_secs(10 * expected as u64);
        body.sense(now, &mut percepts).unwrap();
        let heard = percepts.announcement.unwrap();
        assert_eq!((heard.phase(), heard.seconds_left), (phase, 599.0));
        assert_eq!(heard.team_colour(), Colour::Blue, "the jersey on the field");
        assert_eq!(heard.field_length, 6.0);
    }
    assert_eq!(field.with_world(|world| world.referee().kick_off_team()), 1);

    let mut penalized = announced(GamePhase::Playing);
    (penalized[4].penalized, penalized[4].penalty_left) = (true, 45.0);
    field.follow(penalized).unwrap();
    steps(&field, 6000);
    assert!(!field.with_world(|world| world.robots()[4].on_field), "it leaves, and returns when announced");
    field.follow(announced(GamePhase::Playing)).unwrap();
    steps(&field, 1);
    assert!(field.with_world(|world| world.robots()[4].on_field));

    // A ball in the goal is not a goal until the referee says so.
    let (goal, roll) = (Vector::new(2.9, 0.0), Vector::new(1.0, 0.0));
    field.change(|world| world.place_ball(goal, roll)).unwrap();
    steps(&field, 300);
    assert_eq!(field.with_world(|world| world.referee().score()), [0, 0]);
    let mut ready = announced(GamePhase::Ready);
    for (index, robot) in ready.iter_mut().enumerate() {
        (robot.own_score, robot.opponent_score) = if index < 3 { (1, 0) } else { (0, 1) };
    }
    field.follow(ready).unwrap();
    steps(&field, 1);
    field.with_world(|world| {
        assert_eq!((world.referee().score(), world.referee().state()), ([1, 0], GameState::Ready));
        assert_eq!(world.ball().position, Vector::zeros(), "placed for the kick-off");
        let goals =
            world.events().iter().filter(|event| matches!(event.kind, EventKind::Goal { team: 0, .. }));
        assert_eq!(goals.count(), 1);
    });
}

#[test]
fn halted_robots_stand_and_sides_switch_in_the_second_half() {
    use monas_robot::Actuators;
    let field = field();
    let mut body = field.body(1).unwrap();
    let halted = |is_halted| {
        let mut all = announced(GamePhase::Playing);
        all.iter_mut().for_each(|robot| robot.halted = is_halted);
        all
    };
    let position = || field.with_world(|world| world.robots()[1].pose.position);
    for (is_halted, moves) in [(true, false), (false, true)] {
        field.follow(halted(is_halted)).unwrap();
        steps(&field, 1);
        let before = position();
        body.act(Timestamp::ZERO, &Actuators { walk_x: 0.2, ..Actuators::default() }).unwrap();
        steps(&field, 200);
        assert_eq!((position() - before).norm() > 0.05, moves, "halted: {is_halted}");
    }
    let mut second = announced(GamePhase::Initial);
    for robot in &mut second {
        robot.first_half = false;
        let other = if robot.team == 1 { Colour::Blue } else { Colour::Yellow };
        robot.goal_to_attack = other.into();
    }
    field.follow(second).unwrap();
    steps(&field, 1);
    assert!(
        field.with_world(|world| world.robots()[0].pose.position.x) > 2.0,
        "the goalie is at the other end"
    );
}
