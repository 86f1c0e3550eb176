//! Edits of models that are lists of items: SAG, SUC, AIP, SRM, FT.

use std::collections::BTreeMap;

use aseme::text;
use yase::Span;

use super::{
    EditRefusal, ModelEdit, TextEdit, insertion, line_below, line_break, line_end, line_start, on_one_line,
    replacement, without_lines,
};
use crate::convert::first_word;
use crate::document::{
    Item, ItemDocument, KeyValue, Reference, list, reference, settings, unquoted, value_text,
};
use crate::functionality::FunctionalityTable;
use crate::meta::{Class, Feature, FeatureKind, Metamodel, TypedModel};
use crate::{Aip, Sag, Suc, SystemRoles};

type Edits = Result<Vec<TextEdit>, EditRefusal>;

pub(crate) fn edits(source: &str, edit: &ModelEdit) -> Edits {
    let form = FormText::new(source);
    match edit {
        ModelEdit::SetField { item, key, value } => form.set_field(*item, key, value.as_deref()),
        ModelEdit::AddItem { word, name } => form.add_item(word, name),
        ModelEdit::RemoveItem { item } => form.remove_item(*item),
        _ => Err(EditRefusal::new("this model has items, not states and transitions")),
    }
}

/// The metamodel of a text in the shared form.
pub(crate) fn metamodel_of(source: &str) -> &'static Metamodel {
    match first_word(source).as_str() {
        "SAG" => Sag::METAMODEL,
        "SUC" => Suc::METAMODEL,
        "AIP" => Aip::METAMODEL,
        "SRM" => SystemRoles::METAMODEL,
        _ => FunctionalityTable::METAMODEL,
    }
}

/// A text as items of a metamodel.
pub(crate) struct FormText<'a> {
    source: &'a str,
    pub(crate) metamodel: &'static Metamodel,
    pub(crate) document: ItemDocument,
}

impl<'a> FormText<'a> {
    pub(crate) fn new(source: &'a str) -> FormText<'a> {
        FormText { source, metamodel: metamodel_of(source), document: ItemDocument::parse(source).0 }
    }

    /// The class of an item; the header of the model has none.
    pub(crate) fn class_of(&self, item: &Item) -> Option<&'static Class> {
        self.metamodel.classes.iter().find(|class| class.header == item.word.text)
    }

    /// The text that refers to each item of a class, by its number in the text.
    pub(crate) fn references(&self, class: &Class) -> BTreeMap<usize, Reference> {
        let mut seen: BTreeMap<String, usize> = BTreeMap::new();
        let items = self.document.items.iter().enumerate().filter(|(_, item)| item.word.text == class.header);
        let refer = |(index, item): (usize, &Item)| {
            let name = plain(&item.name.text);
            let number = seen.entry(name.clone()).or_default();
            *number += 1;
            (index, Reference { name, number: *number })
        };
        items.map(refer).collect()
    }

    fn item(&self, index: usize) -> Result<(&Item, &'static Class), EditRefusal> {
        let item = self.document.items.get(index);
        item.and_then(|item| Some((item, self.class_of(item)?)))
            .ok_or_else(|| EditRefusal::new(format!("the model has no item {index}")))
    }

    fn set_field(&self, index: usize, key: &str, value: Option<&str>) -> Edits {
        let (item, class) = self.item(index)?;
        if key.is_empty() {
            return self.rename(index, item, class, value.unwrap_or_default());
        }
        let feature = class.features.iter().enumerate().find(|(position, feature)| {
            feature.key == key
                && *position != class.title
                && !matches!(feature.kind, FeatureKind::Opposite { .. })
        });
        let Some((_, feature)) = feature else {
            return Err(EditRefusal::new(format!("a {} has no `{key}`", class.header)));
        };
        let settings = settings(&item.lines);
        let setting = settings.iter().flatten().find(|setting| setting.key.text == key);
        let value = value.map(str::trim_end).filter(|value| !value.trim().is_empty());
        match value {
            None => Ok(setting.map(|setting| without_setting(self.source, setting)).into_iter().collect()),
            Some(value) if matches!(feature.kind, FeatureKind::Formulas) => {
                Ok(self.set_formulas(item, key, setting, value))
            }
            Some(value) => {
                let value = self.value_of(feature, value)?;
                Ok(vec![match setting {
                    Some(setting) if setting.value.text.is_empty() => {
                        insertion(line_content_end(self.source, setting.value.span.end), format!(" {value}"))
                    }
                    Some(setting) => replacement(setting.value.span, value),
                    None => line_below(
                        self.source,
                        last_line(item),
                        &format!("{:1$}{key} = {value}", "", indent(item)),
                    ),
                }])
            }
        }
    }

    /// A value as it is written, checked as far as its kind says.
    fn value_of(&self, feature: &Feature, value: &str) -> Result<String, EditRefusal> {
        match feature.kind {
            FeatureKind::Choice(choices) if !choices.contains(&value.trim()) => {
                Err(EditRefusal::new(format!("`{value}` is none of {}", choices.join(", "))))
            }
            FeatureKind::Choice(_) => Ok(value.trim().to_owned()),
            FeatureKind::Links { .. } => on_one_line(value, "a list of names"),
            _ => Ok(value_text(value)),
        }
    }

    /// Replaces those lines of a block of formulas that differ.
    fn set_formulas(
        &self,
        item: &Item,
        key: &str,
        setting: Option<&KeyValue<'_>>,
        value: &str,
    ) -> Vec<TextEdit> {
        let ending = line_break(self.source);
        let new: Vec<&str> = value.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        let block = |indent: usize| -> String {
            new.iter().map(|line| format!("{ending}{:1$}{line}", "", indent + 2)).collect()
        };
        let Some(setting) = setting else {
            let indent = indent(item);
            let text = format!("{ending}{:indent$}{key}:{}", "", block(indent));
            return vec![insertion(line_end(self.source, last_line(item)), text)];
        };
        let lines = setting.block.unwrap_or_default();
        let Some(first) = lines.first() else {
            let start = line_start(self.source, setting.key.span.start);
            let own = setting.key.span.start - start;
            let span = Span::new(setting.key.span.start, setting.value.span.end.max(setting.key.span.end));
            let span = Span::new(span.start, line_content_end(self.source, span.end));
            return vec![replacement(span, format!("{key}:{}", block(own)))];
        };
        let old: Vec<&str> = lines.iter().map(|line| line.content.text.as_str()).collect();
        let same = old.iter().zip(&new).take_while(|(old, new)| old == new).count();
        let max = (old.len() - same).min(new.len() - same);
        let end =
            old.iter().rev().zip(new.iter().rev()).take(max).take_while(|(old, new)| old == new).count();
        let (replaced, given) = (&lines[same..lines.len() - end], &new[same..new.len() - end]);
        let mut edits = Vec::new();
        for (line, text) in replaced.iter().zip(given) {
            edits.push(replacement(line.content.span, *text));
        }
        for line in replaced.iter().skip(given.len()) {
            edits.push(without_lines(self.source, line.content.span));
        }
        let above = (same + replaced.len()).checked_sub(1).map(|line| lines[line].content.span.end);
        let more: String = given
            .iter()
            .skip(replaced.len())
            .map(|line| format!("{ending}{:1$}{line}", "", first.indent))
            .collect();
        if !more.is_empty() {
            edits.push(insertion(line_end(self.source, above.unwrap_or(setting.key.span.end)), more));
        }
        edits
    }

    /// Renames an item, and the references to it.
    fn rename(&self, index: usize, item: &Item, class: &'static Class, name: &str) -> Edits {
        let name = name.trim();
        if name.is_empty() && self.metamodel.is_linked(class) {
            return Err(EditRefusal::new(format!("a {} needs a name", class.header)));
        }
        let mut edits = vec![match item.name.text.is_empty() {
            true => insertion(item.word.span.end + 1, format!(" {}", value_text(name))),
            false => replacement(item.name.span, value_text(name)),
        }];
        let known = self.references(class);
        let Some(old) = known.get(&index) else { return Ok(edits) };
        let number = 1 + known.iter().filter(|(other, it)| **other < index && it.name == name).count();
        for (other, class_of_other) in self.items() {
            for setting in settings(&other.lines).into_iter().flatten() {
                let links = |feature: &&Feature| match feature.kind {
                    FeatureKind::Links { class: target, .. } => {
                        feature.key == setting.key.text
                            && self.metamodel.classes[target].header == class.header
                    }
                    _ => false,
                };
                if class_of_other.features.iter().any(|feature| links(&feature)) {
                    let words = list(&setting.value).into_iter();
                    let meant = words.filter(|word| Reference::parse(&word.text).as_ref() == Some(old));
                    edits.extend(meant.map(|word| replacement(word.span, reference(name, number))));
                }
            }
        }
        Ok(edits)
    }

    /// The items with their classes.
    pub(crate) fn items(&self) -> impl Iterator<Item = (&Item, &'static Class)> {
        self.document.items.iter().filter_map(|item| Some((item, self.class_of(item)?)))
    }

    fn add_item(&self, word: &str, name: &str) -> Edits {
        let class = self.metamodel.classes.iter().find(|class| class.header == word);
        let Some(class) = class else {
            return Err(EditRefusal::new(format!(
                "a model of the kind {} has no `{word}`",
                self.metamodel.header
            )));
        };
        let header = match name.trim() {
            "" if self.metamodel.is_linked(class) => {
                return Err(EditRefusal::new(format!("a {word} needs a name")));
            }
            "" => format!("{word}:"),
            name => format!("{word}: {}", value_text(name)),
        };
        let ending = line_break(self.source);
        let same = self.document.items.iter().rfind(|item| item.word.text == word);
        Ok(vec![match same.or(self.document.items.last()) {
            Some(item) => line_below(self.source, last_line(item), &format!("{ending}{header}")),
            None => insertion(
                self.source.len(),
                format!("{}:{ending}{ending}{header}{ending}", self.metamodel.header),
            ),
        }])
    }

    fn remove_item(&self, index: usize) -> Edits {
        let (item, _) = self.item(index)?;
        let start = line_start(self.source, item.word.span.start);
        let end = line_end(self.source, last_line(item));
        let after = self.source[end..].trim_start_matches([' ', '\t', '\r']);
        let mut end = self.source.len() - after.strip_prefix('\n').unwrap_or(after).len();
        // one of two empty lines
        let rest = &self.source[end..];
        let is_empty_before = start == 0
            || self.source[..start].ends_with("\n\n")
            || self.source[..start].ends_with("\r\n\r\n");
        if let (true, Some(blank)) = (is_empty_before, rest.strip_prefix('\n').or(rest.strip_prefix("\r\n")))
        {
            end = self.source.len() - blank.len();
        }
        Ok(vec![replacement(Span::new(start, end), "")])
    }
}

/// A value without quotes, or as it is written if they are wrong.
pub(crate) fn plain(value: &str) -> String {
    unquoted(value).unwrap_or_else(|| value.to_owned())
}

fn without_setting(source: &str, setting: &KeyValue<'_>) -> TextEdit {
    let last = setting.block.and_then(|lines| lines.last()).map(|line| line.content.span.end);
    let end = last.unwrap_or(setting.value.span.end).max(setting.key.span.end);
    without_lines(source, Span::new(setting.key.span.start, end))
}

/// The end of the last line of an item.
fn last_line(item: &Item) -> usize {
    item.lines.last().map_or(item.span().end, |line| line.content.span.end)
}

/// The indentation of an item's lines.
fn indent(item: &Item) -> usize {
    item.lines.iter().map(|line| line.indent).min().unwrap_or(2)
}

/// The end of a line without blanks and comment.
fn line_content_end(source: &str, at: usize) -> usize {
    let blanked = text::without_comments(source);
    let (start, end) = (line_start(source, at), line_end(source, at));
    text::trimmed(&blanked, Span::new(start, end)).end
}
