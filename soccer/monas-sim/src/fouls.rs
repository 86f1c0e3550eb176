//! Detects violations of the rules.

use crate::state::WorldView;
use crate::{FieldSide, MatchRules, RobotState, STEP};

/// Why a robot is penalized.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Offence {
    /// It pressed towards an opponent that it touched for too long.
    Pushing,
    /// It held the ball for too long.
    BallHolding,
    /// A field player was in its own goal area.
    IllegalDefender,
    /// Decided by a person, with a GameController or as the referee of the match.
    Announced,
}

/// A ball that is touched continuously and slower than this is held, m/s.
const HELD_BALL_SPEED: f64 = 0.05;

/// For one robot, the duration of each behaviour that is limited in time, s.
#[derive(Debug, Clone, Copy, Default)]
struct FoulTimer {
    pushing: f64,
    holding: f64,
    defending: f64,
}

/// The timers of all robots.
#[derive(Debug, Clone)]
pub(crate) struct FoulDetector {
    watches: Vec<FoulTimer>,
}

impl FoulDetector {
    pub(crate) fn new(robots: usize) -> Self {
        Self { watches: vec![FoulTimer::default(); robots] }
    }

    /// Resets all timers, as at a kick-off.
    pub(crate) fn clear(&mut self) {
        self.watches.fill(FoulTimer::default());
    }

    /// Updates the timers of a robot for one step and returns its offence if a time limit is
    /// exceeded. `defends` is the end of its team.
    pub(crate) fn watch(
        &mut self,
        robot: usize,
        defends: FieldSide,
        rules: &MatchRules,
        scene: &WorldView<'_>,
    ) -> Option<Offence> {
        let watch = &mut self.watches[robot];
        let state = &scene.robots[robot];
        if !state.on_field {
            *watch = FoulTimer::default();
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
        *watch = FoulTimer::default();
        Some(offence)
    }
}

fn count(time: &mut f64, doing: bool) {
    *time = if doing { *time + STEP } else { 0.0 };
}

/// Whether a robot walks towards an opponent that it touches.
fn pushes(robot: usize, rules: &MatchRules, scene: &WorldView<'_>) -> bool {
    let me = &scene.robots[robot];
    let opponents = scene.contacts.iter().filter_map(|&(one, other)| match robot {
        r if r == one => Some(&scene.robots[other]),
        r if r == other => Some(&scene.robots[one]),
        _ => None,
    });
    let mut opponents = opponents.filter(|other| other.team != me.team && other.on_field);
    me.phase.is_upright() && opponents.any(|other| approach(me, other) > rules.pushing_speed)
}

/// The intended speed of a robot towards another.
fn approach(me: &RobotState, other: &RobotState) -> f64 {
    let between = other.pose.position - me.pose.position;
    me.intent.dot(&between) / between.norm().max(1e-6)
}

/// Whether a robot keeps a resting ball between its feet or under its body. One that kicks does
/// not.
fn holds(robot: usize, scene: &WorldView<'_>) -> bool {
    let kicking = matches!(scene.robots[robot].phase, crate::BodyPhase::Kicking(_));
    scene.touching_ball[robot] && !kicking && scene.ball.velocity.norm() < HELD_BALL_SPEED
}
