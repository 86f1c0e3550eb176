//! `monas studio`: a view of a run or of a tape in the browser.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use clap::{Args, ValueHint};
use clap_complete::engine::ArgValueCandidates;
use monas::{Registry, Timestamp};
use monas_studio::{
    AsemeLanguage, ListenAddress, ModelWorkspace, Pace, Scene, SceneEvent, Studio, StudioSettings, TapeRun,
};
use monas_tape::Recording;
use monas_terminal::{
    CommandFailure, CommandOutput, Exit, Format, FormatArgument, Interrupt, WallClock, failed, report,
};

use super::model::program;
use crate::input::recorded_charts;
use crate::remote::{RunSelector, connection, runs};

#[derive(Args, Debug)]
pub(crate) struct StudioArguments {
    /// Open this tape, at any moment of the run; without it, view a run on this computer.
    #[arg(value_hint = ValueHint::FilePath)]
    tape: Option<PathBuf>,
    /// Show this tape beside the other, on its timeline: another future of `monas tape what-if`.
    #[arg(long, value_name = "TAPE", requires = "tape", value_hint = ValueHint::FilePath)]
    beside: Option<PathBuf>,
    /// The run, by the name of its control socket; not needed if there is only one.
    #[arg(long, value_name = "NAME", conflicts_with = "tape", add = ArgValueCandidates::new(runs))]
    run: Option<String>,
    #[command(flatten)]
    listen: ListenArgument,
    #[command(flatten)]
    format: FormatArgument,
}

/// The address on which a studio listens.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct ListenArgument {
    /// The studio's address, such as 127.0.0.1:8080; 127.0.0.1 with the first free port from 4810
    /// on if not given. At any other address than loopback the page needs a token, which is part of
    /// the printed address; the connection is not encrypted.
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: Option<ListenAddress>,
    /// Let pages of this origin read the topics of the run by Foxglove's protocol, for example
    /// https://app.foxglove.dev. May be given several times.
    #[arg(long = "allow-origin", value_name = "ORIGIN")]
    origins: Vec<String>,
    /// Let pages change the run, as `monas agent`, `monas topic pub` and `monas chart raise` do:
    /// agents, activities, models, messages, events, and the referee of a match. Without it they
    /// are read-only.
    #[arg(long)]
    allow_control: bool,
    /// Let pages edit this model, or the models in this folder: as text, in the drawing of its
    /// chart, and in forms. May be given several times. Pages of other computers can save only with
    /// --allow-control.
    #[arg(long = "edit", value_name = "PATH", value_hint = ValueHint::AnyPath)]
    models: Vec<PathBuf>,
}

impl ListenArgument {
    fn settings(&self, format: Format) -> Result<StudioSettings, CommandFailure> {
        let ListenArgument { listen, origins, allow_control, models } = self.clone();
        let models = (!models.is_empty()).then(|| workspace(&models, format)).transpose()?;
        Ok(StudioSettings {
            listen,
            origins,
            allows_control: allow_control,
            models,
            ..StudioSettings::default()
        })
    }

    pub(crate) fn is_given(&self) -> bool {
        self.listen.is_some() || !self.origins.is_empty() || self.allow_control || !self.models.is_empty()
    }

    /// For the studio of a tape.
    pub(crate) fn require_no_control(&self) -> Result<(), CommandFailure> {
        match self.allow_control {
            true => {
                Err(CommandFailure::Usage("--allow-control is for a run; a tape cannot be changed".into()))
            }
            false => Ok(()),
        }
    }
}

impl StudioArguments {
    /// Whether models are edited and no run was requested.
    fn is_without_run(&self) -> bool {
        !self.listen.models.is_empty() && self.run.is_none() && !self.listen.allow_control
    }
}

/// Serves the studio of a run until Ctrl-C.
pub(crate) fn execute(
    arguments: &StudioArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let _studio = match &arguments.tape {
        Some(tape) => {
            arguments.listen.require_no_control()?;
            let tape = open_tape(tape, format, console)?;
            serve_tape(tape, arguments.beside.as_deref(), &arguments.listen, format, console)?
        }
        None if arguments.is_without_run() => serve_models(&arguments.listen, format, console)?,
        None => {
            let selector = RunSelector::of(arguments.run.clone(), None, arguments.format);
            serve(&connection::socket(&selector)?, &arguments.listen, None, format, console)?
        }
    };
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
    let settings = StudioSettings { scene: scene(), pace, ..listen.settings(format)? };
    let studio = Studio::of_run(socket, settings).map_err(|error| CommandFailure::failed(format, error))?;
    announce(studio, console)
}

/// The models at paths, with the names of this program.
fn workspace(paths: &[PathBuf], format: Format) -> Result<Arc<ModelWorkspace>, CommandFailure> {
    let functionality = |name: &str| program::functionality(&Registry::linked(), name);
    let language = AsemeLanguage::new(program::linked()?, functionality);
    ModelWorkspace::new(paths, Arc::new(language)).map(Arc::new).map_err(failed(format))
}

/// Serves models without a run.
fn serve_models(
    listen: &ListenArgument,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Studio, CommandFailure> {
    let studio = Studio::of_models(listen.settings(format)?);
    announce(studio.map_err(|error| CommandFailure::failed(format, error))?, console)
}

fn announce(studio: Studio, console: &mut CommandOutput<'_>) -> Result<Studio, CommandFailure> {
    writeln!(console.err, "studio: {}", studio.url())?;
    console.err.flush()?;
    Ok(studio)
}

/// Serves the studio of a replayed tape with marks at the differences, until Ctrl-C.
pub(crate) fn view_replay(
    tape: &Path,
    differences: Vec<(Timestamp, SceneEvent)>,
    listen: &ListenArgument,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let mut tape = open_tape(tape, format, console)?;
    tape.mark(differences);
    let _studio = serve_tape(tape, None, listen, format, console)?;
    WallClock::start().wait_until(Duration::MAX, &interrupt);
    Ok(())
}

/// Serves the studio of a tape, or of two, and prints its address.
fn serve_tape(
    tape: TapeRun,
    beside: Option<&Path>,
    listen: &ListenArgument,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Studio, CommandFailure> {
    let settings = listen.settings(format)?;
    let studio = match beside {
        None => Studio::of_tape(tape, settings),
        Some(other) => Studio::of_tapes(tape, open_tape(other, format, console)?, settings),
    };
    announce(studio.map_err(|error| CommandFailure::failed(format, error))?, console)
}

/// Reads a tape. Charts are those of the recorded configuration; without it, all but their drawings
/// is shown, and the reason is printed.
fn open_tape(
    tape: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<TapeRun, CommandFailure> {
    let recording = Recording::open(tape).map_err(failed(format))?;
    let charts = match recorded_charts(&recording, format) {
        Ok(charts) => charts,
        Err(failure) => {
            failure.report(console);
            report::note(
                console,
                format,
                "charts are not drawn, since the tape's configuration cannot be used",
            )?;
            Vec::new()
        }
    };
    let name = tape.file_name().unwrap_or_default().to_string_lossy();
    let tape = TapeRun::new(&name, recording, &charts, scene());
    tape.map_err(|error| CommandFailure::failed(format, error))
}

/// The view from above that this program offers.
#[cfg(feature = "soccer")]
pub(crate) fn scene() -> Option<Arc<dyn Scene>> {
    Some(Arc::new(monas_scene::SoccerField))
}

#[cfg(not(feature = "soccer"))]
fn scene() -> Option<Arc<dyn Scene>> {
    None
}
