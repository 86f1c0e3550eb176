//! The world's robots as bodies for agents.
//!
//! A [`Pitch`] is a world that several bodies share; [`Pitch::body`] gives the body of one robot, a
//! [`monas_robot::Robot`] like any other. Whoever advances the pitch decides how simulated time passes.

mod air;
mod announce;
mod body;
mod skill;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::{EventKind, GameState, Pose, World};

use air::Air;

pub use body::FieldBody;

/// A world shared by the bodies in it. Clones are the same pitch.
#[derive(Clone)]
pub struct Pitch {
    ground: Arc<Mutex<Ground>>,
}

/// The world, and where the referee has put each robot by hand.
pub(crate) struct Ground {
    pub(crate) world: World,
    pub(crate) placements: Vec<Placement>,
    /// What each robot has not listened to yet.
    pub(crate) air: Air,
    seen_events: usize,
}

/// How often a robot was put down by hand, and where last, in the field frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Placement {
    pub(crate) count: u32,
    pub(crate) pose: Pose,
}

impl Pitch {
    /// Shares a world. Its robots have been placed once: where they stand.
    pub fn new(world: World) -> Pitch {
        let placements =
            world.robots().iter().map(|robot| Placement { count: 1, pose: robot.pose }).collect();
        let air = Air::new(world.robots());
        Pitch { ground: Arc::new(Mutex::new(Ground { world, placements, air, seen_events: 0 })) }
    }

    /// Moves the world on by one [`STEP`](crate::STEP).
    pub fn step(&self) {
        let mut ground = self.lock();
        ground.world.step();
        ground.note_placements();
    }

    /// Looks at the world.
    pub fn look<T>(&self, look: impl FnOnce(&World) -> T) -> T {
        look(&self.lock().world)
    }

    /// Changes the world: for tests and exercises.
    pub fn change<T>(&self, change: impl FnOnce(&mut World) -> T) -> T {
        change(&mut self.lock().world)
    }

    /// The body of a robot, by its index in the world.
    pub fn body(&self, robot: usize) -> Option<FieldBody> {
        self.look(|world| world.robots().get(robot).map(|_| ()))?;
        Some(FieldBody::new(self.clone(), robot))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, Ground> {
        self.ground.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Ground {
    /// Robots are put down by hand when a half or a kick-off is prepared, and when a penalty is over.
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
