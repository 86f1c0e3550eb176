//! `monas studio`: a view of a run in the browser.

#[cfg(feature = "soccer")]
mod soccer_field;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use clap_complete::engine::ArgValueCandidates;
use monas_studio::{ListenAddress, Pace, Scene, Studio, StudioSettings};

use crate::remote::{RunSelector, connection, runs};
use crate::terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, Interrupt, WallClock};

#[derive(Args, Debug)]
pub(crate) struct StudioArguments {
    /// The run, by the name of its control socket; not needed if there is only one.
    #[arg(long, value_name = "NAME", add = ArgValueCandidates::new(runs))]
    run: Option<String>,
    #[command(flatten)]
    listen: ListenArgument,
    #[command(flatten)]
    format: FormatArgument,
}

/// Where a studio listens.
#[derive(Args, Debug, Default)]
pub(crate) struct ListenArgument {
    /// The studio's address, such as 127.0.0.1:8080; 127.0.0.1 with the first free port from 4810
    /// on if not given. At any other address than loopback the page needs a token, which is part of
    /// the printed address; the connection is not encrypted.
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: Option<ListenAddress>,
}

impl ListenArgument {
    pub(crate) fn is_given(&self) -> bool {
        self.listen.is_some()
    }
}

/// Serves the studio of a run until Ctrl-C.
pub(crate) fn execute(
    arguments: &StudioArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let selector = RunSelector::of(arguments.run.clone(), None, arguments.format);
    let socket = connection::socket(&selector)?;
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let _studio = serve(&socket, &arguments.listen, None, format, console)?;
    WallClock::start().wait_until(Duration::MAX, &interrupt);
    // An interrupt is the usual way to stop, not a failure.
    Ok(Exit::Success)
}

/// Serves the studio of the run with a control socket, and prints its address.
pub(crate) fn serve(
    socket: &Path,
    listen: &ListenArgument,
    pace: Option<Pace>,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Studio, CommandFailure> {
    let settings = StudioSettings { listen: listen.listen, scene: scene(), pace };
    let studio = Studio::of_run(socket, settings).map_err(|error| CommandFailure::failed(format, error))?;
    writeln!(console.err, "studio: {}", studio.url())?;
    console.err.flush()?;
    Ok(studio)
}

/// What this program draws from above.
#[cfg(feature = "soccer")]
fn scene() -> Option<Arc<dyn Scene>> {
    Some(Arc::new(soccer_field::SoccerField))
}

#[cfg(not(feature = "soccer"))]
fn scene() -> Option<Arc<dyn Scene>> {
    None
}
