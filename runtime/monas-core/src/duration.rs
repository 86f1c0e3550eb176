//! Durations as text, in configurations, parameters and options of commands: `600s`, `10min`,
//! `500ms`, `1.5h`.

use std::time::Duration;

/// Units in nanoseconds.
const UNITS: [(&str, u128); 6] = [
    ("ns", 1),
    ("us", 1_000),
    ("ms", 1_000_000),
    ("s", 1_000_000_000),
    ("min", 60_000_000_000),
    ("h", 3_600_000_000_000),
];

/// Parses a duration: a decimal number and `ns`, `us`, `ms`, `s`, `min` or `h`. The result is
/// exact; fractions of a nanosecond are rounded.
///
/// ```
/// # use std::time::Duration;
/// assert_eq!(monas_core::duration::parse("1.5h"), Ok(Duration::from_secs(5400)));
/// ```
///
/// # Errors
/// A sentence for the user.
pub fn parse(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let number_ends = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(number_ends);
    if number.is_empty() {
        return Err(format!("`{text}` is not a duration: it starts with a number, as in `600s`"));
    }
    let worth = worth_of(unit.trim()).ok_or_else(|| wrong_unit(text, unit.trim()))?;
    let nanoseconds =
        nanoseconds(number, worth).ok_or_else(|| format!("`{number}` is not a valid number"))?;
    u64::try_from(nanoseconds)
        .map(Duration::from_nanos)
        .map_err(|_| format!("`{text}` is longer than 584 years"))
}

fn worth_of(unit: &str) -> Option<u128> {
    UNITS.iter().find(|(name, _)| *name == unit).map(|&(_, worth)| worth)
}

fn wrong_unit(text: &str, unit: &str) -> String {
    match unit {
        "" => format!("`{text}` has no unit: write `{text}s` for seconds, or use ms, min, h"),
        _ => format!("`{unit}` is not a unit of time: use ns, us, ms, s, min or h"),
    }
}

/// `number` times `worth`, to the nearest integer, in integer arithmetic: `0.1s` is exactly 100 ms.
fn nanoseconds(number: &str, worth: u128) -> Option<u128> {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    let wholes = if whole.is_empty() { 0 } else { whole.parse::<u64>().ok()? };
    let parts = if fraction.is_empty() { 0 } else { fraction.parse::<u64>().ok()? };
    if whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let scale = 10_u128.checked_pow(u32::try_from(fraction.len()).ok()?)?;
    Some(u128::from(wholes) * worth + (u128::from(parts) * worth + scale / 2) / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_fractions_are_exact() {
        let cases = [
            ("600s", 600_000_000_000),
            ("10min", 600_000_000_000),
            ("500ms", 500_000_000),
            ("0.1s", 100_000_000),
            (".5 s", 500_000_000),
            ("2.h", 7_200_000_000_000),
            ("0s", 0),
            ("3ns", 3),
            ("1.4ns", 1),
            ("0.0000000016s", 2),
            (" 12ms ", 12_000_000),
            ("1.5min", 90_000_000_000),
            ("9007199254740993ns", 9_007_199_254_740_993),
            ("18446744073.709551615s", u64::MAX),
        ];
        for (text, nanoseconds) in cases {
            assert_eq!(parse(text), Ok(Duration::from_nanos(nanoseconds)), "{text}");
        }
    }

    #[test]
    fn mistakes_are_named() {
        let cases = [
            ("600", "write `600s` for seconds"),
            ("ten", "starts with a number"),
            ("", "starts with a number"),
            ("-3s", "starts with a number"),
            ("5m", "`m` is not a unit of time"),
            (".s", "`.` is not a valid number"),
            ("1.2.3s", "`1.2.3` is not a valid number"),
            ("99999999999999999999s", "is not a valid number"),
            ("18446744074s", "584 years"),
        ];
        for (text, expected) in cases {
            let message = parse(text).unwrap_err();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_panics(text in "\\PC*") {
            let _ = parse(&text);
        }

        #[test]
        fn whole_milliseconds_are_read_back(count in 0..=u64::MAX / 1_000_000) {
            proptest::prop_assert_eq!(parse(&format!("{count}ms")), Ok(Duration::from_nanos(count * 1_000_000)));
        }
    }
}
