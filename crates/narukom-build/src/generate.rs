//! The Rust code that makes a protobuf struct a message of Narukom.

use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorProto};

use crate::error::Error;
use crate::names;
use crate::types::Types;

/// Writes the code for all messages and enumerations of a file, and of none that it imports.
pub(crate) fn file(file: &FileDescriptorProto, types: &Types, code: &mut String) -> Result<(), Error> {
    let scope = Scope { package: file.package(), outer: String::new() };
    file.enum_type.iter().try_for_each(|enumeration| enumeration_code(enumeration, &scope, types, code))?;
    file.message_type.iter().try_for_each(|message| message_code(message, &scope, types, code))
}

/// Where a type is declared: in a file, or in a message.
struct Scope<'a> {
    package: &'a str,
    /// The names of the messages around, each followed by a dot.
    outer: String,
}

impl<'a> Scope<'a> {
    fn name(&self, name: &str) -> String {
        format!("{}{name}", self.outer)
    }

    fn full_name(&self, name: &str) -> String {
        format!("{}.{}{name}", self.package, self.outer)
    }

    fn inside(&self, name: &str) -> Scope<'a> {
        Scope { package: self.package, outer: format!("{}{name}.", self.outer) }
    }
}

fn enumeration_code(
    enumeration: &EnumDescriptorProto,
    scope: &Scope<'_>,
    types: &Types,
    code: &mut String,
) -> Result<(), Error> {
    let full_name = scope.full_name(enumeration.name());
    let rust = types.rust_path(&format!(".{full_name}"))?;
    let values: Vec<_> =
        enumeration.value.iter().map(|value| format!("({:?}, {})", value.name(), value.number())).collect();
    code.push_str(&format!(
        "impl ::narukom::Enumeration for {rust} {{
            const DESCRIPTOR: &'static ::narukom::EnumDescriptor = &::narukom::EnumDescriptor {{
                full_name: {full_name:?},
                name: {name:?},
                values: &[{values}],
            }};
        }}\n",
        name = scope.name(enumeration.name()),
        values = values.join(", "),
    ));
    Ok(())
}

fn message_code(
    message: &DescriptorProto,
    scope: &Scope<'_>,
    types: &Types,
    code: &mut String,
) -> Result<(), Error> {
    if message.options.as_ref().is_some_and(|options| options.map_entry()) {
        return Ok(());
    }
    code.push_str(&Message::new(message, scope, types)?.code());
    let inside = scope.inside(message.name());
    message
        .enum_type
        .iter()
        .try_for_each(|enumeration| enumeration_code(enumeration, &inside, types, code))?;
    message.nested_type.iter().try_for_each(|nested| message_code(nested, &inside, types, code))
}

struct Message {
    full_name: String,
    name: String,
    rust: String,
    fields: Vec<Field>,
}

impl Message {
    fn new(message: &DescriptorProto, scope: &Scope<'_>, types: &Types) -> Result<Message, Error> {
        let full_name = scope.full_name(message.name());
        let fields = message.field.iter().map(|field| Field::new(field, types));
        Ok(Message {
            name: scope.name(message.name()),
            rust: types.rust_path(&format!(".{full_name}"))?,
            fields: fields.collect::<Result<_, _>>()?,
            full_name,
        })
    }

    fn code(&self) -> String {
        format!(
            "const _: () = {{{import}
                static MESSAGE: ::narukom::MessageDescriptor = ::narukom::MessageDescriptor {{
                    full_name: {full_name:?},
                    name: {name:?},
                    fields: &[{descriptors}],
                    file_descriptor_set: FILE_DESCRIPTOR_SET,
                }};
                impl ::narukom::Message for {rust} {{
                    const DESCRIPTOR: &'static ::narukom::MessageDescriptor = &MESSAGE;
                }}
                impl ::narukom::Reflect for {rust} {{
                    fn descriptor(&self) -> &'static ::narukom::MessageDescriptor {{ &MESSAGE }}
                    fn field(&self, index: usize) -> ::narukom::FieldValue<'_> {{
                        match index {{ {getters} _ => ::narukom::FieldValue::Missing }}
                    }}
                    fn set_field(&mut self, index: usize, {value}: ::narukom::FieldValue<'_>)
                        -> Result<(), ::narukom::FieldError> {{
                        match index {{ {setters} _ => Err(::narukom::FieldError::NoSuchField) }}
                    }}
                    fn message_mut(&mut self, index: usize) -> Option<&mut dyn ::narukom::AnyMessage> {{
                        match index {{ {places} _ => None }}
                    }}
                }}
            }};\n",
            full_name = self.full_name,
            name = self.name,
            rust = self.rust,
            import =
                if self.holds_messages() { "\n                use ::narukom::AnyMessage as _;" } else { "" },
            value = if self.is_settable() { "value" } else { "_value" },
            descriptors = self.each(|_, field| format!("{},", field.descriptor())),
            getters = self.each(|index, field| format!("{index} => {},", field.getter())),
            setters = self.each(|index, field| format!("{index} => {},", field.setter())),
            places = self.each(|index, field| field
                .place()
                .map(|place| format!("{index} => {place},"))
                .unwrap_or_default()),
        )
    }

    /// Whether any field is set by index, so that the generated setter uses the value it is given.
    fn is_settable(&self) -> bool {
        self.fields.iter().any(|field| !matches!(field.kind, Kind::Unsupported))
    }

    /// Whether any field is reached as a message, so that the generated code calls methods of `AnyMessage`.
    fn holds_messages(&self) -> bool {
        self.fields.iter().any(|field| matches!(field.kind, Kind::Message(_)))
    }

    fn each(&self, code: impl Fn(usize, &Field) -> String) -> String {
        self.fields.iter().enumerate().map(|(index, field)| code(index, field)).collect()
    }
}

struct Field {
    name: String,
    tag: i32,
    rust: String,
    optional: bool,
    kind: Kind,
}

/// What a field holds, as far as it is reachable by index.
enum Kind {
    /// Variants of `FieldKind` and `FieldValue`, and the function of `narukom::generated` that reads a value.
    Number(&'static str, &'static str, &'static str),
    Text,
    Bytes,
    Enum(String),
    Message(String),
    Unsupported,
}

impl Field {
    fn new(field: &FieldDescriptorProto, types: &Types) -> Result<Field, Error> {
        Ok(Field {
            name: field.name().to_owned(),
            tag: field.number(),
            rust: names::field_name(field.name())?,
            optional: field.proto3_optional(),
            kind: Kind::of(field, types)?,
        })
    }

    fn descriptor(&self) -> String {
        let kind = match &self.kind {
            Kind::Number(kind, ..) => (*kind).to_owned(),
            Kind::Text => "Text".to_owned(),
            Kind::Bytes => "Bytes".to_owned(),
            Kind::Enum(rust) => format!("Enum(<{rust} as ::narukom::Enumeration>::DESCRIPTOR)"),
            Kind::Message(rust) => format!("Message(|| <{rust} as ::narukom::Message>::DESCRIPTOR)"),
            Kind::Unsupported => "Unsupported".to_owned(),
        };
        let (name, tag) = (&self.name, self.tag);
        format!(
            "::narukom::FieldDescriptor {{ name: {name:?}, tag: {tag}, kind: ::narukom::FieldKind::{kind} }}"
        )
    }

    fn getter(&self) -> String {
        let field = &self.rust;
        let (place, value) = match &self.kind {
            Kind::Number(_, variant, _) => ("", format!("{variant}(value.into())")),
            Kind::Enum(_) => ("", "Enum(value)".to_owned()),
            Kind::Text if self.optional => (".as_deref()", "Text(value)".to_owned()),
            Kind::Bytes if self.optional => (".as_deref()", "Bytes(value)".to_owned()),
            Kind::Text => (".as_str()", "Text(value)".to_owned()),
            Kind::Bytes => (".as_slice()", "Bytes(value)".to_owned()),
            Kind::Message(_) => (".as_ref()", "Message(value.as_message())".to_owned()),
            Kind::Unsupported => return "::narukom::FieldValue::Unsupported".to_owned(),
        };
        if self.may_miss() {
            format!(
                "self.{field}{place}.map_or(::narukom::FieldValue::Missing, |value| ::narukom::FieldValue::{value})"
            )
        } else {
            format!("{{ let value = self.{field}{place}; ::narukom::FieldValue::{value} }}")
        }
    }

    fn may_miss(&self) -> bool {
        self.optional || matches!(self.kind, Kind::Message(_))
    }

    fn setter(&self) -> String {
        let (name, field) = (&self.name, &self.rust);
        let read = match &self.kind {
            Kind::Number(_, _, read) => read,
            Kind::Text => "text",
            Kind::Bytes => "bytes",
            Kind::Enum(_) => "enumeration",
            Kind::Message(rust) => {
                let message = format!("::narukom::generated::message::<{rust}>(value, {name:?})?");
                return format!("{{ self.{field} = {message}.map(Into::into); Ok(()) }}");
            }
            Kind::Unsupported => {
                return format!("Err(::narukom::FieldError::Unsupported {{ field: {name:?} }})");
            }
        };
        let value = if self.optional {
            format!("::narukom::generated::optional(value, {name:?}, ::narukom::generated::{read})?")
        } else {
            format!("::narukom::generated::{read}(value, {name:?})?")
        };
        format!("{{ self.{field} = {value}; Ok(()) }}")
    }

    /// The code that reaches the message inside the field.
    fn place(&self) -> Option<String> {
        let Kind::Message(_) = self.kind else { return None };
        Some(format!("Some(self.{}.get_or_insert_default().as_message_mut())", self.rust))
    }
}

impl Kind {
    fn of(field: &FieldDescriptorProto, types: &Types) -> Result<Kind, Error> {
        let in_oneof = field.oneof_index.is_some() && !field.proto3_optional();
        let type_name = field.type_name();
        if !type_name.is_empty() && !types.is_map_entry(type_name) {
            types.rust_path(type_name)?;
        }
        if in_oneof || field.label() == Label::Repeated {
            return Ok(Kind::Unsupported);
        }
        Ok(match field.r#type() {
            Type::Bool => Kind::Number("Bool", "Bool", "boolean"),
            Type::Int32 | Type::Sint32 | Type::Sfixed32 => Kind::Number("I32", "Int", "int32"),
            Type::Int64 | Type::Sint64 | Type::Sfixed64 => Kind::Number("I64", "Int", "int64"),
            Type::Uint32 | Type::Fixed32 => Kind::Number("U32", "Uint", "uint32"),
            Type::Uint64 | Type::Fixed64 => Kind::Number("U64", "Uint", "uint64"),
            Type::Float => Kind::Number("F32", "Float", "float32"),
            Type::Double => Kind::Number("F64", "Float", "float64"),
            Type::String => Kind::Text,
            Type::Bytes => Kind::Bytes,
            _ if types.is_foreign(type_name) => Kind::Unsupported,
            Type::Enum => Kind::Enum(types.rust_path(type_name)?),
            Type::Message => Kind::Message(types.rust_path(type_name)?),
            Type::Group => Kind::Unsupported,
        })
    }
}
