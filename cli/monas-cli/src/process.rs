//! Global state of the process: streams, log and panic hook.

use std::io::{self, IsTerminal};
use std::panic;

use clap::CommandFactory;
use clap_complete::CompleteEnv;
use indicatif::MultiProgress;
use monas_terminal::{CommandOutput, Exit, ProcessLog, UnreadOutput};

use crate::arguments::Arguments;
use crate::crash_report;
#[cfg(target_os = "linux")]
use crate::crash_report::CrashReport;
use crate::delegate;
use crate::dispatch::dispatch;

/// Executes the command as this process.
pub(crate) fn main() -> Exit {
    // Answers a shell's request for completions and exits.
    CompleteEnv::with_factory(Arguments::command).complete();
    let bars = MultiProgress::new();
    let log = ProcessLog::begin(&bars);
    if let Some(exit) = delegate::delegate() {
        log.iter().for_each(|log| log.end());
        return exit;
    }
    #[cfg(target_os = "linux")]
    let _crashes = CrashReport::install();
    #[cfg(target_os = "linux")]
    report_full_files_as_errors();
    // The caller decides how to handle a panic; the log has its location.
    panic::set_hook(Box::new(|panic| tracing::error!("{panic}")));
    let (mut out, mut stderr) = (io::stdout(), io::stderr());
    let colours_are_welcome = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let (reads_bars, reads_colours) = (stderr.is_terminal(), colours_are_welcome && stderr.is_terminal());
    let mut err = UnreadOutput(&mut stderr);
    let mut console = CommandOutput {
        colour_out: colours_are_welcome && out.is_terminal(),
        colour_err: reads_colours,
        bars: reads_bars.then_some(bars),
        catches_signals: true,
        log: log.clone(),
        quiet: false,
        codes: reads_bars.then(Default::default),
        out: &mut out,
        err: &mut err,
    };
    let exit = dispatch(std::env::args_os(), &mut console);
    log.iter().for_each(|log| log.end());
    crash_report::end();
    exit
}

/// Lets writes beyond the limit on the size of files (`ulimit -f`) fail like those to a full disk,
/// instead of ending the process.
#[cfg(target_os = "linux")]
fn report_full_files_as_errors() {
    if let Err(error) = signal_hook::flag::register(libc::SIGXFSZ, Default::default()) {
        tracing::warn!("a limit on the size of files will end the process: {error}");
    }
}
