//! Layers that the command line adds to a configuration.

use std::path::{Path, PathBuf};

use clap::Args;
use monas::config::{self, Layers};
use yase::{Diagnostic, Source};

use super::grammar;

/// The flags `--set` and `--robot`.
#[derive(Args, Debug, Default)]
pub(crate) struct LayerArguments {
    /// Set a value, for example agent.Motion.frequency=50; in a match, for every role with such an
    /// agent. May be given several times.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) settings: Vec<String>,
    /// Apply the overrides of one robot: robots/NAME.xml or .toml, beside the configuration or in a
    /// folder above.
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
}

/// The layers of the command line: the robot's, then each setting.
pub(crate) fn of(config: &Path, arguments: &LayerArguments) -> Result<Layers, Vec<Diagnostic>> {
    let mut layers = match &arguments.robot {
        Some(name) => Layers::new().robot(robot(config, name)?),
        None => Layers::new(),
    };
    let (grammar, mut wrong) = (grammar(), Vec::new());
    for setting in &arguments.settings {
        match layers.clone().set(setting, &grammar) {
            Ok(with) => layers = with,
            Err(diagnostic) => wrong.push(*diagnostic),
        }
    }
    if wrong.is_empty() { Ok(layers) } else { Err(wrong) }
}

/// The overrides of one robot.
fn robot(config: &Path, name: &str) -> Result<Vec<config::Element>, Vec<Diagnostic>> {
    let path = robot_file(config, name).map_err(|diagnostic| vec![*diagnostic])?;
    let source = config::read_file(&path).map_err(|unread| vec![*unread])?;
    let (elements, diagnostics) = config::Grammar::agents().parse(&source);
    if diagnostics.iter().any(Diagnostic::is_error) { Err(diagnostics) } else { Ok(elements) }
}

pub(crate) fn robot_file(config: &Path, name: &str) -> Result<PathBuf, Box<Diagnostic>> {
    let source = Source::new("--robot", name);
    let near = match ["xml", "toml"].map(|ending| config::locate(config, &format!("robots/{name}.{ending}")))
    {
        [Ok(xml), Ok(toml)] => {
            let message = format!("`{}` and `{}` both override this robot", xml.display(), toml.display());
            let diagnostic = Diagnostic::error("E0375", 0..name.len(), message).in_source(&source);
            return Err(Box::new(diagnostic.with_hint("keep one of them")));
        }
        [Ok(path), Err(_)] | [Err(_), Ok(path)] => return Ok(path),
        [Err(xml), Err(toml)] => xml.or(toml),
    };
    let message = format!("no file `robots/{name}.xml` or `robots/{name}.toml` beside the configuration");
    let diagnostic = Diagnostic::error("E0316", 0..name.len(), message).in_source(&source);
    Err(Box::new(match near {
        Some(near) => diagnostic.with_hint(format!("did you mean `{near}`?")),
        None => diagnostic.with_hint("it contains the overrides of this robot, for example `<agent priority=\"2\"><name>Motion</name></agent>`"),
    }))
}
