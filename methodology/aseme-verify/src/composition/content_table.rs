//! Contents of messages between robots, and the conditions on them.

use std::collections::BTreeMap;

use yase::expression::{
    Comparison, Expression, ExpressionKind, Name, Path, ScriptId, TextPosition, parse_condition,
};

use super::composed_robot::{ComposedRobot, FieldSetting};
use super::product::MessageRoute;
use crate::logic::{Claim, GuardSolver};

/// The content of a message that was never sent.
pub(crate) const NEVER_SENT: u32 = 0;

/// The fields of a message: the text of a value, or `None` if it is unknown.
type KnownFields = BTreeMap<String, Option<String>>;

/// A robot, the values of conditions, and the contents that it has received last.
type ContentQuery = (usize, Vec<(ScriptId, bool)>, Vec<u32>);

/// Interns the contents of messages.
pub(crate) struct ContentTable<'a> {
    robots: &'a [ComposedRobot],
    passages: &'a [MessageRoute],
    list: Vec<KnownFields>,
    numbers: BTreeMap<KnownFields, u32>,
    known: BTreeMap<ContentQuery, bool>,
}

impl<'a> ContentTable<'a> {
    pub(crate) fn new(robots: &'a [ComposedRobot], passages: &'a [MessageRoute]) -> ContentTable<'a> {
        // index 0 is NEVER_SENT
        let list = vec![KnownFields::new()];
        ContentTable { robots, passages, list, numbers: BTreeMap::new(), known: BTreeMap::new() }
    }

    /// The content after assigning some fields.
    pub(crate) fn changed(&mut self, content: u32, settings: &[FieldSetting]) -> u32 {
        let mut content = self.list[content as usize].clone();
        for (field, value) in settings {
            if field.is_empty() {
                content.clear();
            } else {
                content.insert(field.clone(), value.clone());
            }
        }
        let next = self.list.len() as u32;
        let number = *self.numbers.entry(content.clone()).or_insert(next);
        if number == next {
            self.list.push(content);
        }
        number
    }

    /// Whether conditions of a robot can have these values, given the messages received last.
    pub(crate) fn allow(&mut self, robot: usize, asks: &[(ScriptId, bool)], newest: &[u32]) -> bool {
        if asks.is_empty() {
            return true;
        }
        let own = self.passages.iter().zip(newest).filter(|(passage, _)| passage.to == robot);
        let question = (robot, asks.to_vec(), own.map(|(_, &content)| content).collect());
        if let Some(&known) = self.known.get(&question) {
            return known;
        }
        let is_possible = self.is_possible(robot, asks, newest);
        self.known.insert(question, is_possible);
        is_possible
    }

    fn is_possible(&self, robot: usize, asks: &[(ScriptId, bool)], newest: &[u32]) -> bool {
        let abstraction = &self.robots[robot].abstraction;
        let facts = self.facts(robot, newest);
        let asked = asks.iter().filter_map(|&(script, value)| {
            let condition = abstraction.conditions.get(script.0 as usize)?.as_ref()?;
            Some(if value { Claim::Holds(condition) } else { Claim::DoesNotHold(condition) })
        });
        let claims: Vec<Claim<'_>> = facts.iter().map(Claim::Holds).chain(asked).collect();
        !GuardSolver::new(&abstraction.constants).together(&claims).is_no()
    }

    /// The known field values as conditions in the notation of a robot.
    fn facts(&self, robot: usize, newest: &[u32]) -> Vec<Expression> {
        let mut facts = Vec::new();
        for (message, received) in self.robots[robot].received.iter().enumerate() {
            let mut coming =
                self.passages.iter().zip(newest).filter(|(passage, _)| {
                    passage.to == robot && passage.received_messages.contains(&message)
                });
            // the order of two messages with one name is unknown
            if let (Some((_, &content)), None) = (coming.next(), coming.next()) {
                self.add_facts(&received.called.prefix, content, &mut facts);
            }
        }
        facts
    }

    /// The facts about a message that a robot receives, by its content.
    pub(crate) fn facts_of(&self, prefix: &Path, content: u32) -> Vec<Expression> {
        let mut facts = Vec::new();
        self.add_facts(prefix, content, &mut facts);
        facts
    }

    fn add_facts(&self, prefix: &Path, content: u32, facts: &mut Vec<Expression>) {
        if content == NEVER_SENT {
            return facts.push(expression_of(ExpressionKind::Absent(prefix.clone())));
        }
        facts.push(expression_of(ExpressionKind::Present(prefix.clone())));
        for (field, value) in &self.list[content as usize] {
            facts.extend(value.as_ref().and_then(|value| is(prefix, field, value)));
        }
    }
}

fn expression_of(kind: ExpressionKind) -> Expression {
    Expression { kind, position: TextPosition::default() }
}

/// The condition that a field has a value.
fn is(prefix: &Path, field: &str, value: &str) -> Option<Expression> {
    let names =
        field.split('.').map(|text| Name { text: text.to_owned(), position: TextPosition::default() });
    let segments = prefix.segments.iter().cloned().chain(names).collect();
    let field = expression_of(ExpressionKind::Variable(Path { segments, position: TextPosition::default() }));
    let value = parse_condition(value).0?;
    Some(match value.kind {
        ExpressionKind::Bool(true) => field,
        ExpressionKind::Bool(false) => expression_of(ExpressionKind::Not(Box::new(field))),
        _ => expression_of(ExpressionKind::Compare(Box::new(field), Comparison::Equal, Box::new(value))),
    })
}
