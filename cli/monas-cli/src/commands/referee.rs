//! `monas referee`: a GameController in the terminal, whose decisions a person makes.

use std::collections::{BTreeMap, VecDeque};
use std::io::{self, BufRead, Write};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Duration;

use clap::Args;
use monas::{Timestamp, duration};
use monas_gamecontroller::{
    Connection, ControlSender, Endpoint, GameControlData, OperatedGame, OperatorCommand, RETURN_PORT,
    Received, WhistleDelay,
};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, Interrupt, WallClock};

use super::run::league::RuleBookArgument;

/// Interval at which input, clocks and reports are polled.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// Arguments of `monas referee`.
#[derive(Args, Debug)]
#[command(after_help = format!(
    "Decisions, one per line:\n{}  {:<39}{}\n\n\
     Example: monas referee 127.0.0.1 --teams 1,2",
    OperatorCommand::help(), "wait SECONDS", "reads on after this time, for scripts"
))]
pub(crate) struct RefereeArguments {
    /// The address of the robots, which may be a broadcast address. The port is 3838 if not
    /// given.
    #[arg(value_name = "ADDRESS", default_value = "127.0.0.1")]
    to: Endpoint,
    /// The numbers of the two teams; the first defends the left goal in the first half.
    #[arg(long, value_name = "LEFT,RIGHT", value_parser = teams)]
    teams: Teams,
    /// The players of a team; others are substitutes.
    #[arg(long, value_name = "COUNT", default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..=20))]
    players: u8,
    /// The length of a half.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, default_value = "10min")]
    half: Duration,
    /// The rule book: Standard Platform League (version 18) or Humanoid Soccer League (version 19).
    #[arg(long, value_name = "LEAGUE", value_enum, default_value = "spl")]
    rules: RuleBookArgument,
    /// The delay with which the beginning of play and goals are announced, since robots should hear
    /// the whistle; 15s in the league.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, default_value = "0s")]
    whistle_delay: Duration,
    /// The port for reports of robots.
    #[arg(long, value_name = "PORT", default_value_t = RETURN_PORT)]
    return_port: u16,
}

/// The numbers of the teams.
#[derive(Clone, Copy, Debug)]
struct Teams([u8; 2]);

/// Parses the numbers of the teams.
fn teams(text: &str) -> Result<Teams, String> {
    let numbers = text
        .split_once(',')
        .and_then(|(left, right)| Some((left.trim().parse::<u8>().ok()?, right.trim().parse::<u8>().ok()?)));
    match numbers {
        // In packets the number 255 stands for no team.
        Some((left, right)) if left != right && left.max(right) < 255 => Ok(Teams([left, right])),
        _ => Err("two different numbers from 0 to 254 are expected, such as 1,2".into()),
    }
}

pub(crate) fn execute(
    arguments: &RefereeArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let failed = |message: String| CommandFailure::failed(Format::Text, message);
    let port = arguments.return_port;
    let sender = ControlSender::open(arguments.to, port)
        .map_err(|error| failed(format!("cannot receive reports at port {port}: {error}")))?;
    let interrupt = Interrupt::for_console(console).map_err(|error| failed(error.to_string()))?;
    let rules = arguments.rules.rule_book();
    let game =
        OperatedGame::new(rules, arguments.teams.0, arguments.players, arguments.half, Timestamp::ZERO);
    let mut referee = Referee {
        game,
        sender,
        whistle: WhistleDelay::new(arguments.whistle_delay),
        sent: None,
        is_send_failing: false,
        connections: BTreeMap::new(),
        lines: VecDeque::new(),
        reads_on_at: Duration::ZERO,
        has_failed: false,
    };
    writeln!(console.remarks(), "{rules}, to {}; `help` lists the decisions", arguments.to)?;
    let (input, clock) = (input_lines(), WallClock::start());
    while !interrupt.is_requested() {
        if referee.look(&input, clock.elapsed(), console)? {
            return Ok(if referee.has_failed { Exit::Failure } else { Exit::Success });
        }
        clock.wait_until(clock.elapsed() + CHECK_INTERVAL, &interrupt);
    }
    Ok(interrupt.exit().unwrap_or(Exit::Success))
}

/// The lines of standard input, read by a thread; the channel closes at their end.
#[expect(clippy::disallowed_methods, reason = "reading standard input blocks")]
fn input_lines() -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    receiver
}

/// A running game and its network.
struct Referee {
    game: OperatedGame,
    sender: ControlSender,
    whistle: WhistleDelay,
    /// The state that was sent last.
    sent: Option<GameControlData>,
    /// Whether the last packet could not be sent.
    is_send_failing: bool,
    connections: BTreeMap<(u8, u8), Connection>,
    /// Lines that have been read and wait.
    lines: VecDeque<String>,
    reads_on_at: Duration,
    /// Whether a decision was refused.
    has_failed: bool,
}

impl Referee {
    /// Carries out decisions, sends and receives. Returns whether there are no more decisions.
    fn look(
        &mut self,
        input: &Receiver<String>,
        elapsed: Duration,
        console: &mut CommandOutput<'_>,
    ) -> Result<bool, CommandFailure> {
        let now = Timestamp::ZERO + elapsed;
        self.game.advance(now);
        let has_ended = loop {
            match input.try_recv() {
                Ok(line) => self.lines.push_back(line),
                Err(TryRecvError::Empty) => break false,
                Err(TryRecvError::Disconnected) => break true,
            }
        };
        while elapsed >= self.reads_on_at
            && let Some(line) = self.lines.pop_front()
        {
            if let Err(reason) = self.carry_out(line.trim(), elapsed, console)? {
                self.has_failed = true;
                writeln!(console.err, "error: {reason}")?;
            }
        }
        self.exchange(now, console)?;
        Ok(has_ended && self.lines.is_empty() && elapsed >= self.reads_on_at)
    }

    fn carry_out(
        &mut self,
        line: &str,
        elapsed: Duration,
        console: &mut CommandOutput<'_>,
    ) -> io::Result<Result<(), String>> {
        if line == "help" {
            write!(console.out, "{}", OperatorCommand::help())?;
            return Ok(Ok(()));
        }
        if line.is_empty() {
            return Ok(Ok(()));
        }
        if let Some(seconds) = line.strip_prefix("wait ") {
            let wait = seconds.trim().parse().ok().and_then(|wait| Duration::try_from_secs_f64(wait).ok());
            return Ok(match wait {
                Some(wait) => {
                    self.reads_on_at = elapsed + wait;
                    Ok(())
                }
                None => Err(format!("`{seconds}` is not a number of seconds: wait SECONDS")),
            });
        }
        let decided = OperatorCommand::parse(line).and_then(|command| self.game.decide(command));
        if decided.is_ok() {
            writeln!(console.out, "{}", summary(self.game.data()))?;
        }
        Ok(decided)
    }

    fn exchange(&mut self, now: Timestamp, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
        let shown = self.whistle.shown(self.game.data(), now);
        let has_changed = self.sent.as_ref().is_none_or(|sent| sent.state != shown.state);
        if self.sender.is_due(now) || has_changed {
            // The network may come back, and the game would be lost with this process.
            let sent = self.sender.send(&shown, now);
            let was_failing = std::mem::replace(&mut self.is_send_failing, sent.is_err());
            if let Err(error) = sent
                && !was_failing
            {
                writeln!(console.err, "the decisions cannot be sent: {error}; it is tried again")?;
            }
            self.sent = Some(shown);
        }
        loop {
            match self.sender.receive(now) {
                Ok(None) => break,
                Ok(Some(Received { content: Ok(_), .. })) => {}
                Ok(Some(Received { from, content: Err(error) })) => {
                    writeln!(console.err, "a report of {from} is ignored: {error}")?;
                }
                Err(error) => {
                    writeln!(console.err, "reports cannot be received: {error}")?;
                    break;
                }
            }
        }
        for ((team, player), connection) in self.sender.online().players(now) {
            if self.connections.insert((team, player), connection) != Some(connection) {
                let connection = match connection {
                    Connection::Good => "is online",
                    Connection::Bad => "has a bad connection",
                    Connection::Offline => "is offline",
                };
                writeln!(console.out, "player {player} of team {team} {connection}")?;
            }
        }
        Ok(())
    }
}

/// `READY, 5 1 : 0 24, first half, 9:21 left, kick-off for 24`
fn summary(data: &GameControlData) -> String {
    let [left, right] = &data.teams;
    let half = if data.is_first_half { "first half" } else { "second half" };
    let seconds = data.seconds_left.max(0);
    let stopped = if data.competition.is_stopped() { ", stopped" } else { "" };
    let mut text = format!(
        "{}{stopped}, {} {} : {} {}, {half}, {}:{:02} left",
        data.state.to_string().to_uppercase(),
        left.number,
        left.score,
        right.score,
        right.number,
        seconds / 60,
        seconds % 60
    );
    if let Some(team) = data.kicking_team {
        let what = data.set_play.map_or_else(|| "kick-off".to_owned(), |set_play| set_play.to_string());
        text += &format!(", {what} for {team}");
    }
    for team in &data.teams {
        for (number, player) in (1..).zip(&team.players).take(data.players_per_team.into()) {
            if let Some(penalty) = player.penalty {
                text += &format!(", {number} of {}: {penalty}", team.number);
            }
        }
    }
    text
}
