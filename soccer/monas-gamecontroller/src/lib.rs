//! The league's GameController: its packets, and both ends of its network protocol.
//!
//! A GameController announces the state of a game to all robots, twice a second, by UDP
//! ([`GameControlData`]); each robot reports its own state ([`ReturnData`]). Two rule books are in
//! use, whose packets differ in version and length: the Standard Platform League's (18) and the
//! Humanoid Soccer League's (19). Both are one type here; a set play or penalty that only one of
//! them has is an error in packets of the other.
//!
//! [`ControlReceiver`] is the robots' end of the protocol, [`ControlSender`] the referee's. Neither
//! has a thread or a clock: the caller passes the time and asks for what has arrived.
//! [`OperatedGame`] is a game whose decisions a person makes, as [`OperatorCommand`]s.
//! [`GameControlData::announcement`] converts a packet to the message that a robot's software
//! reads.
//!
//! ```
//! use monas_gamecontroller::{Competition, ControlReceiver, ControlSender, Endpoint, GameControlData};
//! use narukom::Timestamp;
//!
//! let mut robots = ControlReceiver::open(Endpoint::LOOPBACK)?;
//! let mut referee = ControlSender::open(robots.address()?, 0)?;
//! let control = GameControlData::new(Competition::default(), [5, 24]);
//! referee.send(&control, Timestamp::ZERO)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod competition;
mod control_receiver;
mod control_sender;
mod endpoint;
mod error;
mod game_control_data;
mod jersey_colour;
mod league_state;
mod monitor_request;
mod online_players;
mod operated_game;
mod operator_command;
mod packet_reader;
mod penalty;
mod ports;
mod received;
mod return_data;
mod rule_book;
mod set_play;
mod team_data;
mod whistle_delay;

pub use competition::{Competition, CompetitionPhase, CompetitionType, RobotSize};
pub use control_receiver::ControlReceiver;
pub use control_sender::ControlSender;
pub use endpoint::{Endpoint, Peer};
pub use error::{Error, ErrorKind};
pub use game_control_data::{Audience, GameControlData};
pub use jersey_colour::JerseyColour;
pub use league_state::{LeaguePhase, LeagueState};
pub use monitor_request::MonitorRequest;
pub use online_players::{Connection, OnlinePlayers};
pub use operated_game::OperatedGame;
pub use operator_command::OperatorCommand;
pub use penalty::Penalty;
pub use ports::{CONTROL_PORT, RETURN_PORT};
pub use received::Received;
pub use return_data::{RETURN_DATA_LENGTH, ReturnData};
pub use rule_book::RuleBook;
pub use set_play::SetPlay;
pub use team_data::{MAX_PLAYERS, PlayerData, TeamData};
pub use whistle_delay::WhistleDelay;
