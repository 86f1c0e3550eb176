//! Whole matches of scripted teams: the physics lets robots play soccer.
#![allow(clippy::unwrap_used)] // tests may panic

use crate::common::script::play_match;
use crate::common::world_with_rules;
use monas_sim::{EventKind, Setup, SimulatedWorld};

fn short_match(seed: u64, teams: &[usize]) -> SimulatedWorld {
    let mut world = world_with_rules(seed, |rules| rules.half_duration = 120.0);
    play_match(&mut world, teams);
    world
}

#[test]
fn a_match_has_kicks_shots_saves_and_goals() {
    let mut total = [0; 6];
    for seed in 0..4 {
        let world = short_match(seed, &[0, 1]);
        for tally in [world.statistics().team(0), world.statistics().team(1)] {
            let counts = [tally.goals, tally.shots, tally.saves, tally.falls, tally.strikes, tally.actions];
            total.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
    }
    let [goals, shots, saves, falls, strikes, actions] = total;
    assert!(goals >= 2, "{total:?}");
    assert!(shots > goals && strikes > shots && falls > 0, "{total:?}");
    assert!(saves > 0 && actions > 0, "{total:?}");
}

#[test]
fn a_team_that_plays_beats_one_that_stands() {
    let mut goals = [0; 2];
    for seed in 0..2 {
        let world = short_match(seed, &[0]);
        for team in [0, 1] {
            goals[team] += world.statistics().team(team).goals;
        }
    }
    assert!(goals[0] >= 2 && goals[1] == 0, "{goals:?}");
}

#[test]
fn the_score_is_the_count_of_goal_events() {
    let world = short_match(1, &[0, 1]);
    for team in [0, 1] {
        let goals = crate::common::events(
            &world,
            |kind| matches!(kind, EventKind::Goal { team: of, .. } if *of == team),
        );
        assert_eq!(goals.len() as u32, world.referee().score()[team]);
        assert_eq!(goals.len() as u32, world.statistics().team(team).goals);
    }
}

#[test]
fn a_team_without_a_goalie_concedes_more() {
    let conceded = |with_goalie: bool| -> u32 {
        let play = |seed| {
            let mut setup = Setup::three_against_three(seed);
            setup.robots.retain(|robot| with_goalie || (robot.team, robot.number) != (2, 1));
            let mut world = SimulatedWorld::new(setup).unwrap();
            play_match(&mut world, &[0, 1]);
            world.referee().score()[0]
        };
        (0..3).map(play).sum()
    };
    let (with, without) = (conceded(true), conceded(false));
    assert!(2 * without >= 3 * with, "{with} with a goalie, {without} without");
}
