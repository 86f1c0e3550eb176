//! The world's robots as bodies for agents.
//!
//! A [`SharedField`] is a world that several bodies share; [`SharedField::body`] returns the body
//! of one robot, which implements [`monas_robot::Robot`]. The caller of [`SharedField::step`]
//! determines how simulated time advances.

mod announce;
mod body;
mod image_camera;
mod picture_queue;
mod radio_channel;
mod skill;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use monas_robot::{Announcement, BodyKind, BodySite};

use crate::{Error, EventKind, GameState, Pose, SimulatedWorld};

use radio_channel::RadioChannel;

pub use body::FieldBody;

monas_robot::body_kind!(BodyKind {
    name: BodyKind::DEFAULT,
    summary: "the simulated world's own body: a disk on the embedded field",
    options: &[],
    has_own_time: |_| false,
    limits: |_, _| Vec::new(),
    open: |site: BodySite| site.simulated.ok_or_else(nowhere),
    serve: None,
    probe: |_| Ok("it answers in matches".to_owned()),
});

fn nowhere() -> monas_robot::Error {
    let message = "a body of kind `field` is in a match only: there is no simulated world";
    monas_robot::Error::new(monas_robot::ErrorKind::Configuration, message)
}

/// A world shared by the bodies in it. Clones refer to the same world.
#[derive(Clone)]
pub struct SharedField {
    world: Arc<Mutex<SharedWorld>>,
}

/// The world, and the last pose at which the referee placed each robot.
pub(crate) struct SharedWorld {
    pub(crate) world: SimulatedWorld,
    pub(crate) placements: Vec<Placement>,
    /// Radio messages that the robots have not received yet.
    pub(crate) air: RadioChannel,
    seen_events: usize,
    /// What a referee outside the simulation has announced to each robot: nothing, if it has not
    /// spoken yet; none without such a referee.
    pub(crate) league: Option<Vec<Announcement>>,
}

/// How often a robot was placed by hand, and its last such pose in the field frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Placement {
    pub(crate) count: u32,
    pub(crate) pose: Pose,
}

impl SharedField {
    /// Shares a world. The current poses of its robots count as their first placement.
    pub fn new(world: SimulatedWorld) -> SharedField {
        let placements =
            world.robots().iter().map(|robot| Placement { count: 1, pose: robot.pose }).collect();
        let air = RadioChannel::new(world.robots(), world.radio().clone(), world.seed());
        SharedField {
            world: Arc::new(Mutex::new(SharedWorld { world, placements, air, seen_events: 0, league: None })),
        }
    }

    /// Advances the world by one [`STEP`](crate::STEP).
    pub fn step(&self) {
        let mut ground = self.lock();
        ground.world.step();
        ground.note_placements();
    }

    /// Lets a referee outside the simulation decide. Until it has [announced](Self::follow)
    /// something, robots wait and receive no announcement.
    pub fn await_league(&self) {
        let mut ground = self.lock();
        let order = ground.world.referee().to_order();
        // An order for the robots and teams of the world itself is always accepted.
        let _ = ground.world.follow(order);
        ground.league = Some(Vec::new());
    }

    /// Carries out what a referee outside the simulation announces to each robot, in the order of
    /// the robots. The bodies receive the announcements, with the field, the placements by hand and
    /// the jerseys of the simulation.
    ///
    /// # Errors
    /// There are more or fewer announcements than robots.
    pub fn follow(&self, announcements: Vec<Announcement>) -> Result<(), Error> {
        let mut ground = self.lock();
        let order = announce::order(&ground.world, &announcements);
        ground.world.follow(order)?;
        ground.league = Some(announcements);
        Ok(())
    }

    /// Gives read access to the world.
    pub fn with_world<T>(&self, look: impl FnOnce(&SimulatedWorld) -> T) -> T {
        look(&self.lock().world)
    }

    /// Gives write access to the world, for tests and exercises.
    pub fn change<T>(&self, change: impl FnOnce(&mut SimulatedWorld) -> T) -> T {
        change(&mut self.lock().world)
    }

    /// The number of radio messages that each team has sent.
    pub fn messages_sent(&self) -> [u32; 2] {
        self.lock().air.sent()
    }

    /// The body of a robot, by its index in the world.
    pub fn body(&self, robot: usize) -> Option<FieldBody> {
        self.with_world(|world| world.robots().get(robot).map(|_| ()))?;
        Some(FieldBody::new(self.clone(), robot))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, SharedWorld> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SharedWorld {
    /// Records placements by hand: before a half or a kick-off, and after a penalty.
    fn note_placements(&mut self) {
        let mut placed = Vec::new();
        for event in &self.world.events()[self.seen_events..] {
            match event.kind {
                EventKind::StateChanged { to: GameState::Ready | GameState::Initial, .. } => {
                    placed.extend(0..self.placements.len());
                }
                EventKind::Return { robot } => placed.push(robot),
                _ => {}
            }
        }
        self.seen_events = self.world.events().len();
        for robot in placed {
            let Placement { count, pose } = &mut self.placements[robot];
            *count += 1;
            *pose = self.world.robots()[robot].pose;
        }
    }
}
