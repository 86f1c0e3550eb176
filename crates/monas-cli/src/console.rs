//! Where a command writes, and what it may show there.

use std::io::Write;

/// Standard output and standard error as a command sees them.
pub(crate) struct Console<'a> {
    /// Results.
    pub(crate) out: &'a mut dyn Write,
    /// Diagnostics and progress.
    pub(crate) err: &'a mut dyn Write,
    /// Whether a person watches standard error: lines may be drawn over.
    pub(crate) live: bool,
    /// Whether colours are welcome on standard error.
    pub(crate) colour: bool,
}
