//! `monas model conform`: whether the charts of players hold to a protocol.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme::check::{Conformance, chart_conforms, player_conforms};
use aseme::convert::Model;
use aseme::iac::ChartKind;
use aseme::{Aip, Iac, transformations};
use serde_json::json;
use yase::{Diagnostic, Source};

use super::valid_model;
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(files: &[PathBuf], format: Format, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let models = Models::read(files, format, console)?;
    let charts = models.charts(format)?;
    let mut is_given = true;
    for (path, source, chart) in &charts {
        is_given &= tell(path, source, &chart_conforms(chart, &models.aip), format, console)?;
    }
    for (path, source, player) in &models.players {
        for (_, _, chart) in &charts {
            is_given &= tell(path, source, &player_conforms(player, chart, &models.aip), format, console)?;
        }
    }
    Ok(if is_given { Exit::Success } else { Exit::Diverged })
}

type Chart = (PathBuf, Arc<Source>, Iac);

/// What the files hold, told apart by their kinds.
pub(super) struct Models {
    protocols: PathBuf,
    aip: Aip,
    /// The charts of protocols that were given.
    charts: Vec<Chart>,
    players: Vec<Chart>,
}

impl Models {
    pub(super) fn read(
        files: &[PathBuf],
        format: Format,
        console: &mut Console<'_>,
    ) -> Result<Models, Failure> {
        let (mut protocols, mut charts, mut players) = (None, Vec::new(), Vec::new());
        for path in files {
            let (source, model, ..) = valid_model(path, format, console)?;
            match model {
                Model::Aip(aip) if protocols.is_none() => protocols = Some((path.clone(), aip)),
                Model::Aip(_) => {
                    return Err(Failure::Usage(format!(
                        "`{}` is a second model of protocols (AIP): charts are held against one",
                        path.display()
                    )));
                }
                Model::Chart(chart) if chart.kind == ChartKind::Inter => {
                    charts.push((path.clone(), source, chart))
                }
                Model::Chart(chart) => players.push((path.clone(), source, chart)),
                Model::Role(role) => {
                    let (chart, found) = aseme::srm_to_iac(role.srm());
                    if found.iter().any(Diagnostic::is_error) {
                        let found = found.into_iter().map(|found| found.in_source(&source)).collect();
                        return Err(Failure::Invalid(format, found));
                    }
                    // a chart that is made says nothing of places in the role
                    let source = Source::new(source.name.clone(), "");
                    players.push((path.clone(), source, Iac::from_statechart(&chart, ChartKind::Intra)));
                }
                other => {
                    let (path, kind) = (path.display(), other.kind());
                    return Err(Failure::Usage(format!(
                        "`{path}` is a model of the kind {kind}; there are protocols (AIP), their charts (EAC), and players (IAC or roles)"
                    )));
                }
            }
        }
        let Some((protocols, aip)) = protocols else {
            return Err(Failure::Usage(
                "no file is a model of protocols (AIP), which charts are held against".into(),
            ));
        };
        Ok(Models { protocols, aip, charts, players })
    }

    /// The charts of the protocols: those given, or as the protocols make them.
    pub(super) fn charts(&self, format: Format) -> Result<Vec<Chart>, Failure> {
        if !self.charts.is_empty() {
            return Ok(self.charts.clone());
        }
        let (charts, found) = transformations::aip_to_eac(&self.aip);
        if found.iter().any(Diagnostic::is_error) {
            return Err(Failure::Invalid(format, found));
        }
        let source = Source::new(self.protocols.display().to_string(), "");
        Ok(charts.into_iter().map(|chart| (self.protocols.clone(), source.clone(), chart)).collect())
    }
}

/// Says what was found of one chart, and whether it conforms.
fn tell(
    path: &Path,
    source: &Arc<Source>,
    found: &Conformance,
    format: Format,
    console: &mut Console<'_>,
) -> Result<bool, Failure> {
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
