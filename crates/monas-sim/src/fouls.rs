//! Watching for what the rules forbid.

use crate::state::Scene;
use crate::{FieldSide, RobotState, Rules, STEP};

/// Why a robot is penalized.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Offence {
    /// It pressed towards an opponent that it touched for too long.
    Pushing,
    /// It held the ball for too long.
    BallHolding,
    /// A field player was in its own goal area.
    IllegalDefender,
}

/// A ball slower than this, touched all the time, is held, m/s.
const HELD_BALL_SPEED: f64 = 0.05;

/// For each robot, how long it has been doing what it may not do for long, s.
#[derive(Debug, Clone, Copy, Default)]
struct Watch {
    pushing: f64,
    holding: f64,
    defending: f64,
}

/// The watches over all robots.
#[derive(Debug, Clone)]
pub(crate) struct Fouls {
    watches: Vec<Watch>,
}

impl Fouls {
    pub(crate) fn new(robots: usize) -> Self {
        Self { watches: vec![Watch::default(); robots] }
    }

    /// Forgets everything, as at a kick-off.
    pub(crate) fn clear(&mut self) {
        self.watches.fill(Watch::default());
    }

    /// Watches one step, and names the robot's offence when a time is up. `defends` is the end of its team.
    pub(crate) fn watch(
        &mut self,
        robot: usize,
        defends: FieldSide,
        rules: &Rules,
        scene: &Scene<'_>,
    ) -> Option<Offence> {
        let watch = &mut self.watches[robot];
        let state = &scene.robots[robot];
        if !state.on_field {
            *watch = Watch::default();
            return None;
        }
        let keeps = state.is_goalie() && scene.field.in_goal_area(defends, state.pose.position);
        let intrudes = !state.is_goalie() && scene.field.in_goal_area(defends, state.pose.position);
        count(&mut watch.pushing, !keeps && pushes(robot, rules, scene));
        count(&mut watch.holding, holds(robot, scene));
        count(&mut watch.defending, intrudes);
        let holding_time = if keeps { rules.goalie_holding_time } else { rules.holding_time };
        let offence = if watch.pushing > rules.pushing_time {
            Offence::Pushing
        } else if watch.holding > holding_time {
            Offence::BallHolding
        } else if watch.defending > rules.defender_time {
            Offence::IllegalDefender
        } else {
            return None;
        };
        *watch = Watch::default();
        Some(offence)
    }
}

fn count(time: &mut f64, doing: bool) {
    *time = if doing { *time + STEP } else { 0.0 };
}

/// Answers whether a robot goes for the place of an opponent that it touches.
fn pushes(robot: usize, rules: &Rules, scene: &Scene<'_>) -> bool {
    let me = &scene.robots[robot];
    let opponents = scene.contacts.iter().filter_map(|&(one, other)| match robot {
        r if r == one => Some(&scene.robots[other]),
        r if r == other => Some(&scene.robots[one]),
        _ => None,
    });
    let mut opponents = opponents.filter(|other| other.team != me.team && other.on_field);
    me.phase.is_upright() && opponents.any(|other| approach(me, other) > rules.pushing_speed)
}

/// The speed with which a robot wants to come nearer to another.
fn approach(me: &RobotState, other: &RobotState) -> f64 {
    let between = other.pose.position - me.pose.position;
    me.intent.dot(&between) / between.norm().max(1e-6)
}

/// Answers whether a robot keeps a resting ball between its feet or under its body. One that kicks does not.
fn holds(robot: usize, scene: &Scene<'_>) -> bool {
    let kicking = matches!(scene.robots[robot].phase, crate::Phase::Kicking(_));
    scene.touching_ball[robot] && !kicking && scene.ball.velocity.norm() < HELD_BALL_SPEED
}
