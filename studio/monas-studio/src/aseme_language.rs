//! The models of the method, with the names of the program that runs them.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use aseme::SrmFile;
use aseme_models::edit::{
    self, Completions, FieldKind, ModelEdit, ModelOutline, ProgramNames, StateOutline, TransitionOutline,
};
use aseme_models::{convert, statechart_of};
use aseme_verify::{CheckSettings, ProgramSymbols, ProgressObserver};
use serde_json::{Value, json};
use yase::{Diagnostic, Source};

use crate::model_workspace::ModelLanguage;
use crate::text_positions::TextPositions;
use crate::time::now;

/// The functionality and the technology of an activity, if the program has it.
type Functionality = dyn Fn(&str) -> Option<(String, String)> + Send + Sync;

/// Limits of a check in time and states, since a page waits for it.
const CHECK_LIMIT: Duration = Duration::from_secs(20);
const CHECK_STATES: usize = 20_000;

/// The largest number of completion entries.
const MAX_ENTRIES: usize = 1000;

/// The language of models with the messages, functions and activities of a program.
pub struct AsemeLanguage {
    symbols: ProgramSymbols,
    activities: Vec<String>,
    functionality: Box<Functionality>,
}

impl AsemeLanguage {
    /// The language with these symbols; `functionality` gives that of an activity, and its
    /// technology.
    pub fn new(
        symbols: ProgramSymbols,
        functionality: impl Fn(&str) -> Option<(String, String)> + Send + Sync + 'static,
    ) -> AsemeLanguage {
        let activities = symbols.activities.keys().cloned().collect();
        AsemeLanguage { symbols, activities, functionality: Box::new(functionality) }
    }

    fn names(&self) -> ProgramNames<'_> {
        ProgramNames { environment: &self.symbols.vocabulary, activities: &self.activities }
    }

    fn parts_object(&self, parts: &ModelOutline, text: &str, positions: &TextPositions) -> Value {
        let states = |states: &[StateOutline]| -> Value {
            let state = |state: &StateOutline| {
                let (from, to) = positions.range(state.span);
                let settings: serde_json::Map<String, Value> =
                    state.settings.iter().map(|(key, value)| (key.clone(), json!(value))).collect();
                json!({"from": from, "to": to, "settings": settings})
            };
            states.iter().map(state).collect()
        };
        let transitions = |transitions: &[TransitionOutline]| -> Value {
            let transition = |it: &TransitionOutline| {
                let range = it.span.map(|span| positions.range(span));
                json!({"from": range.map(|range| range.0), "to": range.map(|range| range.1),
                    "expression": it.expression, "modifiers": it.modifiers, "shared": it.is_shared})
            };
            transitions.iter().map(transition).collect()
        };
        match parts {
            ModelOutline::Role { states: nodes, transitions: arrows, entries } => {
                let entry = |entry: &edit::EntryOutline| {
                    let (from, to) = positions.range(entry.span);
                    json!({"section": entry.section, "from": from, "to": to,
                        "text": text[entry.span.start..entry.span.end]})
                };
                json!({"form": "role", "states": states(nodes), "transitions": transitions(arrows),
                    "entries": entries.iter().map(entry).collect::<Vec<_>>(), "table": self.table(text)})
            }
            ModelOutline::Chart { states: nodes, transitions: arrows } => {
                json!({"form": "chart", "states": states(nodes), "transitions": transitions(arrows)})
            }
            ModelOutline::Form { classes, items } => {
                let item = |item: &edit::ItemOutline| {
                    let (from, to) = positions.range(item.span);
                    let fields: serde_json::Map<String, Value> =
                        item.fields.iter().map(|(key, values)| ((*key).to_owned(), json!(values))).collect();
                    json!({"item": item.item, "word": item.word, "name": item.name, "reference": item.reference,
                        "from": from, "to": to, "fields": fields})
                };
                json!({"form": "items", "classes": classes.iter().map(class_object).collect::<Vec<_>>(),
                    "items": items.iter().map(item).collect::<Vec<_>>()})
            }
            _ => json!({"form": "text"}),
        }
    }

    /// The functionality of each activity of a role, as this program implements it.
    fn table(&self, text: &str) -> Value {
        let (file, _) = SrmFile::parse(text);
        let (chart, _) = aseme::role_to_statechart(file.srm());
        let mut names: Vec<String> = chart.nodes().filter_map(|(_, node)| node.activity.clone()).collect();
        names.sort();
        names.dedup();
        let row = |name: String| {
            let known = (self.functionality)(&name);
            let (functionality, technology) = known.unwrap_or_default();
            json!({"activity": name, "functionality": functionality, "technology": technology})
        };
        names.into_iter().map(row).collect()
    }
}

impl ModelLanguage for AsemeLanguage {
    fn outline(&self, name: &str, text: &str) -> Value {
        let source = Source::new(name, text);
        let (positions, parts) = (TextPositions::of(text), edit::outline(text));
        let is_form = matches!(parts, ModelOutline::Form { .. });
        let (picture, findings) = match is_form {
            true => (Value::Null, convert::read(&source).1),
            false => {
                let (chart, findings) = statechart_of(&source);
                let is_drawn = chart.nodes().len() > 1;
                let picture = is_drawn.then(|| yase_export::to_picture(&chart, &[]));
                (picture.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default(), findings)
            }
        };
        json!({"done": true, "picture": picture, "parts": self.parts_object(&parts, text, &positions),
            "findings": findings.iter().map(|it| finding(it, None, &positions)).collect::<Vec<_>>()})
    }

    fn check(&self, name: &str, text: &str, stop: &Arc<AtomicBool>) -> Value {
        let mut settings = CheckSettings::default();
        settings.world = Some(self.symbols.clone());
        settings.states = CHECK_STATES;
        let (begin, stop) = (now(), stop.clone());
        settings.observer = ProgressObserver::new(move |_| {
            match stop.load(Ordering::SeqCst) || now().saturating_duration_since(begin) > CHECK_LIMIT {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let report = aseme_verify::check::check(&Source::new(name, text), &settings);
        let positions = TextPositions::of(text);
        let findings =
            report.findings.iter().filter(|it| it.diagnostic.severity > yase::Severity::Information);
        let findings = findings.map(|it| finding(&it.diagnostic, it.trace.as_deref(), &positions));
        json!({"done": true, "what": report.kind, "stopped": report.is_stopped,
            "findings": findings.collect::<Vec<_>>()})
    }

    fn complete(&self, text: &str, expression: Option<&str>, at: usize) -> Value {
        let completed = expression.unwrap_or(text);
        let positions = TextPositions::of(completed);
        let at = positions.byte(at);
        let Completions { word, entries } = match expression {
            Some(expression) => edit::expression_completions(text, expression, at, self.names()),
            None => edit::completions(text, at, self.names()),
        };
        let (from, to) = positions.range(word);
        let entries = entries.into_iter().take(MAX_ENTRIES);
        let entries = entries.map(|it| json!({"text": it.text, "kind": it.kind, "detail": it.detail}));
        json!({"done": true, "from": from, "to": to, "entries": entries.collect::<Vec<_>>()})
    }

    fn edit(&self, text: &str, edit: Value) -> Result<Value, String> {
        let edit: ModelEdit =
            serde_json::from_value(edit).map_err(|error| format!("not an edit: {error}"))?;
        let edits = edit::edits(text, &edit).map_err(|refused| match refused.hint {
            Some(hint) => format!("{}: {hint}", refused.message),
            None => refused.message,
        })?;
        let positions = TextPositions::of(text);
        let edits = edits.into_iter().map(|edit| {
            let (from, to) = positions.range(edit.span);
            json!({"from": from, "to": to, "insert": edit.text})
        });
        Ok(json!({"done": true, "edits": edits.collect::<Vec<_>>()}))
    }
}

fn finding(diagnostic: &Diagnostic, trace: Option<&str>, positions: &TextPositions) -> Value {
    let (from, to) = positions.range(diagnostic.span);
    let (line, column) = diagnostic.position().unwrap_or_default();
    json!({"code": diagnostic.code, "error": diagnostic.is_error(), "text": diagnostic.message,
        "hint": diagnostic.hint.as_deref().unwrap_or_default(), "file": "", "line": line, "column": column,
        "from": from, "to": to, "trace": trace})
}

fn class_object(class: &edit::ClassOutline) -> Value {
    let field = |field: &edit::FieldOutline| match &field.kind {
        FieldKind::Formulas => json!({"key": field.key, "kind": "formulas"}),
        FieldKind::Choice(choices) => json!({"key": field.key, "kind": "choice", "choices": choices}),
        FieldKind::Links(word, many) => {
            json!({"key": field.key, "kind": "links", "class": word, "many": many})
        }
        FieldKind::Text => json!({"key": field.key, "kind": "text"}),
    };
    json!({"word": class.word, "title": class.title, "fields": class.fields.iter().map(field).collect::<Vec<_>>()})
}

#[cfg(test)]
mod tests {
    use super::*;

    fn language() -> AsemeLanguage {
        AsemeLanguage::new(ProgramSymbols::default(), |_| None)
    }

    #[test]
    fn positions_are_those_of_a_page() {
        let text = "Liveness:\nr = Waitω . Wait\nTransitions:\nWait -> nowhere : [x]\n";
        let outline = language().outline("r.srm", text);
        let units: Vec<u16> = text.encode_utf16().collect();
        let finding = &outline["findings"][0];
        let range = |key: &str| finding[key].as_u64().unwrap_or_default() as usize;
        let marked = String::from_utf16(&units[range("from")..range("to")]).expect("whole characters");
        assert_eq!((marked.as_str(), &finding["line"]), ("Wait -> nowhere : [x]", &json!(4)));
        assert_eq!(outline["parts"]["form"], "role");
        assert!(outline["picture"]["nodes"].as_array().is_some_and(|nodes| nodes.len() > 3));
    }

    #[test]
    fn edits_are_read_strictly_and_refused_with_a_reason() {
        let text = "SAG:\n\nGoal: ω\n\nActor: Team\n";
        let edit = |edit: Value| language().edit(text, edit);
        let added = edit(json!({"edit": "set_field", "item": 1, "key": "depender", "value": "Team"}));
        let added = added.expect("it is possible");
        assert_eq!(added["edits"], json!([{"from": 13, "to": 13, "insert": "\n  depender = Team"}]));
        let unknown = edit(json!({"edit": "set_field", "item": 1, "key": "x", "colour": 1})).unwrap_err();
        assert!(unknown.contains("colour"), "{unknown}");
        let refused = edit(json!({"edit": "remove_item", "item": 9})).unwrap_err();
        assert!(refused.contains("no item 9"), "{refused}");
    }
}
