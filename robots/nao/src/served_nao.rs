//! A simulated body at a LoLA socket, for agents in another process.

use std::path::Path;

use monas_robot::{Actuators, Anatomy, Error, Percepts, Robot};
use narukom::Timestamp;

use crate::anatomy::anatomy;
use crate::server::LolaServer;

/// A simulated body that is commanded through LoLA only.
///
/// Each [`sense`](Robot::sense) is a cycle of the server. Commands of the runtime of this process
/// are ignored: the agents of the robot are in another process, in which [`Nao`](crate::Nao)
/// connects to the socket.
pub struct ServedNao {
    server: LolaServer,
    anatomy: Anatomy,
}

impl ServedNao {
    /// Offers a body at a path.
    ///
    /// # Errors
    /// The path cannot be bound.
    pub fn listen(path: &Path, body: Box<dyn Robot>) -> Result<ServedNao, Error> {
        // Joints, links, cameras and lights are at the other end.
        let (joints, links, cameras) = (Vec::new(), Vec::new(), Vec::new());
        let anatomy = Anatomy { joints, links, cameras, has_leds: false, ..anatomy().clone() };
        Ok(ServedNao { server: LolaServer::listen(path, body)?, anatomy })
    }
}

impl Robot for ServedNao {
    fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        self.server.step(now)?;
        percepts.sensors = self.server.sensors();
        Ok(())
    }

    fn act(&mut self, _now: Timestamp, _actuators: &Actuators) -> Result<(), Error> {
        Ok(())
    }

    fn rest(&mut self, _now: Timestamp) -> Result<(), Error> {
        Ok(())
    }

    fn say(&mut self, _now: Timestamp, _words: &[u8]) -> Result<(), Error> {
        Ok(())
    }
}
