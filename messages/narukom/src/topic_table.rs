//! The topics of a hub: checked once at start, then found by hash or path.

use std::any::TypeId;

use crate::error::{Error, ErrorKind};
use crate::message::Message as _;
use crate::sample::TopicSlot;
use crate::topic::{Retention, Topic, TopicDeclaration, is_topic_path};

/// The declared topics, sorted by path; a topic's slot is its index.
pub(crate) struct TopicTable {
    topics: Vec<TopicDeclaration>,
    /// Open addressing with linear probing: name hash to slot. At most half full, so that every
    /// probe terminates.
    table: Vec<Option<(u64, TopicSlot)>>,
}

impl TopicTable {
    /// Checks that every path is well formed and declared with one type and one retention kind, and
    /// that no two paths have the same hash.
    pub(crate) fn new(declarations: Vec<TopicDeclaration>) -> Result<TopicTable, Error> {
        let topics = merge(declarations)?;
        let mut catalogue = TopicTable { table: vec![None; (topics.len() * 2).next_power_of_two()], topics };
        for number in 0..catalogue.topics.len() {
            catalogue.insert(TopicSlot::new(number as u32))?;
        }
        Ok(catalogue)
    }

    fn insert(&mut self, slot: TopicSlot) -> Result<(), Error> {
        let topic = self.topics[slot.index()];
        let mut index = self.bucket(topic.hash());
        while let Some((hash, other)) = self.table[index] {
            if hash == topic.hash() {
                return Err(collision(&self.topics[other.index()], &topic));
            }
            index = (index + 1) & (self.table.len() - 1);
        }
        self.table[index] = Some((topic.hash(), slot));
        Ok(())
    }

    #[inline]
    fn bucket(&self, hash: u64) -> usize {
        hash as usize & (self.table.len() - 1)
    }

    /// The slot of the topic with that name hash.
    #[inline]
    pub(crate) fn by_hash(&self, hash: u64) -> Option<TopicSlot> {
        let mut index = self.bucket(hash);
        while let Some((entry, slot)) = self.table[index] {
            if entry == hash {
                return Some(slot);
            }
            index = (index + 1) & (self.table.len() - 1);
        }
        None
    }

    /// The slot of a topic that is declared with messages of that type.
    pub(crate) fn checked<K: Retention>(&self, topic: Topic<K>) -> Result<TopicSlot, Error> {
        let slot = self.by_hash(topic.hash()).ok_or_else(|| self.undeclared(topic.path()))?;
        let declared = &self.topics[slot.index()];
        if declared.message_type() == TypeId::of::<K::Message>() {
            Ok(slot)
        } else {
            Err(wrong_type(declared, K::Message::DESCRIPTOR.full_name))
        }
    }

    pub(crate) fn by_path(&self, path: &str) -> Option<TopicSlot> {
        let index = self.topics.binary_search_by(|topic| topic.path().cmp(path)).ok()?;
        Some(TopicSlot::new(index as u32))
    }

    pub(crate) fn topics(&self) -> &[TopicDeclaration] {
        &self.topics
    }

    pub(crate) fn get(&self, slot: TopicSlot) -> Option<&TopicDeclaration> {
        self.topics.get(slot.index())
    }

    /// The slot of the topic at `path`, or the error for an undeclared topic.
    pub(crate) fn declared(&self, path: &str) -> Result<TopicSlot, Error> {
        self.by_path(path).ok_or_else(|| self.undeclared(path))
    }

    /// The error for an undeclared `path`, with the nearest declared one.
    pub(crate) fn undeclared(&self, path: &str) -> Error {
        let nearest = self
            .topics
            .iter()
            .map(|topic| (strsim::damerau_levenshtein(topic.path(), path), topic.path()))
            .filter(|(distance, _)| *distance <= path.len() / 3 + 1)
            .min();
        let hint = nearest.map(|(_, name)| format!("; did you mean `{name}`?")).unwrap_or_default();
        Error::new(ErrorKind::UndeclaredTopic, format!("the topic `{path}` is not declared{hint}"))
    }
}

/// The declarations sorted by path, each path once.
fn merge(mut declarations: Vec<TopicDeclaration>) -> Result<Vec<TopicDeclaration>, Error> {
    declarations.sort_by_key(|topic| (topic.path(), topic.module()));
    let mut merged: Vec<TopicDeclaration> = Vec::with_capacity(declarations.len());
    for topic in declarations {
        if !is_topic_path(topic.path()) {
            return Err(bad_path(&topic));
        }
        match merged.last() {
            Some(first) if first.path() == topic.path() => check_same_declaration(first, &topic)?,
            _ => merged.push(topic),
        }
    }
    Ok(merged)
}

/// Whether two declarations of one path agree.
fn check_same_declaration(first: &TopicDeclaration, second: &TopicDeclaration) -> Result<(), Error> {
    let path = first.path();
    if first.message_type() != second.message_type() {
        let (one, other) = (first.descriptor().full_name, second.descriptor().full_name);
        let (here, there) = (first.module(), second.module());
        let text = format!(
            "the topic `{path}` is declared with two message types: `{one}` in {here} and `{other}` in {there}"
        );
        return Err(Error::new(ErrorKind::TypesDiffer, text));
    }
    let keeps = |topic: &TopicDeclaration| (topic.kind(), topic.depth(), topic.age());
    if keeps(first) != keeps(second) {
        let (one, other) = (keeping(first), keeping(second));
        let text = format!("the topic `{path}` is declared with two retention kinds: {one} and {other}");
        return Err(Error::new(ErrorKind::KindsDiffer, text));
    }
    Ok(())
}

fn keeping(topic: &TopicDeclaration) -> String {
    let age = topic.age().map(|age| format!(" and {} ms", age.as_millis())).unwrap_or_default();
    format!("{} of depth {}{age} in {}", topic.kind(), topic.depth(), topic.module())
}

fn bad_path(topic: &TopicDeclaration) -> Error {
    let (path, module) = (topic.path(), topic.module());
    let text = format!(
        "`{path}` in {module} is not a topic path: expected segments of a-z, 0-9 and _ separated by /"
    );
    Error::new(ErrorKind::BadPath, text)
}

fn collision(first: &TopicDeclaration, second: &TopicDeclaration) -> Error {
    let text = format!(
        "the topics `{}` ({}) and `{}` ({}) have the same name hash; rename one",
        first.path(),
        first.module(),
        second.path(),
        second.module()
    );
    Error::new(ErrorKind::HashCollision, text)
}

/// The error for a message of type `given` on a topic of another type.
pub(crate) fn wrong_type(topic: &TopicDeclaration, given: &str) -> Error {
    let text = format!(
        "the topic `{}` holds `{}` (declared in {}), not `{given}`",
        topic.path(),
        topic.descriptor().full_name,
        topic.module()
    );
    Error::new(ErrorKind::WrongType, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::Ball;
    use crate::topic::State;

    fn declared(path: &'static str, hash: u64) -> TopicDeclaration {
        TopicDeclaration::new::<State<Ball>>(path, "test").with_hash(hash)
    }

    #[test]
    fn topics_of_one_hash_are_refused_with_both_names() {
        let error = TopicTable::new(vec![declared("ball", 7), declared("goal", 7)]).err().unwrap();
        assert_eq!(error.kind(), ErrorKind::HashCollision);
        assert!(error.to_string().contains("`ball`") && error.to_string().contains("`goal`"), "{error}");
    }

    #[test]
    fn topics_that_want_one_place_get_two() {
        // All three hash to index 5 of the table of 8.
        let topics = [("a", 5), ("b", 13), ("c", 21)];
        let catalogue = TopicTable::new(topics.map(|(path, hash)| declared(path, hash)).into()).unwrap();
        for (path, hash) in topics {
            assert_eq!(catalogue.by_hash(hash), catalogue.by_path(path));
            assert!(catalogue.by_path(path).is_some());
        }
        assert_eq!(catalogue.by_hash(29), None);
    }
}
