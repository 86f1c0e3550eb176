//! Exit status of the command.

use std::process::ExitCode;

/// The exit status of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Exit {
    /// 0: success.
    Success,
    /// 1: the command ran, and failed.
    Failure,
    /// 2: the command line is invalid.
    Usage,
    /// 3: a configuration or a model is invalid; nothing ran.
    Invalid,
    /// 4: the peer of a connection does not answer.
    Unreachable,
    /// 5: a check does not hold: a replay differs from its recording, or a check of a model finds
    /// an error.
    Diverged,
    /// 128 and the number of the signal that ended the run: 130 for Ctrl-C, 143 for SIGTERM.
    Interrupted(u8),
}

impl Exit {
    /// The exit code of the process.
    pub const fn code(self) -> u8 {
        match self {
            Exit::Success => 0,
            Exit::Failure => 1,
            Exit::Usage => 2,
            Exit::Invalid => 3,
            Exit::Unreachable => 4,
            Exit::Diverged => 5,
            Exit::Interrupted(signal) => 128 | signal,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit.code())
    }
}
