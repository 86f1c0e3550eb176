//! The robots that a project is brought to: a file of them.

use std::path::{Path, PathBuf};
use std::time::Duration;

use monas::config::{self, AttributeRule, Element, ElementRule, Grammar, Identity, Kind, Layers, resolve};
use yase::Diagnostic;
use yase::diagnostic::nearest;

/// How long a release must go on before it is trusted, if the file does not say.
const SETTLE: &str = "3s";

/// A robot, as the file has it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct RobotEntry {
    pub(super) name: String,
    /// As `ssh` takes it: `nao@10.0.2.2`.
    pub(super) address: String,
    /// The command that reaches it, with its first arguments.
    pub(super) ssh: Vec<String>,
    /// What programs for it are compiled for, if not for this computer.
    pub(super) target: Option<String>,
    /// The configuration that it runs.
    pub(super) config: PathBuf,
    /// More files that go with it.
    pub(super) files: Vec<PathBuf>,
    /// What `run` is told besides.
    pub(super) arguments: Vec<String>,
    /// The folder of Monas there, from the home folder.
    pub(super) folder: String,
    pub(super) service: String,
    pub(super) settle: Duration,
}

/// What may stand in a file of robots.
pub(crate) fn grammar() -> Grammar {
    let services = Kind::Word(vec!["auto", "systemd", "script", "none"]);
    let seconds = Kind::Duration { least: Duration::from_secs(1) };
    let robot = ElementRule::new("robot", "a robot that the project is brought to")
        .attribute(AttributeRule::new("name", Kind::Name, "its name").required())
        .attribute(
            AttributeRule::new("address", Kind::Text, "where it is, as ssh takes it: user@host").required(),
        )
        .attribute(AttributeRule::new("port", Kind::whole_in(1, 65_535), "the port of its ssh server"))
        .attribute(AttributeRule::new("identity", Kind::Text, "the file of the key that it lets in"))
        .attribute(
            AttributeRule::new("ssh", Kind::Text, "the command that reaches it, with its first arguments")
                .or("ssh"),
        )
        .attribute(AttributeRule::new(
            "target",
            Kind::Text,
            "what its programs are compiled for, as rustc names it; this computer's if it is not said",
        ))
        .attribute(AttributeRule::new("config", Kind::File, "the configuration that it runs").required())
        .attribute(AttributeRule::new("arguments", Kind::Text, "what `run` is told besides"))
        .attribute(
            AttributeRule::new("folder", Kind::Text, "the folder of Monas on it, from the home folder")
                .or("monas"),
        )
        .attribute(AttributeRule::new("service", services, "what keeps it running").or("auto"))
        .attribute(
            AttributeRule::new("settle", seconds, "how long a release must go on before it is trusted")
                .or(SETTLE),
        )
        .children("file")
        .identified_by(Identity::Attribute("name"));
    let file =
        ElementRule::new("file", "one more file that goes with the configuration").text("path", Kind::File);
    Grammar::default().root(robot).with(file)
}

/// The robot of a name in a file.
///
/// # Errors
/// Whatever is wrong with the file, or that it has no such robot.
pub(super) fn find(path: &Path, name: &str) -> Result<RobotEntry, Vec<Diagnostic>> {
    if !path.exists() {
        let wrong =
            Diagnostic::error("E0740", yase::Span::default(), format!("there is no file {}", path.display()));
        let example = format!(
            "write it: `<robot name=\"{name}\" address=\"nao@10.0.2.2\" config=\"config/agents.xml\"/>`; `--robots` names another file"
        );
        return Err(vec![wrong.with_hint(example)]);
    }
    let resolved = resolve(path, &grammar(), &Layers::new());
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

fn entry(path: &Path, robot: &Element) -> Result<RobotEntry, Box<Diagnostic>> {
    let text = |key: &str, default: &str| value(robot, key).unwrap_or(default).to_owned();
    let address = text("address", "");
    if address.starts_with('-') || address.contains(char::is_whitespace) {
        let message = format!("`{address}` is no address");
        let wrong = robot.attribute("address").map(|it| it.error("E0741", message.clone()));
        let wrong = wrong.unwrap_or_else(|| robot.error("E0741", robot.span(), message));
        return Err(Box::new(wrong.with_hint("write it as ssh takes it: `nao@10.0.2.2`")));
    }
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<String>>();
    let mut ssh = words(&text("ssh", "ssh"));
    for (key, flag) in [("port", "-p"), ("identity", "-i")] {
        ssh.extend(value(robot, key).into_iter().flat_map(|value| [flag.to_owned(), value.to_owned()]));
    }
    let located = |named: &str| config::locate(path, named).unwrap_or_else(|_| PathBuf::from(named));
    Ok(RobotEntry {
        name: text("name", ""),
        address,
        ssh,
        target: value(robot, "target").map(str::to_owned),
        config: located(&text("config", "")),
        files: robot.children_named("file").map(|file| located(file.text().trim())).collect(),
        arguments: words(&text("arguments", "")),
        folder: text("folder", "monas"),
        service: text("service", "auto"),
        settle: config::duration(&text("settle", SETTLE)).unwrap_or(Duration::from_secs(3)),
    })
}
