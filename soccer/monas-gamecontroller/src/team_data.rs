//! A team in the control data.

use crate::packet_reader::PacketReader;
use crate::{Error, ErrorKind, JerseyColour, Penalty, RuleBook};

/// The players of a team that control data has room for.
pub const MAX_PLAYERS: usize = 20;

/// A team.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TeamData {
    /// The number of the team.
    pub number: u8,
    /// The colour of field players.
    pub field_player_colour: JerseyColour,
    /// The colour of the goalkeeper.
    pub goalkeeper_colour: JerseyColour,
    /// The number of the goalkeeper, from 1 to 20; 0, none, only in version 19.
    pub goalkeeper: u8,
    /// Goals.
    pub score: u8,
    /// Penalty shots taken.
    pub penalty_shot: u8,
    /// Successful penalty shots: a bit for each.
    pub single_shots: u16,
    /// Team messages that are left.
    pub message_budget: u16,
    /// The players 1 to 20.
    pub players: [PlayerData; MAX_PLAYERS],
}

/// A player.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct PlayerData {
    /// Why it is off the field, if it is.
    pub penalty: Option<Penalty>,
    /// Seconds until it may come back.
    pub seconds_left: u8,
    /// Warnings (version 19, otherwise 0).
    pub warnings: u8,
    /// Cautions (version 19, otherwise 0).
    pub cautions: u8,
}

impl TeamData {
    /// A team at the beginning of a game, whose goalkeeper is player 1.
    pub fn new(number: u8, colour: JerseyColour) -> TeamData {
        TeamData {
            number,
            field_player_colour: colour,
            goalkeeper_colour: colour,
            goalkeeper: 1,
            score: 0,
            penalty_shot: 0,
            single_shots: 0,
            message_budget: 0,
            players: [PlayerData::default(); MAX_PLAYERS],
        }
    }

    /// A player by its number, from 1 on.
    pub fn player(&self, number: u8) -> Option<&PlayerData> {
        self.players.get(usize::from(number.checked_sub(1)?))
    }

    /// As [`player`](Self::player), to be changed.
    pub fn player_mut(&mut self, number: u8) -> Option<&mut PlayerData> {
        self.players.get_mut(usize::from(number.checked_sub(1)?))
    }

    pub(crate) fn read(reader: &mut PacketReader<'_>, rules: RuleBook) -> Result<TeamData, Error> {
        let mut team = TeamData {
            number: reader.u8()?,
            field_player_colour: JerseyColour::decode(rules, reader.u8()?)?,
            goalkeeper_colour: JerseyColour::decode(rules, reader.u8()?)?,
            goalkeeper: goalkeeper(rules, reader.u8()?)?,
            score: reader.u8()?,
            penalty_shot: reader.u8()?,
            single_shots: reader.u16()?,
            message_budget: reader.u16()?,
            players: Default::default(),
        };
        for player in &mut team.players {
            *player = PlayerData::read(reader, rules)?;
        }
        Ok(team)
    }

    pub(crate) fn write(&self, packet: &mut Vec<u8>, rules: RuleBook) -> Result<(), Error> {
        packet.push(self.number);
        packet.push(self.field_player_colour.number(rules)?);
        packet.push(self.goalkeeper_colour.number(rules)?);
        packet.push(goalkeeper(rules, self.goalkeeper)?);
        packet.extend([self.score, self.penalty_shot]);
        packet.extend(self.single_shots.to_le_bytes());
        packet.extend(self.message_budget.to_le_bytes());
        self.players.iter().try_for_each(|player| player.write(packet, rules))
    }
}

impl PlayerData {
    fn read(reader: &mut PacketReader<'_>, rules: RuleBook) -> Result<PlayerData, Error> {
        let penalty = match reader.u8()? {
            0 => None,
            byte => Some(Penalty::decode(rules, byte)?),
        };
        let seconds_left = reader.u8()?;
        let [warnings, cautions] = match rules {
            RuleBook::StandardPlatform => [0, 0],
            RuleBook::HumanoidSoccer => reader.bytes()?,
        };
        Ok(PlayerData { penalty, seconds_left, warnings, cautions })
    }

    fn write(&self, packet: &mut Vec<u8>, rules: RuleBook) -> Result<(), Error> {
        packet.push(self.penalty.map_or(Ok(0), |penalty| penalty.number(rules))?);
        packet.push(self.seconds_left);
        match rules {
            RuleBook::HumanoidSoccer => packet.extend([self.warnings, self.cautions]),
            RuleBook::StandardPlatform if self.warnings != 0 || self.cautions != 0 => {
                let message = "version 18 has no warnings and cautions of players";
                return Err(Error::new(ErrorKind::Value, message));
            }
            RuleBook::StandardPlatform => {}
        }
        Ok(())
    }
}

/// Checks the number of a goalkeeper.
fn goalkeeper(rules: RuleBook, number: u8) -> Result<u8, Error> {
    let min = match rules {
        RuleBook::StandardPlatform => 1,
        RuleBook::HumanoidSoccer => 0,
    };
    if (min..=MAX_PLAYERS as u8).contains(&number) {
        return Ok(number);
    }
    let version = rules.version();
    let message =
        format!("the goalkeeper's number in version {version} is {min} to {MAX_PLAYERS}, not {number}");
    Err(Error::new(ErrorKind::Value, message))
}
