//! The control socket of a run.

use monas::RunHandle;
use monas_studio::{Pace, Studio};
use monas_tape::Tape;

use super::RunArguments;

use monas_terminal::{CommandFailure, CommandOutput};
#[cfg(feature = "soccer")] // only matches name the type
pub(crate) use socket::ControlSocket;
pub(crate) use socket::{bind, serve, view};

/// The largest number in names of sockets of one configuration.
#[cfg(unix)]
const LARGEST_NUMBER: u32 = 99;

/// The name of a run: that of its socket, or the stem of the configuration's file, reduced to
/// characters allowed in names of sockets.
pub(crate) fn name_of(arguments: &RunArguments) -> String {
    let stem = arguments.config.file_stem().unwrap_or_default().to_string_lossy();
    let name = arguments.control.as_deref().unwrap_or(&stem);
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' || c == '-' { c } else { '_' };
    match name.is_empty() {
        true => "run".into(),
        false if name == "-" => "stdin".into(),
        false => name.chars().map(plain).collect(),
    }
}

#[cfg(unix)]
mod socket {
    use std::path::Path;
    use std::sync::Arc;

    use monas_link::control::{ControlServer, ControlTarget};
    use monas_link::{Error, ErrorKind, default_folder, runtime_folder};
    use narukom::{Hub, Timestamp};

    pub(crate) use monas_link::control::ControlSocket;

    use crate::commands::run::control::{
        CommandFailure, CommandOutput, LARGEST_NUMBER, Pace, RunArguments, RunHandle, Studio, Tape, name_of,
    };
    use crate::commands::studio;
    use monas_terminal::Format;

    /// A run with the alarms of its recording.
    struct RecordedRun {
        run: RunHandle,
        tape: Option<Tape>,
    }

    impl ControlTarget for RecordedRun {
        fn hubs(&self) -> &[Hub] {
            self.run.hubs()
        }

        fn now(&self) -> Timestamp {
            self.run.now()
        }

        fn is_simulated(&self) -> bool {
            self.run.is_simulated()
        }

        fn alarms(&self) -> Vec<String> {
            self.tape.iter().filter_map(Tape::failure).collect()
        }

        fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
            self.run.publish(host, path, bytes)
        }

        fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
            ControlTarget::manage(&self.run, inquiry)
        }
    }

    /// Takes the name of a run before it writes any file, unless its control socket is disabled.
    ///
    /// A socket that was requested by name must exist. A default socket is optional: the run works
    /// without it, and the log gives the reason.
    pub(crate) fn bind(
        arguments: &RunArguments,
        console: &mut CommandOutput<'_>,
    ) -> Result<Option<ControlSocket>, CommandFailure> {
        if arguments.no_control {
            return Ok(None);
        }
        let format = arguments.format.value;
        match (&arguments.control, default_folder()) {
            (Some(name), Ok(folder)) => {
                let socket = ControlSocket::bind(&folder, name);
                let socket = socket.map_err(|error| match error.kind() {
                    ErrorKind::NameTaken => {
                        let message = format!("{error}; choose another one with --control, or stop that run");
                        CommandFailure::Failed(format, message)
                    }
                    _ => CommandFailure::failed(format, error),
                })?;
                writeln!(console.remarks(), "control socket: {}", socket.path().display())?;
                Ok(Some(socket))
            }
            (Some(_), Err(error)) => Err(CommandFailure::failed(format, error)),
            (None, Ok(folder)) => {
                let socket = by_default(&folder, arguments);
                // Tools find a default only where the system defines a runtime folder.
                let is_said = runtime_folder().is_none();
                if let Some(socket) = socket.as_ref().filter(|_| is_said && format == Format::Text) {
                    writeln!(
                        console.remarks(),
                        "control socket: {} (XDG_RUNTIME_DIR is not set to an absolute path)",
                        socket.path().display()
                    )?;
                }
                Ok(socket)
            }
            (None, Err(error)) => {
                tracing::warn!("no control socket: {error}");
                Ok(None)
            }
        }
    }

    fn by_default(folder: &Path, arguments: &RunArguments) -> Option<ControlSocket> {
        match first_free(folder, &name_of(arguments)) {
            Ok(socket) => {
                tracing::info!("control socket: {}", socket.path().display());
                Some(socket)
            }
            Err(error) => {
                tracing::warn!("no control socket: {error}");
                None
            }
        }
    }

    /// Takes `match`, or `match-2` if that name is taken, and so on.
    fn first_free(folder: &Path, name: &str) -> Result<ControlSocket, Error> {
        let mut bound = ControlSocket::bind(folder, name);
        for number in 2..=LARGEST_NUMBER {
            match &bound {
                Err(error) if error.kind() == ErrorKind::NameTaken => {
                    bound = ControlSocket::bind(folder, &format!("{name}-{number}"));
                }
                _ => break,
            }
        }
        bound
    }

    /// Serves the control socket of a run.
    pub(crate) fn serve(
        socket: Option<ControlSocket>,
        run: RunHandle,
        tape: Option<Tape>,
        arguments: &RunArguments,
    ) -> Result<Option<ControlServer>, CommandFailure> {
        let served = socket.map(|socket| socket.serve(Arc::new(RecordedRun { run, tape })));
        served.transpose().map_err(|error| CommandFailure::failed(arguments.format.value, error))
    }

    /// Serves the studio of a run, if it is wanted.
    pub(crate) fn view(
        control: Option<&ControlServer>,
        pace: Option<Pace>,
        arguments: &RunArguments,
        console: &mut CommandOutput<'_>,
    ) -> Result<Option<Studio>, CommandFailure> {
        if !arguments.studio {
            return Ok(None);
        }
        let format = arguments.format.value;
        let control = control.ok_or_else(|| {
            CommandFailure::failed(format, "the studio needs the control socket, which cannot be served here")
        })?;
        studio::serve(control.path(), &arguments.listen, pace, format, console).map(Some)
    }
}

#[cfg(not(unix))]
mod socket {
    use crate::commands::run::control::{
        CommandFailure, CommandOutput, Pace, RunArguments, RunHandle, Studio, Tape,
    };

    /// Control sockets exist only on Unix.
    pub(crate) enum ControlSocket {}

    pub(crate) fn bind(
        arguments: &RunArguments,
        _: &mut CommandOutput<'_>,
    ) -> Result<Option<ControlSocket>, CommandFailure> {
        match arguments.control {
            Some(_) => {
                Err(CommandFailure::failed(arguments.format.value, "control sockets exist only on Unix"))
            }
            None => Ok(None),
        }
    }

    pub(crate) fn serve(
        socket: Option<ControlSocket>,
        _: RunHandle,
        _: Option<Tape>,
        _: &RunArguments,
    ) -> Result<Option<ControlSocket>, CommandFailure> {
        Ok(socket)
    }

    /// The studio of a run needs its control socket.
    pub(crate) fn view(
        _: Option<&ControlSocket>,
        _: Option<Pace>,
        _: &RunArguments,
        _: &mut CommandOutput<'_>,
    ) -> Result<Option<Studio>, CommandFailure> {
        Ok(None)
    }
}
