//! The decisions of the direct players, and the loop that calls them.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use monas_robot::{GamePhase, Posture};

use super::*;
use crate::decision_cases::{Case, GazeTarget, Requests, game};
use crate::decision_tests::{DecisionFixture, decision_tests};

const TICK: Duration = Duration::from_millis(20);

/// A body that stands, and counts its commands.
struct StandingBody {
    anatomy: Anatomy,
    commands: Arc<AtomicU32>,
}

impl Robot for StandingBody {
    fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    fn sense(&mut self, _: Timestamp, _: &mut Percepts) -> Result<(), Error> {
        Ok(())
    }

    fn act(&mut self, _: Timestamp, _: &Actuators) -> Result<(), Error> {
        self.commands.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
}

/// A behaviour and the time, without the loop.
struct Fixture<B> {
    robot: DirectRobot<B>,
    commands: Arc<AtomicU32>,
    percepts: Percepts,
}

impl<B: Behaviour> Fixture<B> {
    /// The referee announces a phase.
    fn announce(&mut self, phase: GamePhase) {
        let announced = Announcement { phase: phase.into(), ..Announcement::default() };
        self.percepts.announcement = Some(announced);
    }

    /// Runs the loop; returns how often images were processed and how often the robot decided.
    fn run(&mut self, millis: u64) -> (usize, usize) {
        let (mut images, mut decisions) = (0, 0);
        for _ in 0..millis / 20 {
            let before = (self.robot.vision_at, self.robot.decision_at);
            let now = self.robot.memory.now + TICK;
            self.robot.step(now, &self.percepts).unwrap();
            self.percepts.announcement = None;
            images += usize::from(self.robot.vision_at != before.0);
            decisions += usize::from(self.robot.decision_at != before.1);
        }
        (images, decisions)
    }
}

impl<B: Behaviour + Default> DecisionFixture for Fixture<B> {
    fn new() -> Fixture<B> {
        let commands = Arc::new(AtomicU32::new(0));
        let body = StandingBody { anatomy: Anatomy::new("test", TICK), commands: Arc::clone(&commands) };
        let mut robot = DirectRobot::new(Box::new(body), B::default());
        robot.memory.now = Timestamp::from_nanos(10_000_000_000);
        robot.memory.game = game();
        let mut percepts = Percepts::default();
        percepts.sensors.posture = Posture::Standing.into();
        Fixture { robot, commands, percepts }
    }

    fn decide(&mut self, case: &Case) -> Requests {
        let memory = &mut self.robot.memory;
        (memory.ball, memory.pose) = (case.ball, Some(case.pose));
        // A time before all others marks that nothing was requested.
        (memory.gaze, memory.requested_at) = (GazeRequest::Ahead, Timestamp::default());
        self.robot.behaviour.decide(memory);
        let look = match memory.gaze {
            GazeRequest::Ahead => None,
            GazeRequest::Scan => Some(GazeTarget::Scan),
            GazeRequest::At(gaze) => Some(GazeTarget::At(gaze)),
        };
        (look, (memory.requested_at == memory.now).then_some(memory.motion))
    }

    fn wait(&mut self, millis: u64) {
        self.robot.memory.now += Duration::from_millis(millis);
    }

    fn finish_motion(&mut self) {
        self.robot.memory.motion_done = self.robot.memory.motion_number;
    }
}

decision_tests!(Fixture<DirectGoalie>, Fixture<DirectPlayer>);

#[test]
fn goalie_plays() {
    play::<DirectGoalie>(5);
}

#[test]
fn player_plays() {
    play::<DirectPlayer>(10);
}

/// Stands up first, walks to its place in READY, decides only during play, ten times a second and
/// only on new estimates of the ball, and commands the body ten times a second all the time.
fn play<B: Behaviour + Default>(images_a_second: usize) {
    let mut fixture = Fixture::<B>::new();
    fixture.percepts.sensors.posture = Posture::Fallen.into();
    fixture.announce(GamePhase::Playing);
    assert_eq!(fixture.run(1000), (0, 0), "it stands up first");
    fixture.percepts.sensors.posture = Posture::Standing.into();
    fixture.announce(GamePhase::Ready);
    assert_ne!(fixture.run(1000), (0, 0), "it walks to its place");
    assert!(matches!(fixture.robot.memory.motion, DesiredMotion::Walk(_)));
    fixture.announce(GamePhase::Set);
    fixture.run(100);
    assert_eq!(fixture.run(1000).1, 0, "it waits for play");
    fixture.announce(GamePhase::Playing);
    fixture.commands.store(0, Ordering::Relaxed);
    let (images, decisions) = fixture.run(2000);
    assert!(images.abs_diff(2 * images_a_second) <= 1, "{images} images");
    assert!(decisions.abs_diff(2 * images_a_second) <= 1, "{decisions} decisions");
    assert!(matches!(fixture.robot.memory.gaze, GazeRequest::Scan), "without a ball it searches");
    assert!(fixture.commands.load(Ordering::Relaxed).abs_diff(20) <= 1);
    fixture.announce(GamePhase::Finished);
    fixture.run(100);
    assert_eq!(fixture.run(1000), (0, 0));
}
