//! Return data: what a robot reports to the GameController.

use crate::packet_reader::PacketReader;
use crate::team_data::MAX_PLAYERS;
use crate::{Error, ErrorKind};

const HEADER: [u8; 4] = *b"RGrt";
const VERSION: u8 = 4;
/// The age of a ball that was never seen.
const NEVER_SEEN: f32 = -1.0;

/// The length of return data in bytes.
pub const RETURN_DATA_LENGTH: usize = 32;

/// A robot's report of its state, version 4. Poses are in millimetres, as in the packet.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ReturnData {
    /// The number of the player, from 1 to 20.
    pub player: u8,
    /// The number of its team.
    pub team: u8,
    /// Whether it lies on the ground.
    pub is_fallen: bool,
    /// Its pose in the field frame of its own team, with x towards the opponents' goal: mm, mm and
    /// radians.
    pub pose: [f32; 3],
    /// Seconds since it saw the ball; none if it never did.
    pub ball_age: Option<f32>,
    /// The ball relative to the robot, mm.
    pub ball: [f32; 2],
}

impl ReturnData {
    /// Reads a packet.
    ///
    /// # Errors
    /// Length, header, version or a value is wrong: a player that is not 1 to 20, a number that is
    /// none, a robot that neither stands nor lies.
    pub fn decode(packet: &[u8]) -> Result<ReturnData, Error> {
        let mut reader = PacketReader::new("return data", packet);
        reader.header(&[HEADER])?;
        let version = reader.u8()?;
        if version != VERSION {
            let message = format!("return data of version {version} is not supported, only {VERSION}");
            return Err(Error::new(ErrorKind::Version, message));
        }
        if packet.len() != RETURN_DATA_LENGTH {
            let message = format!("return data has {RETURN_DATA_LENGTH} bytes, not {}", packet.len());
            return Err(Error::new(ErrorKind::Length, message));
        }
        let player = player(reader.u8()?)?;
        let team = reader.u8()?;
        let is_fallen = reader.bool("fallen")?;
        let mut number = |field| reader.f32(field);
        Ok(ReturnData {
            player,
            team,
            is_fallen,
            pose: [number("x of the pose")?, number("y of the pose")?, number("the heading")?],
            ball_age: Some(number("the age of the ball")?).filter(|age| *age >= 0.0),
            ball: [number("x of the ball")?, number("y of the ball")?],
        })
    }

    /// Writes a packet.
    ///
    /// # Errors
    /// The player is not 1 to 20, or a number is none.
    pub fn encode(&self) -> Result<Vec<u8>, Error> {
        let mut packet = Vec::with_capacity(RETURN_DATA_LENGTH);
        packet.extend(HEADER);
        packet.extend([VERSION, player(self.player)?, self.team, self.is_fallen.into()]);
        let [x, y, heading] = self.pose;
        let [ball_x, ball_y] = self.ball;
        for number in [x, y, heading, self.ball_age.unwrap_or(NEVER_SEEN), ball_x, ball_y] {
            if number.is_nan() {
                return Err(Error::new(ErrorKind::Value, "a pose, a position or an age is not a number"));
            }
            packet.extend(number.to_le_bytes());
        }
        Ok(packet)
    }
}

/// Checks the number of a player.
fn player(number: u8) -> Result<u8, Error> {
    if (1..=MAX_PLAYERS as u8).contains(&number) {
        return Ok(number);
    }
    Err(Error::new(ErrorKind::Value, format!("a player has a number from 1 to {MAX_PLAYERS}, not {number}")))
}
