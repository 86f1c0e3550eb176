//! `monas tape`: recordings looked at, mended, cut, merged, written as text, and replayed.

pub(crate) mod arguments;
mod edit;
mod export;
mod info;
mod replay;
mod select;
mod text;

use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

use arguments::{ReplayArguments, TapeCommand};
pub(crate) use replay::recorded_hosts;

pub(crate) fn execute(command: &TapeCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        TapeCommand::Info { file, format } => info::execute(file, format.value, console),
        TapeCommand::Export(arguments) => export::execute(arguments, console),
        TapeCommand::Recover { file, output, format } => {
            edit::recover(file, output.as_deref(), format.value, console)
        }
        TapeCommand::Replay(arguments) => replay::execute(arguments, console),
        TapeCommand::Verify { file, format } => {
            let (agents, config) = (Vec::new(), None);
            let (file, format) = (file.clone(), *format);
            replay::execute(&ReplayArguments { file, agents, verify: true, config, format }, console)
        }
        TapeCommand::Cut(arguments) => edit::cut(arguments, console),
        TapeCommand::Merge { files, output, format } => edit::merge(files, output, format.value, console),
    }
}

/// An error of the tape below, told as the command tells its errors.
pub(crate) fn failed(format: Format) -> impl Fn(monas_tape::Error) -> Failure {
    move |error| Failure::failed(format, error)
}

/// `1 message`, `12,345 messages`.
fn counted(count: u64, word: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{} {word}{plural}", grouped(count))
}

/// A number with a comma between thousands.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// `12.3 MB`
fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_for_people() {
        assert_eq!(counted(1, "message"), "1 message");
        assert_eq!(counted(0, "message"), "0 messages");
        assert_eq!([grouped(999), grouped(1_000), grouped(1_234_567)], ["999", "1,000", "1,234,567"]);
        assert_eq!([size(999), size(1_000), size(12_340_000)], ["999 B", "1.0 kB", "12.3 MB"]);
    }
}
