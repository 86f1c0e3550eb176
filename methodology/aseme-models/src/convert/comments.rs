//! Preservation of comments when a text is rewritten.

use std::collections::BTreeMap;

use crate::document::{Comments, Item, ItemDocument, Line};

/// Copies the comments of an older text: each goes to the equal line of the item with the same
/// header, else to that item, else to the end.
pub(crate) fn transfer_comments(old: &ItemDocument, new: &mut ItemDocument) {
    let mut indices: BTreeMap<(String, String, usize), usize> = BTreeMap::new();
    let mut seen = BTreeMap::new();
    for (index, item) in new.items.iter().enumerate() {
        indices.insert(key(item, &mut seen), index);
    }
    let mut seen = BTreeMap::new();
    for item in &old.items {
        match indices.get(&key(item, &mut seen)) {
            Some(&index) => transfer_item_comments(item, &mut new.items[index]),
            None => new.tail.extend(all(item)),
        }
    }
    new.tail.extend(old.tail.iter().cloned());
}

/// The header of an item and its index among equal headers.
fn key(item: &Item, seen: &mut BTreeMap<(String, String), usize>) -> (String, String, usize) {
    let header = (item.word.text.clone(), item.name.text.clone());
    let count = seen.entry(header.clone()).or_default();
    *count += 1;
    (header.0, header.1, *count)
}

fn transfer_item_comments(old: &Item, new: &mut Item) {
    add(&old.comments, &mut new.comments);
    let mut indices: BTreeMap<(String, usize), usize> = BTreeMap::new();
    let mut seen = BTreeMap::new();
    for (index, line) in new.lines.iter().enumerate() {
        indices.insert(line_key(line, &mut seen), index);
    }
    let mut seen = BTreeMap::new();
    let mut homeless = Vec::new();
    for line in &old.lines {
        match indices.get(&line_key(line, &mut seen)) {
            Some(&index) => add(&line.comments, &mut new.lines[index].comments),
            None => homeless.extend(texts(&line.comments)),
        }
    }
    new.comments.above.extend(homeless);
}

/// The key of a line: the key of its setting, the ends of its transition, or its text, without
/// blanks.
fn line_key(line: &Line, seen: &mut BTreeMap<String, usize>) -> (String, usize) {
    let text = &line.content.text;
    let end = match text.find("->") {
        Some(_) => text.find(" : "),
        None => text.find('='),
    };
    let about: String = text[..end.unwrap_or(text.len())].split_whitespace().collect();
    let count = seen.entry(about.clone()).or_default();
    *count += 1;
    (about, *count)
}

fn add(from: &Comments, to: &mut Comments) {
    to.above.extend(from.above.iter().cloned());
    to.trailing.clone_from(&from.trailing);
}

fn texts(comments: &Comments) -> impl Iterator<Item = String> {
    let beside = Some(comments.trailing.clone()).filter(|beside| !beside.is_empty());
    comments.above.iter().cloned().chain(beside).collect::<Vec<_>>().into_iter()
}

fn all(item: &Item) -> Vec<String> {
    let lines = item.lines.iter().flat_map(|line| texts(&line.comments));
    texts(&item.comments).chain(lines).collect()
}
