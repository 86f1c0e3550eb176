//! The clock that agents go by in real time.

use std::time::Duration;

use super::Finding;
use crate::run::{Interrupt, WallClock};

const AREA: &str = "clock";
/// So many waits of a millisecond are measured.
const WAITS: u32 = 10;
/// A wait may end this late.
const LATE: Duration = Duration::from_millis(2);
/// Clocks that are read without asking the system.
const QUICK: [&str; 4] = ["tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page"];

pub(super) fn findings() -> Vec<Finding> {
    let interrupt = Interrupt::default();
    let clock = WallClock::start();
    let mut latest = Duration::ZERO;
    for number in 1..=WAITS {
        let due = Duration::from_millis(number.into());
        clock.wait_until(due, &interrupt);
        latest = latest.max(clock.elapsed().saturating_sub(due));
    }
    let source = std::fs::read_to_string("/sys/devices/system/clocksource/clocksource0/current_clocksource");
    let source = source.ok().map(|name| source_of(name.trim()));
    std::iter::once(lateness(latest)).chain(source).collect()
}

fn lateness(latest: Duration) -> Finding {
    let what = format!("the latest of {WAITS} waits of 1 ms ended {:.2} ms late", latest.as_secs_f64() * 1e3);
    match latest <= LATE {
        true => Finding::well(AREA, what),
        false => {
            Finding::odd(AREA, what, "the computer is busy, or its timers are coarse: cycles begin as late")
        }
    }
}

fn source_of(name: &str) -> Finding {
    let what = format!("the system's clock is `{name}`");
    match QUICK.contains(&name) {
        true => Finding::well(AREA, what),
        false => Finding::odd(AREA, what, "it is slow to read; `tsc` is quick where the processor has it"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::*;

    #[test]
    fn late_waits_and_slow_clocks_are_odd() {
        assert_eq!(lateness(Duration::from_micros(80)).state, State::Well);
        assert_eq!(lateness(Duration::from_millis(3)).state, State::Odd);
        assert_eq!(source_of("tsc").state, State::Well);
        assert_eq!(source_of("hpet").state, State::Odd);
    }
}
