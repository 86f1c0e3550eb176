//! Terminal output of the commands of `monas`: results, diagnostics, failures, tables.
//!
//! A command receives a [`CommandOutput`]: the writers of its results and of its diagnostics, and
//! what they are capable of (colours, progress bars). It returns an [`Exit`], or a
//! [`CommandFailure`] that knows its report and its exit status. This is the only crate that
//! renders a [`yase::Diagnostic`] ([`report`]) or handles Ctrl-C ([`Interrupt`]), so that all
//! commands look and end alike. It is a separate crate, since it depends on no command.
//!
//! Commands write to the given writers instead of the streams of the process, so that tests read
//! what a user would see:
//!
//! ```
//! use monas_terminal::{CommandFailure, CommandOutput, Exit, Format};
//!
//! fn command(console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
//!     let rows = [["Vision".to_owned(), monas_terminal::grouped(12_345)]];
//!     writeln!(console.out, "{}", monas_terminal::table::of_numbers(["agent", "cycles"], 1, rows))?;
//!     Err(CommandFailure::failed(Format::Text, "no room"))
//! }
//!
//! let (mut out, mut err) = (Vec::new(), Vec::new());
//! let mut console = CommandOutput::plain(&mut out, &mut err);
//! let exit = command(&mut console).unwrap_or_else(|failure| failure.report(&mut console));
//! assert_eq!(exit.code(), 1);
//! assert_eq!(String::from_utf8(out)?, "agent   cycles\n──────────────\nVision  12,345\n");
//! assert_eq!(String::from_utf8(err)?, "error: no room\n");
//! # Ok::<(), std::string::FromUtf8Error>(())
//! ```

mod command_failure;
mod command_output;
mod exit;
mod file_output;
mod format;
mod global_arguments;
mod interrupt;
mod process_log;
mod quantity;
mod repaint;
pub mod report;
pub mod table;
mod unread_output;
mod wall_clock;

pub use command_failure::{CommandFailure, failed};
pub use command_output::CommandOutput;
pub use exit::Exit;
pub use file_output::{check_distinct, output_file, write_drawing, write_text};
pub use format::{Format, FormatArgument};
pub use global_arguments::{GlobalArguments, wanted_colours};
pub use interrupt::Interrupt;
pub use process_log::ProcessLog;
pub use quantity::{counted, grouped, memory, millis, parse_size, seconds, size};
pub use repaint::Repaint;
pub use unread_output::UnreadOutput;
pub use wall_clock::WallClock;
