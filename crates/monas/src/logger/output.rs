//! Where lines go: a file and the console.

use std::fs::File;
use std::io::{self, Write};

use super::lines;
use super::record::Record;
use super::settings::{Format, Settings};

/// What writes to the console, a line or several at a time.
pub(super) type Console = Box<dyn Fn(&[u8]) + Send + Sync>;

/// The outputs of a log. Each write is one call of the system, so that lines of several threads do not mix.
pub(super) struct Outputs {
    file: Option<File>,
    console: Option<Console>,
    colour: bool,
    format: Format,
}

/// Lines that are written together.
#[derive(Default)]
pub(super) struct Batch {
    file: String,
    console: String,
}

impl Outputs {
    /// Makes the file anew.
    pub(super) fn open(settings: &Settings, console: Console) -> io::Result<Outputs> {
        let file = settings.file.as_ref().map(|path| {
            File::create(path)?; // what an earlier run has written goes
            File::options().append(true).open(path)
        });
        Ok(Outputs {
            file: file.transpose()?,
            console: settings.console.then_some(console),
            colour: settings.colour,
            format: settings.format,
        })
    }

    /// Adds a message to what is written next.
    pub(super) fn add(&self, record: &Record, batch: &mut Batch) {
        if self.file.is_some() {
            match self.format {
                Format::Text => lines::text(record, false, &mut batch.file),
                Format::Json => lines::json(record, &mut batch.file),
            }
        }
        if self.console.is_some() {
            lines::text(record, self.colour, &mut batch.console);
        }
    }

    /// Writes what was added. A log that cannot be written has nowhere to say so but the console.
    pub(super) fn write(&self, batch: &mut Batch) {
        let Batch { file: lines, console } = batch;
        if let (Some(file), false) = (&self.file, lines.is_empty())
            && let Err(error) = (&*file).write_all(lines.as_bytes())
        {
            console.push_str(&format!("the log's file cannot be written: {error}\n"));
            if self.console.is_none() {
                let _ = io::stderr().write_all(console.as_bytes());
            }
        }
        if let (Some(write), false) = (&self.console, console.is_empty()) {
            write(console.as_bytes());
        }
        lines.clear();
        console.clear();
    }
}
