//! Settings of a log: the thesis's Listing 4.5.

use std::path::{Path, PathBuf};

use yase::Diagnostic;

use crate::severity::Severity;
use crate::{Element, ElementRule, Grammar, Kind, Layers, resolve};

/// Outputs and filters of the log.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LogSettings {
    /// The file. If it exists, the log takes the next free name.
    pub file: Option<PathBuf>,
    /// Whether to write to the console.
    pub console: bool,
    /// Whether console output has colours.
    pub colour: bool,
    /// The activities and agents whose messages are written; default all.
    pub filter: Option<Vec<String>>,
    /// The minimum severity. Errors are always written.
    pub verbosity: Severity,
    /// The format of the file.
    pub format: LogFormat,
}

/// Format of a log file.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum LogFormat {
    /// Text lines.
    #[default]
    Text,
    /// One JSON object per line.
    Json,
}

impl Default for LogSettings {
    /// Severity `Info`, no outputs.
    fn default() -> LogSettings {
        LogSettings {
            file: None,
            console: false,
            colour: false,
            filter: None,
            verbosity: Severity::Info,
            format: LogFormat::Text,
        }
    }
}

impl LogSettings {
    /// Reads a file, in XML as in Listing 4.5 or in TOML, with its diagnostics.
    pub fn load(path: impl AsRef<Path>) -> (LogSettings, Vec<Diagnostic>) {
        let resolved = resolve(path.as_ref(), &LogSettings::grammar(), &Layers::new());
        let settings = LogSettings::of(&resolved.elements);
        (settings, resolved.into_diagnostics())
    }

    /// The grammar of such a file.
    pub fn grammar() -> Grammar {
        let flag = |name, doc| ElementRule::new(name, doc).text(name, Kind::Flag);
        let verbosity = Kind::whole_in(i64::from(i32::MIN), 4);
        Grammar::default()
            .root(
                ElementRule::new("message_log_file", "the file of the log")
                    .text("message_log_file", Kind::Text),
            )
            .root(flag("message_log_cerr", "whether to log to the console too"))
            .root(flag("message_log_cerr_color", "whether the console has colours"))
            .root(
                ElementRule::new("message_log_filter", "the activities and agents to log, or `all`")
                    .text("message_log_filter", Kind::List),
            )
            .root(
                ElementRule::new(
                    "log_file_verbosity_level",
                    "0 fatal errors, 1 errors, 2 info, 3 extra info, 4 all",
                )
                .text("log_file_verbosity_level", verbosity),
            )
            .root(
                ElementRule::new("message_log_format", "the format of lines in the file")
                    .text("message_log_format", Kind::Word(vec!["text", "json"])),
            )
    }

    /// The last of several elements with the same name counts.
    fn of(elements: &[Element]) -> LogSettings {
        let text = |name: &str| {
            elements.iter().rev().find(|element| element.is(name)).map(|element| element.text().trim())
        };
        let is_on = |name| matches!(text(name), Some("1" | "true"));
        let file = text("message_log_file").filter(|path| !path.is_empty());
        let filter = text("message_log_filter").map(|names| names.split([' ', ',', '\n', '\t']));
        let filter: Option<Vec<String>> =
            filter.map(|names| names.filter(|name| !name.is_empty()).map(str::to_owned).collect());
        let verbosity = text("log_file_verbosity_level").and_then(|number| number.parse::<i32>().ok());
        LogSettings {
            file: file.map(PathBuf::from),
            console: is_on("message_log_cerr"),
            colour: is_on("message_log_cerr_color"),
            filter: filter.filter(|names| !names.iter().any(|name| name == "all")),
            verbosity: verbosity.map_or(Severity::Info, least_grave),
            format: if text("message_log_format") == Some("json") {
                LogFormat::Json
            } else {
                LogFormat::Text
            },
        }
    }

    /// Whether messages of the agent or activity are written.
    pub fn wants_of(&self, agent: &str, activity: &str) -> bool {
        self.filter.as_ref().is_none_or(|names| names.iter().any(|name| name == agent || name == activity))
    }
}

/// The severity for a number of the thesis; negative numbers count as 0.
fn least_grave(number: i32) -> Severity {
    match number {
        ..=0 => Severity::FatalError,
        1 => Severity::Error,
        2 => Severity::Info,
        3 => Severity::ExtraInfo,
        4.. => Severity::ExtraExtraInfo,
    }
}
