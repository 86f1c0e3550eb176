//! Delays in documents.

use std::time::Duration;

/// Parses a delay by the rules of CSS2: a number, then `s` or `ms`; `None` if it is not one.
pub(crate) fn delay(text: &str) -> Option<Duration> {
    let text = text.trim();
    let (number, unit) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e6),
        None => (text.strip_suffix('s')?, 1e9),
    };
    let number = number.strip_prefix('+').unwrap_or(number);
    let plain = !number.is_empty()
        && number.bytes().any(|byte| byte.is_ascii_digit())
        && number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    let value: f64 = if plain { number.parse().ok()? } else { return None };
    Some(Duration::from_nanos((value * unit).round() as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_are_numbers_with_units() {
        assert_eq!(delay("500ms"), Some(Duration::from_millis(500)));
        assert_eq!(delay(" .5s "), Some(Duration::from_millis(500)));
        assert_eq!(delay("1.5s"), Some(Duration::from_millis(1500)));
        assert_eq!(delay("0s"), Some(Duration::ZERO));
        for wrong in ["", "5", "s", ".s", "-1s", "1 s", "1m", "1e3s", "1.2.3s"] {
            assert_eq!(delay(wrong), None, "{wrong}");
        }
    }
}
