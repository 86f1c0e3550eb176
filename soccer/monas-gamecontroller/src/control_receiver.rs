//! The robots' end of the protocol.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io;
use std::net::{SocketAddr, UdpSocket};

use crate::received::{self, Received};
use crate::{Endpoint, GameControlData, Peer, RETURN_PORT, ReturnData};

/// Receives control data, and sends the return data of the robots of this host.
pub struct ControlReceiver {
    control: UdpSocket,
    return_port: u16,
    /// The sockets from which robots report, by team and player, and whether to this host: one at
    /// a loopback address reaches no other computer.
    robots: BTreeMap<(u8, u8, bool), UdpSocket>,
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
    /// The socket cannot be read. A malformed packet is not an error of this kind.
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
        let to = SocketAddr::from((referee.0, self.return_port));
        self.socket((report.team, report.player), referee)?.send_to(&packet, to).map(drop)
    }

    /// The socket from which a robot reports to a GameController.
    fn socket(&mut self, (team, player): (u8, u8), referee: Peer) -> io::Result<&UdpSocket> {
        let before = self.robots.keys().filter(|(.., is_loopback)| *is_loopback).count();
        match self.robots.entry((team, player, referee.0.is_loopback())) {
            Entry::Occupied(socket) => Ok(socket.into_mut()),
            Entry::Vacant(entry) => Ok(entry.insert(received::socket((referee.source(before), 0).into())?)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_reports_to_another_computer_after_this_one() {
        let mut receiver = ControlReceiver::open(Endpoint::LOOPBACK).unwrap();
        let [here, elsewhere] = [[127, 0, 0, 1], [192, 0, 2, 1]].map(|address| Peer(address.into()));
        let mut source = |player, referee| {
            receiver.socket((1, player), referee).unwrap().local_addr().unwrap().ip().to_string()
        };
        assert_eq!([source(1, here), source(1, elsewhere)], ["127.0.0.2", "0.0.0.0"]);
        assert_eq!([source(2, elsewhere), source(2, here)], ["0.0.0.0", "127.0.0.3"]);
        assert_eq!([source(1, here), source(1, elsewhere)], ["127.0.0.2", "0.0.0.0"]);
    }
}
