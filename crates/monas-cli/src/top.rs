//! `monas top`: what the agents of a run are doing, and which of them takes the time.

mod draw;
mod figures;
mod told;

use std::io::{self, IsTerminal};
use std::time::Duration;

use clap::Args;
use monas::records::{AgentEntry, Inquiry, Reply};
use monas_link::control::ControlClient;
use monas_link::control::messages::TopicEntry;
use prost::Message;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use crate::arguments::Format;
use crate::console::Console;
use crate::duration;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::run::{Interrupt, WallClock};
use crate::topic::arguments::RunChoice;
use crate::topic::connect::{self, failure};

use draw::Screen;
use figures::Figures;
pub(crate) use told::memory;

/// What may be written after `monas top`.
#[derive(Args, Debug)]
pub(crate) struct TopArguments {
    /// How often it looks.
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, default_value = "1s")]
    every: Duration,
    /// Tell it once and end, as when no terminal is there.
    #[arg(long)]
    once: bool,
    #[command(flatten)]
    run: RunChoice,
}

/// What a run says of itself at one time.
struct Sample {
    run: String,
    /// The run's own time.
    now: Duration,
    agents: Vec<AgentEntry>,
    topics: Vec<TopicEntry>,
}

/// Looks at a run.
struct Look<'a> {
    client: ControlClient,
    choice: &'a RunChoice,
}

pub(crate) fn execute(arguments: &TopArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let TopArguments { every, once, run } = arguments;
    let mut look = Look { client: connect::client(run)?, choice: run };
    let is_watched = console.bars.is_some() && io::stdout().is_terminal();
    if is_watched && !once && run.format.value == Format::Text {
        return watch(*every, &mut look);
    }
    let before = look.again()?;
    WallClock::start().wait_until(*every, &Interrupt::default());
    let figures = Figures::between(&before, &look.again()?);
    match run.format.value {
        Format::Json => told::objects(&figures).try_for_each(|object| writeln!(console.out, "{object}"))?,
        Format::Text => told::text(&figures, console.out)?,
    }
    Ok(Exit::Success)
}

impl Look<'_> {
    fn again(&mut self) -> Result<Sample, Failure> {
        let failed = || failure(self.choice.format.value);
        let host = self.choice.host.clone().unwrap_or_default();
        let inquiry = Inquiry { host: host.clone(), agents: true, ..Inquiry::default() };
        let run = self.client.describe().map_err(failed())?;
        let reply = self.client.manage(inquiry.encode_to_vec()).map_err(failed())?;
        let agents = Reply::decode(reply.as_slice()).ok().and_then(|reply| reply.agents);
        let topics = self.client.topics(&host, "").map_err(failed())?;
        let agents = agents.ok_or_else(|| crate::agent::odd(self.choice))?.agents;
        Ok(Sample { run: run.name, now: Duration::from_nanos(run.now), agents, topics })
    }
}

/// Shows it on the whole terminal until somebody has seen enough.
fn watch(every: Duration, look: &mut Look<'_>) -> Result<Exit, Failure> {
    let mut before = look.again()?;
    let mut screen = Screen::new(Figures::between(&before, &before));
    let mut terminal = ratatui::try_init()?;
    let watched = loop {
        match show(&mut terminal, &mut screen, every) {
            Ok(true) => {}
            Ok(false) => break Ok(Exit::Success),
            Err(error) => break Err(error.into()),
        }
        match look.again() {
            Ok(sample) => {
                screen.show(Figures::between(&before, &sample));
                before = sample;
            }
            Err(failure) => break Err(failure),
        }
    };
    ratatui::try_restore()?;
    watched
}

/// Shows a screen for a while and follows the keys meanwhile. Says whether to go on.
fn show(terminal: &mut DefaultTerminal, screen: &mut Screen, length: Duration) -> io::Result<bool> {
    let clock = WallClock::start();
    loop {
        terminal.draw(|frame| screen.draw(frame))?;
        let left = length.saturating_sub(clock.elapsed());
        if !event::poll(left)? {
            return Ok(true);
        }
        if let Event::Key(key) = event::read()?
            && key.kind != KeyEventKind::Release
            && !follow(key, screen)
        {
            return Ok(false);
        }
    }
}

/// Does what a key asks for. Says whether to go on.
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
