//! How the command ends.

use std::process::ExitCode;

/// What the exit code of the process says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Exit {
    /// 0: it did what was asked.
    Success,
    /// 1: it ran, and failed.
    Failure,
    /// 2: the command line was not understood.
    Usage,
    /// 3: a configuration or a model is invalid; nothing ran.
    Invalid,
    /// 4: what it is to connect to is not there.
    Unreachable,
    /// 5: a property that was to be checked does not hold: a replay differs from its recording, a check of a model finds an error.
    Diverged,
    /// 130: it was interrupted.
    Interrupted,
}

impl Exit {
    /// The number that the process ends with.
    pub const fn code(self) -> u8 {
        match self {
            Exit::Success => 0,
            Exit::Failure => 1,
            Exit::Usage => 2,
            Exit::Invalid => 3,
            Exit::Unreachable => 4,
            Exit::Diverged => 5,
            Exit::Interrupted => 130,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit.code())
    }
}
