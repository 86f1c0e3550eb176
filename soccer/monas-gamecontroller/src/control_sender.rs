//! The referee's end of the protocol.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;

use narukom::Timestamp;

use crate::received::{self, Received};
use crate::{Endpoint, GameControlData, OnlinePlayers, ReturnData};

/// Time between two packets of control data.
const INTERVAL: Duration = Duration::from_millis(500);

/// Sends control data, and receives the return data of robots.
pub struct ControlSender {
    socket: UdpSocket,
    to: SocketAddr,
    reports: UdpSocket,
    sent: u64,
    due: Timestamp,
    online: OnlinePlayers,
}

impl ControlSender {
    /// Sends to an address, which may be a broadcast address, and receives return data at a port,
    /// usually [`RETURN_PORT`](crate::RETURN_PORT): of the loopback interface if it sends there,
    /// otherwise of all.
    ///
    /// # Errors
    /// The port for return data is in use.
    pub fn open(to: Endpoint, return_port: u16) -> io::Result<ControlSender> {
        let interface = to.reporting_interface();
        let socket = received::socket((interface, 0).into())?;
        socket.set_broadcast(true)?;
        let reports = received::socket((interface, return_port).into())?;
        let online = OnlinePlayers::default();
        Ok(ControlSender { socket, to: to.0, reports, sent: 0, due: Timestamp::ZERO, online })
    }

    /// The port at which it receives return data.
    ///
    /// # Errors
    /// As the operating system reports.
    pub fn return_port(&self) -> io::Result<u16> {
        self.reports.local_addr().map(|address| address.port())
    }

    /// Whether half a second has passed since the last packet.
    pub fn is_due(&self, now: Timestamp) -> bool {
        now >= self.due
    }

    /// Sends control data with the next packet number.
    ///
    /// # Errors
    /// The rule book does not define a value, or the packet cannot be sent.
    pub fn send(&mut self, control: &GameControlData, now: Timestamp) -> io::Result<()> {
        self.due = now + INTERVAL;
        self.online.expect(control.teams.each_ref().map(|team| team.number));
        let packet = GameControlData { packet_number: self.sent as u8, ..control.clone() }.encode();
        let packet = packet.map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        self.socket.send_to(&packet, self.to)?;
        self.sent += 1;
        Ok(())
    }

    /// The number of packets sent.
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// The next return data that has arrived; returns at once if there is none.
    ///
    /// # Errors
    /// The socket cannot be read. A malformed packet is not an error of this kind.
    pub fn receive(&mut self, now: Timestamp) -> io::Result<Option<Received<ReturnData>>> {
        let received = received::next(&self.reports, ReturnData::decode)?;
        if let Some(Received { content: Ok(report), .. }) = &received {
            self.online.note(report.team, report.player, now);
        }
        Ok(received)
    }

    /// The players that report.
    pub fn online(&self) -> &OnlinePlayers {
        &self.online
    }
}
