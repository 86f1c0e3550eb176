//! `monas model transform`: from a model to the next one of the method.

use std::path::Path;
use std::sync::Arc;

use aseme::convert::{Format as Written, Model};
use aseme::iac::{ChartKind, Iac};
use aseme::{Aip, SystemRoles, transformations};
use yase::{Diagnostic, Source};

use super::{convert, valid_chart, valid_model, write};
use crate::arguments::{Format, Kind, TransformArguments};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(arguments: &TransformArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match arguments.to {
        None => chart(arguments, console),
        Some(kind) => Transformation { arguments, format: arguments.format.value, console }.execute(kind),
    }
}

/// The statechart that a model describes, for reading.
fn chart(arguments: &TransformArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let chart = valid_chart(&arguments.file, format, console)?;
    let text = match format {
        Format::Text => aseme::to_text(&chart),
        Format::Json => format!("{}\n", aseme::to_json(&chart)),
    };
    write(arguments.output.as_deref(), &text, format, console)
}

struct Transformation<'a, 'c> {
    arguments: &'a TransformArguments,
    format: Format,
    console: &'a mut Console<'c>,
}

impl Transformation<'_, '_> {
    fn execute(&mut self, kind: Kind) -> Result<Exit, Failure> {
        let (source, model, ..) = valid_model(&self.arguments.file, self.format, self.console)?;
        let (made, findings) = match (model, kind) {
            (Model::Sag(sag), Kind::Suc) => one(transformations::sag_to_suc(&sag), Model::Suc),
            (Model::Suc(suc), Kind::Aip) => one(transformations::suc_to_aip(&suc), Model::Aip),
            (Model::Suc(suc), Kind::Srm) => {
                let aip = self.aip()?;
                one(transformations::suc_to_srm(&suc, aip.as_ref()), Model::Srm)
            }
            (Model::Aip(aip), Kind::Eac) => {
                let (charts, findings) = transformations::aip_to_eac(&aip);
                (charts.into_iter().map(Model::Chart).collect(), findings)
            }
            (Model::Srm(srm), Kind::Iac) => self.roles(&srm)?,
            (Model::Role(role), Kind::Iac) => {
                let (chart, findings) = aseme::srm_to_iac(role.srm());
                self.with_protocols(vec![Iac::from_statechart(&chart, ChartKind::Intra)], findings)?
            }
            (Model::Chart(chart), Kind::Iac) => self.with_protocols(vec![chart], Vec::new())?,
            (Model::Srm(srm), Kind::Ft) => return self.table(&srm),
            (Model::Role(role), Kind::Ft) => return self.table(&SystemRoles::from_role(role.srm()).0),
            (model, _) => return Err(self.no_way(&model)),
        };
        self.judge(findings, &source)?;
        let made = self.kept(made, kind)?;
        self.write(made, &source)
    }

    fn no_way(&self, model: &Model) -> Failure {
        let ways = match model {
            Model::Sag(_) => "suc",
            Model::Suc(_) => "aip and srm",
            Model::Aip(_) => "eac",
            Model::Srm(_) | Model::Role(_) => "iac and ft",
            _ => "iac, with an EAC",
        };
        Failure::Usage(format!(
            "`{}` is a model of the kind {}; from there one goes to {ways}",
            self.arguments.file.display(),
            model.kind()
        ))
    }

    /// Findings are shown; with errors nothing is made.
    fn judge(&mut self, findings: Vec<Diagnostic>, source: &Arc<Source>) -> Result<(), Failure> {
        let findings: Vec<Diagnostic> =
            findings.into_iter().map(|finding| finding.in_source(source)).collect();
        if findings.iter().any(Diagnostic::is_error) {
            return Err(Failure::Invalid(self.format, findings));
        }
        Ok(report::write(self.console, self.format, &findings)?)
    }

    fn aip(&mut self) -> Result<Option<Aip>, Failure> {
        let Some(path) = self.arguments.with.first() else { return Ok(None) };
        match self.other(path)? {
            Model::Aip(aip) => Ok(Some(aip)),
            other => Err(wrong_kind(path, &other, "AIP")),
        }
    }

    fn other(&mut self, path: &Path) -> Result<Model, Failure> {
        valid_model(path, self.format, self.console).map(|(_, model, ..)| model)
    }

    fn roles(&mut self, srm: &SystemRoles) -> Result<(Vec<Model>, Vec<Diagnostic>), Failure> {
        let (charts, findings) = transformations::roles_to_iac(srm);
        self.with_protocols(charts, findings)
    }

    /// Charts of roles, with the protocols' charts put in.
    fn with_protocols(
        &mut self,
        mut charts: Vec<Iac>,
        mut findings: Vec<Diagnostic>,
    ) -> Result<(Vec<Model>, Vec<Diagnostic>), Failure> {
        for path in &self.arguments.with {
            let eac = match self.other(path)? {
                Model::Chart(eac) => eac,
                other => return Err(wrong_kind(path, &other, "EAC")),
            };
            for chart in &mut charts {
                findings.extend(transformations::merge_eac(chart, &eac).1);
            }
        }
        Ok((charts.into_iter().map(Model::Chart).collect(), findings))
    }

    /// The chart with what an older one says besides.
    fn kept(&mut self, made: Vec<Model>, kind: Kind) -> Result<Vec<Model>, Failure> {
        let Some(path) = &self.arguments.keep else { return Ok(made) };
        let mut made = self.chosen(made)?;
        let [Model::Chart(chart)] = made.as_mut_slice() else {
            let reason = if kind == Kind::Iac { "of one chart: say by --name which" } else { "of an IAC" };
            return Err(Failure::Usage(format!("--keep is for what an older model says {reason}")));
        };
        let (source, older, ..) = valid_model(path, self.format, self.console)?;
        let Model::Chart(older) = older else { return Err(wrong_kind(path, &older, "IAC")) };
        let lost = aseme::regenerate::keep(&older, chart);
        let lost: Vec<Diagnostic> = lost.into_iter().map(|found| found.in_source(&source)).collect();
        report::write(self.console, self.format, &lost)?;
        Ok(made)
    }

    fn table(&mut self, srm: &SystemRoles) -> Result<Exit, Failure> {
        let table = transformations::functionality_table(srm);
        let text = match self.arguments.written.as_deref() {
            None | Some("table") => table.to_table(),
            Some("html") => table.to_html(),
            Some("csv") => table.to_csv(),
            Some("text") => Model::Ft(table).to_text(),
            Some(word) => {
                return Err(Failure::Usage(format!(
                    "a functionality table is written as table, html, csv or text, not as `{word}`"
                )));
            }
        };
        write(self.arguments.output.as_deref(), &text, self.format, self.console)
    }

    fn write(&mut self, made: Vec<Model>, source: &Arc<Source>) -> Result<Exit, Failure> {
        let wanted = self.arguments.written.as_deref().map_or(Ok(Written::Text), convert::named)?;
        let made = self.chosen(made)?;
        let mut texts = Vec::new();
        // Comments are about the model that was read, so they stay there.
        let nowhere = Source::new(source.name.clone(), "");
        for model in &made {
            texts.push(convert::text_of(
                model,
                wanted,
                &nowhere,
                0,
                self.arguments.lossy,
                self.format,
                self.console,
            )?);
        }
        write(self.arguments.output.as_deref(), &texts.join("\n"), self.format, self.console)
    }

    /// The one that is named; all, if they can be printed one after the other.
    fn chosen(&self, made: Vec<Model>) -> Result<Vec<Model>, Failure> {
        let names: Vec<String> = made.iter().map(name_of).collect();
        let list = || names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        match &self.arguments.name {
            Some(name) if !names.contains(name) => {
                Err(Failure::Usage(format!("there is no `{name}`; there are {}", list())))
            }
            Some(name) => Ok(made.into_iter().filter(|model| name_of(model) == *name).collect()),
            None if made.len() > 1 && self.arguments.output.is_some() => Err(Failure::Usage(format!(
                "there are {}: {}; say by --name which one goes into the file",
                made.len(),
                list()
            ))),
            None => Ok(made),
        }
    }
}

fn wrong_kind(path: &Path, model: &Model, wanted: &str) -> Failure {
    Failure::Usage(format!("`{}` is a model of the kind {}, not {wanted}", path.display(), model.kind()))
}

fn one<T>(
    (made, findings): (T, Vec<Diagnostic>),
    model: impl Fn(T) -> Model,
) -> (Vec<Model>, Vec<Diagnostic>) {
    (vec![model(made)], findings)
}

fn name_of(model: &Model) -> String {
    match model {
        Model::Chart(chart) => chart.name.clone(),
        _ => String::new(),
    }
}
