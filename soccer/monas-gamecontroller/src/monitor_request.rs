//! The request of a monitor for the true state of a game.

use crate::packet_reader::PacketReader;
use crate::{Error, ErrorKind};

const HEADER: [u8; 4] = *b"RGTr";
const VERSION: u8 = 0;

/// The request of a monitor, which then receives control data for [`Monitors`] and the return data
/// of all robots.
///
/// [`Monitors`]: crate::Audience::Monitors
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MonitorRequest;

impl MonitorRequest {
    /// Reads a packet.
    ///
    /// # Errors
    /// Length, header or version is wrong.
    pub fn decode(packet: &[u8]) -> Result<MonitorRequest, Error> {
        let mut reader = PacketReader::new("a monitor's request", packet);
        reader.header(&[HEADER])?;
        let version = reader.u8()?;
        if version != VERSION {
            let message =
                format!("a monitor's request of version {version} is not supported, only {VERSION}");
            return Err(Error::new(ErrorKind::Version, message));
        }
        match packet.len() {
            5 => Ok(MonitorRequest),
            length => {
                Err(Error::new(ErrorKind::Length, format!("a monitor's request has 5 bytes, not {length}")))
            }
        }
    }

    /// Writes a packet.
    pub fn encode(self) -> [u8; 5] {
        let [a, b, c, d] = HEADER;
        [a, b, c, d, VERSION]
    }
}
