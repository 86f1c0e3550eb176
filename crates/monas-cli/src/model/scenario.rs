//! Scenarios in files: read with what comes before them, and played.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme::scenario::{Link, Script, Step};
use monas::scenario::{Difference, Played, Player};
use monas::{Registry, config};
use serde_json::{Value, json};
use yase::{Chart, Diagnostic, Source};

use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

/// What scenarios are known by.
const ENDING: &str = "scenario";

/// A scenario with all that comes before it.
pub(super) struct Scenario {
    /// Its file, as it was named or found.
    pub(super) file: PathBuf,
    /// The file of the model that it is about.
    model: PathBuf,
    /// Where it says so.
    named: Link,
    source: Arc<Source>,
    /// From the first to its own.
    scripts: Vec<Script>,
}

impl Scenario {
    /// Whether it is about the model in a file.
    pub(super) fn is_about(&self, model: &Path) -> bool {
        is_same(&self.model, model)
    }

    /// Its steps, of those that come before it too.
    pub(super) fn bind(&self, chart: &Chart, player: &Player) -> Result<Vec<Step>, Vec<Diagnostic>> {
        let (mut steps, mut found) = (Vec::new(), Vec::new());
        for script in &self.scripts {
            match script.bind(chart, player.vocabulary()) {
                Ok(more) => steps.extend(more),
                Err(wrong) => found.extend(wrong),
            }
        }
        if found.is_empty() { Ok(steps) } else { Err(found) }
    }
}

/// Whether a text is a scenario; a trace names no model.
pub(super) fn is_one(source: &Arc<Source>) -> bool {
    let (script, _) = Script::parse(source);
    script.model.is_some() || script.after.is_some()
}

/// Reads a scenario and those that come before it.
///
/// # Errors
/// Whatever is wrong with their texts.
pub(super) fn load(file: &Path) -> Result<Scenario, Vec<Diagnostic>> {
    let (mut scripts, mut files) = (Vec::new(), Vec::new());
    let (source, script) = read(file)?;
    let (named, model) = linked(file, script.model.as_ref(), &source)?;
    let mut here = (file.to_owned(), source.clone(), script);
    loop {
        let (file, source, script) = here;
        files.push(file.clone());
        let after = script.after.clone();
        scripts.insert(0, script);
        let Some(link) = after else { break };
        let before = beside(&file, &link);
        let wrong = |message: &str| vec![Diagnostic::error("E0897", link.span, message).in_source(&source)];
        if files.iter().any(|file| is_same(file, &before)) {
            return Err(wrong("the scenario comes after itself"));
        }
        let (other, script) = read(&before)?;
        let about = linked(&before, script.model.as_ref(), &other)?.1;
        if !is_same(&about, &model) {
            return Err(wrong("the scenario that comes first is about another model"));
        }
        here = (before, other, script);
    }
    Ok(Scenario { file: file.to_owned(), model, named, source, scripts })
}

fn read(file: &Path) -> Result<(Arc<Source>, Script), Vec<Diagnostic>> {
    let source = config::read_file(file).map_err(|unread| vec![*unread])?;
    let (script, wrong) = Script::parse(&source);
    if wrong.is_empty() { Ok((source, script)) } else { Err(wrong) }
}

/// The model that a scenario names, and where its file is.
fn linked(
    file: &Path,
    link: Option<&Link>,
    source: &Arc<Source>,
) -> Result<(Link, PathBuf), Vec<Diagnostic>> {
    let Some(link) = link else {
        let wrong = Diagnostic::error("E0891", yase::Span::default(), "the scenario names no model");
        return Err(vec![wrong.in_source(source)]);
    };
    let model = beside(file, link);
    if !model.is_file() {
        let wrong = Diagnostic::error("E0897", link.span, format!("there is no file {}", model.display()));
        return Err(vec![
            wrong.with_hint("a scenario names files as they are seen from its own folder").in_source(source),
        ]);
    }
    Ok((link.clone(), model))
}

/// A file as it is seen from the folder of another.
fn beside(file: &Path, link: &Link) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(&link.path)
}

fn is_same(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

/// Every scenario in a folder and those in it, in the order of their paths.
///
/// # Errors
/// A folder that cannot be read.
pub(super) fn files(folder: &Path, format: Format) -> Result<Vec<PathBuf>, Failure> {
    let failed =
        |error: std::io::Error| Failure::Failed(format, format!("cannot read {}: {error}", folder.display()));
    let mut entries: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        entries.push(entry.map_err(failed)?.path());
    }
    entries.sort();
    let mut found = Vec::new();
    for path in entries {
        if path.is_dir() {
            found.extend(files(&path, format)?);
        } else if path.extension().is_some_and(|ending| ending == ENDING) {
            found.push(path);
        }
    }
    Ok(found)
}

/// The player of this program.
pub(super) fn player(format: Format) -> Result<Player, Failure> {
    Player::new(&Registry::linked()).map_err(|error| Failure::failed(format, error))
}

/// The chart of a model, ready to be played.
pub(super) fn chart(model: &Path, player: &Player, format: Format) -> Result<Arc<Chart>, Failure> {
    let source = config::read_file(model).map_err(|unread| Failure::Invalid(format, vec![*unread]))?;
    let (chart, found) = aseme::statechart_of(&source);
    if found.iter().any(Diagnostic::is_error) {
        return Err(Failure::Invalid(format, found));
    }
    let placed = |wrong: Diagnostic| wrong.in_source(&source);
    player.compile(&chart).map_err(|wrong| Failure::Invalid(format, wrong.into_iter().map(placed).collect()))
}

/// Plays a scenario on a chart, and prints each step.
pub(super) fn run(
    model: &Path,
    file: &Path,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let scenario = load(file).map_err(|wrong| Failure::Invalid(format, wrong))?;
    if !scenario.is_about(model) {
        let message = format!(
            "the scenario is about {}, and is played on {}",
            scenario.model.display(),
            model.display()
        );
        let other = Diagnostic::warning("E0897", scenario.named.span, message).in_source(&scenario.source);
        report::write(console, format, &[other])?;
    }
    let player = player(format)?;
    let chart = chart(model, &player, format)?;
    let steps = scenario.bind(&chart, &player).map_err(|wrong| Failure::Invalid(format, wrong))?;
    let mut lines = Vec::new();
    let differences = player
        .play(&chart, &steps, |played| lines.push(told(&played, format)))
        .map_err(|error| Failure::failed(format, error))?;
    for line in lines {
        writeln!(console.out, "{line}")?;
    }
    Ok(if differences.is_empty() { Exit::Success } else { Exit::Diverged })
}

/// What a step was for, what it did, where it led, and what was expected in its place.
fn told(played: &Played<'_>, format: Format) -> String {
    let cause = played.step.passage.text();
    match format {
        Format::Text => {
            let records: String = played.records.iter().map(|record| format!("  {record}\n")).collect();
            let differences: String =
                played.differences.iter().map(|it| format!("\n  {}: {it}", place(it))).collect();
            format!("{cause}\n{records}  active: {}{differences}", played.active.join(", "))
        }
        Format::Json => {
            let differences: Vec<Value> = played.differences.iter().map(object).collect();
            json!({"step": cause, "records": played.records, "active": played.active, "differences": differences})
                .to_string()
        }
    }
}

/// `file:line`
pub(super) fn place(difference: &Difference) -> String {
    format!("{}:{}", difference.passage.source.name, difference.passage.line())
}

fn object(difference: &Difference) -> Value {
    json!({
        "file": difference.passage.source.name,
        "line": difference.passage.line(),
        "expected": difference.expected,
        "seen": difference.seen,
    })
}
