//! `monas model compose`: robots together, and whether they wait for each other for ever.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme::Iac;
use aseme::check::compose::{Channels, Composition, compose};
use aseme::check::{Settings, parts_taken};
use aseme::convert::Model;
use aseme::iac::ChartKind;
use serde_json::json;
use yase::Source;

use super::{check, conform, valid_model};
use crate::arguments::{ComposeArguments, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(arguments: &ComposeArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let cast = Cast::read(&arguments.files, format, console)?;
    let conforms = cast.conforms(format, console)?;
    let mut settings = Settings::default();
    settings.events.extend(arguments.events.iter().cloned());
    settings.states = arguments.states;
    settings.world = arguments.linked.then(check::linked).transpose()?;
    let mut channels = Channels::default();
    (channels.capacity, channels.may_lose) = (arguments.channel, arguments.lose);
    let found =
        compose(&cast.robots, channels, &settings).map_err(|wrong| Failure::Invalid(format, wrong))?;
    if let Some(folder) = &arguments.traces {
        let named = found.findings.iter().map(|finding| (String::from("composed"), finding));
        check::traces::write_all(folder, named)?;
    }
    match format {
        Format::Text => text(&found, console)?,
        Format::Json => objects(&found, console)?,
    }
    Ok(if conforms && !found.has_errors() { Exit::Success } else { Exit::Diverged })
}

/// Files with the names of the robots that they are the models of: that before `=`, or that of the file.
///
/// # Errors
/// Two robots with one name.
pub(super) fn named(files: &[PathBuf]) -> Result<Vec<(String, PathBuf)>, Failure> {
    let mut found: Vec<(String, PathBuf)> = Vec::new();
    for file in files {
        let (name, file) = name_of(file);
        if found.iter().any(|(other, _)| *other == name) {
            return Err(Failure::Usage(format!("two robots are called `{name}`: write `NAME=FILE`")));
        }
        found.push((name, file));
    }
    Ok(found)
}

fn name_of(file: &Path) -> (String, PathBuf) {
    let text = file.to_string_lossy();
    match text.split_once('=').filter(|(name, _)| !name.is_empty() && !name.contains(['/', '\\', '.'])) {
        Some((name, path)) => (name.to_owned(), PathBuf::from(path)),
        None => (file.file_stem().unwrap_or_default().to_string_lossy().into_owned(), file.to_path_buf()),
    }
}

/// Who there is, and the files of the protocol that they play.
struct Cast {
    robots: Vec<(String, Arc<Source>)>,
    files: Vec<PathBuf>,
    protocol: Vec<PathBuf>,
}

impl Cast {
    fn read(files: &[PathBuf], format: Format, console: &mut Console<'_>) -> Result<Cast, Failure> {
        let (mut robots, mut protocol) = (Vec::new(), Vec::new());
        for file in files {
            let path = name_of(file).1;
            let (source, model, ..) = valid_model(&path, format, console)?;
            match model {
                Model::Aip(_) => protocol.push(path),
                Model::Chart(chart) if chart.kind == ChartKind::Inter => protocol.push(path),
                Model::Chart(_) | Model::Role(_) => robots.push((file.clone(), source)),
                other => {
                    let (path, kind) = (path.display(), other.kind());
                    return Err(Failure::Usage(format!(
                        "`{path}` is a model of the kind {kind}: there are robots (roles or charts), and a protocol (AIP, EAC)"
                    )));
                }
            }
        }
        if robots.is_empty() {
            return Err(Failure::Usage("no file is the model of a robot (a role or a chart)".into()));
        }
        let files: Vec<PathBuf> = robots.iter().map(|(file, _)| file.clone()).collect();
        let names = named(&files)?;
        let robots =
            names.iter().zip(robots).map(|((name, _), (_, source))| (name.clone(), source)).collect();
        Ok(Cast { robots, files: names.into_iter().map(|(_, file)| file).collect(), protocol })
    }

    /// Whether those who take part in the protocol hold to it, and each part is taken. So it is if there is none.
    fn conforms(&self, format: Format, console: &mut Console<'_>) -> Result<bool, Failure> {
        if self.protocol.is_empty() {
            return Ok(true);
        }
        let protocol = conform::Models::read(&self.protocol, format, console)?;
        let charts = protocol.charts(format)?;
        let mut taken: Vec<(String, bool)> = Vec::new();
        let mut files = self.protocol.clone();
        for file in &self.files {
            let player = player(file, format, console)?;
            let parts: Vec<(String, bool)> =
                charts.iter().flat_map(|(_, _, chart)| parts_taken(&player, chart)).collect();
            if parts.iter().any(|(_, is_taken)| *is_taken) && !files.contains(file) {
                files.push(file.clone());
            }
            taken.extend(parts);
        }
        let is_given = conform::execute(&files, format, console)? == Exit::Success;
        let mut missing: Vec<&str> = taken.iter().map(|(name, _)| name.as_str()).collect();
        missing.sort_unstable();
        missing.dedup();
        missing.retain(|name| !taken.iter().any(|(other, is_taken)| other == name && *is_taken));
        let found: Vec<yase::Diagnostic> = missing.iter().map(|name| nobody_plays(name)).collect();
        report::write(console, format, &found)?;
        Ok(is_given && found.is_empty())
    }
}

fn nobody_plays(name: &str) -> yase::Diagnostic {
    let message = format!("no robot takes the part `{name}` in the protocol");
    let found = yase::Diagnostic::error("E0936", yase::Span::default(), message);
    found.with_hint("compose it with a role that has a composite of that name")
}

fn player(path: &Path, format: Format, console: &mut Console<'_>) -> Result<Iac, Failure> {
    Ok(Iac::from_statechart(&super::valid_chart(path, format, console)?, ChartKind::Intra))
}

fn text(found: &Composition, console: &mut Console<'_>) -> Result<(), Failure> {
    for finding in &found.findings {
        report::write(console, Format::Text, std::slice::from_ref(&finding.diagnostic))?;
        check::way_there(finding, console)?;
    }
    for (from, to, message) in &found.passing {
        writeln!(console.out, "`{message}` passes from {from} to {to}")?;
    }
    if found.passing.is_empty() {
        writeln!(
            console.out,
            "no message passes from one to another: none is read by the name of a robot here"
        )?;
    }
    for (name, states) in &found.robots {
        writeln!(console.out, "{name}: {states} states explored")?;
    }
    if !found.has_errors() {
        writeln!(
            console.out,
            "none waits for ever; all of the {} states together were explored",
            found.states
        )?;
    }
    Ok(())
}

fn objects(found: &Composition, console: &mut Console<'_>) -> Result<(), Failure> {
    for finding in &found.findings {
        writeln!(console.err, "{}", check::object(finding))?;
    }
    for (from, to, message) in &found.passing {
        writeln!(console.out, "{}", json!({"message": message, "from": from, "to": to}))?;
    }
    for (name, states) in &found.robots {
        writeln!(console.out, "{}", json!({"robot": name, "states": states}))?;
    }
    writeln!(console.out, "{}", json!({"states": found.states, "finished": found.is_finished}))?;
    Ok(())
}
