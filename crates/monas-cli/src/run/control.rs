//! The control socket of a run.

use monas::Overview;

use crate::arguments::RunArguments;
use crate::console::Console;
use crate::failure::Failure;

pub(super) use socket::serve;

/// With so many runs of one configuration at a time the last has no socket.
#[cfg(unix)]
const NAMESAKES: u32 = 99;

#[cfg(unix)]
mod socket {
    use std::path::Path;
    use std::sync::Arc;

    use monas_link::control::ControlServer;
    use monas_link::{Error, ErrorKind, default_folder};

    use super::{Console, Failure, NAMESAKES, Overview, RunArguments};

    /// Serves the control socket of a run, unless it is not wanted.
    ///
    /// A socket that was asked for by name has to come up. Without being asked for it comes up where it can: a robot runs without it
    /// too, and the log says why.
    pub(crate) fn serve(
        arguments: &RunArguments,
        overview: Overview,
        console: &mut Console<'_>,
    ) -> Result<Option<ControlServer>, Failure> {
        if arguments.no_control {
            return Ok(None);
        }
        let format = arguments.format.value;
        match (&arguments.control, default_folder()) {
            (Some(name), Some(folder)) => {
                let server = ControlServer::start(&folder, name, Arc::new(overview));
                let server = server.map_err(|error| Failure::failed(format, error))?;
                writeln!(console.err, "control socket: {}", server.path().display())?;
                Ok(Some(server))
            }
            (Some(_), None) => {
                let message = "there is no place for a control socket: XDG_RUNTIME_DIR is not set";
                Err(Failure::failed(format, message))
            }
            (None, Some(folder)) => Ok(by_default(&folder, arguments, overview)),
            (None, None) => {
                tracing::info!("no control socket: XDG_RUNTIME_DIR is not set");
                Ok(None)
            }
        }
    }

    fn by_default(folder: &Path, arguments: &RunArguments, overview: Overview) -> Option<ControlServer> {
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

    /// `match`, or `match-2` if another run has that name.
    fn first_free(folder: &Path, name: &str, overview: Arc<Overview>) -> Result<ControlServer, Error> {
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

    /// The name of a configuration's file, as far as a socket may have it.
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
    use super::{Console, Failure, Overview, RunArguments};

    /// A socket that is never there.
    pub(crate) enum NoSocket {}

    pub(crate) fn serve(
        arguments: &RunArguments,
        _: Overview,
        _: &mut Console<'_>,
    ) -> Result<Option<NoSocket>, Failure> {
        match arguments.control {
            Some(_) => Err(Failure::failed(arguments.format.value, "control sockets are those of Unix")),
            None => Ok(None),
        }
    }
}
