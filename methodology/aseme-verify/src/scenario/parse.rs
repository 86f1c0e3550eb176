//! Parser of scenarios, without resolution of names.

use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

use super::{ScenarioLink, ScenarioText, StepLines};
use aseme::text;

impl ScenarioText {
    /// Parses a scenario; the findings are E0890 to E0892.
    pub fn parse(source: &Arc<Source>) -> (ScenarioText, Vec<Diagnostic>) {
        let blanked = text::without_comments(&source.text);
        let script = ScenarioText { source: source.clone(), model: None, after: None, steps: Vec::new() };
        let mut reader = Reader { script, blanked: &blanked, found: Vec::new() };
        for line in text::lines_of(&blanked, Span::new(0, blanked.len())) {
            reader.line(line);
        }
        reader.finish()
    }
}

struct Reader<'a> {
    script: ScenarioText,
    blanked: &'a str,
    found: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn line(&mut self, line: Span) {
        let span = text::trimmed(self.blanked, line);
        if span.start == span.end {
            return;
        }
        let content = &self.blanked[span.start..span.end];
        let (word, rest) = content.split_once(char::is_whitespace).unwrap_or((content, ""));
        match (span.start == line.start, word) {
            (true, "model" | "after") => self.link(word == "model", span, rest.trim()),
            (true, _) => self.script.steps.push(StepLines { cause: span, details: Vec::new() }),
            (false, _) => match self.script.steps.last_mut() {
                Some(step) => step.details.push(span),
                None => self.report(
                    Diagnostic::error("E0890", span, "this line belongs to no step")
                        .with_hint("a step starts at the beginning of a line, its details are indented"),
                ),
            },
        }
    }

    fn link(&mut self, is_model: bool, span: Span, path: &str) {
        let word = if is_model { "model" } else { "after" };
        let target = if is_model { &mut self.script.model } else { &mut self.script.after };
        let link = ScenarioLink { path: path.to_owned(), span };
        let wrong = match (path.is_empty(), &target, self.script.steps.is_empty()) {
            (true, ..) => Some(format!("`{word}` names no file")),
            (_, Some(_), _) => Some(format!("a second `{word}`")),
            (_, _, false) => Some(format!("`{word}` after a step")),
            _ => None,
        };
        match wrong {
            None => *target = Some(link),
            Some(message) => self.report(
                Diagnostic::error("E0891", span, message)
                    .with_hint("a scenario starts with one line `model FILE` and optionally `after FILE`"),
            ),
        }
    }

    fn finish(mut self) -> (ScenarioText, Vec<Diagnostic>) {
        if self.script.model.is_none() {
            let wrong = Diagnostic::error("E0891", Span::default(), "the scenario names no model");
            self.report(wrong.with_hint("start it with `model FILE`, relative to its own folder"));
        }
        self.starts();
        let Reader { script, found, .. } = self;
        let found = found.into_iter().map(|wrong| wrong.in_source(&script.source)).collect();
        (script, found)
    }

    /// Checks that only the first step starts the chart.
    fn starts(&mut self) {
        let goes_on = self.script.after.is_some();
        let mut wrong = Vec::new();
        for (index, step) in self.script.steps.iter().enumerate() {
            let is_start = &self.blanked[step.cause.start..step.cause.end] == "start";
            if is_start != (index == 0 && !goes_on) {
                let message = match is_start {
                    true => "the chart was started already",
                    false if index == 0 => "the chart was not started",
                    false => continue,
                };
                let hint = "a scenario starts with the step `start`, unless it is `after` another";
                wrong.push(Diagnostic::error("E0892", step.cause, message).with_hint(hint));
            }
        }
        if self.script.steps.is_empty() {
            let none = Diagnostic::error("E0892", Span::default(), "the scenario has no step");
            wrong.push(none.with_hint("the first step is `start`"));
        }
        wrong.into_iter().for_each(|wrong| self.report(wrong));
    }

    fn report(&mut self, wrong: Diagnostic) {
        self.found.push(wrong);
    }
}
