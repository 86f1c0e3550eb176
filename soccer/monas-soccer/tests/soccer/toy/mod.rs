//! A minimal world: one robot, one ball, no noise. Its body advances the world by 20 ms at each
//! reading of its sensors.

#![expect(clippy::unwrap_used, reason = "a part of tests")]

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use monas::{HostConfig, Registry, Simulation, Talws, Timestamp};
use monas_robot::{
    Actuators, Anatomy, Announcement, Colour, Error, GamePhase, ObjectKind, Percepts, Posture, Robot,
    Sensors, Sighting, Sightings, Skill,
};
use nalgebra::{Isometry2, Point2, Vector2};

const CYCLE: Duration = Duration::from_millis(20);
const DT: f64 = 0.02;
const DECELERATION: f64 = 0.3;

/// The ground truth.
pub(crate) struct World {
    start: Isometry2<f64>,
    pub(crate) field_from_robot: Isometry2<f64>,
    pub(crate) ball: Point2<f64>,
    pub(crate) ball_velocity: Vector2<f64>,
    pub(crate) phase: GamePhase,
    pub(crate) number: u32,
    pub(crate) posture: Posture,
    /// The skills that were performed, in order.
    pub(crate) performed: Vec<Skill>,
}

/// A world that the test and the body share.
#[derive(Clone)]
pub(crate) struct Shared(Arc<Mutex<World>>);

impl Shared {
    pub(crate) fn new(number: u32, field_from_robot: Isometry2<f64>, ball: Point2<f64>) -> Shared {
        Shared(Arc::new(Mutex::new(World {
            start: field_from_robot,
            field_from_robot,
            ball,
            ball_velocity: Vector2::zeros(),
            phase: GamePhase::Playing,
            number,
            posture: Posture::Standing,
            performed: Vec::new(),
        })))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, World> {
        self.0.lock().unwrap()
    }

    /// A simulation of one robot with the agents of a role of this repository.
    pub(crate) fn play(&self, role: &str) -> Simulation {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/roles").join(role);
        let (setup, diagnostics) = monas::config::load(&file, &Registry::linked());
        let errors: Vec<_> = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).collect();
        assert!(errors.is_empty(), "{errors:?}");
        let mut talws = Talws::new();
        let body: Option<Box<dyn Robot>> = Some(Box::new(Body::new(self.clone())));
        let number = self.lock().number;
        let (agents, links, modules) = (setup.agents, setup.links, setup.modules);
        talws.host(HostConfig {
            name: "robot".into(),
            team: 1,
            number,
            body,
            agents,
            links,
            modules,
            configuration: None,
        });
        talws.simulate(1).unwrap()
    }

    /// Runs until a condition holds and returns the time; none if it does not hold within `limit`
    /// seconds.
    pub(crate) fn until(
        &self,
        simulation: &mut Simulation,
        limit: f64,
        is: impl Fn(&World) -> bool,
    ) -> Option<f64> {
        while simulation.now().as_secs_f64() < limit {
            simulation.run_until(simulation.now() + Duration::from_millis(100)).unwrap();
            if is(&self.lock()) {
                return Some(simulation.now().as_secs_f64());
            }
        }
        None
    }
}

impl World {
    fn ball_in_robot(&self) -> Point2<f64> {
        self.field_from_robot.inverse_transform_point(&self.ball)
    }

    fn roll(&mut self) {
        let speed = self.ball_velocity.norm();
        self.ball += self.ball_velocity * DT;
        self.ball_velocity *= if speed > 0.0 { (speed - DECELERATION * DT).max(0.0) / speed } else { 0.0 };
    }

    fn strike(&mut self, side: f64) {
        let ball = self.ball_in_robot();
        if (ball.x - 0.15).abs() < 0.05 && (ball.y - 0.05 * side).abs() < 0.05 {
            self.ball_velocity = self.field_from_robot * Vector2::new(2.0, 0.0);
        }
    }
}

struct Body {
    shared: Shared,
    anatomy: Anatomy,
    command: Actuators,
    /// The skill in progress, its number and elapsed time.
    skill: Option<(Skill, u64, f64)>,
    skill_done: u64,
    walked: Isometry2<f64>,
}

impl Body {
    fn new(shared: Shared) -> Body {
        let anatomy = Anatomy::new("toy", CYCLE);
        Body {
            shared,
            anatomy,
            command: Actuators::default(),
            skill: None,
            skill_done: 0,
            walked: Isometry2::identity(),
        }
    }

    fn step(&mut self) {
        let shared = self.shared.clone();
        let mut world = shared.lock();
        world.roll();
        self.walked = Isometry2::identity();
        match &mut self.skill {
            Some((skill, number, lasted)) => {
                let before = *lasted;
                *lasted += DT;
                let (skill, number) = (*skill, *number);
                let (strikes, ends) = (before < 0.8 && before + DT >= 0.8, before + DT >= duration(skill));
                match skill {
                    Skill::KickLeft if strikes => world.strike(1.0),
                    Skill::KickRight if strikes => world.strike(-1.0),
                    _ => {}
                }
                if ends {
                    world.posture = if lies_after(skill) { Posture::Fallen } else { Posture::Standing };
                    self.skill_done = number;
                    self.skill = None;
                }
            }
            None if world.posture != Posture::Fallen => {
                let Actuators { walk_x, walk_y, walk_turn, .. } = self.command;
                self.walked = Isometry2::new(Vector2::new(walk_x * DT, walk_y * DT), walk_turn * DT);
                world.field_from_robot *= self.walked;
            }
            None => {}
        }
    }
}

fn duration(skill: Skill) -> f64 {
    match skill {
        Skill::KickLeft | Skill::KickRight => 1.6,
        Skill::StandUp => 3.0,
        _ => 0.5,
    }
}

fn lies_after(skill: Skill) -> bool {
    matches!(skill, Skill::FallLeft | Skill::FallRight | Skill::DiveLeft | Skill::DiveRight)
}

impl Robot for Body {
    fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        self.step();
        let world = self.shared.lock();
        percepts.sensors = Sensors {
            measured_at: now.as_nanos(),
            head_yaw: self.command.head_yaw,
            head_pitch: self.command.head_pitch,
            odometry_x: self.walked.translation.x,
            odometry_y: self.walked.translation.y,
            odometry_turn: self.walked.rotation.angle(),
            posture: world.posture.into(),
            skill_done: self.skill_done,
            ..Sensors::default()
        };
        percepts.sightings = Some(Sightings {
            taken_at: now.as_nanos(),
            head_yaw: self.command.head_yaw,
            head_pitch: self.command.head_pitch,
            objects: sightings(&world, self.command.head_yaw),
        });
        percepts.announcement = Some(announcement(&world));
        Ok(())
    }

    fn act(&mut self, _now: Timestamp, actuators: &Actuators) -> Result<(), Error> {
        let is_new =
            actuators.skill_number != self.command.skill_number && actuators.skill() != Skill::NoSkill;
        self.command = *actuators;
        if is_new && self.skill.is_none() {
            self.skill = Some((actuators.skill(), actuators.skill_number, 0.0));
            let mut world = self.shared.lock();
            world.posture = Posture::Busy;
            world.performed.push(actuators.skill());
        }
        Ok(())
    }
}

/// Sightings of the objects within half a radian of the gaze.
fn sightings(world: &World, head_yaw: f64) -> Vec<Sighting> {
    let mut seen = Vec::new();
    let mut see = |kind: ObjectKind, colour: Colour, position: Point2<f64>| {
        let position = world.field_from_robot.inverse_transform_point(&position);
        let bearing = libm::atan2(position.y, position.x);
        if (bearing - head_yaw).abs() < 0.5 {
            seen.push(Sighting {
                kind: kind.into(),
                colour: colour.into(),
                bearing,
                distance: position.coords.norm(),
            });
        }
    };
    see(ObjectKind::Ball, Colour::Orange, world.ball);
    see(ObjectKind::LeftPost, Colour::Yellow, Point2::new(3.0, 0.7));
    see(ObjectKind::RightPost, Colour::Yellow, Point2::new(3.0, -0.7));
    seen
}

fn announcement(world: &World) -> Announcement {
    Announcement {
        phase: world.phase.into(),
        team: 1,
        number: world.number,
        team_colour: Colour::Blue.into(),
        goal_to_attack: Colour::Yellow.into(),
        placements: 1,
        placed_x: world.start.translation.x,
        placed_y: world.start.translation.y,
        placed_heading: world.start.rotation.angle(),
        field_length: 6.0,
        field_width: 4.0,
        goal_width: 1.4,
        ..Announcement::default()
    }
}
