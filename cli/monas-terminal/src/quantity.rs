//! Times, sizes and counts as text.

/// A time in seconds, written in milliseconds; `-` if it was not measured.
pub fn millis(seconds: Option<f64>) -> String {
    seconds.map_or_else(|| "-".into(), |seconds| format!("{:.3} ms", seconds * 1e3))
}

/// Nanoseconds as seconds.
pub fn seconds(nanos: u64) -> f64 {
    nanos as f64 / 1e9
}

/// A size of memory; `-` if it was not measured.
pub fn memory(held: Option<u64>) -> String {
    match held {
        None => "-".into(),
        Some(bytes) if bytes < 10 * 1024 => format!("{bytes} B"),
        Some(bytes) if bytes < 10 * 1024 * 1024 => format!("{} KiB", bytes / 1024),
        Some(bytes) => format!("{} MiB", bytes / (1024 * 1024)),
    }
}

/// The size of a file: `12.3 MB`.
pub fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

/// Parses a size as [`size`] writes it: `500MB`.
pub fn parse_size(text: &str) -> Result<u64, String> {
    let number_ends = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let (number, unit) = text.split_at(number_ends);
    let worth = match unit.trim() {
        "B" => 1,
        "kB" => 1_000,
        "MB" => 1_000_000,
        "GB" => 1_000_000_000,
        unit => return Err(format!("`{unit}` is not a unit of size: use B, kB, MB or GB, as in `500MB`")),
    };
    let number: u64 = number.parse().map_err(|_| format!("`{text}` does not start with a whole number"))?;
    number.checked_mul(worth).ok_or_else(|| format!("`{text}` is too large"))
}

/// `1 message`, `12,345 messages`.
pub fn counted(count: u64, word: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{} {word}{plural}", grouped(count))
}

/// A number with a comma between thousands.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_sizes_are_readable() {
        assert_eq!(counted(1, "message"), "1 message");
        assert_eq!(counted(0, "message"), "0 messages");
        assert_eq!([grouped(999), grouped(1_000), grouped(1_234_567)], ["999", "1,000", "1,234,567"]);
        assert_eq!([parse_size("12 kB"), parse_size("4GB")], [Ok(12_000), Ok(4_000_000_000)]);
        for wrong in ["", "5", "MB", "1.5GB", "5MiB", "99999999999GB"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
        assert_eq!([size(999), size(1_000), size(12_340_000)], ["999 B", "1.0 kB", "12.3 MB"]);
    }
}
