//! Outputs of lines: a file and the console.

use std::fs::File;
use std::io::{self, Write};

use super::lines;
use super::record::Record;
use monas_config::{LogFormat, LogSettings};

/// Writes one or more lines to the console.
pub(crate) type ConsoleWriter = Box<dyn Fn(&[u8]) + Send + Sync>;

/// The outputs of a log. Each write is one system call, so that lines of several threads do not
/// mix.
pub(crate) struct Outputs {
    file: Option<File>,
    console: Option<ConsoleWriter>,
    colour: bool,
    format: LogFormat,
}

/// Lines written together.
#[derive(Default)]
pub(crate) struct OutputBatch {
    file: String,
    console: String,
}

impl Outputs {
    /// Creates the file, replacing an existing one.
    pub(crate) fn open(settings: &LogSettings, console: ConsoleWriter) -> io::Result<Outputs> {
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

    /// Adds a message to the next write.
    pub(crate) fn add(&self, record: &Record, batch: &mut OutputBatch) {
        if self.file.is_some() {
            match self.format {
                LogFormat::Text => lines::text(record, false, &mut batch.file),
                LogFormat::Json => lines::json(record, &mut batch.file),
            }
        }
        if self.console.is_some() {
            lines::text(record, self.colour, &mut batch.console);
        }
    }

    /// Writes the added messages. A failure to write the file is reported on the console.
    pub(crate) fn write(&self, batch: &mut OutputBatch) {
        let OutputBatch { file: lines, console } = batch;
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
