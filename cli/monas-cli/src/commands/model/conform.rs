//! `monas model conform`: checks whether the charts of players conform to a protocol.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme_models::convert::Model;
use aseme_models::iac::ChartKind;
use aseme_models::{Aip, Iac, transformations};
use aseme_verify::protocol::{Conformance, chart_conforms, parts_taken, player_conforms, role_chart};
use clap::{Args, ValueHint};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, report};
use serde_json::json;
use yase::{Diagnostic, Source};

use crate::input::valid_model;

/// Arguments of `monas model conform`.
#[derive(Args, Debug)]
pub(crate) struct ConformArguments {
    /// The model files.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &ConformArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    conform(&arguments.files, arguments.format.value, console)
}

/// Checks the charts in these files against the protocols among them.
pub(crate) fn conform(
    files: &[PathBuf],
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let models = LoadedModels::read(files, format, console)?;
    let charts = models.charts(format)?;
    let mut is_given = true;
    for (path, source, chart) in &charts {
        is_given &= report_conformance(path, source, &chart_conforms(chart, &models.aip), format, console)?;
    }
    for (path, source, player) in &models.players {
        let takes_part = |chart: &Iac| parts_taken(player, chart).iter().any(|(_, is_taken)| *is_taken);
        let has_part = charts.iter().any(|(_, _, chart)| takes_part(chart));
        // of several protocols a player takes part in some
        for (_, _, chart) in charts.iter().filter(|(_, _, chart)| takes_part(chart) || !has_part) {
            let found = player_conforms(player, chart, &models.aip);
            is_given &= report_conformance(path, source, &found, format, console)?;
        }
    }
    Ok(if is_given { Exit::Success } else { Exit::Diverged })
}

/// A chart of a protocol with the file that it is from.
pub(crate) type NamedChart = (PathBuf, Arc<Source>, Iac);

/// The models of the files, by kind.
pub(crate) struct LoadedModels {
    protocols: PathBuf,
    /// The text of the protocols.
    source: Arc<Source>,
    aip: Aip,
    /// The given charts of protocols.
    charts: Vec<NamedChart>,
    players: Vec<NamedChart>,
}

impl LoadedModels {
    pub(crate) fn read(
        files: &[PathBuf],
        format: Format,
        console: &mut CommandOutput<'_>,
    ) -> Result<LoadedModels, CommandFailure> {
        let (mut protocols, mut charts, mut players) = (None, Vec::new(), Vec::new());
        for path in files {
            let (source, model, ..) = valid_model(path, format, console)?;
            match model {
                Model::Aip(aip) if protocols.is_none() => protocols = Some((path.clone(), source, aip)),
                Model::Aip(_) => {
                    return Err(CommandFailure::Usage(format!(
                        "`{}` is a second model of protocols (AIP): charts are checked against one",
                        path.display()
                    )));
                }
                Model::Chart(chart) if chart.kind == ChartKind::Inter => {
                    charts.push((path.clone(), source, chart))
                }
                Model::Chart(chart) => players.push((path.clone(), source, chart)),
                Model::Role(role) => {
                    let chart = role_chart(role.srm()).map_err(|found| {
                        let found = found.into_iter().map(|found| found.in_source(&source)).collect();
                        CommandFailure::Invalid(format, found)
                    })?;
                    players.push((path.clone(), source, chart));
                }
                other => {
                    let (path, kind) = (path.display(), other.kind());
                    return Err(CommandFailure::Usage(format!(
                        "`{path}` is a model of the kind {kind}; expected protocols (AIP), their charts (EAC), or players (IAC or roles)"
                    )));
                }
            }
        }
        let Some((protocols, source, aip)) = protocols else {
            return Err(CommandFailure::Usage(
                "no file is a model of protocols (AIP), against which charts are checked".into(),
            ));
        };
        Ok(LoadedModels { protocols, source, aip, charts, players })
    }

    /// The charts of the protocols: the given ones, or those derived from the protocols.
    pub(crate) fn charts(&self, format: Format) -> Result<Vec<NamedChart>, CommandFailure> {
        if !self.charts.is_empty() {
            return Ok(self.charts.clone());
        }
        let (charts, found) = transformations::aip_to_eac(&self.aip);
        if found.iter().any(Diagnostic::is_error) {
            let found = found.into_iter().map(|found| found.in_source(&self.source)).collect();
            return Err(CommandFailure::Invalid(format, found));
        }
        let placed = |chart| (self.protocols.clone(), self.source.clone(), chart);
        Ok(charts.into_iter().map(placed).collect())
    }
}

/// Reports the findings of one chart, and returns whether it conforms.
fn report_conformance(
    path: &Path,
    source: &Arc<Source>,
    found: &Conformance,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<bool, CommandFailure> {
    let findings: Vec<Diagnostic> =
        found.findings.iter().map(|found| found.clone().in_source(source)).collect();
    report::write(console, format, &findings)?;
    let path = path.display();
    for (name, explored) in &found.explored {
        let (states, is_finished) = (explored.states, explored.is_finished);
        match format {
            Format::Text if found.is_given() => {
                writeln!(console.out, "{path}: `{name}` conforms; all of its {states} states were explored")?;
            }
            Format::Text => {}
            Format::Json => {
                let object = json!({"file": path.to_string(), "part": name, "conforms": found.is_given(),
                    "states": states, "finished": is_finished});
                writeln!(console.out, "{object}")?;
            }
        }
    }
    Ok(found.is_given())
}
