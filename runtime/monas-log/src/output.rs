//! Outputs of lines: a file and the console.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use monas_files::{ExclusiveFile, ExistingFile};

use super::lines;
use super::record::Record;
use monas_config::{LogFormat, LogSettings};

/// Writes one or more lines to the console.
pub(crate) type ConsoleWriter = Box<dyn Fn(&[u8]) + Send + Sync>;

/// The outputs of a log. Each write is one system call, so that lines of several threads do not
/// mix.
pub(crate) struct Outputs {
    file: Option<ExclusiveFile>,
    console: Option<ConsoleWriter>,
    colour: bool,
    format: LogFormat,
    /// The lines since the file could not be written any more; 0 while it can.
    missing: AtomicU64,
}

/// Lines written together.
#[derive(Default)]
pub(crate) struct OutputBatch {
    file: String,
    console: String,
}

impl Outputs {
    /// Creates the file.
    pub(crate) fn open(
        settings: &LogSettings,
        existing: ExistingFile,
        console: ConsoleWriter,
    ) -> io::Result<Outputs> {
        let file = settings.file.as_ref().map(|path| ExclusiveFile::create(path, existing));
        Ok(Outputs {
            file: file.transpose()?,
            console: settings.console.then_some(console),
            colour: settings.colour,
            format: settings.format,
            missing: AtomicU64::new(0),
        })
    }

    /// The path of the file.
    pub(crate) fn path(&self) -> Option<&Path> {
        self.file.as_ref().map(ExclusiveFile::path)
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

    /// Writes the added messages. The console reports once that the file cannot be written, and the
    /// file how many lines are missing as soon as it can be written again.
    pub(crate) fn write(&self, batch: &mut OutputBatch) {
        let OutputBatch { file: lines, console } = batch;
        if let (Some(file), false) = (&self.file, lines.is_empty())
            && let Err(error) = self.write_file(file, lines)
        {
            let count = lines.lines().count() as u64;
            if self.missing.fetch_add(count, Ordering::Relaxed) == 0 {
                let path = file.path().display();
                let alarm =
                    format!("the log {path} cannot be written: {error}; the run goes on without it\n");
                console.push_str(&alarm);
                if self.console.is_none() {
                    // If standard error is closed there is nowhere to report that.
                    let _ = io::stderr().write_all(alarm.as_bytes());
                }
            }
        }
        if let (Some(write), false) = (&self.console, console.is_empty()) {
            write(console.as_bytes());
        }
        lines.clear();
        console.clear();
    }

    fn write_file(&self, file: &ExclusiveFile, lines: &str) -> io::Result<()> {
        let missing = self.missing.load(Ordering::Relaxed);
        if missing > 0 {
            let mut gap = String::from("\n"); // a line may have been cut
            let text = format_args!("{missing} lines are missing here: the file could not be written");
            match self.format {
                LogFormat::Text => lines::text(&Record::of_logger(text), false, &mut gap),
                LogFormat::Json => lines::json(&Record::of_logger(text), &mut gap),
            }
            file.file().write_all(gap.as_bytes())?;
            self.missing.store(0, Ordering::Relaxed);
        }
        file.file().write_all(lines.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_reported_once() {
        use std::sync::{Arc, Mutex};

        let reported = Arc::new(Mutex::new(String::new()));
        let console = reported.clone();
        let settings =
            LogSettings { file: Some("/dev/full".into()), console: true, ..LogSettings::default() };
        let write = move |lines: &[u8]| console.lock().unwrap().push_str(&String::from_utf8_lossy(lines));
        let outputs = Outputs::open(&settings, ExistingFile::Keep, Box::new(write)).unwrap();
        let mut batch = OutputBatch::default();
        for number in 0..3 {
            outputs.add(&Record::of_logger(format_args!("line {number}")), &mut batch);
            outputs.write(&mut batch);
        }
        let reported = reported.lock().unwrap();
        let alarms = reported.lines().filter(|line| line.contains("/dev/full cannot be written")).count();
        assert_eq!((alarms, outputs.missing.load(Ordering::Relaxed)), (1, 3), "{reported}");
    }
}
