//! The file of robots.

use std::path::{Path, PathBuf};
use std::time::Duration;

use monas::config::{self, AttributeRule, Element, ElementRule, Grammar, Identity, Kind, Layers, resolve};
use yase::Diagnostic;
use yase::diagnostic::nearest;

/// Time that a release must keep running to be accepted, by default.
const DEFAULT_ACCEPTANCE_TIME: &str = "3s";

/// The number of recordings that are kept, and their size in megabytes, by default.
const DEFAULT_KEPT_RECORDINGS: &str = "20";
const KEEP_MB: &str = "4000";

/// A robot in the file of robots.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Robot {
    /// Its name in the file of robots.
    pub name: String,
    /// As `ssh` takes it: `nao@10.0.2.2`.
    pub address: String,
    /// The command that connects, with its first arguments.
    pub(crate) ssh: Vec<String>,
    /// The target triple of its programs, if not that of this computer.
    pub target: Option<String>,
    /// The configuration that it runs.
    pub config: PathBuf,
    /// Further files of its releases.
    pub files: Vec<PathBuf>,
    /// Further arguments of `run`.
    pub(crate) arguments: Vec<String>,
    /// The folder of releases on the robot, relative to the home folder.
    pub(crate) folder: String,
    pub(crate) service: String,
    pub(crate) settle: Duration,
    /// Whether each run is recorded, and how many recordings the robot keeps.
    pub(crate) recordings: Option<KeptRecordings>,
}

/// The limits of the recordings on a robot, as [`Robot`] has them from the file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct KeptRecordings {
    pub(crate) count: String,
    pub(crate) megabytes: String,
}

/// The grammar of a file of robots.
pub fn robots_grammar() -> Grammar {
    let services = Kind::Word(vec!["auto", "systemd", "script", "none"]);
    let seconds = Kind::Duration { min: Duration::from_secs(1) };
    let robot = ElementRule::new("robot", "a robot to deploy to")
        .attribute(AttributeRule::new("name", Kind::Name, "its name").required())
        .attribute(AttributeRule::new("address", Kind::Text, "its address for ssh: user@host").required())
        .attribute(AttributeRule::new("port", Kind::whole_in(1, 65_535), "the port of its ssh server"))
        .attribute(AttributeRule::new("identity", Kind::Text, "the file of the private key for ssh"))
        .attribute(
            AttributeRule::new("ssh", Kind::Text, "the ssh command, with its first arguments").or("ssh"),
        )
        .attribute(AttributeRule::new(
            "target",
            Kind::Text,
            "the target triple of its programs; this computer's if not given",
        ))
        .attribute(AttributeRule::new("config", Kind::File, "the configuration that it runs").required())
        .attribute(AttributeRule::new("arguments", Kind::Text, "further arguments of `run`"))
        .attribute(
            AttributeRule::new(
                "folder",
                Kind::Text,
                "the folder of releases on the robot, relative to the home folder",
            )
            .or("monas"),
        )
        .attribute(
            AttributeRule::new("service", services, "the service that keeps the program running").or("auto"),
        )
        .attribute(
            AttributeRule::new("settle", seconds, "how long a release must keep running to be accepted")
                .or(DEFAULT_ACCEPTANCE_TIME),
        )
        .attribute(
            AttributeRule::new(
                "record",
                Kind::Flag,
                "whether each run is recorded in `recordings` of the folder",
            )
            .or("0"),
        )
        .attribute(
            AttributeRule::new("keep", Kind::whole_in(1, 1_000_000), "the most recordings that are kept")
                .or(DEFAULT_KEPT_RECORDINGS),
        )
        .attribute(
            AttributeRule::new(
                "keep_mb",
                Kind::whole_in(1, 1_000_000_000),
                "the most that all recordings take, in megabytes",
            )
            .or(KEEP_MB),
        )
        .children("file")
        .identified_by(Identity::Attribute("name"));
    let file = ElementRule::new("file", "a further file of the release").text("path", Kind::File);
    Grammar::default().root(robot).with(file)
}

/// The robot of a name in a file.
///
/// # Errors
/// The file is missing or invalid, or has no such robot.
pub fn find_robot(path: &Path, name: &str) -> Result<Robot, Vec<Diagnostic>> {
    if !path.exists() {
        let wrong =
            Diagnostic::error("E0740", yase::Span::default(), format!("there is no file {}", path.display()));
        let example = format!(
            "write it: `<robot name=\"{name}\" address=\"nao@10.0.2.2\" config=\"config/agents.xml\"/>`; `--robots` names another file"
        );
        return Err(vec![wrong.with_hint(example)]);
    }
    let resolved = resolve(path, &robots_grammar(), &Layers::new());
    let robots: Vec<Element> = resolved.elements.clone();
    let diagnostics = resolved.into_diagnostics();
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(diagnostics);
    }
    let named = |robot: &&Element| value(robot, "name") == Some(name);
    match robots.iter().find(named) {
        Some(robot) => entry(path, robot).map_err(|wrong| vec![*wrong]),
        None => Err(vec![unknown(path, name, &robots)]),
    }
}

fn unknown(path: &Path, name: &str, robots: &[Element]) -> Diagnostic {
    let names: Vec<&str> = robots.iter().filter_map(|robot| value(robot, "name")).collect();
    let message = format!("{} has no robot `{name}`", path.display());
    let wrong = Diagnostic::error("E0740", yase::Span::default(), message);
    match nearest(name, names.iter().copied()) {
        Some(near) => wrong.with_hint(format!("did you mean `{near}`?")),
        None => wrong.with_hint(format!("it has {}", names.join(", "))),
    }
}

fn value<'e>(robot: &'e Element, key: &str) -> Option<&'e str> {
    robot.attribute(key).map(|attribute| attribute.value.trim()).filter(|value| !value.is_empty())
}

fn entry(path: &Path, robot: &Element) -> Result<Robot, Box<Diagnostic>> {
    let text = |key: &str, default: &str| value(robot, key).unwrap_or(default).to_owned();
    let address = text("address", "");
    if address.starts_with('-') || address.contains(char::is_whitespace) {
        let message = format!("`{address}` is not an address");
        let wrong = robot.attribute("address").map(|it| it.error("E0741", message.clone()));
        let wrong = wrong.unwrap_or_else(|| robot.error("E0741", robot.span(), message));
        return Err(Box::new(wrong.with_hint("write it as ssh takes it: `nao@10.0.2.2`")));
    }
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<String>>();
    let mut ssh = words(&text("ssh", "ssh"));
    for (key, flag) in [("port", "-p"), ("identity", "-i")] {
        ssh.extend(value(robot, key).into_iter().flat_map(|value| [flag.to_owned(), value.to_owned()]));
    }
    let is_recorded = matches!(value(robot, "record"), Some("1" | "true"));
    let arguments = words(&text("arguments", ""));
    if let Some(message) = misplaced_recording(&arguments, is_recorded) {
        let wrong = robot.attribute("arguments").map(|it| it.error("E0743", message.clone()));
        let wrong = wrong.unwrap_or_else(|| robot.error("E0743", robot.span(), message));
        let hint = "`record=\"1\"` records each run in `recordings`, outside of releases";
        return Err(Box::new(wrong.with_hint(hint)));
    }
    let recordings = is_recorded.then(|| KeptRecordings {
        count: text("keep", DEFAULT_KEPT_RECORDINGS),
        megabytes: text("keep_mb", KEEP_MB),
    });
    let located = |named: &str| config::locate(path, named).unwrap_or_else(|_| PathBuf::from(named));
    Ok(Robot {
        name: text("name", ""),
        address,
        ssh,
        target: value(robot, "target").map(str::to_owned),
        config: located(&text("config", "")),
        files: robot.children_named("file").map(|file| located(file.text().trim())).collect(),
        arguments,
        folder: text("folder", "monas"),
        service: text("service", "auto"),
        settle: config::duration(&text("settle", DEFAULT_ACCEPTANCE_TIME)).unwrap_or(Duration::from_secs(3)),
        recordings,
    })
}

/// The reason to refuse `--record` among the arguments: a relative path lies in a release, which is
/// removed some day.
fn misplaced_recording(arguments: &[String], is_recorded: bool) -> Option<String> {
    let index = arguments.iter().position(|word| word == "--record" || word.starts_with("--record="))?;
    if is_recorded {
        return Some("the run is recorded twice: by `record` and by `--record`".into());
    }
    let path = match arguments[index].split_once('=') {
        Some((_, path)) => path,
        None => arguments.get(index + 1)?,
    };
    let is_absolute = path.starts_with('/');
    (!is_absolute).then(|| format!("the recording `{path}` would be in the release, and removed with it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_within_a_release_is_refused() {
        let wrong = |arguments: &[&str], is_recorded| {
            let arguments: Vec<String> = arguments.iter().map(|word| (*word).to_owned()).collect();
            misplaced_recording(&arguments, is_recorded)
        };
        for arguments in [&["--record", "goalie.mcap"][..], &["--record=../goalie.mcap"]] {
            assert!(wrong(arguments, false).is_some_and(|message| message.contains("in the release")));
        }
        assert_eq!(wrong(&["--record", "/data/goalie.mcap"], false), None);
        assert_eq!(wrong(&["--for", "1s"], true), None);
        assert!(wrong(&["--record", "/data/goalie.mcap"], true).is_some());
    }
}
