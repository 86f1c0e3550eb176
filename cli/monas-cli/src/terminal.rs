//! The terminal of a command: output, diagnostics, failures, tables, quantities, interrupts and the
//! wall clock.

mod command_failure;
mod command_output;
pub(crate) mod crash_report;
pub(crate) mod duration;
mod exit;
mod file_output;
mod format;
mod global_arguments;
mod interrupt;
mod process_log;
mod quantity;
mod repaint;
pub(crate) mod report;
pub(crate) mod table;
mod unread_output;
mod wall_clock;

pub(crate) use command_failure::{CommandFailure, failed, project_failure};
pub(crate) use command_output::CommandOutput;
pub use exit::Exit;
pub(crate) use file_output::write_text;
pub(crate) use format::{Format, FormatArgument};
pub(crate) use global_arguments::{GlobalArguments, wanted_colours};
pub(crate) use interrupt::Interrupt;
pub(crate) use process_log::ProcessLog;
pub(crate) use quantity::{counted, grouped, memory, millis, parse_size, seconds, size};
pub(crate) use repaint::Repaint;
pub(crate) use unread_output::UnreadOutput;
pub(crate) use wall_clock::WallClock;
