//! The robots' belief about the ball in a match, compared with the truth.

use std::time::Duration;

use monas::config::Layers;
use monas_match::{MatchOptions, MatchSource};
use monas_sim::{GameState, SimulatedWorld};
use monas_soccer::topics;
use narukom::Blackboard;

use crate::root;

/// Time between two samples.
const SAMPLE_INTERVAL: Duration = Duration::from_millis(100);

/// Age, after the latency of the camera, from which a ball is no longer known, s: images are 0.1 s
/// apart.
const KNOWN_FOR: f64 = 0.15;

/// The index in the world of blue's first attacker, `blue-2`.
const WATCHED_ROBOT: usize = 1;

/// The settings of a match with today's ball and goals.
pub const TODAY: [&str; 2] = ["match.objects=today", "simulator.physics.ball_radius=0.05"];

/// Samples of the estimate of the ball that one robot of a match has, and its play.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct BallKnowledge {
    /// Samples of the robot in play that has the ball in view, not hidden and at most 3 m away.
    pub in_view: usize,
    /// Those in which it knows an image of the last 0.15 s, before the latency of its camera, that
    /// shows the ball at most 25 % from its place.
    pub known: usize,
    /// Those in which such an image shows a ball that is farther from its place.
    pub wrong: usize,
    /// The sum of the errors of the distance of the known balls, relative to the distance.
    error_sum: f64,
    /// Samples of the robot in play: how many, and the sum of the errors of its position, m.
    poses: (usize, f64),
    /// Its kicks that hit the ball.
    pub kicks: u32,
}

impl BallKnowledge {
    /// Plays `config/match.xml` for a duration with each seed, from kick-off, with settings as of
    /// `--set`, and watches blue's first attacker. Its cameras deliver images of a width, or
    /// finished sightings.
    ///
    /// # Errors
    /// The diagnostics of its files or settings, or the failure.
    pub fn of_matches(
        settings: &[&str],
        image_width: Option<u32>,
        seeds: &[u64],
        length: Duration,
    ) -> Result<BallKnowledge, String> {
        let mut sum = BallKnowledge::default();
        for seed in seeds {
            sum.add_match(settings, image_width, *seed, length)?;
        }
        Ok(sum)
    }

    fn add_match(
        &mut self,
        settings: &[&str],
        image_width: Option<u32>,
        seed: u64,
        length: Duration,
    ) -> Result<(), String> {
        let grammar = monas_match::grammar();
        let body = image_width.map(|width| {
            let body = "match.team.1.robot.2.body";
            [format!("{body}.vision=images"), format!("{body}.image_width={width}")]
        });
        let kick_off = ["initial", "ready", "set"].map(|phase| format!("simulator.rules.{phase}_duration=0"));
        let settings =
            settings.iter().map(ToString::to_string).chain(body.into_iter().flatten()).chain(kick_off);
        let mut layers = Layers::new();
        for text in settings {
            layers = layers.set(&text, &grammar).map_err(|found| found.to_string())?;
        }
        let plan =
            MatchSource::load_with(root().join("config/match.xml"), &monas::Registry::linked(), &layers)
                .map_err(|found| found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
        let mut running =
            plan.start(MatchOptions { seed, record: None }).map_err(|error| error.to_string())?;
        let board = running.simulation().and_then(|simulation| simulation.hub("blue-2"));
        let mut board = board.ok_or("no robot blue-2")?.blackboard("compared with the truth");
        while running.now() < length {
            running.advance(running.now() + SAMPLE_INTERVAL).map_err(|error| error.to_string())?;
            let Some(now) = running.simulation().map(|simulation| simulation.now()) else { break };
            board.process_messages(now);
            running.pitch().with_world(|world| self.sample(world, &board));
        }
        let kicks =
            running.pitch().with_world(|world| world.statistics().robot(WATCHED_ROBOT).map(|it| it.strikes));
        self.kicks += kicks.unwrap_or_default();
        Ok(())
    }

    /// The share of the samples in view in which the ball is known.
    pub fn known_share(&self) -> f64 {
        self.known as f64 / self.in_view.max(1) as f64
    }

    /// The mean error of the distance of known balls, relative to the distance.
    pub fn error(&self) -> f64 {
        self.error_sum / self.known.max(1) as f64
    }

    /// The mean error of the position of the robot in play, m.
    pub fn pose_error(&self) -> f64 {
        self.poses.1 / self.poses.0.max(1) as f64
    }

    fn sample(&mut self, world: &SimulatedWorld, board: &Blackboard) {
        let state = &world.robots()[WATCHED_ROBOT];
        if world.referee().state() != GameState::Playing || !state.phase.is_upright() || !state.on_field {
            return;
        }
        if let Some(pose) = board.read(topics::POSE) {
            // The frame of a team that attacks to the left is turned by half a turn.
            let position = state.pose.position;
            let errors =
                [1.0, -1.0].map(|sign| libm::hypot(pose.x - sign * position.x, pose.y - sign * position.y));
            let attacks_left = board
                .read(topics::GAME_STATE)
                .is_some_and(|game| game.goal_to_attack() == monas_soccer::Colour::Blue);
            self.poses.0 += 1;
            self.poses.1 += errors[usize::from(attacks_left)];
        }
        let truth = state.pose.to_own(world.ball().position);
        let ball = board
            .read(topics::BALL)
            .filter(|ball| ball.found && ball.age < KNOWN_FOR + world.physics().camera_latency);
        if !is_in_view(world, WATCHED_ROBOT) {
            return;
        }
        self.in_view += 1;
        let Some(ball) = ball else { return };
        let error = libm::hypot(ball.x - truth.x, ball.y - truth.y) / truth.norm();
        match error < 0.25 {
            true => (self.known, self.error_sum) = (self.known + 1, self.error_sum + error),
            false => self.wrong += 1,
        }
    }
}

/// Whether one of the cameras of a robot shows the whole ball, at most 3 m away and not behind a
/// robot.
fn is_in_view(world: &SimulatedWorld, robot: usize) -> bool {
    /// Least distance of the ball from the edges of the image, rad.
    const IMAGE_MARGIN: f64 = 0.08;
    let (me, physics) = (&world.robots()[robot], world.physics());
    let ball = me.pose.to_own(world.ball().position);
    let distance = ball.norm();
    let bearing = libm::atan2(ball.y, ball.x);
    let down = libm::atan2(physics.camera_height - physics.ball_radius, distance);
    let is_within = |angle: f64, view: f64| angle.abs() < view / 2.0 - IMAGE_MARGIN;
    let tilts = [0.0, physics.camera_tilt];
    let shows = tilts.map(|tilt| is_within(down - me.head_pitch - tilt, physics.camera_view_vertical));
    let is_hidden = world.robots().iter().enumerate().any(|(index, other)| {
        let at = me.pose.to_own(other.pose.position);
        let along = (at.x * ball.x + at.y * ball.y) / distance.max(1e-9);
        let beside = (at.y * ball.x - at.x * ball.y) / distance.max(1e-9);
        index != robot && other.on_field && (0.0..distance + 0.15).contains(&along) && beside.abs() < 0.3
    });
    distance < 3.0
        && is_within(bearing - me.head_yaw, physics.camera_view_horizontal)
        && shows.contains(&true)
        && !is_hidden
}
