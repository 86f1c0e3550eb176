//! What is told of mutants: for people, and for programs.

use std::sync::Arc;

use aseme::mutation::Kind;
use serde_json::{Value, json};
use yase::Source;

use super::{Judged, Verdict};
use crate::arguments::Format;
use crate::console::Console;
use crate::failure::Failure;
use crate::model::scenario::{Scenario, place};

/// All that is to be told.
pub(super) struct Report<'a> {
    pub(super) source: Arc<Source>,
    pub(super) judged: Vec<Judged>,
    pub(super) scenarios: &'a [Scenario],
}

/// How many mutants there are of what became of them.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
struct Count {
    made: usize,
    refused: usize,
    noticed: usize,
}

impl Count {
    fn add(&mut self, verdict: &Verdict) {
        self.made += 1;
        self.refused += usize::from(matches!(verdict, Verdict::Refused(_)));
        self.noticed += usize::from(matches!(verdict, Verdict::Noticed(..)));
    }

    /// Those that can run.
    fn able(self) -> usize {
        self.made - self.refused
    }

    fn survived(self) -> usize {
        self.able() - self.noticed
    }

    /// Of a hundred that can run so many are noticed.
    fn percent(self) -> f64 {
        if self.able() == 0 { 100.0 } else { 100.0 * self.noticed as f64 / self.able() as f64 }
    }
}

impl Report<'_> {
    /// Whether so many of a hundred are noticed.
    pub(super) fn is_least(&self, percent: u8) -> bool {
        let all = self.count(|_| true);
        all.noticed * 100 >= all.able() * usize::from(percent)
    }

    fn count(&self, is_meant: impl Fn(Kind) -> bool) -> Count {
        let mut count = Count::default();
        self.judged.iter().filter(|it| is_meant(it.mutant.kind)).for_each(|it| count.add(&it.verdict));
        count
    }

    /// The kinds of which there are any, with how many.
    fn kinds(&self) -> impl Iterator<Item = (Kind, Count)> + '_ {
        let counted = Kind::ALL.into_iter().map(|kind| (kind, self.count(|it| it == kind)));
        counted.filter(|(_, count)| count.made > 0)
    }

    pub(super) fn write(&self, format: Format, console: &mut Console<'_>) -> Result<(), Failure> {
        match format {
            Format::Text => self.text(console),
            Format::Json => self.json(console),
        }
    }

    fn text(&self, console: &mut Console<'_>) -> Result<(), Failure> {
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

    fn survivors(&self, console: &mut Console<'_>) -> Result<(), Failure> {
        let survivors: Vec<&Judged> =
            self.judged.iter().filter(|it| matches!(it.verdict, Verdict::Survived)).collect();
        if !survivors.is_empty() {
            writeln!(console.out, "no scenario notices:")?;
        }
        for Judged { mutant, .. } in survivors {
            writeln!(console.out, "  {}: {}", self.place(mutant.span.start), mutant.description)?;
            writeln!(console.out, "    a scenario would have to show {}", mutant.wanted)?;
        }
        Ok(())
    }

    fn refused(&self, console: &mut Console<'_>) -> Result<(), Failure> {
        let mut is_first = true;
        for Judged { mutant, verdict } in &self.judged {
            let Verdict::Refused(why) = verdict else { continue };
            if std::mem::take(&mut is_first) {
                writeln!(console.out, "cannot run:")?;
            }
            writeln!(console.out, "  {}: {}", self.place(mutant.span.start), mutant.description)?;
            writeln!(console.out, "    {why}")?;
        }
        Ok(())
    }

    /// `file:line`
    fn place(&self, byte: usize) -> String {
        format!("{}:{}", self.source.name, self.source.position(byte).0)
    }

    /// An object for each mutant, and one of them all.
    fn json(&self, console: &mut Console<'_>) -> Result<(), Failure> {
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

    fn object(&self, Judged { mutant, verdict }: &Judged) -> Value {
        let (word, by, at, why) = match verdict {
            Verdict::Refused(why) => ("refused", None, None, Some(why.clone())),
            Verdict::Noticed(scenario, difference) => {
                let by = self.scenarios.get(*scenario).map(|it| it.file.display().to_string());
                ("noticed", by, Some(place(difference)), Some(difference.to_string()))
            }
            Verdict::Survived => ("survived", None, None, None),
        };
        json!({
            "kind": "mutant",
            "name": mutant.name,
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

fn figures(count: Count) -> Value {
    json!({
        "made": count.made,
        "refused": count.refused,
        "noticed": count.noticed,
        "survived": count.survived(),
    })
}
