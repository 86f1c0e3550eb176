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

use crate::{Error, SimulatedWorld};

use radio_channel::RadioChannel;

pub use body::FieldBody;

monas_robot::body_kind!(BodyKind {
    name: BodyKind::DEFAULT,
    summary: "the simulated world's own body: a disk on the embedded field",
    options: &[],
    has_own_time: |_| false,
    limits: |_, _| Vec::new(),
    faults: |_, _| Vec::new(),
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

/// The world, and what its robots hear.
pub(crate) struct SharedWorld {
    pub(crate) world: SimulatedWorld,
    /// Radio messages that the robots have not received yet.
    pub(crate) air: RadioChannel,
    /// The latest announcement of a referee outside the simulation to each robot: empty before the
    /// first announcement; none without such a referee.
    pub(crate) league: Option<Vec<Announcement>>,
}

impl SharedField {
    /// Shares a world.
    pub fn new(world: SimulatedWorld) -> SharedField {
        let air = RadioChannel::new(world.robots(), world.radio().clone(), world.seed());
        SharedField { world: Arc::new(Mutex::new(SharedWorld { world, air, league: None })) }
    }

    /// Advances the world by one [`STEP`](crate::STEP).
    pub fn step(&self) {
        self.lock().world.step();
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
    /// the robots. The bodies receive the announcements, with the field and the jerseys of the
    /// simulation.
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
