//! The report on mutants as text and JSON.

use std::sync::Arc;

use aseme_verify::mutation::MutationKind;
use monas_terminal::{CommandFailure, CommandOutput, Format};
use serde_json::{Value, json};
use yase::Source;

use super::{EvaluatedMutant, MutantOutcome};
use crate::commands::model::scenario::{Scenario, file_and_line};

/// The outcomes of all mutants of a model.
pub(crate) struct MutationReport<'a> {
    pub(crate) source: Arc<Source>,
    pub(crate) judged: Vec<EvaluatedMutant>,
    pub(crate) scenarios: &'a [Scenario],
}

/// The number of mutants by outcome.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
struct OutcomeCount {
    made: usize,
    refused: usize,
    noticed: usize,
}

impl OutcomeCount {
    fn add(&mut self, verdict: &MutantOutcome) {
        self.made += 1;
        self.refused += usize::from(matches!(verdict, MutantOutcome::Refused(_)));
        self.noticed += usize::from(matches!(verdict, MutantOutcome::Killed(..)));
    }

    /// The number of mutants that can run.
    fn able(self) -> usize {
        self.made - self.refused
    }

    fn survived(self) -> usize {
        self.able() - self.noticed
    }

    /// The percentage of the runnable mutants that is detected.
    fn percent(self) -> f64 {
        if self.able() == 0 { 100.0 } else { 100.0 * self.noticed as f64 / self.able() as f64 }
    }
}

impl MutationReport<'_> {
    /// Whether at least this percentage is detected.
    pub(crate) fn is_least(&self, percent: u8) -> bool {
        let all = self.count(|_| true);
        all.noticed * 100 >= all.able() * usize::from(percent)
    }

    fn count(&self, is_meant: impl Fn(MutationKind) -> bool) -> OutcomeCount {
        let mut count = OutcomeCount::default();
        self.judged.iter().filter(|it| is_meant(it.mutant.kind)).for_each(|it| count.add(&it.verdict));
        count
    }

    /// The kinds of mutants that occur, with their counts.
    fn kinds(&self) -> impl Iterator<Item = (MutationKind, OutcomeCount)> + '_ {
        let counted = MutationKind::ALL.into_iter().map(|kind| (kind, self.count(|it| it == kind)));
        counted.filter(|(_, count)| count.made > 0)
    }

    pub(crate) fn write(
        &self,
        format: Format,
        console: &mut CommandOutput<'_>,
    ) -> Result<(), CommandFailure> {
        match format {
            Format::Text => self.text(console),
            Format::Json => self.json(console),
        }
    }

    fn text(&self, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
        let all = self.count(|_| true);
        let scenarios = match self.scenarios.len() {
            1 => String::from("1 scenario notices"),
            several => format!("{several} scenarios notice"),
        };
        let refused = match all.refused {
            0 => String::new(),
            refused => format!("; {refused} more cannot run"),
        };
        let (noticed, able, percent) = (all.noticed, all.able(), all.percent());
        writeln!(
            console.out,
            "{}: {scenarios} {noticed} of {able} mutants ({percent:.1} %){refused}",
            self.source.name
        )?;
        writeln!(console.out, "  {:<20}{:>8}{:>9}{:>9}", "", "noticed", "survive", "refused")?;
        for (kind, count) in self.kinds() {
            let (noticed, survived) = (count.noticed, count.survived());
            writeln!(console.out, "  {:<20}{noticed:>8}{survived:>9}{:>9}", kind.word(), count.refused)?;
        }
        self.survivors(console)?;
        self.refused(console)
    }

    fn survivors(&self, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
        let survivors: Vec<&EvaluatedMutant> =
            self.judged.iter().filter(|it| matches!(it.verdict, MutantOutcome::Survived)).collect();
        if !survivors.is_empty() {
            writeln!(console.out, "no scenario notices:")?;
        }
        for EvaluatedMutant { mutant, .. } in survivors {
            writeln!(console.out, "  {}: {}", self.file_and_line(mutant.span.start), mutant.description)?;
            writeln!(console.out, "    a scenario would have to show {}", mutant.wanted)?;
        }
        Ok(())
    }

    fn refused(&self, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
        let mut is_first = true;
        for EvaluatedMutant { mutant, verdict } in &self.judged {
            let MutantOutcome::Refused(why) = verdict else { continue };
            if std::mem::take(&mut is_first) {
                writeln!(console.out, "cannot run:")?;
            }
            writeln!(console.out, "  {}: {}", self.file_and_line(mutant.span.start), mutant.description)?;
            writeln!(console.out, "    {why}")?;
        }
        Ok(())
    }

    /// `file:line`
    fn file_and_line(&self, byte: usize) -> String {
        format!("{}:{}", self.source.name, self.source.position(byte).0)
    }

    /// One object per mutant, and a summary.
    fn json(&self, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
        for judged in &self.judged {
            writeln!(console.out, "{}", self.object(judged))?;
        }
        let all = self.count(|_| true);
        let kinds: serde_json::Map<String, Value> =
            self.kinds().map(|(kind, count)| (kind.word().to_owned(), figures(count))).collect();
        let files: Vec<String> = self.scenarios.iter().map(|it| it.file.display().to_string()).collect();
        let mut object = figures(all);
        if let Some(fields) = object.as_object_mut() {
            fields.insert("kind".into(), "mutation".into());
            fields.insert("model".into(), self.source.name.clone().into());
            fields.insert("percent".into(), all.percent().into());
            fields.insert("kinds".into(), kinds.into());
            fields.insert("scenarios".into(), files.into());
        }
        writeln!(console.out, "{object}")?;
        Ok(())
    }

    fn object(&self, EvaluatedMutant { mutant, verdict }: &EvaluatedMutant) -> Value {
        let (word, by, at, why) = match verdict {
            MutantOutcome::Refused(why) => ("refused", None, None, Some(why.clone())),
            MutantOutcome::Killed(scenario, difference) => {
                let by = self.scenarios.get(*scenario).map(|it| it.file.display().to_string());
                ("noticed", by, Some(file_and_line(difference)), Some(difference.to_string()))
            }
            MutantOutcome::Survived => ("survived", None, None, None),
        };
        json!({
            "kind": "mutant",
            "name": mutant.name,
            "path": mutant.path,
            "change": mutant.kind.word(),
            "description": mutant.description,
            "wanted": mutant.wanted,
            "file": self.source.name,
            "line": self.source.position(mutant.span.start).0,
            "verdict": word,
            "scenario": by,
            "at": at,
            "why": why,
        })
    }
}

fn figures(count: OutcomeCount) -> Value {
    json!({
        "made": count.made,
        "refused": count.refused,
        "noticed": count.noticed,
        "survived": count.survived(),
    })
}
