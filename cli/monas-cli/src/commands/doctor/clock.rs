//! Checks of the clock that real-time agents use.

use std::time::Duration;

use monas_terminal::{Interrupt, WallClock};

use super::CheckResult;

const AREA: &str = "clock";
/// The number of waits of 1 ms that are measured.
const MEASURED_WAITS: u32 = 10;
/// The latest acceptable end of a wait.
const MAX_WAIT: Duration = Duration::from_millis(2);
/// Clock sources that are read without a system call.
const FAST_CLOCK_SOURCES: [&str; 4] = ["tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page"];

pub(crate) fn findings() -> Vec<CheckResult> {
    let interrupt = Interrupt::default();
    let clock = WallClock::start();
    let mut latest = Duration::ZERO;
    for number in 1..=MEASURED_WAITS {
        let due = Duration::from_millis(number.into());
        clock.wait_until(due, &interrupt);
        latest = latest.max(clock.elapsed().saturating_sub(due));
    }
    let source = std::fs::read_to_string("/sys/devices/system/clocksource/clocksource0/current_clocksource");
    let source = source.ok().map(|name| source_of(name.trim()));
    std::iter::once(lateness(latest)).chain(source).collect()
}

fn lateness(latest: Duration) -> CheckResult {
    let what = format!(
        "the latest of {MEASURED_WAITS} waits of 1 ms ended {:.2} ms late",
        latest.as_secs_f64() * 1e3
    );
    match latest <= MAX_WAIT {
        true => CheckResult::ok(AREA, what),
        false => CheckResult::warning(
            AREA,
            what,
            "the computer is busy, or its timers are coarse: cycles start that late",
        ),
    }
}

fn source_of(name: &str) -> CheckResult {
    let what = format!("the clock source is `{name}`");
    match FAST_CLOCK_SOURCES.contains(&name) {
        true => CheckResult::ok(AREA, what),
        false => {
            CheckResult::warning(AREA, what, "it is slow to read; `tsc` is fast if the processor has it")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::doctor::CheckStatus;

    #[test]
    fn late_waits_and_slow_clocks_are_odd() {
        assert_eq!(lateness(Duration::from_micros(80)).state, CheckStatus::Ok);
        assert_eq!(lateness(Duration::from_millis(3)).state, CheckStatus::Warning);
        assert_eq!(source_of("tsc").state, CheckStatus::Ok);
        assert_eq!(source_of("hpet").state, CheckStatus::Warning);
    }
}
