//! Heap of arrays and objects.
//!
//! Objects may refer to each other in cycles. They are therefore stored in one heap and referred to
//! by index, and a collector frees unreachable objects from time to time. Every allocation is
//! charged, so that a document cannot exhaust the memory.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::memory::StepBudget;
use super::value::{DataValue, ScriptValue};
use super::{EvalError, MAX_BYTES};

/// An array or an object, by its index in the heap.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct ObjectId(u32);

/// An array or an object.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub(crate) content: ObjectContent,
    /// Whether it belongs to a system variable, which documents cannot change.
    pub(crate) frozen: bool,
}

/// Content of an [`Object`].
#[derive(Clone, Debug)]
pub(crate) enum ObjectContent {
    Array(Vec<ScriptValue>),
    Record(PropertyMap),
}

/// Names with values, in the order of their first assignment.
#[derive(Clone, Debug, Default)]
pub(crate) struct PropertyMap {
    indices: BTreeMap<Arc<str>, usize>,
    members: Vec<(Arc<str>, ScriptValue)>,
}

impl PropertyMap {
    pub(crate) fn get(&self, name: &str) -> Option<&ScriptValue> {
        self.indices.get(name).map(|&index| &self.members[index].1)
    }

    pub(crate) fn set(&mut self, name: &str, value: ScriptValue) {
        match self.indices.get(name) {
            Some(&index) => self.members[index].1 = value,
            None => {
                let name: Arc<str> = name.into();
                self.indices.insert(name.clone(), self.members.len());
                self.members.push((name, value));
            }
        }
    }

    pub(crate) fn members(&self) -> &[(Arc<str>, ScriptValue)] {
        &self.members
    }
}

/// Size of a value in bytes.
const VALUE_BYTES: usize = size_of::<ScriptValue>();
/// Size of an object in bytes, without its content.
const OBJECT_BYTES: usize = size_of::<Option<Object>>();
/// Size of a member of a record in bytes, without its value and name.
const MEMBER_BYTES: usize = 64;
/// Maximum nesting of values that are copied.
const MAX_NESTING: usize = 64;
/// Minimum size in bytes from which collection is worthwhile.
const COLLECT_FROM: usize = 1 << 20;

/// The arrays and objects of a session.
#[derive(Clone, Debug, Default)]
pub(crate) struct Heap {
    slots: Vec<Option<Object>>,
    free: Vec<u32>,
    /// Size of the live objects at the last collection.
    live: usize,
    /// Bytes charged since then.
    charged: usize,
}

impl Heap {
    /// Charges an allocation of this size.
    pub(crate) fn charge(&mut self, bytes: usize) -> Result<(), EvalError> {
        self.charged = self.charged.saturating_add(bytes);
        match self.live.saturating_add(self.charged) > 2 * MAX_BYTES {
            true => Err(EvalError::new(format!("the data takes more than {MAX_BYTES} bytes"))),
            false => Ok(()),
        }
    }

    fn insert(&mut self, content: ObjectContent, frozen: bool) -> Result<ScriptValue, EvalError> {
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
        Ok(ScriptValue::Object(ObjectId(id)))
    }

    pub(crate) fn array(&mut self, items: Vec<ScriptValue>) -> Result<ScriptValue, EvalError> {
        self.charge(items.len() * VALUE_BYTES)?;
        self.insert(ObjectContent::Array(items), false)
    }

    pub(crate) fn record(&mut self, record: PropertyMap, frozen: bool) -> Result<ScriptValue, EvalError> {
        for (name, _) in record.members() {
            self.charge(name.len() + VALUE_BYTES + MEMBER_BYTES)?;
        }
        self.insert(ObjectContent::Record(record), frozen)
    }

    pub(crate) fn text(&mut self, text: impl Into<Arc<str>>) -> Result<ScriptValue, EvalError> {
        let text = text.into();
        self.charge(text.len())?;
        Ok(ScriptValue::Text(text))
    }

    pub(crate) fn get(&self, id: ObjectId) -> Option<&Object> {
        self.slots.get(id.0 as usize)?.as_ref()
    }

    /// The items, if the value is an array.
    pub(crate) fn items(&self, value: &ScriptValue) -> Option<&[ScriptValue]> {
        match value {
            ScriptValue::Object(id) => match &self.get(*id)?.content {
                ObjectContent::Array(items) => Some(items),
                ObjectContent::Record(_) => None,
            },
            _ => None,
        }
    }

    /// A member of an object that is not an array.
    pub(crate) fn member(&self, value: &ScriptValue, name: &str) -> Option<ScriptValue> {
        match value {
            ScriptValue::Object(id) => match &self.get(*id)?.content {
                ObjectContent::Record(record) => record.get(name).cloned(),
                ObjectContent::Array(_) => None,
            },
            _ => None,
        }
    }

    /// Mutable content of an object.
    pub(crate) fn change(&mut self, id: ObjectId) -> Result<&mut ObjectContent, EvalError> {
        match self.slots.get_mut(id.0 as usize).and_then(Option::as_mut) {
            Some(object) if !object.frozen => Ok(&mut object.content),
            Some(_) => Err(EvalError::new("a system variable cannot be changed")),
            None => Err(EvalError::new("the object is gone")),
        }
    }

    /// Charges one more member.
    pub(crate) fn charge_member(&mut self, name: &str) -> Result<(), EvalError> {
        self.charge(name.len() + VALUE_BYTES + MEMBER_BYTES)
    }

    /// Charges more items.
    pub(crate) fn charge_items(&mut self, count: usize) -> Result<(), EvalError> {
        self.charge(count.saturating_mul(VALUE_BYTES))
    }

    /// Creates a value from external data.
    pub(crate) fn import(&mut self, data: &DataValue) -> Result<ScriptValue, EvalError> {
        Ok(match data {
            DataValue::Undefined => ScriptValue::Undefined,
            DataValue::Null => ScriptValue::Null,
            DataValue::Bool(value) => ScriptValue::Bool(*value),
            DataValue::Number(value) => ScriptValue::Number(*value),
            DataValue::Text(text) => self.text(text.as_str())?,
            DataValue::Array(items) => {
                let items = items.iter().map(|item| self.import(item)).collect::<Result<_, _>>()?;
                self.array(items)?
            }
            DataValue::Object(members) => {
                let mut record = PropertyMap::default();
                for (name, value) in members {
                    let value = self.import(value)?;
                    record.set(name, value);
                }
                self.record(record, false)?
            }
        })
    }

    /// Copies a value with everything that it refers to; charges the steps for reading it.
    ///
    /// # Errors
    /// It contains a function or a cycle, or is too large.
    pub(crate) fn export(
        &mut self,
        value: &ScriptValue,
        steps: &mut StepBudget,
    ) -> Result<DataValue, EvalError> {
        let mut bytes = 0;
        let data = self.copy(value, MAX_NESTING, &mut bytes);
        steps.charge_reading(bytes)?;
        let data = data?;
        self.charge(bytes)?;
        Ok(data)
    }

    fn copy(&self, value: &ScriptValue, depth: usize, bytes: &mut usize) -> Result<DataValue, EvalError> {
        *bytes += VALUE_BYTES;
        if depth == 0 {
            return Err(EvalError::new("the value lies in itself, or is nested too deeply to be copied"));
        }
        if *bytes > MAX_BYTES {
            return Err(EvalError::new("the value is too large to be copied"));
        }
        let object = match value {
            ScriptValue::Undefined => return Ok(DataValue::Undefined),
            ScriptValue::Null => return Ok(DataValue::Null),
            ScriptValue::Bool(value) => return Ok(DataValue::Bool(*value)),
            ScriptValue::Number(value) => return Ok(DataValue::Number(*value)),
            ScriptValue::Text(text) => {
                *bytes += text.len();
                return Ok(DataValue::Text(text.to_string()));
            }
            ScriptValue::Function(_) => return Err(EvalError::new("a function cannot be copied")),
            ScriptValue::Object(id) => self.get(*id).ok_or_else(|| EvalError::new("the object is gone"))?,
        };
        match &object.content {
            ObjectContent::Array(items) => {
                let items = items.iter().map(|item| self.copy(item, depth - 1, bytes));
                Ok(DataValue::Array(items.collect::<Result<_, _>>()?))
            }
            ObjectContent::Record(record) => {
                let members = record.members().iter().map(|(name, value)| {
                    *bytes += name.len() + MEMBER_BYTES;
                    Ok((name.to_string(), self.copy(value, depth - 1, bytes)?))
                });
                Ok(DataValue::Object(members.collect::<Result<_, _>>()?))
            }
        }
    }

    /// Whether enough was allocated to make a collection worthwhile.
    pub(crate) fn is_due(&self) -> bool {
        self.charged > self.live.max(COLLECT_FROM)
    }

    /// Frees everything that these values do not reach, and measures the rest.
    ///
    /// # Errors
    /// The rest exceeds the limit of a session.
    pub(crate) fn collect<'a>(
        &mut self,
        roots: impl Iterator<Item = &'a ScriptValue>,
    ) -> Result<(), EvalError> {
        let mut reached = vec![false; self.slots.len()];
        let mut open = Vec::new();
        let mut bytes = 0;
        for root in roots {
            visit(root, &mut bytes, &mut reached, &mut open);
        }
        while let Some(id) = open.pop() {
            bytes += OBJECT_BYTES;
            match self.get(id).map(|object| &object.content) {
                Some(ObjectContent::Array(items)) => {
                    items.iter().for_each(|item| visit(item, &mut bytes, &mut reached, &mut open));
                }
                Some(ObjectContent::Record(record)) => {
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
            return Err(EvalError::new(format!("the data takes more than {MAX_BYTES} bytes")));
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

fn visit(value: &ScriptValue, bytes: &mut usize, reached: &mut [bool], open: &mut Vec<ObjectId>) {
    *bytes += VALUE_BYTES;
    match value {
        ScriptValue::Text(text) => *bytes += text.len(),
        ScriptValue::Object(id) if !reached[id.0 as usize] => {
            reached[id.0 as usize] = true;
            open.push(*id);
        }
        _ => {}
    }
}
