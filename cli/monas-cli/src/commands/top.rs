//! `monas top`: monitors the agents of a run and the load of their activities.

mod draw;
mod metrics;
mod sample;

use std::io::{self, IsTerminal};
use std::time::Duration;

use clap::Args;
use monas::duration;
use monas::records::{AgentEntry, Inquiry, Reply};
use monas_link::control::ControlClient;
use monas_link::control::messages::TopicEntry;
use prost::Message;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use crate::remote::{RunSelector, connection, failure, unexpected_reply};
use draw::Screen;
use metrics::Metrics;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, Interrupt, WallClock};

/// The longest wait for a key before the interrupt is checked.
const CHECK_INTERVAL: Duration = Duration::from_millis(50);

/// Arguments of `monas top`.
#[derive(Args, Debug)]
pub(crate) struct TopArguments {
    /// The interval between updates.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, default_value = "1s")]
    every: Duration,
    /// Print one interval and exit, as without a terminal.
    #[arg(long)]
    once: bool,
    #[command(flatten)]
    run: RunSelector,
}

/// The state of a run at one time.
struct RunSample {
    run: String,
    /// Time of the run.
    now: Duration,
    /// Conditions that endanger its results.
    alarms: Vec<String>,
    agents: Vec<AgentEntry>,
    topics: Vec<TopicEntry>,
}

/// Requests samples of a run.
struct RunPoller<'a> {
    client: ControlClient,
    choice: &'a RunSelector,
}

pub(crate) fn execute(
    arguments: &TopArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let TopArguments { every, once, run } = arguments;
    let mut look = RunPoller { client: connection::client(run)?, choice: run };
    let is_watched = console.bars.is_some() && io::stdout().is_terminal();
    if is_watched && !once && run.format.value == Format::Text {
        return watch(*every, &mut look, console);
    }
    let before = look.next_sample()?;
    WallClock::start().wait_until(*every, &Interrupt::default());
    let figures = Metrics::between(&before, &look.next_sample()?);
    match run.format.value {
        Format::Json => sample::objects(&figures).try_for_each(|object| writeln!(console.out, "{object}"))?,
        Format::Text => sample::text(&figures, console.out)?,
    }
    Ok(Exit::Success)
}

impl RunPoller<'_> {
    fn next_sample(&mut self) -> Result<RunSample, CommandFailure> {
        let failed = || failure(self.choice.format.value);
        let host = self.choice.host.clone().unwrap_or_default();
        let inquiry = Inquiry { host: host.clone(), agents: true, ..Inquiry::default() };
        let run = self.client.describe().map_err(failed())?;
        let reply = self.client.manage(inquiry.encode_to_vec()).map_err(failed())?;
        let agents = Reply::decode(reply.as_slice()).ok().and_then(|reply| reply.agents);
        let topics = self.client.topics(&host, "").map_err(failed())?;
        let agents = agents.ok_or_else(|| unexpected_reply(self.choice))?.agents;
        Ok(RunSample {
            run: run.name,
            now: Duration::from_nanos(run.now),
            alarms: run.alarms,
            agents,
            topics,
        })
    }
}

/// Shows a run on the whole terminal until the user quits, or until a signal.
fn watch(
    every: Duration,
    look: &mut RunPoller<'_>,
    console: &CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let interrupt = Interrupt::for_console(console)?;
    let mut before = look.next_sample()?;
    let mut screen = Screen::new(Metrics::between(&before, &before));
    let mut terminal = ratatui::try_init()?;
    let watched = loop {
        match show(&mut terminal, &mut screen, every, &interrupt) {
            Ok(true) => {}
            Ok(false) => break Ok(Exit::Success),
            Err(error) => break Err(error.into()),
        }
        match look.next_sample() {
            Ok(sample) => {
                screen.show(Metrics::between(&before, &sample));
                before = sample;
            }
            Err(failure) => break Err(failure),
        }
    };
    ratatui::try_restore()?;
    watched
}

/// Shows a screen for a time and handles keys meanwhile. Returns false to quit.
fn show(
    terminal: &mut DefaultTerminal,
    screen: &mut Screen,
    length: Duration,
    interrupt: &Interrupt,
) -> io::Result<bool> {
    let clock = WallClock::start();
    loop {
        terminal.draw(|frame| screen.draw(frame))?;
        let mut left = length.saturating_sub(clock.elapsed());
        while !event::poll(left.min(CHECK_INTERVAL))? {
            if interrupt.is_requested() {
                return Ok(false);
            }
            left = length.saturating_sub(clock.elapsed());
            if left.is_zero() {
                return Ok(true);
            }
        }
        if let Event::Key(key) = event::read()?
            && key.kind != KeyEventKind::Release
            && !follow(key, screen)
        {
            return Ok(false);
        }
    }
}

/// Handles a key. Returns false to quit.
fn follow(key: KeyEvent, screen: &mut Screen) -> bool {
    match key.code {
        KeyCode::Char('q') | KeyCode::Esc => return false,
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => return false,
        KeyCode::Down | KeyCode::Char('j') => screen.select_next(),
        KeyCode::Up | KeyCode::Char('k') => screen.select_previous(),
        _ => {}
    }
    true
}
