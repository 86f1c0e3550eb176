//! Wire schemas of message types, line by line, so that two programs can find out whether and where
//! they differ.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use narukom::MessageDescriptor;
use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorSet};

/// The schema of a message type and all types that it uses, without what is irrelevant on the wire:
/// comments, files, order.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Schema {
    lines: String,
}

impl Schema {
    /// The schema of a message type.
    pub fn of(descriptor: &MessageDescriptor) -> Schema {
        let set = FileDescriptorSet::decode(descriptor.file_descriptor_set).unwrap_or_default();
        let types = TypeCollector::new(&set);
        let lines = if types.messages.contains_key(descriptor.full_name) {
            types.describe(descriptor.full_name)
        } else {
            // A hand-written type without a schema: use its field descriptors.
            let field = |field: &narukom::FieldDescriptor| {
                format!("{}.{} = {} {:?}\n", descriptor.full_name, field.name, field.tag, field.kind)
            };
            descriptor.fields.iter().map(field).collect()
        };
        Schema { lines }
    }

    /// One line per field and per value of an enumeration, sorted.
    pub fn lines(&self) -> &str {
        &self.lines
    }

    /// Equal for equal schemas.
    pub fn hash(&self) -> [u8; 16] {
        let mut hash = [0; 16];
        hash.copy_from_slice(&blake3::hash(self.lines.as_bytes()).as_bytes()[..16]);
        hash
    }
}

/// The lines that are in only one of two schemas, at most `limit`: prefixed with `- ` if in `ours`,
/// with `+ ` if in `theirs`.
pub fn differences(ours: &str, theirs: &str, limit: usize) -> Vec<String> {
    let (mine, other): (BTreeSet<&str>, BTreeSet<&str>) = (ours.lines().collect(), theirs.lines().collect());
    let removed = mine.difference(&other).map(|line| format!("- {line}"));
    let added = other.difference(&mine).map(|line| format!("+ {line}"));
    removed.chain(added).take(limit).collect()
}

/// The types of a file and of all its imports, by full name.
struct TypeCollector<'a> {
    messages: BTreeMap<String, &'a DescriptorProto>,
    enumerations: BTreeMap<String, &'a EnumDescriptorProto>,
}

impl<'a> TypeCollector<'a> {
    fn new(set: &'a FileDescriptorSet) -> TypeCollector<'a> {
        let mut types = TypeCollector { messages: BTreeMap::new(), enumerations: BTreeMap::new() };
        for file in &set.file {
            file.message_type.iter().for_each(|message| types.add(file.package(), message));
            file.enum_type.iter().for_each(|one| types.add_enumeration(file.package(), one));
        }
        types
    }

    fn add(&mut self, package: &str, message: &'a DescriptorProto) {
        let name = join(package, message.name());
        message.nested_type.iter().for_each(|nested| self.add(&name, nested));
        message.enum_type.iter().for_each(|one| self.add_enumeration(&name, one));
        self.messages.insert(name, message);
    }

    fn add_enumeration(&mut self, package: &str, one: &'a EnumDescriptorProto) {
        self.enumerations.insert(join(package, one.name()), one);
    }

    /// The lines of a type and of all types that it uses, each once.
    fn describe(&self, name: &str) -> String {
        let (mut reached, mut lines) = (BTreeSet::new(), BTreeSet::new());
        let mut open = vec![name.to_owned()];
        while let Some(name) = open.pop() {
            if !reached.insert(name.clone()) {
                continue;
            }
            if let Some(message) = self.messages.get(&name) {
                for field in &message.field {
                    lines.insert(field_line(&name, field));
                    open.extend(field.type_name.iter().map(|inner| inner.trim_start_matches('.').to_owned()));
                }
            }
            let values = self.enumerations.get(&name).into_iter().flat_map(|one| &one.value);
            lines.extend(values.map(|value| format!("{name}: {} = {}", value.name(), value.number())));
        }
        lines.into_iter().fold(String::new(), |mut text, line| {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{line}");
            text
        })
    }
}

fn join(package: &str, name: &str) -> String {
    if package.is_empty() { name.to_owned() } else { format!("{package}.{name}") }
}

fn field_line(message: &str, field: &FieldDescriptorProto) -> String {
    let many = if field.label() == Label::Repeated { "repeated " } else { "" };
    let kind = match field.r#type() {
        Type::Message | Type::Enum | Type::Group => field.type_name().trim_start_matches('.').to_owned(),
        plain => plain.as_str_name().trim_start_matches("TYPE_").to_lowercase(),
    };
    let choice = field.oneof_index.map(|one| format!(" of choice {one}")).unwrap_or_default();
    format!("{message}: {many}{kind} {} = {}{choice}", field.name(), field.number())
}
