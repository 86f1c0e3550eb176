//! What a log is wanted: the thesis's Listing 4.5.

use std::path::{Path, PathBuf};

use yase::Diagnostic;

use super::record::Severity;
use crate::config::{Element, ElementRule, Grammar, Kind, Layers, resolve};

/// What is written, and where.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Settings {
    /// The file; it is begun anew.
    pub file: Option<PathBuf>,
    /// Whether the console shows it too.
    pub console: bool,
    /// Whether the console has colours.
    pub colour: bool,
    /// The activities and agents whose messages are wanted; all, if it is not said.
    pub filter: Option<Vec<String>>,
    /// The least grave of what is wanted. Errors are always written.
    pub verbosity: Severity,
    /// How lines of the file look.
    pub format: Format,
}

/// How lines of a log's file look.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// A JSON object a line.
    Json,
}

impl Default for Settings {
    /// Everything that is worth knowing, nowhere.
    fn default() -> Settings {
        Settings {
            file: None,
            console: false,
            colour: false,
            filter: None,
            verbosity: Severity::Info,
            format: Format::Text,
        }
    }
}

impl Settings {
    /// Reads a file, in XML as Listing 4.5 or in TOML, with everything that is wrong with it.
    pub fn load(path: impl AsRef<Path>) -> (Settings, Vec<Diagnostic>) {
        let resolved = resolve(path.as_ref(), &Settings::grammar(), &Layers::new());
        let settings = Settings::of(&resolved.elements);
        (settings, resolved.into_diagnostics())
    }

    /// What may stand in such a file.
    pub fn grammar() -> Grammar {
        let flag = |name, doc| ElementRule::new(name, doc).text(name, Kind::Flag);
        let verbosity = Kind::whole_in(i64::from(i32::MIN), 4);
        Grammar::default()
            .root(
                ElementRule::new("message_log_file", "the file of the log")
                    .text("message_log_file", Kind::Text),
            )
            .root(flag("message_log_cerr", "whether the console shows it too"))
            .root(flag("message_log_cerr_color", "whether the console has colours"))
            .root(
                ElementRule::new(
                    "message_log_filter",
                    "the activities and agents whose messages are wanted, or `all`",
                )
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
                ElementRule::new("message_log_format", "how lines of the file look")
                    .text("message_log_format", Kind::Word(vec!["text", "json"])),
            )
    }

    /// Of several elements of one name the last counts.
    fn of(elements: &[Element]) -> Settings {
        let text = |name: &str| {
            elements.iter().rev().find(|element| element.is(name)).map(|element| element.text().trim())
        };
        let is_on = |name| matches!(text(name), Some("1" | "true"));
        let file = text("message_log_file").filter(|path| !path.is_empty());
        let filter = text("message_log_filter").map(|names| names.split([' ', ',', '\n', '\t']));
        let filter: Option<Vec<String>> =
            filter.map(|names| names.filter(|name| !name.is_empty()).map(str::to_owned).collect());
        let verbosity = text("log_file_verbosity_level").and_then(|number| number.parse::<i32>().ok());
        Settings {
            file: file.map(PathBuf::from),
            console: is_on("message_log_cerr"),
            colour: is_on("message_log_cerr_color"),
            filter: filter.filter(|names| !names.iter().any(|name| name == "all")),
            verbosity: verbosity.map_or(Severity::Info, least_grave),
            format: if text("message_log_format") == Some("json") { Format::Json } else { Format::Text },
        }
    }

    /// Whether messages of that agent or activity are wanted.
    pub(super) fn wants_of(&self, agent: &str, activity: &str) -> bool {
        self.filter.as_ref().is_none_or(|names| names.iter().any(|name| name == agent || name == activity))
    }
}

/// What a number of the thesis means; a negative one keeps back no more than 0 does.
fn least_grave(number: i32) -> Severity {
    match number {
        ..=0 => Severity::FatalError,
        1 => Severity::Error,
        2 => Severity::Info,
        3 => Severity::ExtraInfo,
        4.. => Severity::ExtraExtraInfo,
    }
}
