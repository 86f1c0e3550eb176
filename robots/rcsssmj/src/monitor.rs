//! The monitor of the server, by which the referee and trials place ball and robots.

use std::fmt::{Display, Formatter, Write};

use crate::connection::Connection;
use crate::error::Error;
use crate::expression::{Item, Items};
use crate::percept::{PlayMode, Side};

/// The state of the game as a monitor receives it.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct MonitoredGame {
    /// The time of the server, s.
    pub time: f64,
    /// The time that has been played, s.
    pub play_time: f64,
    /// The play mode.
    pub play_mode: PlayMode,
    /// The goals of the team on the left.
    pub left_score: u32,
    /// The goals of the team on the right.
    pub right_score: u32,
}

impl MonitoredGame {
    /// Reads a message to a monitor: `((RSMP 1 0)((gt 1 0)137.24)((sg 1 0)…)((gs 1 0)…))`. The
    /// scene is passed over, and what a message leaves out stays.
    ///
    /// # Errors
    /// The parentheses are not balanced, or a value is not of its kind.
    pub fn decode(&mut self, message: &[u8]) -> Result<(), Error> {
        self.read(Items::of(message)?)
            .ok_or_else(|| Error::protocol("the state of the game is not understood"))
    }

    fn read(&mut self, mut message: Items<'_>) -> Option<()> {
        let Some(Item::List(parts)) = message.next() else { return Some(()) };
        for part in parts {
            let Item::List(mut part) = part else { continue };
            let Some(Item::List(mut head)) = part.next() else { continue };
            match head.word() {
                Some(b"gt") => self.time = part.number()?,
                Some(b"gs") => self.read_game(part)?,
                _ => {}
            }
        }
        Some(())
    }

    fn read_game(&mut self, mut values: Items<'_>) -> Option<()> {
        while let Some((key, mut value)) = values.next_named() {
            match key {
                b"time" => self.play_time = value.number()?,
                b"play_mode" => self.play_mode = PlayMode::numbered(value.number()? as usize)?,
                b"score_left" => self.left_score = value.number()? as u32,
                b"score_right" => self.right_score = value.number()? as u32,
                _ => {}
            }
        }
        Some(())
    }
}

/// A command of a monitor.
#[derive(Clone, PartialEq, Debug)]
pub enum Command {
    /// Gives a team the kick-off.
    KickOff(Side),
    /// Resumes the game where the ball lies.
    DropBall,
    /// Places the ball at a position, m, with a velocity, m/s.
    PlaceBall {
        /// The middle of the ball.
        at: [f64; 3],
        /// Its velocity.
        velocity: [f64; 3],
    },
    /// Places a robot upright, with all its joints at zero.
    PlaceRobot {
        /// The name of its team.
        team: String,
        /// Its number.
        number: u32,
        /// The origin of its torso, m.
        at: [f64; 3],
        /// Its heading, rad.
        heading: f64,
    },
}

impl Display for Command {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Command::KickOff(side) => write!(f, "(kickOff {side:?})"),
            Command::DropBall => write!(f, "(dropBall)"),
            Command::PlaceBall { at: [x, y, z], velocity: [vx, vy, vz] } => {
                write!(f, "(ball (pos {x} {y} {z}) (vel {vx} {vy} {vz}))")
            }
            Command::PlaceRobot { team, number, at: [x, y, z], heading } => {
                let heading = heading.to_degrees();
                write!(f, "(agent (unum {number}) (team {team}) (move {x} {y} {z} {heading}))")
            }
        }
    }
}

/// A connection to the port for monitors.
///
/// The server sends the scene in every second cycle and does not stop for a monitor that does not
/// read: [`drain`](Monitor::drain) has to be called again and again.
#[derive(Debug)]
pub struct Monitor {
    connection: Connection,
    game: MonitoredGame,
    text: String,
}

impl Monitor {
    /// Connects to an address such as `127.0.0.1:60001`.
    ///
    /// # Errors
    /// Nothing answers there.
    pub fn connect(address: &str) -> Result<Monitor, Error> {
        let connection = Connection::open(address)?;
        Ok(Monitor { connection, game: MonitoredGame::default(), text: String::new() })
    }

    /// Waits for the first message: the server makes its cycles.
    pub(crate) fn begun(mut self) -> Result<Monitor, Error> {
        let game = &mut self.game;
        self.connection.receive(|message| game.decode(message))?;
        Ok(self)
    }

    /// Reads what has arrived, without waiting, and returns the newest state of the game.
    ///
    /// # Errors
    /// The connection has ended, or a message is not understood.
    pub fn drain(&mut self) -> Result<MonitoredGame, Error> {
        let game = &mut self.game;
        self.connection.drain(|message| game.decode(message))?;
        Ok(*game)
    }

    /// Sends a command.
    ///
    /// # Errors
    /// The connection has ended.
    pub fn send(&mut self, command: &Command) -> Result<(), Error> {
        self.text.clear();
        // Writing into a string does not fail.
        let _ = write!(self.text, "{command}");
        self.connection.send(self.text.as_bytes())
    }

    /// Waits for the state after a time of the server, s.
    pub(crate) fn wait_beyond(&mut self, time: f64) -> Result<(), Error> {
        // Both times are truncated to two decimals.
        while self.game.time < time + 0.005 {
            let game = &mut self.game;
            self.connection.receive(|message| game.decode(message))?;
        }
        Ok(())
    }

    /// Ends the connection after the server has read all commands, which it shows by closing its
    /// side.
    pub(crate) fn finish(self) -> Result<(), Error> {
        self.connection.finish()
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};
    use std::net::TcpListener;
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;

    const TEXT: &str = "((RSMP 1 0)((gt 1 0)137.24)((sg 1 0)full(nd TRF(SLT 1.0 0.0)(nd DSC(ball))))\
        ((gs 1 0)(time 12.5)(half 1)(score_left 1)(score_right 0)(play_mode 13)(team_left Monas)))";

    #[test]
    fn the_state_of_the_game_is_found_behind_the_scene() {
        let mut game = MonitoredGame::default();
        game.decode(TEXT.as_bytes()).unwrap();
        let expected = MonitoredGame {
            time: 137.24,
            play_time: 12.5,
            play_mode: PlayMode::Goal(Side::Left),
            left_score: 1,
            right_score: 0,
        };
        assert_eq!(game, expected);
        game.decode(b"((RSMP 1 0)((gt 1 0)138))").unwrap();
        assert_eq!(game, MonitoredGame { time: 138.0, ..expected });
        assert!(game.decode(b"((RSMP 1 0)((gs 1 0)(play_mode 23)))").is_err());
    }

    #[test]
    fn commands_arrive_in_frames_while_the_scene_is_drained() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut monitor = Monitor::connect(&listener.local_addr().unwrap().to_string()).unwrap();
        let (mut server, _) = listener.accept().unwrap();
        let mut frame = Vec::new();
        crate::frame::write(TEXT.as_bytes(), &mut frame);
        server.write_all(&frame).unwrap();
        while monitor.drain().unwrap().left_score == 0 {
            std::thread::yield_now();
        }
        let (at, heading) = ([-1.5, 0.0, 0.7], std::f64::consts::PI);
        for command in [
            Command::KickOff(Side::Right),
            Command::DropBall,
            Command::PlaceBall { at: [1.0, -2.0, 0.11], velocity: [0.5, 0.0, 0.0] },
            Command::PlaceRobot { team: "Monas".into(), number: 2, at, heading },
        ] {
            monitor.send(&command).unwrap();
        }
        let mut expected = Vec::new();
        for command in [
            "(kickOff Right)",
            "(dropBall)",
            "(ball (pos 1 -2 0.11) (vel 0.5 0 0))",
            "(agent (unum 2) (team Monas) (move -1.5 0 0.7 180))",
        ] {
            crate::frame::write(command.as_bytes(), &mut expected);
        }
        let mut sent = vec![0; expected.len()];
        server.read_exact(&mut sent).unwrap();
        assert_eq!(sent, expected);
        drop(server);
        let ended = loop {
            if let Err(error) = monitor.drain() {
                break error;
            }
        };
        assert_eq!(ended.kind(), crate::ErrorKind::Disconnected);
    }

    /// Messages of the server itself, if a folder `shared` above the workspace has them.
    #[test]
    fn recorded_messages_are_read() {
        let mut folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
        let file = |folder: &Path| std::fs::read(folder.join("shared/robots/rcsssmj/monitor_diff.txt")).ok();
        let Some(recorded) = folders.find_map(file) else { return };
        let line = recorded.split(|byte| *byte == b'\n').next().unwrap();
        let mut game = MonitoredGame::default();
        game.decode(line).unwrap();
        assert_eq!((game.time, game.play_mode), (137.28, PlayMode::BeforeKickOff));
    }

    proptest! {
        #[test]
        fn a_message_cut_off_or_changed_is_read_or_refused(
            length in 0..TEXT.len(), index in 0..TEXT.len(), byte in any::<u8>(),
        ) {
            let mut bytes = TEXT.as_bytes().to_vec();
            bytes[index] = byte;
            let _ = MonitoredGame::default().decode(&bytes);
            bytes.truncate(length);
            let _ = MonitoredGame::default().decode(&bytes);
        }
    }
}
