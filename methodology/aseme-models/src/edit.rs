//! Edits of models as edits of their text: unaffected parts keep their bytes and comments.
//!
//! [`edits`] turns a [`ModelEdit`], such as another guard of a transition, into a few replacements
//! of spans of the text that a person wrote. Undo is therefore that of any text editor, and a file
//! that is edited in a drawing or a form differs only where it was edited. The text may be wrong
//! elsewhere: an edit needs only what it concerns.
//!
//! Roles and all models in the shared text form can be edited. The formulas of a role make its
//! states and transitions: in a drawing its transitions are refined, states get settings and new
//! names, and formulas are edited as text. XMI and SCXML are edited in no way; they can be
//! converted.
//!
//! ```
//! use aseme_models::edit::{ModelEdit, applied, edits};
//!
//! let text = "Role: r\nLiveness:\nr = A . B   # two\nTransitions:\nA -> B : [x]  # why\n";
//! let (chart, _) = aseme_models::statechart_of(&yase::Source::new("r.srm", text));
//! let (id, _) = chart.transitions().nth(1).expect("START -> A, A -> B, B -> END");
//! let edit = ModelEdit::SetTransition { transition: id.0, expression: Some("[y]".into()), modifiers: None };
//! let edited = applied(text, &edits(text, &edit)?);
//! assert_eq!(edited, "Role: r\nLiveness:\nr = A . B   # two\nTransitions:\nA -> B : [y]  # why\n");
//! # Ok::<(), aseme_models::edit::EditRefusal>(())
//! ```

mod chart_edit;
mod complete;
mod item_edit;
mod outline;
mod role_edit;
mod state_reference;

use aseme::SrmFile;
use aseme::text;
use serde::Deserialize;
use yase::Span;

use crate::convert::{KINDS, first_word};
use crate::xmi;

pub use complete::{Completion, Completions, ProgramNames, completions, expression_completions};
pub use outline::{
    ClassOutline, EntryOutline, FieldKind, FieldOutline, ItemOutline, ModelOutline, StateOutline,
    TransitionOutline, outline,
};

/// Replaces a span of a text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TextEdit {
    /// The replaced text, in bytes of the text before all edits; empty for an insertion.
    pub span: Span,
    /// The replacement.
    pub text: String,
}

/// An edit of a model. States and transitions are given by their numbers in the chart that
/// [`statechart_of`](crate::statechart_of) makes of the same text.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(tag = "edit", rename_all = "snake_case", deny_unknown_fields)]
pub enum ModelEdit {
    /// Gives a transition another expression (`event [guard] / action`), or other modifiers
    /// (`!priority %weight interrupts internal`).
    SetTransition {
        /// The number of the transition.
        transition: u32,
        /// The expression, which may be empty; unchanged if absent.
        expression: Option<String>,
        /// The modifiers, which may be empty; unchanged if absent.
        modifiers: Option<String>,
    },
    /// Adds a transition.
    AddTransition {
        /// The number of the state that it leaves.
        source: u32,
        /// The number of the state that it leads to.
        target: u32,
        /// Its expression.
        expression: String,
    },
    /// Removes a transition; of a role, the refinement of one.
    RemoveTransition {
        /// The number of the transition.
        transition: u32,
    },
    /// Renames a state wherever it is named.
    RenameState {
        /// The number of the state.
        state: u32,
        /// Its new name.
        name: String,
    },
    /// Gives a setting of a state a value.
    SetState {
        /// The number of the state.
        state: u32,
        /// The key, such as `activity`.
        key: String,
        /// The value; the setting is removed if absent.
        value: Option<String>,
    },
    /// Adds a state or connector to a chart.
    AddState {
        /// The number of the composite.
        parent: u32,
        /// Its kind, such as `BASIC` or `JUNCTION`.
        kind: String,
        /// Its name; empty for none.
        name: String,
    },
    /// Removes a state or connector of a chart, with what is in it and the transitions there.
    RemoveState {
        /// The number of the state.
        state: u32,
    },
    /// Gives a field of an item of a form a value.
    SetField {
        /// The number of the item in the text.
        item: usize,
        /// The key of the field; empty for the name of the item.
        key: String,
        /// The value; the field is removed if absent.
        value: Option<String>,
    },
    /// Adds an item.
    AddItem {
        /// Its header, such as `Goal`.
        word: String,
        /// Its name.
        name: String,
    },
    /// Removes an item.
    RemoveItem {
        /// The number of the item in the text.
        item: usize,
    },
    /// Replaces an entry of a role by another text.
    SetEntry {
        /// The number of the entry in the text.
        entry: usize,
        /// The text; the entry is removed if absent.
        text: Option<String>,
    },
    /// Adds an entry to a section of a role.
    AddEntry {
        /// The word of the section, such as `Constants`.
        section: String,
        /// The text.
        text: String,
    },
}

/// Why an edit is not possible.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{message}")]
pub struct EditRefusal {
    /// The reason.
    pub message: String,
    /// An alternative, if one is known.
    pub hint: Option<String>,
}

impl EditRefusal {
    pub(crate) fn new(message: impl Into<String>) -> EditRefusal {
        EditRefusal { message: message.into(), hint: None }
    }

    pub(crate) fn with_hint(self, hint: impl Into<String>) -> EditRefusal {
        EditRefusal { hint: Some(hint.into()), ..self }
    }
}

/// The form of a model's text.
enum TextForm {
    Role,
    Chart,
    Items,
    Foreign,
}

fn form(source: &str) -> TextForm {
    match first_word(source).as_str() {
        _ if xmi::is_xml(source) => TextForm::Foreign,
        "IAC" | "EAC" => TextForm::Chart,
        kind if KINDS.contains(&kind) => TextForm::Items,
        _ => TextForm::Role,
    }
}

/// The replacements that make an edit, in order, none within another.
///
/// # Errors
/// The edit is not possible in this text.
pub fn edits(source: &str, edit: &ModelEdit) -> Result<Vec<TextEdit>, EditRefusal> {
    let mut edits = match form(source) {
        TextForm::Foreign => {
            let hint = "convert it: `monas model convert FILE --to text`; the text of the file can be edited";
            return Err(
                EditRefusal::new("XMI and SCXML are not edited in drawings and forms").with_hint(hint)
            );
        }
        TextForm::Role => role_edit::edits(&SrmFile::parse(source).0, edit)?,
        TextForm::Chart => chart_edit::edits(source, edit)?,
        TextForm::Items => item_edit::edits(source, edit)?,
    };
    edits.sort_by_key(|edit| edit.span);
    Ok(edits)
}

/// A text after edits, which are in order.
pub fn applied(source: &str, edits: &[TextEdit]) -> String {
    let (mut text, mut end) = (String::with_capacity(source.len()), 0);
    for edit in edits {
        text.extend([&source[end..edit.span.start.max(end)], &edit.text]);
        end = edit.span.end.max(end);
    }
    text + &source[end..]
}

/// An insertion.
fn insertion(at: usize, text: impl Into<String>) -> TextEdit {
    TextEdit { span: Span::new(at, at), text: text.into() }
}

fn replacement(span: Span, text: impl Into<String>) -> TextEdit {
    TextEdit { span, text: text.into() }
}

/// The start of the line with a position.
fn line_start(source: &str, at: usize) -> usize {
    source[..at].rfind('\n').map_or(0, |end| end + 1)
}

/// The end of the line with a position, before its line break.
fn line_end(source: &str, at: usize) -> usize {
    let end = source[at..].find('\n').map_or(source.len(), |end| at + end);
    if source[at..end].ends_with('\r') { end - 1 } else { end }
}

/// Inserts a line below the one with a position.
fn line_below(source: &str, at: usize, line: &str) -> TextEdit {
    insertion(line_end(source, at), format!("{}{line}", line_break(source)))
}

/// The line break of a text.
fn line_break(source: &str) -> &'static str {
    if source.contains("\r\n") { "\r\n" } else { "\n" }
}

/// Removes the lines of a span, but not the comments on them.
fn without_lines(source: &str, span: Span) -> TextEdit {
    let (start, end) = (line_start(source, span.start), line_end(source, span.end));
    let comments = text::comments_within(source, Span::new(start, end));
    if !comments.is_empty() {
        return replacement(Span::new(start, end), comments.join(line_break(source)));
    }
    let end = source[end..].find('\n').map_or(source.len(), |end_of_line| end + end_of_line + 1);
    replacement(Span::new(start, end), "")
}

/// A text that is written on one line, without comments.
fn on_one_line(text: &str, what: &str) -> Result<String, EditRefusal> {
    let line = if text.contains(['\n', '\r', '\t']) { text::one_line(text) } else { text.trim().to_owned() };
    match text::is_plain(&line) {
        true => Ok(line),
        false => Err(EditRefusal::new(format!("`{line}` is not {what}"))
            .with_hint("`#` begins a comment outside quotes, and a quote needs its end")),
    }
}
