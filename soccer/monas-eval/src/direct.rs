//! Players directly on the robot interface: no blackboard, no agents, no chart.
//!
//! [`DirectRobot`] is a loop over modules that share a [`SharedMemory`], as modules on a robot
//! vendor's framework do: game state, LEDs, vision and motion, and one [`Behaviour`].

mod goalie;
mod player;

use std::collections::VecDeque;
use std::time::Duration;

use monas_robot::{Actuators, Anatomy, Announcement, Error, Percepts, Robot, Sensors, Sightings};
use monas_soccer::functionality::field::FieldModel;
use monas_soccer::functionality::game::{GameTracker, PlayerState};
use monas_soccer::functionality::head::{Gaze, HeadController};
use monas_soccer::functionality::kick_off::KickOffWalk;
use monas_soccer::functionality::motion::{DesiredMotion, MotionArbiter, PendingRequest, Posture};
use monas_soccer::functionality::placement::PlacementTracker;
use monas_soccer::functionality::walk::GaitLimits;
use monas_soccer::perception::{Perception, PerceptionModel};
use monas_soccer::{Ball, GameState, LedRequest, Placement, Pose, Robots, convert};
use nalgebra::{Isometry2, Point2};
use narukom::Timestamp;

pub use goalie::DirectGoalie;
pub use player::DirectPlayer;

/// Decides what the robot does, from the memory that all modules share.
pub trait Behaviour: Send {
    /// The interval of processed images.
    const VISION: Duration;

    /// Decides once, after a new estimate of the ball.
    fn decide(&mut self, memory: &mut SharedMemory);
}

/// The direction in which the head is to look.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum GazeRequest {
    #[default]
    Ahead,
    At(Gaze),
    Scan,
}

/// The data that the modules exchange.
#[derive(Clone, Debug)]
pub struct SharedMemory {
    pub(crate) now: Timestamp,
    pub(crate) game: GameState,
    pub(crate) ball: Ball,
    pub(crate) pose: Option<Pose>,
    pub(crate) robots: Robots,
    kick_off: KickOffWalk,
    pub(crate) gaze: GazeRequest,
    pub(crate) motion: DesiredMotion,
    /// The number of the last skill that was requested, and of the last that is over.
    pub(crate) motion_number: u64,
    pub(crate) motion_done: u64,
    requested_at: Timestamp,
    lights: LedRequest,
    sensors: Sensors,
    odometry: Isometry2<f64>,
    /// The odometry of the last second, by time of measurement.
    history: VecDeque<(u64, Isometry2<f64>)>,
    image: Option<Sightings>,
    announcement: Option<Announcement>,
    has_new_ball: bool,
}

impl SharedMemory {
    /// Requests a motion. A skill gets a new number, which identifies its completion.
    pub(crate) fn request(&mut self, motion: DesiredMotion) {
        if matches!(motion, DesiredMotion::Skill(_)) {
            self.motion_number = self.motion_number.max(self.motion_done) + 1;
        }
        (self.motion, self.requested_at) = (motion, self.now);
    }

    /// The pose and the field, when both are known.
    pub(crate) fn ground(&self) -> Option<(FieldModel, Isometry2<f64>)> {
        let pose = self.pose?.field_from_robot();
        (self.game.field_length > 0.0).then(|| (self.game.field(), pose))
    }

    fn odometry_at(&self, measured_at: u64) -> Option<Isometry2<f64>> {
        self.history.iter().rev().find(|(at, _)| *at <= measured_at).map(|(_, odometry)| *odometry)
    }

    fn is_on_field(&self) -> bool {
        matches!(self.game.state(), PlayerState::Ready | PlayerState::Set | PlayerState::Playing)
    }

    /// Requests the walk to the place for a kick-off.
    fn take_place(&mut self) {
        self.gaze = GazeRequest::Scan;
        let place = self.game.kick_off_pose();
        let robots: Vec<Point2<f64>> = self.robots.robots.iter().map(|robot| robot.position()).collect();
        let pose = self.pose.map(|pose| (pose.field_from_robot(), pose.confidence));
        let walk = self.kick_off.walk(self.now, pose, &place, &robots);
        self.request(DesiredMotion::Walk(walk));
    }
}

/// A body with the program of a player in it. Commands from outside are ignored.
pub struct DirectRobot<B> {
    body: Box<dyn Robot>,
    memory: SharedMemory,
    tracker: GameTracker,
    button_was_pressed: bool,
    placements: PlacementTracker,
    model: PerceptionModel,
    perception: Option<Perception>,
    arbiter: MotionArbiter,
    head: HeadController,
    scanning_since: Option<Timestamp>,
    behaviour: B,
    has_stood_up: bool,
    is_calibrated: bool,
    modules_at: Timestamp,
    vision_at: Timestamp,
    decision_at: Timestamp,
}

/// The period of the modules and of the behaviour.
const PERIOD: Duration = Duration::from_millis(100);
const GAIT: GaitLimits = GaitLimits { forward: 0.3, backward: 0.15, sideways: 0.15, turn: 1.2 };

impl<B: Behaviour> DirectRobot<B> {
    /// Takes over a body.
    pub fn new(body: Box<dyn Robot>, behaviour: B) -> DirectRobot<B> {
        let start = Timestamp::default();
        let memory = SharedMemory {
            now: start,
            game: GameState::default(),
            ball: Ball::default(),
            pose: None,
            robots: Robots::default(),
            kick_off: KickOffWalk::default(),
            gaze: GazeRequest::Ahead,
            motion: DesiredMotion::Stand,
            motion_number: 0,
            motion_done: 0,
            requested_at: start,
            lights: LedRequest::default(),
            sensors: Sensors::default(),
            odometry: Isometry2::identity(),
            history: VecDeque::new(),
            image: None,
            announcement: None,
            has_new_ball: false,
        };
        DirectRobot {
            body,
            memory,
            tracker: GameTracker::default(),
            button_was_pressed: false,
            placements: PlacementTracker::default(),
            model: PerceptionModel::default(),
            perception: None,
            arbiter: MotionArbiter::new(GAIT),
            head: HeadController::default(),
            scanning_since: None,
            behaviour,
            has_stood_up: false,
            is_calibrated: false,
            modules_at: start,
            vision_at: start,
            decision_at: start,
        }
    }

    fn step(&mut self, now: Timestamp, percepts: &Percepts) -> Result<(), Error> {
        self.memory.now = now;
        self.feel(percepts);
        if now >= self.modules_at {
            self.modules_at = now + PERIOD;
            self.control_game();
            self.set_lights();
            self.start_up();
        }
        if self.is_calibrated && self.memory.is_on_field() {
            if now >= self.vision_at {
                self.vision_at = now + B::VISION;
                self.process_image();
            }
            if now >= self.decision_at && self.memory.has_new_ball {
                self.decision_at = now + PERIOD;
                self.memory.has_new_ball = false;
                match self.memory.game.state() {
                    PlayerState::Ready => self.memory.take_place(),
                    PlayerState::Playing => self.behaviour.decide(&mut self.memory),
                    _ => {}
                }
            }
        }
        self.command(now)
    }

    fn feel(&mut self, percepts: &Percepts) {
        let memory = &mut self.memory;
        memory.sensors = percepts.sensors;
        memory.odometry *= convert::odometry(&percepts.sensors);
        memory.history.push_back((percepts.sensors.measured_at, memory.odometry));
        if memory.history.len() > 50 {
            memory.history.pop_front();
        }
        if let Some(image) = &percepts.sightings {
            memory.image = Some(image.clone());
        }
        if let Some(announcement) = percepts.announcement {
            memory.announcement = Some(announcement);
            self.tracker.announce(convert::phase(&announcement), announcement.penalized);
        }
        if percepts.sensors.chest_button && !self.button_was_pressed {
            self.tracker.press_chest_button();
        }
        self.button_was_pressed = percepts.sensors.chest_button;
        let said = memory.announcement.unwrap_or_default();
        let is_lifted = percepts.sensors.posture() == monas_robot::Posture::Lifted;
        self.placements.feel(is_lifted, convert::phase(&said), said.penalized);
    }

    fn control_game(&mut self) {
        let player_state = monas_soccer::PlayerState::from(self.tracker.state()).into();
        let FieldModel { area_depth, area_width, circle_radius, .. } = FieldModel::LEAGUE_2010;
        let (by_hand, placement) = self.placements.placements();
        let said = self.memory.announcement.unwrap_or_default();
        self.memory.game = GameState {
            player_state,
            team_colour: said.team_colour,
            goal_to_attack: said.goal_to_attack,
            number: said.number,
            kick_off_own: said.kick_off,
            placements: by_hand,
            placement: Placement::from(placement).into(),
            field_length: said.field_length,
            field_width: said.field_width,
            goal_width: said.goal_width,
            area_depth,
            area_width,
            circle_radius,
            ..GameState::default()
        }
        .with_kick_off_pose();
    }

    fn set_lights(&mut self) {
        let memory = &mut self.memory;
        let confidence = memory.pose.map_or(0.0, |pose| pose.confidence);
        memory.lights = convert::lights(Some(&memory.game), memory.ball.found, confidence);
    }

    /// Stands up before the first decision, and begins perception anew once it stands.
    fn start_up(&mut self) {
        if self.has_stood_up {
            self.is_calibrated = true;
            return;
        }
        self.has_stood_up = convert::report(&self.memory.sensors).posture == Posture::Upright;
        self.perception = None;
        self.memory.request(DesiredMotion::Stand);
    }

    fn process_image(&mut self) {
        let memory = &mut self.memory;
        let (now, odometry) = (memory.now, memory.odometry);
        let perception = self.perception.get_or_insert_with(|| Perception::new(&self.model, now, odometry));
        perception.apply_placement(&memory.game, now, odometry);
        perception.feel(Some(memory.sensors.posture()));
        if let Some(image) = memory.image.take().filter(|image| image.taken_at > perception.taken_at())
            && let Some(odometry) = memory.odometry_at(image.taken_at)
        {
            perception.see(&image, &memory.game, &odometry);
        }
        perception.advance(now, &odometry);
        memory.robots = perception.robots();
        memory.ball = perception.ball(&self.model, &memory.robots, Some(memory.game.field()));
        memory.pose = perception.pose();
        memory.has_new_ball = matches!(memory.game.state(), PlayerState::Ready | PlayerState::Playing);
    }

    fn command(&mut self, now: Timestamp) -> Result<(), Error> {
        // Commands follow the period of the modules, as on the other ways.
        if now + PERIOD != self.modules_at {
            return Ok(());
        }
        let memory = &mut self.memory;
        let allowed = matches!(memory.game.state(), PlayerState::Ready | PlayerState::Playing);
        let request = PendingRequest {
            motion: memory.motion,
            ball_speed: 0.0,
            number: memory.motion_number,
            age: now.since(memory.requested_at),
        };
        let order = self.arbiter.step(now, convert::report(&memory.sensors), Some(request), allowed);
        memory.motion_done = self.arbiter.done();
        let gaze = if allowed { memory.gaze } else { GazeRequest::Ahead };
        if !matches!(gaze, GazeRequest::Scan) {
            self.scanning_since = None;
        }
        let gaze = match gaze {
            GazeRequest::Ahead => Gaze::default(),
            GazeRequest::At(gaze) => gaze,
            GazeRequest::Scan => self.head.scan(now.since(*self.scanning_since.get_or_insert(now))),
        };
        self.body.act(now, &convert::actuators(&order, (gaze.yaw, gaze.pitch), memory.lights))
    }
}

impl<B: Behaviour> Robot for DirectRobot<B> {
    fn anatomy(&self) -> &Anatomy {
        self.body.anatomy()
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        self.body.sense(now, percepts)?;
        self.step(now, percepts)?;
        // The program above is the only reader.
        (percepts.sightings, percepts.announcement) = (None, None);
        percepts.heard.clear();
        Ok(())
    }

    fn act(&mut self, _now: Timestamp, _actuators: &Actuators) -> Result<(), Error> {
        Ok(())
    }

    fn rest(&mut self, now: Timestamp) -> Result<(), Error> {
        self.body.rest(now)
    }
}

#[cfg(test)]
mod tests;
