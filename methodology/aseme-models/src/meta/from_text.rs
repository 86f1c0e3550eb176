//! Parser of model instances in text.

use std::collections::BTreeMap;

use yase::Diagnostic;
use yase::diagnostic::Suggestions;
use yase::expression::TextPosition;

use super::{Class, Feature, FeatureKind, FeatureValue, Metamodel, ModelInstance, Object, UNLIMITED};
use crate::document::{Item, ItemDocument, KeyValue, Line, Reference, SpannedText, list, settings, unquoted};

/// Parses a model from text; the findings are E0261 to E0269.
pub(crate) fn from_text(metamodel: &Metamodel, document: &ItemDocument) -> (ModelInstance, Vec<Diagnostic>) {
    let mut reader = Reader {
        metamodel,
        titles: Vec::new(),
        suggestions: Suggestions::default(),
        diagnostics: Vec::new(),
    };
    let items = reader.sorted(document);
    reader.titles =
        metamodel.classes.iter().zip(&items).map(|(class, items)| reader.titles(class, items)).collect();
    let mut instance = metamodel.empty();
    for (index, items) in items.iter().enumerate() {
        instance.objects[index] =
            items.iter().map(|item| reader.object(&metamodel.classes[index], item)).collect();
    }
    (instance, reader.diagnostics)
}

struct Reader<'a> {
    metamodel: &'a Metamodel,
    /// For each class, the index of the k-th object of a name.
    titles: Vec<BTreeMap<Reference, usize>>,
    suggestions: Suggestions,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// The items of each class; the first item names the kind of the model.
    fn sorted<'a>(&mut self, document: &'a ItemDocument) -> Vec<Vec<&'a Item>> {
        let mut sorted: Vec<Vec<&Item>> = self.metamodel.classes.iter().map(|_| Vec::new()).collect();
        for (index, item) in document.items.iter().enumerate() {
            let word = item.word.text.as_str();
            match self.metamodel.classes.iter().position(|class| class.header == word) {
                Some(class) => sorted[class].push(item),
                None if index == 0 && word == self.metamodel.header => self.kind(item),
                None => {
                    let message = format!("a model of the kind {} has no `{word}`", self.metamodel.header);
                    let words = self.metamodel.classes.iter().map(|class| class.header);
                    let hint = format!("headers are {}", words.clone().collect::<Vec<_>>().join(", "));
                    let found = Diagnostic::error("E0261", item.word.span, message).with_hint(hint);
                    self.report(found.with_nearest(word, words));
                }
            }
        }
        sorted
    }

    /// Checks that the header of the model has neither a name nor lines.
    fn kind(&mut self, item: &Item) {
        let too_much = (!item.name.text.is_empty()).then_some(item.name.span);
        if let Some(span) = too_much.or(item.lines.first().map(|line| line.content.span)) {
            let message = format!("`{}:` has no settings", item.word.text);
            self.report(
                Diagnostic::error("E0262", span, message).with_hint("start an item with its own header"),
            );
        }
    }

    fn titles(&mut self, class: &Class, items: &[&Item]) -> BTreeMap<Reference, usize> {
        let mut seen: BTreeMap<String, usize> = BTreeMap::new();
        let mut titles = BTreeMap::new();
        for (index, item) in items.iter().enumerate() {
            let name = self.plain(&item.name);
            let number = seen.entry(name.clone()).or_default();
            *number += 1;
            if *number == 2 && !name.is_empty() && self.metamodel.is_linked(class) {
                let message = format!("another {} has the name `{name}`", class.header);
                let hint = format!("give it another name, or refer to it as `{name}[2]`");
                self.report(Diagnostic::warning("E0263", item.span(), message).with_hint(hint));
            }
            titles.insert(Reference { name, number: *number }, index);
        }
        titles
    }

    /// The content of a value.
    fn plain(&mut self, value: &SpannedText) -> String {
        unquoted(&value.text).unwrap_or_else(|| {
            let message = format!("`{}` cannot be read", value.text);
            let hint =
                "a quoted value ends with a quote and may contain the escapes `\\n`, `\\t`, `\\\"` and `\\\\`";
            self.report(Diagnostic::error("E0264", value.span, message).with_hint(hint));
            value.text.clone()
        })
    }

    fn object(&mut self, class: &Class, item: &Item) -> Object {
        let mut object = class.object();
        object.position = TextPosition(item.span());
        object.values[class.title] =
            FeatureValue::Text(unquoted(&item.name.text).unwrap_or_else(|| item.name.text.clone()));
        object.value_positions[class.title] = TextPosition(item.name.span);
        let mut said = vec![false; class.features.len()];
        for setting in settings(&item.lines) {
            match setting {
                Ok(setting) => self.setting(class, &setting, &mut object, &mut said),
                Err(line) => {
                    let message = format!("`{}` is not a setting", line.content.text);
                    let hint = match keys(class).next() {
                        Some(_) => format!("write `key = value`; {}", keys_hint(class)),
                        None => keys_hint(class),
                    };
                    self.report(Diagnostic::error("E0265", line.content.span, message).with_hint(hint));
                }
            }
        }
        object
    }

    fn setting(&mut self, class: &Class, setting: &KeyValue<'_>, object: &mut Object, said: &mut [bool]) {
        let key = &setting.key;
        let known = |feature: &Feature| {
            feature.key == key.text && !matches!(feature.kind, FeatureKind::Opposite { .. })
        };
        let Some(index) = class.features.iter().position(known).filter(|&index| index != class.title) else {
            let message = format!("`{}:` has no `{}`", class.header, key.text);
            let found = Diagnostic::error("E0266", key.span, message).with_hint(keys_hint(class));
            return self.report(found.with_nearest(&key.text, keys(class)));
        };
        if std::mem::replace(&mut said[index], true) {
            let message = format!("`{}` is said twice", key.text);
            self.report(Diagnostic::error("E0267", key.span, message).with_hint("keep one of the two"));
            return;
        }
        object.value_positions[index] = TextPosition(setting.block.map_or(setting.value.span, block_span));
        let kind = class.features[index].kind;
        if setting.block.is_some() && !matches!(kind, FeatureKind::Formulas) {
            let hint = format!("write `{} = value`", key.text);
            self.report(
                Diagnostic::error("E0265", key.span, format!("`{}` has no lines", key.text)).with_hint(hint),
            );
            return;
        }
        object.values[index] = match (kind, setting.block) {
            (FeatureKind::Formulas, Some(lines)) => FeatureValue::Text(block_text(lines)),
            (FeatureKind::Choice(choices), _) => FeatureValue::Choice(self.choice(choices, &setting.value)),
            (FeatureKind::Links { class, max, .. }, _) => {
                FeatureValue::Links(self.links(class, max, &setting.value))
            }
            _ => FeatureValue::Text(self.plain(&setting.value)),
        };
    }

    fn choice(&mut self, choices: &[&'static str], value: &SpannedText) -> usize {
        choices.iter().position(|choice| *choice == value.text).unwrap_or_else(|| {
            let message = format!("`{}` is none of {}", value.text, choices.join(", "));
            let found = Diagnostic::error("E0268", value.span, message);
            self.report(found.with_nearest(&value.text, choices.iter().copied()));
            0
        })
    }

    fn links(&mut self, class: usize, max: usize, value: &SpannedText) -> Vec<usize> {
        let words = list(value);
        if words.len() > max {
            let message = format!("there can be {max} here, not {}", words.len());
            self.report(Diagnostic::error("E0269", value.span, message).with_hint("keep the first"));
        }
        let max = if max == UNLIMITED { words.len() } else { max };
        words.iter().take(max).filter_map(|word| self.link(class, word)).collect()
    }

    fn link(&mut self, class: usize, word: &SpannedText) -> Option<usize> {
        let titles = &self.titles[class];
        let found = Reference::parse(&word.text).and_then(|reference| titles.get(&reference).copied());
        if found.is_none() {
            let message = format!("there is no {} `{}`", self.metamodel.classes[class].header, word.text);
            let names = titles.keys().map(|reference| reference.name.as_str());
            let found = Diagnostic::error("E0269", word.span, message).with_suggestion(
                &self.suggestions,
                &word.text,
                names,
            );
            self.report(found);
        }
        found
    }
}

/// The settings of an object.
fn keys(class: &Class) -> impl Iterator<Item = &'static str> {
    let features = class.features.iter().enumerate().filter(|(index, _)| *index != class.title);
    let said = features.filter(|(_, feature)| !matches!(feature.kind, FeatureKind::Opposite { .. }));
    said.map(|(_, feature)| feature.key)
}

/// The settings of an object in words.
fn keys_hint(class: &Class) -> String {
    let keys: Vec<&str> = keys(class).collect();
    match keys.as_slice() {
        [] => format!("an item `{}:` has a name and no settings", class.header),
        keys => format!("keys are {}", keys.join(", ")),
    }
}

fn block_text(lines: &[Line]) -> String {
    lines.iter().flat_map(|line| [line.content.text.as_str(), "\n"]).collect()
}

fn block_span(lines: &[Line]) -> yase::Span {
    let spans = lines.iter().map(|line| line.content.span);
    spans.reduce(yase::Span::to).unwrap_or_default()
}
