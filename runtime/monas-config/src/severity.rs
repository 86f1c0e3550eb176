//! Severities of log messages.

/// Severity of a message, in the thesis's words; the most severe first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Severity {
    /// The process does not survive it, or not in a usable state.
    FatalError,
    /// An error.
    Error,
    /// A possible error. Not in the thesis; filtered like [`Info`](Severity::Info).
    Warning,
    /// Information.
    Info,
    /// Information for debugging.
    ExtraInfo,
    /// All other messages.
    ExtraExtraInfo,
}

impl Severity {
    /// The number in the thesis, 0 (most severe) to 4.
    pub const fn number(self) -> u8 {
        match self {
            Severity::FatalError => 0,
            Severity::Error => 1,
            Severity::Warning | Severity::Info => 2,
            Severity::ExtraInfo => 3,
            Severity::ExtraExtraInfo => 4,
        }
    }

    /// Its word in a line.
    pub const fn name(self) -> &'static str {
        match self {
            Severity::FatalError => "FATAL",
            Severity::Error => "ERROR",
            Severity::Warning => "WARN",
            Severity::Info => "INFO",
            Severity::ExtraInfo => "DEBUG",
            Severity::ExtraExtraInfo => "TRACE",
        }
    }

    /// Whether it is written regardless of the settings and before the call returns.
    pub const fn is_urgent(self) -> bool {
        matches!(self, Severity::FatalError | Severity::Error)
    }
}
