//! Control data: what the GameController sends to all robots, twice a second.

use monas_robot::{Announcement, Colour, GamePhase};

use crate::packet_reader::PacketReader;
use crate::{
    Competition, CompetitionPhase, CompetitionType, Error, ErrorKind, JerseyColour, LeaguePhase, LeagueState,
    RobotSize, RuleBook, SetPlay, TeamData,
};

/// The header of control data for players.
const PLAYERS: [u8; 4] = *b"RGme";
/// The header of control data for monitors.
const MONITORS: [u8; 4] = *b"RGTD";
/// The kicking team if there is none, or if it is hidden.
const NO_TEAM: u8 = 255;

/// Whom control data is for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Audience {
    /// Robots, from which the referee may hide a new state until its whistle must have been heard.
    Players,
    /// Monitors, which get the true state.
    Monitors,
}

/// The state of a game, of either rule book.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct GameControlData {
    /// Whom it is for.
    pub audience: Audience,
    /// Counts packets, and wraps.
    pub packet_number: u8,
    /// The players of a team on the field.
    pub players_per_team: u8,
    /// The competition, whose rule book determines the version.
    pub competition: Competition,
    /// The phase of the game.
    pub phase: LeaguePhase,
    /// The state of the game.
    pub state: LeagueState,
    /// The restart of play, if there is one.
    pub set_play: Option<SetPlay>,
    /// Whether this is the first half.
    pub is_first_half: bool,
    /// The number of the team that kicks; none if there is none, or if it is hidden.
    pub kicking_team: Option<u8>,
    /// Seconds left in this half.
    pub seconds_left: i16,
    /// Seconds left of what else is timed: READY, a kick-off, a set play, a timeout, a break.
    pub secondary_seconds: i16,
    /// The teams; the first defends the left goal.
    pub teams: [TeamData; 2],
}

impl GameControlData {
    /// A game that has not begun, of the teams with these numbers, in blue and red.
    pub fn new(competition: Competition, [left, right]: [u8; 2]) -> GameControlData {
        GameControlData {
            audience: Audience::Players,
            packet_number: 0,
            players_per_team: 5,
            competition,
            phase: LeaguePhase::Normal,
            state: LeagueState::Initial,
            set_play: None,
            is_first_half: true,
            kicking_team: None,
            seconds_left: 600,
            secondary_seconds: 0,
            teams: [TeamData::new(left, JerseyColour::Blue), TeamData::new(right, JerseyColour::Red)],
        }
    }

    /// Reads a packet of version 18 or 19.
    ///
    /// # Errors
    /// Length, header, version or a value is wrong.
    pub fn decode(packet: &[u8]) -> Result<GameControlData, Error> {
        let mut reader = PacketReader::new("control data", packet);
        let audience = match reader.header(&[PLAYERS, MONITORS])? {
            MONITORS => Audience::Monitors,
            _ => Audience::Players,
        };
        let version = reader.u8()?;
        let known = RuleBook::ALL.into_iter().find(|rules| rules.version() == version);
        let rules = known.ok_or_else(|| {
            let message = format!("control data of version {version} is not supported, only 18 and 19");
            Error::new(ErrorKind::Version, message)
        })?;
        if packet.len() != rules.packet_length() {
            let wanted = rules.packet_length();
            let message =
                format!("control data of version {version} has {wanted} bytes, not {}", packet.len());
            return Err(Error::new(ErrorKind::Length, message));
        }
        let packet_number = reader.u8()?;
        let players_per_team = reader.u8()?;
        let competition = match rules {
            RuleBook::StandardPlatform => Competition::StandardPlatform {
                phase: CompetitionPhase::decode(rules, reader.u8()?)?,
                kind: CompetitionType::decode(rules, reader.u8()?)?,
            },
            RuleBook::HumanoidSoccer => Competition::HumanoidSoccer {
                size: RobotSize::decode(rules, reader.u8()?)?,
                is_stopped: reader.bool("stopped")?,
            },
        };
        Ok(GameControlData {
            audience,
            packet_number,
            players_per_team,
            competition,
            phase: LeaguePhase::decode(rules, reader.u8()?)?,
            state: LeagueState::decode(rules, reader.u8()?)?,
            set_play: match reader.u8()? {
                0 => None,
                byte => Some(SetPlay::decode(rules, byte)?),
            },
            is_first_half: reader.bool("the first half")?,
            kicking_team: Some(reader.u8()?).filter(|team| *team != NO_TEAM),
            seconds_left: reader.i16()?,
            secondary_seconds: reader.i16()?,
            teams: [TeamData::read(&mut reader, rules)?, TeamData::read(&mut reader, rules)?],
        })
    }

    /// Writes a packet of the version of the competition's rule book.
    ///
    /// # Errors
    /// The rule book does not define a value, or the kicking team has the number 255, which stands
    /// for none.
    pub fn encode(&self) -> Result<Vec<u8>, Error> {
        let rules = self.competition.rules();
        let mut packet = Vec::with_capacity(rules.packet_length());
        packet.extend(match self.audience {
            Audience::Players => PLAYERS,
            Audience::Monitors => MONITORS,
        });
        packet.extend([rules.version(), self.packet_number, self.players_per_team]);
        packet.extend(match self.competition {
            Competition::StandardPlatform { phase, kind } => [phase.number(rules)?, kind.number(rules)?],
            Competition::HumanoidSoccer { size, is_stopped } => [size.number(rules)?, is_stopped.into()],
        });
        packet.extend([self.phase.number(rules)?, self.state.number(rules)?]);
        packet.push(self.set_play.map_or(Ok(0), |set_play| set_play.number(rules))?);
        packet.push(self.is_first_half.into());
        if self.kicking_team == Some(NO_TEAM) {
            return Err(Error::new(ErrorKind::Value, "the number 255 stands for no kicking team"));
        }
        packet.push(self.kicking_team.unwrap_or(NO_TEAM));
        packet.extend(self.seconds_left.to_le_bytes());
        packet.extend(self.secondary_seconds.to_le_bytes());
        self.teams.iter().try_for_each(|team| team.write(&mut packet, rules))?;
        Ok(packet)
    }

    /// The packet's content for one robot; none if its team or player does not take part.
    ///
    /// STANDBY is INITIAL with [`halted`](Announcement::halted), which a stopped game is as well.
    /// Placements and the size of the field are not in the packet and stay unset. The left goal
    /// counts as blue, the right one as yellow.
    pub fn announcement(&self, team: u8, player: u8) -> Option<Announcement> {
        let index = self.teams.iter().position(|candidate| candidate.number == team)?;
        let (own, opponent) = (&self.teams[index], &self.teams[1 - index]);
        let record = own.player(player)?;
        let colour = if player == own.goalkeeper { own.goalkeeper_colour } else { own.field_player_colour };
        let goal_to_attack = if index == 0 { Colour::Yellow } else { Colour::Blue };
        Some(Announcement {
            phase: phase(self.state).into(),
            penalized: record.penalty.is_some(),
            penalty_left: record.seconds_left.into(),
            seconds_left: self.seconds_left.into(),
            first_half: self.is_first_half,
            team: team.into(),
            number: player.into(),
            team_colour: Colour::from(colour).into(),
            goal_to_attack: goal_to_attack.into(),
            kick_off: self.kicking_team == Some(team),
            own_score: own.score.into(),
            opponent_score: opponent.score.into(),
            set_play: set_play(self.set_play).into(),
            halted: self.state == LeagueState::Standby || self.competition.is_stopped(),
            ..Announcement::default()
        })
    }
}

fn phase(state: LeagueState) -> GamePhase {
    match state {
        LeagueState::Initial | LeagueState::Standby => GamePhase::Initial,
        LeagueState::Ready => GamePhase::Ready,
        LeagueState::Set => GamePhase::Set,
        LeagueState::Playing => GamePhase::Playing,
        LeagueState::Finished => GamePhase::Finished,
    }
}

fn set_play(set_play: Option<SetPlay>) -> monas_robot::SetPlay {
    match set_play {
        None => monas_robot::SetPlay::NoSetPlay,
        Some(SetPlay::GoalKick) => monas_robot::SetPlay::GoalKick,
        Some(SetPlay::CornerKick) => monas_robot::SetPlay::CornerKick,
        Some(SetPlay::PenaltyKick) => monas_robot::SetPlay::PenaltyKick,
        Some(SetPlay::KickIn | SetPlay::ThrowIn) => monas_robot::SetPlay::ThrowIn,
        Some(SetPlay::PushingFreeKick | SetPlay::DirectFreeKick) => monas_robot::SetPlay::DirectFreeKick,
        Some(SetPlay::IndirectFreeKick) => monas_robot::SetPlay::IndirectFreeKick,
    }
}
