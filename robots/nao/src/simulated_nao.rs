//! A Nao in simulated time: a LoLA server over a simulated body, and its client, in lockstep.

use std::collections::BTreeMap;

use monas_robot::{Actuators, Anatomy, Error, JointCommands, Leds, Percepts, Robot};
use narukom::Timestamp;

use crate::control::NaoControl;
use crate::lola::SensorPacket;
use crate::server::LolaServer;
use crate::side_channels::{self, RobotChannels};
use crate::socket::Socket;

/// A Nao whose hardware is simulated.
///
/// Server and client exchange their packets through sockets, as on the robot, but take turns on one
/// thread: [`sense`](Robot::sense) sends the actuators, has the server make its cycle, and receives
/// the sensors. So the same seed gives the same bytes.
pub struct SimulatedNao {
    server: LolaServer,
    lola: Socket,
    channels: RobotChannels,
    control: NaoControl,
    sensors: SensorPacket,
    bytes: Vec<u8>,
}

impl SimulatedNao {
    /// A Nao with the body of a robot in a simulated world.
    ///
    /// # Errors
    /// The sockets cannot be created.
    pub fn new(body: Box<dyn Robot>) -> Result<SimulatedNao, Error> {
        SimulatedNao::with_control(body, NaoControl::of(&BTreeMap::new())?)
    }

    /// As [`new`](SimulatedNao::new), with this control.
    pub(crate) fn with_control(body: Box<dyn Robot>, mut control: NaoControl) -> Result<SimulatedNao, Error> {
        let (server, lola) = Socket::pair()?;
        let (simulated, channels) = side_channels::pair()?;
        let server = LolaServer::new(body, server, simulated);
        control.anatomy_mut().radio = server.radio();
        Ok(SimulatedNao {
            server,
            lola,
            channels,
            control,
            sensors: SensorPacket::default(),
            bytes: Vec::new(),
        })
    }
}

impl Robot for SimulatedNao {
    fn anatomy(&self) -> &Anatomy {
        self.control.anatomy()
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        self.control.actuators().encode(&mut self.bytes);
        self.lola.send(&self.bytes)?;
        self.server.step(now)?;
        let sensors = &mut self.sensors;
        if self.lola.receive(|bytes| sensors.decode(bytes))? {
            self.control.receive(&self.sensors);
        }
        self.control.percepts(now, percepts);
        self.channels.receive(now, percepts)?;
        while self.server.send_rest_of_images()? {
            self.channels.receive(now, percepts)?;
        }
        Ok(())
    }

    fn deliver_images(&mut self, width: Option<u32>) -> Result<(), Error> {
        self.server.deliver_images(width)
    }

    fn act(&mut self, _now: Timestamp, actuators: &Actuators) -> Result<(), Error> {
        self.control.act(actuators);
        Ok(())
    }

    fn command_joints(&mut self, _now: Timestamp, commands: &JointCommands) -> Result<(), Error> {
        self.control.command_joints(commands)
    }

    fn light(&mut self, _now: Timestamp, leds: &Leds) -> Result<(), Error> {
        self.control.light(leds);
        Ok(())
    }

    fn rest(&mut self, _now: Timestamp) -> Result<(), Error> {
        self.control.rest();
        Ok(())
    }

    fn say(&mut self, _now: Timestamp, words: &[u8]) -> Result<(), Error> {
        say(&mut self.channels, self.control.anatomy().radio, words)
    }
}

/// Sends a radio message that is not too long.
pub(crate) fn say(channels: &mut RobotChannels, max: usize, words: &[u8]) -> Result<(), Error> {
    if words.len() > max {
        let message = format!("{} bytes are more than the {max} of a message", words.len());
        return Err(Error::new(monas_robot::ErrorKind::Protocol, message));
    }
    Ok(channels.say(words)?)
}
