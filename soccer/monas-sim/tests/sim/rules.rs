//! The referee: states, goals, sides, penalties and restarts.
#![allow(clippy::unwrap_used)] // tests may panic

use crate::common::{clear_field, events, play, playing, roll_into_goal, run, world, world_with_rules};
use monas_sim::{
    Command, EventKind, FieldSide, GameState, GoalColour, Motion, Offence, Pose, Side, SimulatedWorld,
    TeamColour, Vector,
};

fn changes(world: &SimulatedWorld) -> Vec<(GameState, GameState)> {
    let states = world.events().iter().filter_map(|event| match event.kind {
        EventKind::StateChanged { from, to } => Some((from, to)),
        _ => None,
    });
    states.collect()
}

#[test]
fn a_half_goes_from_initial_to_play() {
    use GameState::{Initial, Playing, Ready, Set};
    let mut world = world(1);
    assert_eq!(world.referee().state(), Initial);
    run(&mut world, 1.0);
    assert_eq!(world.referee().state(), Ready);
    run(&mut world, 3.0);
    assert_eq!(world.referee().state(), Set);
    run(&mut world, 2.0);
    assert_eq!(world.referee().state(), Playing);
    assert_eq!(changes(&world), [(Initial, Ready), (Ready, Set), (Set, Playing)]);
    assert_eq!(events(&world, |kind| matches!(kind, EventKind::KickOff { .. })).len(), 1);
}

#[test]
fn robots_walk_in_ready_and_are_held_before_and_after_it() {
    let mut world = world(2);
    let position = |world: &SimulatedWorld| world.robots()[2].pose.position;
    let before = position(&world);
    world.command(2, Command::walk(0.2, 0.0, 0.0)).unwrap();
    run(&mut world, 0.9);
    assert_eq!((world.referee().state(), position(&world)), (GameState::Initial, before));
    run(&mut world, 2.0);
    assert!((position(&world) - before).norm() > 0.2);
    world.command(2, Command::new(Motion::Stand)).unwrap();
    while world.referee().state() == GameState::Ready {
        world.step();
    }
    assert!((5.9..7.0).contains(&world.time()), "READY ends 3 s after the last motion: {}", world.time());
    let before = position(&world);
    world.command(2, Command::walk(0.2, 0.0, 0.0)).unwrap();
    run(&mut world, 1.0);
    assert_eq!((world.referee().state(), position(&world)), (GameState::Set, before));
}

#[test]
fn set_places_only_robots_that_stand_where_they_must_not() {
    let mut world = world_with_rules(2, |rules| rules.ready_duration = 20.0);
    run(&mut world, 1.1);
    let legal = Pose::new(-2.0, -1.0, 1.0);
    world.place_robot(2, legal).unwrap();
    world.place_robot(1, Pose::new(1.5, 1.0, 0.0)).unwrap();
    // one that does not stop does not prolong READY beyond its time
    world.command(1, Command::walk(0.0, 0.0, 0.5)).unwrap();
    run(&mut world, 19.8);
    assert_eq!(world.referee().state(), GameState::Ready);
    run(&mut world, 0.3);
    assert_eq!(world.referee().state(), GameState::Set);
    assert_eq!(world.robots()[2].pose.position, legal.position);
    assert!(world.robots()[1].pose.position.x < 0.0, "{:?}", world.robots()[1].pose);
    let mut senses = monas_sim::Senses::default();
    let mut is_lifted = |world: &mut SimulatedWorld, robot| {
        world.sense(robot, &mut senses).unwrap();
        senses.is_lifted
    };
    assert!(is_lifted(&mut world, 1) && !is_lifted(&mut world, 2), "it feels that it is placed");
    run(&mut world, 0.5);
    assert!(!is_lifted(&mut world, 1));
}

#[test]
fn goals_count_for_the_right_team_in_both_halves() {
    let mut world = play(world_with_rules(3, |rules| rules.half_duration = 60.0));
    roll_into_goal(&mut world, 1.0);
    assert_eq!(world.referee().score(), [1, 0], "the left team scores on the right");
    assert_eq!(world.referee().state(), GameState::Ready);
    assert_eq!(world.referee().kick_off_team(), 1, "who concedes kicks off");
    let mut world = play(world);
    while world.referee().half() == 1 {
        world.step();
    }
    let mut world = play(world);
    roll_into_goal(&mut world, 1.0);
    assert_eq!(world.referee().score(), [1, 1], "sides are switched");
    let mut world = play(world);
    roll_into_goal(&mut world, -1.0);
    assert_eq!(world.referee().score(), [2, 1]);
    assert_eq!(world.statistics().team(0).goals, 2);
}

#[test]
fn half_time_switches_sides_and_shirts_and_the_end_ends() {
    let mut world = play(world_with_rules(4, |rules| rules.half_duration = 20.0));
    let first_kick_off = world.referee().kick_off_team();
    let before = world.announcement(0).unwrap();
    assert_eq!((before.attacks, before.colour, before.half), (GoalColour::Yellow, TeamColour::Blue, 1));
    run(&mut world, 20.0);
    let after = world.announcement(0).unwrap();
    assert_eq!((after.attacks, after.colour, after.half), (GoalColour::Blue, TeamColour::Red, 2));
    assert_eq!(world.referee().kick_off_team(), 1 - first_kick_off);
    assert_eq!(world.referee().defends(), [FieldSide::Right, FieldSide::Left]);
    assert!(world.robots()[0].pose.position.x > 2.5, "the goalie guards the other goal");
    while world.referee().state() != GameState::Finished {
        world.step();
    }
    assert!((world.time() - 40.0).abs() < 1e-9, "{}", world.time());
    run(&mut world, 5.0);
    assert_eq!(world.referee().state(), GameState::Finished);
}

#[test]
fn shirts_can_be_kept() {
    let mut world = world_with_rules(4, |rules| {
        rules.half_duration = 20.0;
        rules.switch_colours = 0.0;
    });
    run(&mut world, 25.0);
    assert_eq!(world.announcement(0).unwrap().colour, TeamColour::Blue);
}

#[test]
fn a_ball_over_the_touch_line_is_thrown_in_against_the_last_toucher() {
    let mut world = playing(5);
    clear_field(&mut world, &[1]);
    world.place_robot(1, Pose::new(1.0, 1.5, std::f64::consts::FRAC_PI_2)).unwrap();
    world.place_ball(Vector::new(0.95, 1.66), Vector::zeros()).unwrap();
    world.command(1, Command::new(Motion::Kick(Side::Left))).unwrap();
    run(&mut world, 1.5);
    let thrown = events(&world, |kind| matches!(kind, EventKind::ThrowIn { .. }));
    let [EventKind::ThrowIn { against, position }] = thrown[..] else { panic!("{:?}", world.events()) };
    assert_eq!(against, Some(0));
    assert!((position.x - (-0.05)).abs() < 0.2 && (position.y - 1.6).abs() < 0.01, "{position}");
    assert!((world.ball().position - position).norm() < 1e-6);
}

#[test]
fn an_untouched_ball_is_dropped_at_the_centre() {
    let mut world = playing(6);
    clear_field(&mut world, &[]);
    world.place_ball(Vector::new(2.0, 1.0), Vector::zeros()).unwrap();
    run(&mut world, 29.9);
    assert!(events(&world, |kind| matches!(kind, EventKind::DropBall { .. })).is_empty());
    run(&mut world, 0.2);
    assert_eq!(events(&world, |kind| matches!(kind, EventKind::DropBall { .. })).len(), 1);
    assert_eq!(world.ball().position, Vector::zeros());
    run(&mut world, 30.0);
    assert!((world.ball().position.x.abs() - 1.2).abs() < 1e-6, "from the centre it goes to a mark");
}

fn penalties(world: &SimulatedWorld) -> Vec<(usize, Offence)> {
    let all = world.events().iter().filter_map(|event| match event.kind {
        EventKind::Penalty { robot, offence } => Some((robot, offence)),
        _ => None,
    });
    all.collect()
}

#[test]
fn a_defender_in_its_goal_area_is_sent_off_and_returns() {
    let mut world = playing(7);
    clear_field(&mut world, &[0, 2]);
    world.place_robot(0, Pose::new(-2.8, -0.5, 0.0)).unwrap();
    world.place_robot(2, Pose::new(-2.6, 0.5, 0.0)).unwrap();
    world.place_ball(Vector::new(1.0, 1.0), Vector::zeros()).unwrap();
    run(&mut world, 0.9);
    assert!(penalties(&world).is_empty());
    run(&mut world, 0.3);
    assert_eq!(penalties(&world), [(2, Offence::IllegalDefender)], "the goalie may be there");
    let state = world.robots()[2];
    assert!(!state.on_field && !world.field().contains(state.pose.position));
    let penalty = world.announcement(2).unwrap().penalty.unwrap();
    assert!((29.0..=30.0).contains(&penalty.remaining));
    world.command(2, Command::walk(0.3, 0.0, 0.0)).unwrap();
    run(&mut world, 29.5);
    assert_eq!(world.robots()[2].pose, state.pose, "it is held");
    world.command(2, Command::new(Motion::Stand)).unwrap();
    run(&mut world, 1.0);
    let back = world.robots()[2];
    assert!(back.on_field && world.announcement(2).unwrap().penalty.is_none());
    assert!(back.pose.position.x.abs() < 0.5, "it comes back at the halfway line");
    assert!((back.pose.position.y + 2.0).abs() < 0.5, "away from the ball");
}

#[test]
fn pushing_an_opponent_for_three_seconds_is_penalized() {
    let mut setup = monas_sim::Setup::three_against_three(8);
    setup.physics.fall_rate_pushed = 0.0;
    setup.physics.fall_rate_walking = 0.0;
    let mut world = play(SimulatedWorld::new(setup).unwrap());
    clear_field(&mut world, &[1, 2, 4]);
    world.place_robot(1, Pose::new(-0.3, -1.0, 0.0)).unwrap();
    world.place_robot(4, Pose::new(0.0, -1.0, 0.0)).unwrap();
    world.place_robot(2, Pose::new(-0.3, 1.0, 0.0)).unwrap();
    world.command(1, Command::walk(0.15, 0.0, 0.0)).unwrap();
    run(&mut world, 2.5);
    assert!(penalties(&world).is_empty());
    run(&mut world, 2.0);
    assert_eq!(penalties(&world), [(1, Offence::Pushing)]);
}

#[test]
fn pushing_a_team_mate_is_not_penalized() {
    let mut setup = monas_sim::Setup::three_against_three(8);
    setup.physics.fall_rate_pushed = 0.0;
    setup.physics.fall_rate_walking = 0.0;
    let mut world = play(SimulatedWorld::new(setup).unwrap());
    clear_field(&mut world, &[1, 2]);
    world.place_robot(1, Pose::new(-0.3, -1.0, 0.0)).unwrap();
    world.place_robot(2, Pose::new(0.0, -1.0, 0.0)).unwrap();
    world.command(1, Command::walk(0.15, 0.0, 0.0)).unwrap();
    run(&mut world, 5.0);
    assert!(penalties(&world).is_empty());
}

#[test]
fn holding_the_ball_is_penalized_and_a_goalie_may_hold_it_longer() {
    for (robot, position, time) in [(2, Pose::new(0.0, 1.0, 0.0), 3.0), (0, Pose::new(-2.8, 0.0, 0.0), 10.0)]
    {
        let mut world = playing(9);
        clear_field(&mut world, &[robot]);
        world.place_robot(robot, position).unwrap();
        world.place_ball(position.position + Vector::new(0.1235, 0.0), Vector::zeros()).unwrap();
        run(&mut world, time - 0.2);
        assert!(penalties(&world).is_empty(), "{:?}", world.events());
        run(&mut world, 0.6);
        assert_eq!(penalties(&world), [(robot, Offence::BallHolding)]);
    }
}

#[test]
fn half_time_lifts_penalties() {
    let mut world = play(world_with_rules(10, |rules| rules.half_duration = 20.0));
    clear_field(&mut world, &[2]);
    world.place_robot(2, Pose::new(-2.6, 0.5, 0.0)).unwrap();
    run(&mut world, 2.0);
    assert!(!world.robots()[2].on_field);
    run(&mut world, 13.0);
    assert_eq!(world.referee().half(), 2);
    assert!(world.robots()[2].on_field && world.referee().penalty(2).is_none());
}

#[test]
fn a_kick_into_the_goal_is_a_shot_and_a_goal_of_the_robot() {
    let mut world = playing(11);
    clear_field(&mut world, &[1]);
    world.place_robot(1, Pose::new(1.5, -0.05, 0.0)).unwrap();
    world.place_ball(Vector::new(1.66, 0.0), Vector::zeros()).unwrap();
    world.command(1, Command::new(Motion::Kick(Side::Left))).unwrap();
    run(&mut world, 2.5);
    let tally = *world.statistics().robot(1).unwrap();
    assert_eq!((tally.kicks, tally.strikes, tally.shots, tally.goals), (1, 1, 1, 1), "{:?}", world.events());
    let goals = events(&world, |kind| matches!(kind, EventKind::Goal { .. }));
    assert_eq!(goals, [EventKind::Goal { team: 0, robot: Some(1), own_goal: false }]);
}

#[test]
fn a_shot_that_the_goalie_stops_is_a_save() {
    let mut world = playing(12);
    clear_field(&mut world, &[1, 3]);
    world.place_robot(1, Pose::new(1.5, -0.05, 0.0)).unwrap();
    world.place_robot(3, Pose::new(2.8, 0.0, std::f64::consts::PI)).unwrap();
    world.place_ball(Vector::new(1.66, 0.0), Vector::zeros()).unwrap();
    world.command(1, Command::new(Motion::Kick(Side::Left))).unwrap();
    run(&mut world, 0.9);
    let direction = if world.ball().velocity.y > 0.0 { Side::Right } else { Side::Left };
    world.command(3, Command::new(Motion::Dive(direction))).unwrap();
    run(&mut world, 9.0);
    let (shooter, goalie) = (*world.statistics().robot(1).unwrap(), *world.statistics().robot(3).unwrap());
    assert_eq!((shooter.shots, shooter.goals, goalie.saves), (1, 0, 1), "{:?}", world.events());
    assert_eq!((goalie.actions, goalie.actions_to_ball), (1, 1));
}

#[test]
fn an_own_goal_counts_for_the_others() {
    let mut world = playing(13);
    clear_field(&mut world, &[1]);
    world.place_robot(1, Pose::new(-1.5, 0.05, std::f64::consts::PI)).unwrap();
    world.place_ball(Vector::new(-1.66, 0.0), Vector::zeros()).unwrap();
    world.command(1, Command::new(Motion::Kick(Side::Left))).unwrap();
    run(&mut world, 2.5);
    let goals = events(&world, |kind| matches!(kind, EventKind::Goal { .. }));
    assert_eq!(goals, [EventKind::Goal { team: 1, robot: Some(1), own_goal: true }]);
    let tally = *world.statistics().robot(1).unwrap();
    assert_eq!((tally.goals, tally.own_goals, tally.shots), (0, 1, 0));
    assert_eq!((world.statistics().team(0).goals, world.statistics().team(1).goals), (0, 1));
}

#[test]
fn a_shot_that_a_goalie_deflects_into_its_goal_is_the_shooters() {
    let mut world = playing(15);
    clear_field(&mut world, &[1, 3]);
    world.place_robot(1, Pose::new(1.5, -0.05, 0.0)).unwrap();
    world.place_robot(3, Pose::new(3.0, 0.75, 3.0)).unwrap();
    world.place_ball(Vector::new(1.66, 0.0), Vector::zeros()).unwrap();
    world.command(1, Command::new(Motion::Kick(Side::Left))).unwrap();
    run(&mut world, 0.85);
    world.place_robot(3, Pose::new(2.8, 0.0, 0.0)).unwrap();
    world.place_ball(Vector::new(2.9245, 0.0), Vector::new(1.0, 0.0)).unwrap();
    world.step();
    assert_eq!(world.referee().last_touch(), Some(3));
    run(&mut world, 0.5);
    let goals = events(&world, |kind| matches!(kind, EventKind::Goal { .. }));
    assert_eq!(goals, [EventKind::Goal { team: 0, robot: Some(1), own_goal: false }], "{:?}", world.events());
}

#[test]
fn possession_and_first_touch_are_measured() {
    let mut world = playing(14);
    clear_field(&mut world, &[1, 4]);
    world.place_robot(1, Pose::new(-0.2, 0.0, 0.0)).unwrap();
    world.place_robot(4, Pose::new(0.25, 0.0, std::f64::consts::PI)).unwrap();
    run(&mut world, 1.0);
    let of = |world: &SimulatedWorld, team| world.statistics().team(team).possession;
    assert!((of(&world, 0) - 1.0).abs() < 0.05 && of(&world, 1) < 0.05);
    assert_eq!(world.statistics().time_to_first_touch(), None);
    world.command(1, Command::walk(0.2, 0.0, 0.0)).unwrap();
    run(&mut world, 2.0);
    let touched = world.statistics().time_to_first_touch().unwrap();
    assert!((1.0..3.0).contains(&touched), "{touched}");
}

#[test]
fn a_person_decides_what_the_rules_permit() {
    use monas_sim::RefereeCall as Call;
    let mut world = world(1);
    let state = |world: &SimulatedWorld| world.referee().state();
    assert!(world.call(Call::Play).unwrap_err().to_string().contains("play cannot follow initial"));
    for (call, next) in
        [(Call::Ready, GameState::Ready), (Call::Set, GameState::Set), (Call::Play, GameState::Playing)]
    {
        world.call(call).unwrap();
        world.step();
        assert_eq!(state(&world), next);
    }
    assert_eq!(events(&world, |kind| matches!(kind, EventKind::KickOff { .. })).len(), 1);
    assert!(changes(&world).iter().all(|(from, to)| from.may_become(*to)));
    // a robot that is penalized leaves the field until it is called back
    world.call(Call::Penalize(1)).unwrap();
    assert!(world.call(Call::Penalize(1)).is_err() && world.call(Call::Penalize(9)).is_err());
    world.step();
    assert!(!world.robots()[1].on_field);
    world.call(Call::Return(1)).unwrap();
    world.step();
    assert!(world.robots()[1].on_field && world.call(Call::Return(1)).is_err());
    // the ball is dropped, and the game placed again for a kick-off
    world.place_ball(Vector::new(1.0, 1.0), Vector::zeros()).unwrap();
    world.call(Call::DropBall).unwrap();
    world.step();
    assert_ne!(world.ball().position, Vector::new(1.0, 1.0));
    world.call(Call::Ready).unwrap();
    world.step();
    assert_eq!((state(&world), world.ball().position), (GameState::Ready, Vector::zeros()));
    world.call(Call::EndHalf).unwrap();
    world.step();
    assert_eq!((world.referee().half(), state(&world)), (2, GameState::Initial));
}

#[test]
fn nothing_goes_on_in_a_stopped_game() {
    use monas_sim::RefereeCall as Call;
    let mut world = playing(2);
    assert!(world.call(Call::Resume).is_err());
    world.call(Call::Stop).unwrap();
    world.command(1, Command::walk(0.2, 0.0, 0.0)).unwrap();
    world.step();
    let (position, left) = (world.robots()[1].pose.position, world.referee().seconds_remaining());
    assert!(world.announcement(1).unwrap().halted);
    run(&mut world, 3.0);
    assert_eq!(world.robots()[1].pose.position, position);
    assert_eq!(world.referee().seconds_remaining(), left);
    world.call(Call::Resume).unwrap();
    run(&mut world, 3.0);
    assert!((world.robots()[1].pose.position - position).norm() > 0.1);
    assert!((left - world.referee().seconds_remaining() - 3.0).abs() < 0.02);
}
