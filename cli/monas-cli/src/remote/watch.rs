//! Watches messages of a run as they are published.

use std::time::Duration;

use clap::Args;
use monas::duration;
use monas_link::control::WatchStream;
use monas_link::control::messages::Seen;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Interrupt, WallClock};

use super::connection::{self, failure};
use super::run_selector::RunSelector;

/// The longest wait before the limits are checked.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// When to stop watching.
#[derive(Args, Debug)]
pub(crate) struct WatchLimits {
    /// Stop after this many messages.
    #[arg(long, value_name = "MESSAGES")]
    pub(crate) count: Option<u64>,
    /// Stop after this much time, for example 5s.
    #[arg(long = "for", value_name = "DURATION", value_parser = duration::parse)]
    pub(crate) length: Option<Duration>,
}

/// Passes each published message to `take`, and none at intervals, until a limit is reached, an
/// interrupt, or `take` returns false.
pub(crate) fn watch(
    pattern: &str,
    payload: bool,
    limits: &WatchLimits,
    choice: &RunSelector,
    console: &mut CommandOutput<'_>,
    mut take: impl FnMut(Option<Seen>, &mut CommandOutput<'_>) -> Result<bool, CommandFailure>,
) -> Result<Exit, CommandFailure> {
    let format = choice.format.value;
    let host = choice.host.as_deref().unwrap_or_default();
    let client = connection::client(choice)?;
    let mut watching: WatchStream = client.watch(host, pattern, payload).map_err(failure(format))?;
    let interrupt = Interrupt::for_console(console).map_err(|error| CommandFailure::failed(format, error))?;
    let clock = WallClock::start();
    let mut count = 0;
    while !interrupt.is_requested() {
        let left = limits.length.map(|length| length.saturating_sub(clock.elapsed()));
        if left == Some(Duration::ZERO) || limits.count == Some(count) {
            break;
        }
        let seen =
            watching.wait(left.unwrap_or(CHECK_INTERVAL).min(CHECK_INTERVAL)).map_err(failure(format))?;
        count += u64::from(seen.is_some());
        if !take(seen, console)? {
            break;
        }
    }
    // An interrupt is the usual way to stop watching, not a failure.
    Ok(Exit::Success)
}

#[cfg(test)]
mod tests {
    use clap::{Args, Command, FromArgMatches};

    use super::*;

    #[test]
    fn a_length_has_the_units_of_configurations() {
        let read = |length: &str| {
            let command = WatchLimits::augment_args(Command::new("watch"));
            let matches = command.try_get_matches_from(["watch", "--for", length])?;
            WatchLimits::from_arg_matches(&matches).map(|limits| limits.length)
        };
        assert_eq!(read("1.5h").unwrap(), Some(Duration::from_secs(5400)));
        let refused = read("1.5d").unwrap_err().to_string();
        assert!(refused.contains("`d` is not a unit of time: use ns, us, ms, s, min or h"), "{refused}");
    }
}
