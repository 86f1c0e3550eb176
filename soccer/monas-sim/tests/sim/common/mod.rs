//! Helpers shared by the tests of worlds.
#![allow(dead_code)] // each test file uses a part

pub(crate) mod script;

use monas_sim::{Command, EventKind, GameState, MatchRules, Motion, Pose, Setup, SimulatedWorld, Vector};

/// A world with two teams of three robots.
pub(crate) fn world(seed: u64) -> SimulatedWorld {
    SimulatedWorld::new(Setup::three_against_three(seed)).unwrap()
}

/// A world whose rules are changed.
pub(crate) fn world_with_rules(seed: u64, change: impl FnOnce(&mut MatchRules)) -> SimulatedWorld {
    let mut setup = Setup::three_against_three(seed);
    change(&mut setup.rules);
    SimulatedWorld::new(setup).unwrap()
}

/// A world in PLAYING, with short phases before it.
pub(crate) fn playing(seed: u64) -> SimulatedWorld {
    play(world_with_rules(seed, |rules| {
        (rules.initial_duration, rules.ready_duration, rules.set_duration) = (0.0, 0.0, 0.0);
    }))
}

/// Steps until play begins.
pub(crate) fn play(mut world: SimulatedWorld) -> SimulatedWorld {
    while world.referee().state() != GameState::Playing {
        world.step();
    }
    world
}

/// Moves every robot except `kept` into the corners.
pub(crate) fn clear_field(world: &mut SimulatedWorld, kept: &[usize]) {
    for robot in (0..world.robots().len()).filter(|robot| !kept.contains(robot)) {
        let x = -2.9 + 0.4 * robot as f64;
        world.place_robot(robot, Pose::new(x, 2.5, 0.0)).unwrap();
        world.command(robot, Command::new(Motion::Stand)).unwrap();
    }
}

/// Steps for a time.
pub(crate) fn run(world: &mut SimulatedWorld, seconds: f64) {
    for _ in 0..(seconds / monas_sim::STEP).round() as usize {
        world.step();
    }
}

/// The events of the world that satisfy `wanted`.
pub(crate) fn events(world: &SimulatedWorld, wanted: impl Fn(&EventKind) -> bool) -> Vec<EventKind> {
    world.events().iter().map(|event| event.kind).filter(|kind| wanted(kind)).collect()
}

/// Rolls the ball into the goal at the end with this sign.
pub(crate) fn roll_into_goal(world: &mut SimulatedWorld, sign: f64) {
    world.place_ball(Vector::new(sign * 2.6, 0.4), Vector::new(sign * 2.0, 0.0)).unwrap();
    run(world, 0.4);
}
