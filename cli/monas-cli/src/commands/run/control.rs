//! The control socket of a run.

use monas::RunHandle;

use super::RunArguments;
use crate::terminal::{CommandFailure, CommandOutput};

pub(crate) use socket::serve;

/// The largest number in names of sockets of one configuration.
#[cfg(unix)]
const NAMESAKES: u32 = 99;

#[cfg(unix)]
mod socket {
    use std::path::Path;
    use std::sync::Arc;

    use monas_link::control::ControlServer;
    use monas_link::{Error, ErrorKind, default_folder};

    use crate::commands::run::control::{CommandFailure, CommandOutput, NAMESAKES, RunArguments, RunHandle};
    use crate::terminal::Format;

    /// Serves the control socket of a run, unless it is disabled.
    ///
    /// A socket that was requested by name must start. A default socket is optional: the run works
    /// without it, and the log gives the reason.
    pub(crate) fn serve(
        arguments: &RunArguments,
        overview: RunHandle,
        console: &mut CommandOutput<'_>,
    ) -> Result<Option<ControlServer>, CommandFailure> {
        if arguments.no_control {
            return Ok(None);
        }
        let format = arguments.format.value;
        match (&arguments.control, default_folder()) {
            (Some(name), Ok(folder)) => {
                let server = ControlServer::start(&folder, name, Arc::new(overview));
                let server = server.map_err(|error| CommandFailure::failed(format, error))?;
                writeln!(console.err, "control socket: {}", server.path().display())?;
                Ok(Some(server))
            }
            (Some(_), Err(error)) => Err(CommandFailure::failed(format, error)),
            (None, Ok(folder)) => {
                let server = by_default(&folder, arguments, overview);
                // Where tools look is known only if the system says so.
                let is_said = std::env::var_os("XDG_RUNTIME_DIR").is_none_or(|folder| folder.is_empty());
                if let Some(server) = server.as_ref().filter(|_| is_said && format == Format::Text) {
                    writeln!(
                        console.err,
                        "control socket: {} (XDG_RUNTIME_DIR is not set)",
                        server.path().display()
                    )?;
                }
                Ok(server)
            }
            (None, Err(error)) => {
                tracing::warn!("no control socket: {error}");
                Ok(None)
            }
        }
    }

    fn by_default(folder: &Path, arguments: &RunArguments, overview: RunHandle) -> Option<ControlServer> {
        match first_free(folder, &name_of(&arguments.config), Arc::new(overview)) {
            Ok(server) => {
                tracing::info!("control socket: {}", server.path().display());
                Some(server)
            }
            Err(error) => {
                tracing::warn!("no control socket: {error}");
                None
            }
        }
    }

    /// Starts `match`, or `match-2` if that name is taken, and so on.
    fn first_free(folder: &Path, name: &str, overview: Arc<RunHandle>) -> Result<ControlServer, Error> {
        let mut started = ControlServer::start(folder, name, overview.clone());
        for number in 2..=NAMESAKES {
            match &started {
                Err(error) if error.kind() == ErrorKind::NameTaken => {
                    started = ControlServer::start(folder, &format!("{name}-{number}"), overview.clone());
                }
                _ => break,
            }
        }
        started
    }

    /// The stem of the configuration's file, reduced to characters allowed in names of sockets.
    fn name_of(config: &Path) -> String {
        let stem = config.file_stem().unwrap_or_default().to_string_lossy();
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' || c == '-' { c } else { '_' };
        match stem.is_empty() {
            true => "run".into(),
            false => stem.chars().map(plain).collect(),
        }
    }
}

#[cfg(not(unix))]
mod socket {
    use crate::commands::run::control::{CommandFailure, CommandOutput, RunArguments, RunHandle};

    /// Control sockets exist only on Unix.
    pub(crate) enum NoSocket {}

    pub(crate) fn serve(
        arguments: &RunArguments,
        _: RunHandle,
        _: &mut CommandOutput<'_>,
    ) -> Result<Option<NoSocket>, CommandFailure> {
        match arguments.control {
            Some(_) => {
                Err(CommandFailure::failed(arguments.format.value, "control sockets exist only on Unix"))
            }
            None => Ok(None),
        }
    }
}
