//! The decisions of a person, as lines of text.

use crate::{Penalty, SetPlay};

/// A decision about a game.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum OperatorCommand {
    /// Robots wait before a half.
    Initial,
    /// Robots wait for the referee's gesture.
    Standby,
    /// Robots walk to their positions for a kick-off of this team.
    Ready {
        /// The team that has the kick-off, if one has it.
        team: Option<u8>,
    },
    /// Robots wait for the kick-off.
    Set,
    /// The ball is in play.
    Play,
    /// The half is over.
    Finish,
    /// The second half follows, with sides switched.
    Half,
    /// A goal of a team.
    Goal {
        /// The team that has scored.
        team: u8,
    },
    /// A set play of a team.
    SetPlay {
        /// The team that kicks.
        team: u8,
        /// The kind of set play.
        kind: SetPlay,
    },
    /// A player leaves the field.
    Penalize {
        /// Its team.
        team: u8,
        /// Its number.
        player: u8,
        /// The reason.
        penalty: Penalty,
        /// For how long; by default as usual for the reason.
        seconds: Option<u8>,
    },
    /// A player comes back.
    Return {
        /// Its team.
        team: u8,
        /// Its number.
        player: u8,
    },
    /// The game is stopped, or goes on.
    Stop {
        /// Whether it is stopped.
        is_stopped: bool,
    },
}

/// Each command with its arguments and its effect, for people.
const HELP: [(&str, &str); 13] = [
    ("initial", "robots wait"),
    ("standby", "robots wait for the referee's gesture (SPL)"),
    ("ready [TEAM]", "robots walk to their positions; TEAM has the kick-off"),
    ("set", "robots wait for the kick-off"),
    ("play", "the ball is in play"),
    ("finish", "the half is over"),
    ("half", "the second half, with sides switched"),
    ("goal TEAM", "a goal; the other team has the kick-off"),
    ("set-play TEAM KIND", "a restart: goal kick, corner kick, ..."),
    ("penalize TEAM PLAYER REASON [SECONDS]", "a penalty: pushing, ball holding, ..."),
    ("return TEAM PLAYER", "the player comes back"),
    ("stop", "the game is stopped (HSL)"),
    ("continue", "a stopped game goes on (HSL)"),
];

impl OperatorCommand {
    /// Reads a line such as `penalize 5 2 pushing`.
    ///
    /// # Errors
    /// There is no such command, or its arguments are wrong: what is right.
    pub fn parse(line: &str) -> Result<OperatorCommand, String> {
        let (name, arguments) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
        let mut words = CommandArguments { rest: arguments.trim(), usage: usage(name) };
        let command = match name {
            "initial" => OperatorCommand::Initial,
            "standby" => OperatorCommand::Standby,
            "ready" => {
                let team = if words.rest.is_empty() { None } else { Some(words.number("TEAM")?) };
                OperatorCommand::Ready { team }
            }
            "set" => OperatorCommand::Set,
            "play" => OperatorCommand::Play,
            "finish" => OperatorCommand::Finish,
            "half" => OperatorCommand::Half,
            "goal" => OperatorCommand::Goal { team: words.number("TEAM")? },
            "set-play" => {
                let team = words.number("TEAM")?;
                OperatorCommand::SetPlay {
                    team,
                    kind: words.named("set play", &SetPlay::all().collect::<Vec<_>>())?,
                }
            }
            "penalize" => {
                let (team, player) = (words.number("TEAM")?, words.number("PLAYER")?);
                let seconds = words.last_number();
                let penalty = words.named("penalty", &Penalty::all().collect::<Vec<_>>())?;
                OperatorCommand::Penalize { team, player, penalty, seconds }
            }
            "return" => {
                OperatorCommand::Return { team: words.number("TEAM")?, player: words.number("PLAYER")? }
            }
            "stop" => OperatorCommand::Stop { is_stopped: true },
            "continue" => OperatorCommand::Stop { is_stopped: false },
            other => {
                let names = HELP.map(|(usage, _)| usage.split(' ').next().unwrap_or_default());
                return Err(format!("there is no command `{other}`; there are {}", names.join(", ")));
            }
        };
        words.end().map(|()| command)
    }

    /// The commands, one per line.
    pub fn help() -> String {
        HELP.iter().map(|(usage, effect)| format!("  {usage:<39}{effect}\n")).collect()
    }
}

/// The syntax of a command.
fn usage(name: &str) -> &'static str {
    let is_named = |usage: &str| usage.split(' ').next() == Some(name);
    HELP.iter().map(|(usage, _)| *usage).find(|usage| is_named(usage)).unwrap_or_default()
}

/// The arguments of a command that have not been read.
struct CommandArguments<'a> {
    rest: &'a str,
    usage: &'static str,
}

impl CommandArguments<'_> {
    fn number(&mut self, what: &str) -> Result<u8, String> {
        let (word, rest) = self.rest.split_once(char::is_whitespace).unwrap_or((self.rest, ""));
        let number = word.parse().map_err(|_| match word {
            "" => format!("{what} is missing: {}", self.usage),
            _ => format!("`{word}` is not a number from 0 to 255: {}", self.usage),
        })?;
        self.rest = rest.trim_start();
        Ok(number)
    }

    /// The number at the end, if there is one.
    fn last_number(&mut self) -> Option<u8> {
        let (rest, word) = self.rest.rsplit_once(char::is_whitespace)?;
        let number = word.parse().ok()?;
        self.rest = rest.trim_end();
        Some(number)
    }

    /// One of several values, by its name, which takes the rest.
    fn named<T: Copy + ToString>(&mut self, what: &str, values: &[T]) -> Result<T, String> {
        let wanted = std::mem::take(&mut self.rest);
        values.iter().find(|value| value.to_string() == wanted).copied().ok_or_else(|| {
            let names: Vec<String> = values.iter().map(ToString::to_string).collect();
            format!("there is no {what} `{wanted}`; there are {}", names.join(", "))
        })
    }

    fn end(&self) -> Result<(), String> {
        match self.rest {
            "" => Ok(()),
            rest => Err(format!("`{rest}` is too much: {}", self.usage)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read() {
        let penalize = |seconds| OperatorCommand::Penalize {
            team: 5,
            player: 2,
            penalty: Penalty::MotionInSet,
            seconds,
        };
        assert_eq!(OperatorCommand::parse(" penalize 5 2  motion in set"), Ok(penalize(None)));
        assert_eq!(OperatorCommand::parse("penalize 5 2 motion in set 30"), Ok(penalize(Some(30))));
        assert_eq!(OperatorCommand::parse("ready"), Ok(OperatorCommand::Ready { team: None }));
        let kind = SetPlay::CornerKick;
        assert_eq!(
            OperatorCommand::parse("set-play 24 corner kick"),
            Ok(OperatorCommand::SetPlay { team: 24, kind })
        );
    }

    #[test]
    fn mistakes_are_answered_with_what_is_right() {
        for (line, reason) in [
            ("reddy", "there is no command `reddy`; there are initial, standby, ready"),
            ("goal", "TEAM is missing: goal TEAM"),
            ("goal blue", "`blue` is not a number from 0 to 255: goal TEAM"),
            ("goal 5 1", "`1` is too much: goal TEAM"),
            ("penalize 5 2 pushin", "there is no penalty `pushin`; there are ball holding, pushing"),
            ("set-play 5 kick", "there is no set play `kick`; there are goal kick"),
            ("", "there is no command ``"),
        ] {
            let refused = OperatorCommand::parse(line).expect_err(line);
            assert!(refused.starts_with(reason), "{line}: {refused}");
        }
        let named = OperatorCommand::help();
        assert!(named.lines().all(|line| line.len() <= 100) && named.lines().count() == 13);
    }
}
