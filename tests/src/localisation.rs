//! The errors of the poses that the robots of a match believe.

use std::time::Duration;

use monas::Blackboard;
use monas_match::{MatchOptions, MatchSource, RunningMatch};
use monas_sim::{FieldSide, GameState, Pose, SimulatedWorld, Vector};
use monas_soccer::topics;
use narukom::Timestamp;

use crate::{Variant, root};

/// The interval of comparisons of poses with the truth.
const COMPARISON_INTERVAL: Duration = Duration::from_millis(100);
/// Errors below which a robot knows where it is: metres and radians.
const KNOWN_POSE_ERROR: (f64, f64) = (0.5, 0.35);
/// Time for which a robot that was carried away is observed, and the play between two of them,
/// seconds.
const WATCHED_TIME: f64 = 30.0;
const PLAY_TIME: f64 = 5.0;

/// Differences between estimated and true poses while the game is played.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PoseErrors {
    /// Of the place, metres.
    pub distances: Vec<f64>,
    /// Of the heading, radians.
    pub turns: Vec<f64>,
}

/// Robots that were carried away during play without a sign.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Kidnappings {
    /// The seconds after which each knew where it was.
    pub recoveries: Vec<f64>,
    /// Those that did not know it within 30 s.
    pub lost: usize,
}

/// The value below which a part of the values lies; none has any.
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    sorted.get((part * last as f64).round() as usize).copied()
}

/// A match whose poses are read.
struct PoseMatch {
    running: RunningMatch,
    blackboards: Vec<Blackboard>,
    now: Duration,
}

impl PoseMatch {
    fn start(variant: &Variant, seed: u64) -> Result<PoseMatch, String> {
        let plan = MatchSource::load(root().join(variant.file), &monas::Registry::linked())
            .map_err(|found| found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
        let running = plan.start(MatchOptions { seed, record: None }).map_err(|error| error.to_string())?;
        let hosts: Vec<String> = running.pitch().with_world(|world| {
            let host = |robot: &monas_sim::RobotState| {
                format!("{}-{}", world.teams()[robot.team].name.to_lowercase(), robot.number)
            };
            world.robots().iter().map(host).collect()
        });
        let simulation = running.simulation().ok_or("a match in real time")?;
        let blackboard = |host: &String| {
            Ok(simulation.hub(host).ok_or_else(|| format!("no robot `{host}`"))?.blackboard("observer"))
        };
        let blackboards = hosts.iter().map(blackboard).collect::<Result<Vec<_>, String>>()?;
        Ok(PoseMatch { running, blackboards, now: Duration::ZERO })
    }

    fn advance(&mut self) -> Result<(), String> {
        self.now += COMPARISON_INTERVAL;
        self.running.advance(self.now).map_err(|error| error.to_string())
    }

    /// The errors of place and heading of a robot that plays.
    fn error(&mut self, robot: usize) -> Option<(f64, f64)> {
        let blackboard = self.blackboards.get_mut(robot)?;
        blackboard.process_messages(Timestamp::from_nanos(self.now.as_nanos() as u64));
        let pose = *blackboard.read(topics::POSE)?;
        self.running.pitch().with_world(|world| {
            let state = &world.robots()[robot];
            let plays = state.on_field && world.referee().state() == GameState::Playing;
            let truth = in_frame_of_team(world, robot);
            let distance = (truth.position - Vector::new(pose.x, pose.y)).norm();
            let turn = libm::remainder(truth.heading - pose.heading, std::f64::consts::TAU).abs();
            plays.then_some((distance, turn))
        })
    }

    fn robots(&self) -> usize {
        self.blackboards.len()
    }
}

fn in_frame_of_team(world: &SimulatedWorld, robot: usize) -> Pose {
    let state = &world.robots()[robot];
    match world.referee().defends()[state.team] {
        FieldSide::Left => state.pose,
        FieldSide::Right => Pose::new(0.0, 0.0, std::f64::consts::PI).compose(&state.pose),
    }
}

/// Plays a match and compares the poses of its robots with the truth, ten times a second.
///
/// # Errors
/// The diagnostics of its files, or the failure.
pub fn pose_errors(variant: &Variant, seed: u64, length: Duration) -> Result<PoseErrors, String> {
    let mut game = PoseMatch::start(variant, seed)?;
    let mut errors = PoseErrors::default();
    while game.now < length {
        game.advance()?;
        for robot in 0..game.robots() {
            if let Some((distance, turn)) = game.error(robot) {
                errors.distances.push(distance);
                errors.turns.push(turn);
            }
        }
    }
    Ok(errors)
}

/// Plays a match in which one robot after the other is carried away during play, which it does not
/// feel. A robot that leaves the field or the play before it knows where it is does not count.
///
/// # Errors
/// The diagnostics of its files, or the failure.
pub fn kidnap(variant: &Variant, seed: u64, length: Duration) -> Result<Kidnappings, String> {
    let mut game = PoseMatch::start(variant, seed)?;
    let mut result = Kidnappings::default();
    let mut dice = seed;
    let mut roll = move || {
        // Knuth's linear congruential generator.
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (dice >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut victim = 0;
    let mut rest = 0.0;
    while game.now < length {
        game.advance()?;
        rest += COMPARISON_INTERVAL.as_secs_f64();
        let plays = game.error(victim).is_some();
        if rest < PLAY_TIME || !plays {
            victim = if plays { victim } else { (victim + 1) % game.robots() };
            continue;
        }
        let pose = Pose::new(5.0 * roll() - 2.5, 3.4 * roll() - 1.7, std::f64::consts::TAU * roll());
        let is_free = game.running.pitch().with_world(|world| {
            let robots = world.robots().iter().map(|other| other.pose.position);
            robots.chain([world.ball().position]).all(|other| (other - pose.position).norm() > 0.4)
        });
        if !is_free {
            continue;
        }
        game.running
            .pitch()
            .change(|world| world.place_robot(victim, pose))
            .map_err(|error| error.to_string())?;
        match recovery(&mut game, victim)? {
            Some(after) if after < WATCHED_TIME => result.recoveries.push(after),
            Some(_) => result.lost += 1,
            None => {}
        }
        victim = (victim + 1) % game.robots();
        rest = 0.0;
    }
    Ok(result)
}

/// The seconds until a robot knows where it is, for a second on end; none if it leaves the play.
fn recovery(game: &mut PoseMatch, robot: usize) -> Result<Option<f64>, String> {
    let mut known_since = None;
    let mut after = 0.0;
    while after < WATCHED_TIME {
        game.advance()?;
        after += COMPARISON_INTERVAL.as_secs_f64();
        let Some((distance, turn)) = game.error(robot) else { return Ok(None) };
        if distance > KNOWN_POSE_ERROR.0 || turn > KNOWN_POSE_ERROR.1 {
            known_since = None;
            continue;
        }
        let since = *known_since.get_or_insert(after);
        if after - since >= 1.0 {
            return Ok(Some(since));
        }
    }
    Ok(Some(WATCHED_TIME))
}
