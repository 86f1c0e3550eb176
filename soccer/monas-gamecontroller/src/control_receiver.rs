//! The robots' end of the protocol.

use std::collections::BTreeMap;
use std::io;
use std::net::{SocketAddr, UdpSocket};

use crate::received::{self, Received};
use crate::{Endpoint, GameControlData, Peer, RETURN_PORT, ReturnData};

/// Receives control data, and sends the return data of the robots of this host.
pub struct ControlReceiver {
    control: UdpSocket,
    return_port: u16,
    /// The sockets from which robots report, by team and player.
    robots: BTreeMap<(u8, u8), UdpSocket>,
}

impl ControlReceiver {
    /// Listens at an address: usually [`CONTROL_PORT`](crate::CONTROL_PORT) of all interfaces,
    /// since a GameController broadcasts. Reports go to [`RETURN_PORT`] of the GameController.
    ///
    /// # Errors
    /// The address is in use, or none of this host.
    pub fn open(listen: Endpoint) -> io::Result<ControlReceiver> {
        let control = received::socket(listen.0)?;
        Ok(ControlReceiver { control, return_port: RETURN_PORT, robots: BTreeMap::new() })
    }

    /// Sends reports to another port than the league's.
    pub fn with_return_port(self, return_port: u16) -> ControlReceiver {
        ControlReceiver { return_port, ..self }
    }

    /// The address at which it listens.
    ///
    /// # Errors
    /// As the operating system reports.
    pub fn address(&self) -> io::Result<Endpoint> {
        self.control.local_addr().map(Endpoint)
    }

    /// The next control data that has arrived; returns at once if there is none.
    ///
    /// # Errors
    /// The socket cannot be read. A malformed packet is no error of this kind.
    pub fn receive(&mut self) -> io::Result<Option<Received<GameControlData>>> {
        received::next(&self.control, GameControlData::decode)
    }

    /// Sends the report of a robot to a GameController. A GameController on this host identifies
    /// robots by their address, so that each robot then has a loopback address of its own: the
    /// first one to report 127.0.0.2, the next 127.0.0.3.
    ///
    /// # Errors
    /// The robot's address is not available, or the report cannot be sent.
    pub fn report(&mut self, report: &ReturnData, referee: Peer) -> io::Result<()> {
        let packet = report.encode().map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        let robot = (report.team, report.player);
        if !self.robots.contains_key(&robot) {
            let source = referee.source(self.robots.len());
            self.robots.insert(robot, received::socket((source, 0).into())?);
        }
        let to = SocketAddr::from((referee.0, self.return_port));
        self.robots[&robot].send_to(&packet, to).map(drop)
    }
}
