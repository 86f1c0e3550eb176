//! Scenario files: reads them with their predecessors, and plays them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme_verify::scenario::{ScenarioLink, ScenarioStep, ScenarioText};
use monas::scenario::{ScenarioDifference, ScenarioRunner, StepResult};
use monas::{Registry, config};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, report};
use serde_json::{Value, json};
use yase::{CompiledChart, Diagnostic, Source};

/// The extension of scenario files.
const EXTENSION: &str = "scenario";

/// A scenario with its predecessors.
pub(crate) struct Scenario {
    /// Its file, as given or found.
    pub(crate) file: PathBuf,
    /// The file of its model.
    model: PathBuf,
    /// The line that names the model.
    named: ScenarioLink,
    source: Arc<Source>,
    /// From the first predecessor to the scenario itself.
    scripts: Vec<ScenarioText>,
}

impl Scenario {
    /// Whether it belongs to the model in a file.
    pub(crate) fn is_about(&self, model: &Path) -> bool {
        is_same(&self.model, model)
    }

    /// Its steps, including those of its predecessors.
    pub(crate) fn bind(
        &self,
        chart: &CompiledChart,
        runner: &ScenarioRunner,
    ) -> Result<Vec<ScenarioStep>, Vec<Diagnostic>> {
        let (mut steps, mut found) = (Vec::new(), Vec::new());
        for script in &self.scripts {
            match script.bind(chart, runner.vocabulary()) {
                Ok(more) => steps.extend(more),
                Err(wrong) => found.extend(wrong),
            }
        }
        if found.is_empty() { Ok(steps) } else { Err(found) }
    }
}

/// Whether a text is a scenario; a trace names no model.
pub(crate) fn is_one(source: &Arc<Source>) -> bool {
    let (script, _) = ScenarioText::parse(source);
    script.model.is_some() || script.after.is_some()
}

/// Reads a scenario and its predecessors.
///
/// # Errors
/// The errors in their texts.
pub(crate) fn load(file: &Path) -> Result<Scenario, Vec<Diagnostic>> {
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
            return Err(wrong("the scenario continues itself"));
        }
        let (other, script) = read(&before)?;
        let about = linked(&before, script.model.as_ref(), &other)?.1;
        if !is_same(&about, &model) {
            return Err(wrong("the continued scenario has another model"));
        }
        here = (before, other, script);
    }
    Ok(Scenario { file: file.to_owned(), model, named, source, scripts })
}

fn read(file: &Path) -> Result<(Arc<Source>, ScenarioText), Vec<Diagnostic>> {
    let source = config::read_file(file).map_err(|unread| vec![*unread])?;
    let (script, wrong) = ScenarioText::parse(&source);
    if wrong.is_empty() { Ok((source, script)) } else { Err(wrong) }
}

/// The model that a scenario names, and its file.
fn linked(
    file: &Path,
    link: Option<&ScenarioLink>,
    source: &Arc<Source>,
) -> Result<(ScenarioLink, PathBuf), Vec<Diagnostic>> {
    let Some(link) = link else {
        let wrong = Diagnostic::error("E0891", yase::Span::default(), "the scenario names no model");
        return Err(vec![wrong.in_source(source)]);
    };
    let model = beside(file, link);
    if !model.is_file() {
        let wrong = Diagnostic::error("E0897", link.span, format!("there is no file {}", model.display()));
        return Err(vec![
            wrong.with_hint("paths in a scenario are relative to its folder").in_source(source),
        ]);
    }
    Ok((link.clone(), model))
}

/// A path relative to the folder of a file.
fn beside(file: &Path, link: &ScenarioLink) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(&link.path)
}

fn is_same(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

/// All scenario files in a folder, recursively, ordered by path.
///
/// # Errors
/// A folder cannot be read.
pub(crate) fn files(folder: &Path, format: Format) -> Result<Vec<PathBuf>, CommandFailure> {
    let failed = |error: std::io::Error| {
        CommandFailure::Failed(format, format!("cannot read {}: {error}", folder.display()))
    };
    let mut entries: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        entries.push(entry.map_err(failed)?.path());
    }
    entries.sort();
    let mut found = Vec::new();
    for path in entries {
        if path.is_dir() {
            found.extend(files(&path, format)?);
        } else if path.extension().is_some_and(|ending| ending == EXTENSION) {
            found.push(path);
        }
    }
    Ok(found)
}

/// A scenario runner with the symbols of this program.
pub(crate) fn runner(format: Format) -> Result<ScenarioRunner, CommandFailure> {
    ScenarioRunner::new(&Registry::linked()).map_err(|error| CommandFailure::failed(format, error))
}

/// The compiled chart of a model.
pub(crate) fn chart(
    model: &Path,
    runner: &ScenarioRunner,
    format: Format,
) -> Result<Arc<CompiledChart>, CommandFailure> {
    let source = config::read_file(model).map_err(|unread| CommandFailure::Invalid(format, vec![*unread]))?;
    let (chart, found) = aseme_models::statechart_of(&source);
    if found.iter().any(Diagnostic::is_error) {
        return Err(CommandFailure::Invalid(format, found));
    }
    let placed = |wrong: Diagnostic| wrong.in_source(&source);
    runner
        .compile(&chart)
        .map_err(|wrong| CommandFailure::Invalid(format, wrong.into_iter().map(placed).collect()))
}

/// Plays a scenario on a chart, and prints each step.
pub(crate) fn run(
    model: &Path,
    file: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let scenario = load(file).map_err(|wrong| CommandFailure::Invalid(format, wrong))?;
    if !scenario.is_about(model) {
        let message = format!(
            "the scenario belongs to {}, but is played on {}",
            scenario.model.display(),
            model.display()
        );
        let other = Diagnostic::warning("E0897", scenario.named.span, message).in_source(&scenario.source);
        report::write(console, format, &[other])?;
    }
    let runner = runner(format)?;
    let chart = chart(model, &runner, format)?;
    let steps = scenario.bind(&chart, &runner).map_err(|wrong| CommandFailure::Invalid(format, wrong))?;
    let mut lines = Vec::new();
    let differences = runner
        .play(&chart, &steps, |played| lines.push(step_text(&played, format)))
        .map_err(|error| CommandFailure::failed(format, error))?;
    for line in lines {
        writeln!(console.out, "{line}")?;
    }
    Ok(if differences.is_empty() { Exit::Success } else { Exit::Diverged })
}

/// The cause of a step, its records, the states after it, and failed expectations.
fn step_text(played: &StepResult<'_>, format: Format) -> String {
    let cause = played.step.passage.text();
    match format {
        Format::Text => {
            let records: String = played.records.iter().map(|record| format!("  {record}\n")).collect();
            let differences: String =
                played.differences.iter().map(|it| format!("\n  {}: {it}", file_and_line(it))).collect();
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
pub(crate) fn file_and_line(difference: &ScenarioDifference) -> String {
    format!("{}:{}", difference.passage.source.name, difference.passage.line())
}

fn object(difference: &ScenarioDifference) -> Value {
    json!({
        "file": difference.passage.source.name,
        "line": difference.passage.line(),
        "expected": difference.expected,
        "seen": difference.seen,
    })
}
