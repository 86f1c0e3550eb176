//! Where arrays and objects live.
//!
//! Objects may point at one another in circles, so they live in one place, known by number, and what no variable reaches any
//! more is collected from time to time. Everything that takes room is charged, so that a document cannot fill the memory.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::value::{Data, Value};
use super::{Fault, MAX_BYTES};

/// An array or an object, by its place in the heap.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct ObjectId(u32);

/// An array or an object.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub(crate) content: Content,
    /// Whether it belongs to a system variable, which documents do not change.
    pub(crate) frozen: bool,
}

/// What an [`Object`] holds.
#[derive(Clone, Debug)]
pub(crate) enum Content {
    Array(Vec<Value>),
    Record(Record),
}

/// Names with values, in the order they were set.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    places: BTreeMap<Arc<str>, usize>,
    members: Vec<(Arc<str>, Value)>,
}

impl Record {
    pub(crate) fn get(&self, name: &str) -> Option<&Value> {
        self.places.get(name).map(|&place| &self.members[place].1)
    }

    pub(crate) fn set(&mut self, name: &str, value: Value) {
        match self.places.get(name) {
            Some(&place) => self.members[place].1 = value,
            None => {
                let name: Arc<str> = name.into();
                self.places.insert(name.clone(), self.members.len());
                self.members.push((name, value));
            }
        }
    }

    pub(crate) fn members(&self) -> &[(Arc<str>, Value)] {
        &self.members
    }
}

/// What a value takes up.
const VALUE_BYTES: usize = size_of::<Value>();
/// What an object takes up beside what it holds.
const OBJECT_BYTES: usize = size_of::<Option<Object>>();
/// What a member of a record takes up beside its value and the letters of its name.
const MEMBER_BYTES: usize = 64;
/// How deeply values may lie in one another when they are copied.
const MAX_NESTING: usize = 64;
/// Below this it is not worth looking for what nobody needs.
const COLLECT_FROM: usize = 1 << 20;

/// The arrays and objects of a session.
#[derive(Clone, Debug, Default)]
pub(crate) struct Heap {
    slots: Vec<Option<Object>>,
    free: Vec<u32>,
    /// What is alive took this much when it was last counted.
    live: usize,
    /// Charged since then.
    charged: usize,
}

impl Heap {
    /// Notes that something is made that takes this much room.
    pub(crate) fn charge(&mut self, bytes: usize) -> Result<(), Fault> {
        self.charged = self.charged.saturating_add(bytes);
        match self.live.saturating_add(self.charged) > 2 * MAX_BYTES {
            true => Err(Fault::new(format!("the data takes more than {MAX_BYTES} bytes"))),
            false => Ok(()),
        }
    }

    fn insert(&mut self, content: Content, frozen: bool) -> Result<Value, Fault> {
        self.charge(OBJECT_BYTES)?;
        let object = Some(Object { content, frozen });
        let id = match self.free.pop() {
            Some(id) => {
                self.slots[id as usize] = object;
                id
            }
            None => {
                self.slots.push(object);
                self.slots.len() as u32 - 1
            }
        };
        Ok(Value::Object(ObjectId(id)))
    }

    pub(crate) fn array(&mut self, items: Vec<Value>) -> Result<Value, Fault> {
        self.charge(items.len() * VALUE_BYTES)?;
        self.insert(Content::Array(items), false)
    }

    pub(crate) fn record(&mut self, record: Record, frozen: bool) -> Result<Value, Fault> {
        for (name, _) in record.members() {
            self.charge(name.len() + VALUE_BYTES + MEMBER_BYTES)?;
        }
        self.insert(Content::Record(record), frozen)
    }

    pub(crate) fn text(&mut self, text: impl Into<Arc<str>>) -> Result<Value, Fault> {
        let text = text.into();
        self.charge(text.len())?;
        Ok(Value::Text(text))
    }

    pub(crate) fn get(&self, id: ObjectId) -> Option<&Object> {
        self.slots.get(id.0 as usize)?.as_ref()
    }

    /// The items, if the value is an array.
    pub(crate) fn items(&self, value: &Value) -> Option<&[Value]> {
        match value {
            Value::Object(id) => match &self.get(*id)?.content {
                Content::Array(items) => Some(items),
                Content::Record(_) => None,
            },
            _ => None,
        }
    }

    /// A member of an object that is no array.
    pub(crate) fn member(&self, value: &Value, name: &str) -> Option<Value> {
        match value {
            Value::Object(id) => match &self.get(*id)?.content {
                Content::Record(record) => record.get(name).cloned(),
                Content::Array(_) => None,
            },
            _ => None,
        }
    }

    /// What an object holds, to be changed.
    pub(crate) fn change(&mut self, id: ObjectId) -> Result<&mut Content, Fault> {
        match self.slots.get_mut(id.0 as usize).and_then(Option::as_mut) {
            Some(object) if !object.frozen => Ok(&mut object.content),
            Some(_) => Err(Fault::new("a system variable cannot be changed")),
            None => Err(Fault::new("the object is gone")),
        }
    }

    /// Room for one more member.
    pub(crate) fn charge_member(&mut self, name: &str) -> Result<(), Fault> {
        self.charge(name.len() + VALUE_BYTES + MEMBER_BYTES)
    }

    /// Room for more items.
    pub(crate) fn charge_items(&mut self, count: usize) -> Result<(), Fault> {
        self.charge(count.saturating_mul(VALUE_BYTES))
    }

    /// Makes a value of data that came from elsewhere.
    pub(crate) fn import(&mut self, data: &Data) -> Result<Value, Fault> {
        Ok(match data {
            Data::Undefined => Value::Undefined,
            Data::Null => Value::Null,
            Data::Bool(value) => Value::Bool(*value),
            Data::Number(value) => Value::Number(*value),
            Data::Text(text) => self.text(text.as_str())?,
            Data::Array(items) => {
                let items = items.iter().map(|item| self.import(item)).collect::<Result<_, _>>()?;
                self.array(items)?
            }
            Data::Object(members) => {
                let mut record = Record::default();
                for (name, value) in members {
                    let value = self.import(value)?;
                    record.set(name, value);
                }
                self.record(record, false)?
            }
        })
    }

    /// Copies a value with all that belongs to it.
    ///
    /// # Errors
    /// When there is a function in it, a circle, or too much of it.
    pub(crate) fn export(&mut self, value: &Value) -> Result<Data, Fault> {
        let mut bytes = 0;
        let data = self.copy(value, MAX_NESTING, &mut bytes)?;
        self.charge(bytes)?;
        Ok(data)
    }

    fn copy(&self, value: &Value, depth: usize, bytes: &mut usize) -> Result<Data, Fault> {
        *bytes += VALUE_BYTES;
        if depth == 0 {
            return Err(Fault::new("the value lies in itself, or is nested too deeply to be copied"));
        }
        if *bytes > MAX_BYTES {
            return Err(Fault::new("the value is too large to be copied"));
        }
        let object = match value {
            Value::Undefined => return Ok(Data::Undefined),
            Value::Null => return Ok(Data::Null),
            Value::Bool(value) => return Ok(Data::Bool(*value)),
            Value::Number(value) => return Ok(Data::Number(*value)),
            Value::Text(text) => {
                *bytes += text.len();
                return Ok(Data::Text(text.to_string()));
            }
            Value::Function(_) => return Err(Fault::new("a function cannot be copied")),
            Value::Object(id) => self.get(*id).ok_or_else(|| Fault::new("the object is gone"))?,
        };
        match &object.content {
            Content::Array(items) => {
                let items = items.iter().map(|item| self.copy(item, depth - 1, bytes));
                Ok(Data::Array(items.collect::<Result<_, _>>()?))
            }
            Content::Record(record) => {
                let members = record.members().iter().map(|(name, value)| {
                    *bytes += name.len() + MEMBER_BYTES;
                    Ok((name.to_string(), self.copy(value, depth - 1, bytes)?))
                });
                Ok(Data::Object(members.collect::<Result<_, _>>()?))
            }
        }
    }

    /// Whether so much was made that it is worth looking for what nobody needs.
    pub(crate) fn is_due(&self) -> bool {
        self.charged > self.live.max(COLLECT_FROM)
    }

    /// Frees what is not reached from these values, and counts the rest.
    ///
    /// # Errors
    /// When the rest is more than a session may hold.
    pub(crate) fn collect<'a>(&mut self, roots: impl Iterator<Item = &'a Value>) -> Result<(), Fault> {
        let mut reached = vec![false; self.slots.len()];
        let mut open = Vec::new();
        let mut bytes = 0;
        for root in roots {
            visit(root, &mut bytes, &mut reached, &mut open);
        }
        while let Some(id) = open.pop() {
            bytes += OBJECT_BYTES;
            match self.get(id).map(|object| &object.content) {
                Some(Content::Array(items)) => {
                    items.iter().for_each(|item| visit(item, &mut bytes, &mut reached, &mut open));
                }
                Some(Content::Record(record)) => {
                    for (name, value) in record.members() {
                        bytes += name.len() + MEMBER_BYTES;
                        visit(value, &mut bytes, &mut reached, &mut open);
                    }
                }
                None => {}
            }
        }
        self.sweep(&reached);
        (self.live, self.charged) = (bytes, 0);
        if bytes > MAX_BYTES {
            return Err(Fault::new(format!("the data takes more than {MAX_BYTES} bytes")));
        }
        Ok(())
    }

    fn sweep(&mut self, reached: &[bool]) {
        for (index, slot) in self.slots.iter_mut().enumerate() {
            if slot.is_some() && !reached[index] {
                *slot = None;
                self.free.push(index as u32);
            }
        }
    }
}

fn visit(value: &Value, bytes: &mut usize, reached: &mut [bool], open: &mut Vec<ObjectId>) {
    *bytes += VALUE_BYTES;
    match value {
        Value::Text(text) => *bytes += text.len(),
        Value::Object(id) if !reached[id.0 as usize] => {
            reached[id.0 as usize] = true;
            open.push(*id);
        }
        _ => {}
    }
}
