//! `monas model transform`: transforms a model into another model of the method.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme_models::convert::{Format as ModelFormat, Model};
use aseme_models::iac::{ChartKind, Iac};
use aseme_models::{Aip, SystemRoles, transformations};
use clap::{Args, ValueEnum, ValueHint};
use monas::Registry;
use monas_terminal::{
    CommandFailure, CommandOutput, Exit, Format, FormatArgument, check_distinct, report, write_text,
};
use yase::{Diagnostic, Source};

use super::model_format::{named, text_of};
use super::program;
use crate::input::{valid_chart, valid_model};

/// The kinds of models that a transformation yields.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Kind {
    /// Use cases, from actors and goals.
    Suc,
    /// Protocols, from use cases.
    Aip,
    /// Roles, from use cases.
    Srm,
    /// The functionality table, from roles.
    Ft,
    /// The statechart of a protocol, from protocols.
    Eac,
    /// The statechart of a role, from roles.
    Iac,
}

/// Arguments of `monas model transform`.
#[derive(Args, Debug)]
pub(crate) struct TransformArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// The kind of the result.
    #[arg(long, value_name = "KIND")]
    pub(crate) to: Option<Kind>,
    /// A further input: the protocols (AIP) for an SRM, a protocol's chart (EAC) for an IAC.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) with: Vec<PathBuf>,
    /// An older statechart of the role (IAC) whose additions are kept; those that cannot be kept
    /// are listed.
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub(crate) keep: Option<PathBuf>,
    /// The protocol or role, if there are several.
    #[arg(long)]
    pub(crate) name: Option<String>,
    /// The output file; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// The format of the result: a format of `model convert`, or for a functionality table `table`,
    /// `html` or `csv`. If not given, it follows from the extension of the output file (.iac, .eac,
    /// .stct, .model, .xmi, .scxml, .rs).
    #[arg(long = "as", value_name = "FORMAT")]
    pub(crate) written: Option<String>,
    /// Write the file even if the format cannot represent all of the model.
    #[arg(long)]
    pub(crate) lossy: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &TransformArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    if let Some(output) = &arguments.output {
        check_distinct(&arguments.file, output, "model")?;
        arguments.with.iter().try_for_each(|with| check_distinct(with, output, "model of --with"))?;
    }
    let kind = arguments.to.or(arguments.model_format()?.map(|_| Kind::Iac));
    arguments.check_options(kind)?;
    match kind {
        None => chart(arguments, console),
        Some(kind) => Transformation { arguments, format: arguments.format.value, console }.execute(kind),
    }
}

impl TransformArguments {
    /// Refuses options that this transformation would ignore.
    fn check_options(&self, kind: Option<Kind>) -> Result<(), CommandFailure> {
        let gives_models = !matches!(kind, None | Some(Kind::Ft));
        let takes_others = matches!(kind, Some(Kind::Srm | Kind::Iac));
        let options = [
            ("name", self.name.is_some(), gives_models, "it selects one of the models that `--to` gives"),
            ("keep", self.keep.is_some(), gives_models, "it belongs to `--to iac` and `--to eac`"),
            ("with", !self.with.is_empty(), takes_others, "it belongs to `--to srm` and `--to iac`"),
        ];
        match options.into_iter().find(|(_, is_given, has_effect, _)| *is_given && !has_effect) {
            Some((option, .., reason)) => {
                Err(CommandFailure::Usage(format!("`--{option}` has no effect here: {reason}")))
            }
            None => Ok(()),
        }
    }

    /// The format of models that --as or the extension of the output asks for; none for the outline
    /// of a statechart.
    fn model_format(&self) -> Result<Option<ModelFormat>, CommandFailure> {
        if let Some(word) = self.written.as_deref().filter(|_| self.to != Some(Kind::Ft)) {
            return named(word).map(Some);
        }
        let ending = self.output.as_ref().and_then(|path| path.extension()?.to_str());
        Ok(ending.and_then(|ending| match ending {
            "iac" | "eac" => Some(ModelFormat::Text),
            "txt" => None,
            ending => ModelFormat::of_ending(ending),
        }))
    }
}

/// The statechart that a model describes, as text or JSON.
fn chart(arguments: &TransformArguments, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let chart = valid_chart(&arguments.file, format, console)?;
    let text = match format {
        Format::Text => aseme::to_text(&chart),
        Format::Json => format!("{}\n", serde_json::json!(aseme::to_json(&chart))),
    };
    write_text(arguments.output.as_deref(), &text, format, console)
}

struct Transformation<'a, 'c> {
    arguments: &'a TransformArguments,
    format: Format,
    console: &'a mut CommandOutput<'c>,
}

impl Transformation<'_, '_> {
    fn execute(&mut self, kind: Kind) -> Result<Exit, CommandFailure> {
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
                let (chart, findings) = aseme::role_to_statechart(role.srm());
                self.with_protocols(vec![Iac::from_statechart(&chart, ChartKind::Intra)], findings)?
            }
            (Model::Chart(chart), Kind::Iac) => self.with_protocols(vec![chart], Vec::new())?,
            (Model::Srm(srm), Kind::Ft) => return self.table(&srm),
            (Model::Role(role), Kind::Ft) => return self.table(&SystemRoles::from_role(role.srm()).0),
            (model, _) => return Err(self.unsupported(&model)),
        };
        self.report(findings, &source)?;
        let made = self.with_additions(made, kind)?;
        self.write(made, &source)
    }

    fn unsupported(&self, model: &Model) -> CommandFailure {
        let targets = match model {
            Model::Sag(_) => "suc",
            Model::Suc(_) => "aip and srm",
            Model::Aip(_) => "eac",
            Model::Srm(_) | Model::Role(_) => "iac and ft",
            _ => "iac, with an EAC",
        };
        CommandFailure::Usage(format!(
            "`{}` is a model of the kind {}; it can be transformed to {targets}",
            self.arguments.file.display(),
            model.kind()
        ))
    }

    /// Reports findings; fails if there are errors.
    fn report(&mut self, findings: Vec<Diagnostic>, source: &Arc<Source>) -> Result<(), CommandFailure> {
        let findings: Vec<Diagnostic> =
            findings.into_iter().map(|finding| finding.in_source(source)).collect();
        if findings.iter().any(Diagnostic::is_error) {
            return Err(CommandFailure::Invalid(self.format, findings));
        }
        Ok(report::write(self.console, self.format, &findings)?)
    }

    fn aip(&mut self) -> Result<Option<Aip>, CommandFailure> {
        let Some(path) = self.arguments.with.first() else { return Ok(None) };
        match self.other(path)? {
            Model::Aip(aip) => Ok(Some(aip)),
            other => Err(wrong_kind(path, &other, "AIP")),
        }
    }

    fn other(&mut self, path: &Path) -> Result<Model, CommandFailure> {
        valid_model(path, self.format, self.console).map(|(_, model, ..)| model)
    }

    fn roles(&mut self, srm: &SystemRoles) -> Result<(Vec<Model>, Vec<Diagnostic>), CommandFailure> {
        let (charts, findings) = transformations::roles_to_iac(srm);
        self.with_protocols(charts, findings)
    }

    /// Charts of roles, merged with the protocols' charts.
    fn with_protocols(
        &mut self,
        mut charts: Vec<Iac>,
        mut findings: Vec<Diagnostic>,
    ) -> Result<(Vec<Model>, Vec<Diagnostic>), CommandFailure> {
        for path in &self.arguments.with {
            let eac = match self.other(path)? {
                Model::Chart(eac) => eac,
                other => return Err(wrong_kind(path, &other, "EAC")),
            };
            let merged: Vec<_> =
                charts.iter_mut().map(|chart| transformations::merge_eac(chart, &eac)).collect();
            // of several roles some take part in a protocol
            let is_taken = merged.iter().any(|(composites, _)| !composites.is_empty());
            let found = merged.into_iter().flat_map(|(_, found)| found);
            findings.extend(found.filter(|finding| !(is_taken && finding.code == "E0837")));
        }
        Ok((charts.into_iter().map(Model::Chart).collect(), findings))
    }

    /// The chart with the additions of an older one.
    fn with_additions(&mut self, made: Vec<Model>, kind: Kind) -> Result<Vec<Model>, CommandFailure> {
        let Some(path) = &self.arguments.keep else { return Ok(made) };
        let mut made = self.selected(made)?;
        let [Model::Chart(chart)] = made.as_mut_slice() else {
            let reason = if kind == Kind::Iac { "of one chart: select it with --name" } else { "of an IAC" };
            return Err(CommandFailure::Usage(format!(
                "--keep takes refinements of an older model {reason}"
            )));
        };
        let (source, older, ..) = valid_model(path, self.format, self.console)?;
        let Model::Chart(older) = older else { return Err(wrong_kind(path, &older, "IAC")) };
        let lost = aseme_models::regenerate::transfer_refinements(&older, chart);
        let lost: Vec<Diagnostic> = lost.into_iter().map(|found| found.in_source(&source)).collect();
        report::write(self.console, self.format, &lost)?;
        Ok(made)
    }

    fn table(&mut self, srm: &SystemRoles) -> Result<Exit, CommandFailure> {
        let mut table = transformations::functionality_table(srm);
        let registry = Registry::linked();
        table.complete(|activity| program::functionality(&registry, activity));
        let text = match self.arguments.written.as_deref() {
            None | Some("table") => table.to_table(),
            Some("html") => table.to_html(),
            Some("csv") => table.to_csv(),
            Some("text") => Model::Ft(table).to_text(),
            Some(word) => {
                return Err(CommandFailure::Usage(format!(
                    "a functionality table is written as table, html, csv or text, not as `{word}`"
                )));
            }
        };
        write_text(self.arguments.output.as_deref(), &text, self.format, self.console)
    }

    fn write(&mut self, made: Vec<Model>, source: &Arc<Source>) -> Result<Exit, CommandFailure> {
        let wanted = self.arguments.model_format()?.unwrap_or(ModelFormat::Text);
        let made = self.selected(made)?;
        let mut texts = Vec::new();
        // Comments belong to the source model and are not copied.
        let nowhere = Source::new(source.name.clone(), "");
        for model in &made {
            texts.push(text_of(model, wanted, &nowhere, 0, self.arguments.lossy, self.format, self.console)?);
        }
        write_text(self.arguments.output.as_deref(), &texts.join("\n"), self.format, self.console)
    }

    /// The model that --name selects; all if they go to standard output.
    fn selected(&self, made: Vec<Model>) -> Result<Vec<Model>, CommandFailure> {
        let names: Vec<String> = made.iter().map(name_of).collect();
        let list = || names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        match &self.arguments.name {
            Some(name) if !names.contains(name) => {
                Err(CommandFailure::Usage(format!("there is no `{name}`; there are {}", list())))
            }
            Some(name) => Ok(made.into_iter().filter(|model| name_of(model) == *name).collect()),
            None if made.len() > 1 && self.arguments.output.is_some() => Err(CommandFailure::Usage(format!(
                "there are {}: {}; select one with --name",
                made.len(),
                list()
            ))),
            None => Ok(made),
        }
    }
}

fn wrong_kind(path: &Path, model: &Model, wanted: &str) -> CommandFailure {
    CommandFailure::Usage(format!(
        "`{}` is a model of the kind {}, not {wanted}",
        path.display(),
        model.kind()
    ))
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
