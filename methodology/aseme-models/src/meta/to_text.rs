//! Writer of model instances in text.

use std::collections::BTreeMap;

use super::{Class, FeatureKind, FeatureValue, Metamodel, ModelInstance, Object};
use crate::document::{Item, ItemDocument, reference, value_text};
use aseme::text;

/// A model as text: a header with its kind, and an item for each object, class by class.
pub(crate) fn to_text(metamodel: &Metamodel, instance: &ModelInstance) -> ItemDocument {
    let titles: Vec<Vec<String>> =
        (0..metamodel.classes.len()).map(|class| references(metamodel, instance, class)).collect();
    let mut items = vec![Item::new(metamodel.header, String::new())];
    for (class, objects) in metamodel.classes.iter().zip(&instance.objects) {
        items.extend(objects.iter().map(|object| item(class, object, &titles)));
    }
    ItemDocument { items, tail: Vec::new() }
}

/// The reference to each object of a class.
fn references(metamodel: &Metamodel, instance: &ModelInstance, class: usize) -> Vec<String> {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let refer = |object: &Object| {
        let title = object.text(metamodel.classes[class].title);
        let number = seen.entry(title.clone()).or_default();
        *number += 1;
        reference(&title, *number)
    };
    instance.of(class).iter().map(refer).collect()
}

fn item(class: &Class, object: &Object, titles: &[Vec<String>]) -> Item {
    let title = object.text(class.title);
    let mut item = Item::new(class.header, if title.is_empty() { title } else { value_text(&title) });
    for (index, feature) in class.features.iter().enumerate().filter(|(index, _)| *index != class.title) {
        match (feature.kind, &object.values[index]) {
            (FeatureKind::Formulas, FeatureValue::Text(text)) if is_block(text) => {
                item.line(2, format!("{}:", feature.key));
                text.lines().for_each(|line| item.line(4, line.into()));
            }
            (FeatureKind::Formulas, FeatureValue::Text(text)) if !text.is_empty() => {
                item.set(feature.key, &value_text(text))
            }
            (FeatureKind::Text, FeatureValue::Text(text)) if !text.is_empty() => {
                item.set(feature.key, &value_text(text))
            }
            (FeatureKind::Choice(choices), FeatureValue::Choice(choice)) if *choice > 0 => {
                item.set(feature.key, choices.get(*choice).copied().unwrap_or_default());
            }
            (FeatureKind::Links { class, .. }, FeatureValue::Links(links)) if !links.is_empty() => {
                let words = links.iter().filter_map(|&link| titles[class].get(link).map(String::as_str));
                item.set(feature.key, &words.collect::<Vec<_>>().join(", "));
            }
            _ => {}
        }
    }
    item
}

/// Whether formulas parse back to the same text when they are written as lines.
fn is_block(text: &str) -> bool {
    let is_line = |line: &str| !line.is_empty() && text::is_plain(line);
    text.ends_with('\n') && text[..text.len() - 1].split('\n').all(is_line)
}
