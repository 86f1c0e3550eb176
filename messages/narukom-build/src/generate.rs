//! Generates the Rust code that implements Narukom's traits for a protobuf struct.

use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorProto};

use crate::error::Error;
use crate::names;
use crate::types::TypePaths;

/// Generates the code for all messages and enumerations of a file, but not of its imports.
pub(crate) fn file(file: &FileDescriptorProto, types: &TypePaths, code: &mut String) -> Result<(), Error> {
    let scope = TypeScope { package: file.package(), outer: String::new() };
    file.enum_type.iter().try_for_each(|enumeration| enumeration_code(enumeration, &scope, types, code))?;
    file.message_type.iter().try_for_each(|message| message_code(message, &scope, types, code))
}

/// The scope in which a type is declared: a file, or a message.
struct TypeScope<'a> {
    package: &'a str,
    /// The names of the enclosing messages, each followed by a dot.
    outer: String,
}

impl<'a> TypeScope<'a> {
    fn name(&self, name: &str) -> String {
        format!("{}{name}", self.outer)
    }

    fn full_name(&self, name: &str) -> String {
        format!("{}.{}{name}", self.package, self.outer)
    }

    fn inside(&self, name: &str) -> TypeScope<'a> {
        TypeScope { package: self.package, outer: format!("{}{name}.", self.outer) }
    }
}

fn enumeration_code(
    enumeration: &EnumDescriptorProto,
    scope: &TypeScope<'_>,
    types: &TypePaths,
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
    scope: &TypeScope<'_>,
    types: &TypePaths,
    code: &mut String,
) -> Result<(), Error> {
    if message.options.as_ref().is_some_and(|options| options.map_entry()) {
        return Ok(());
    }
    code.push_str(&MessageCode::new(message, scope, types)?.code());
    let inside = scope.inside(message.name());
    message
        .enum_type
        .iter()
        .try_for_each(|enumeration| enumeration_code(enumeration, &inside, types, code))?;
    message.nested_type.iter().try_for_each(|nested| message_code(nested, &inside, types, code))
}

struct MessageCode {
    full_name: String,
    name: String,
    rust: String,
    fields: Vec<FieldCode>,
}

impl MessageCode {
    fn new(
        message: &DescriptorProto,
        scope: &TypeScope<'_>,
        types: &TypePaths,
    ) -> Result<MessageCode, Error> {
        let full_name = scope.full_name(message.name());
        let fields = message.field.iter().map(|field| FieldCode::new(field, types));
        Ok(MessageCode {
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
                .inner_message()
                .map(|place| format!("{index} => {place},"))
                .unwrap_or_default()),
        )
    }

    /// Whether any field can be set by index, so that the generated setter uses its value.
    fn is_settable(&self) -> bool {
        self.fields.iter().any(|field| !matches!(field.kind, FieldShape::Unsupported))
    }

    /// Whether any field is accessible as a message, so that the generated code calls methods of
    /// `AnyMessage`.
    fn holds_messages(&self) -> bool {
        self.fields.iter().any(|field| matches!(field.kind, FieldShape::Message(_)))
    }

    fn each(&self, code: impl Fn(usize, &FieldCode) -> String) -> String {
        self.fields.iter().enumerate().map(|(index, field)| code(index, field)).collect()
    }
}

struct FieldCode {
    name: String,
    tag: i32,
    rust: String,
    optional: bool,
    kind: FieldShape,
}

/// The type of a field, as far as it is accessible by index.
enum FieldShape {
    /// Variants of `FieldKind` and `FieldValue`, and the function of `narukom::generated` that
    /// converts a value.
    Number(&'static str, &'static str, &'static str),
    Text,
    Bytes,
    Enum(String),
    Message(String),
    Unsupported,
}

impl FieldCode {
    fn new(field: &FieldDescriptorProto, types: &TypePaths) -> Result<FieldCode, Error> {
        Ok(FieldCode {
            name: field.name().to_owned(),
            tag: field.number(),
            rust: names::field_name(field.name())?,
            optional: field.proto3_optional(),
            kind: FieldShape::of(field, types)?,
        })
    }

    fn descriptor(&self) -> String {
        let kind = match &self.kind {
            FieldShape::Number(kind, ..) => (*kind).to_owned(),
            FieldShape::Text => "Text".to_owned(),
            FieldShape::Bytes => "Bytes".to_owned(),
            FieldShape::Enum(rust) => format!("Enum(<{rust} as ::narukom::Enumeration>::DESCRIPTOR)"),
            FieldShape::Message(rust) => format!("Message(|| <{rust} as ::narukom::Message>::DESCRIPTOR)"),
            FieldShape::Unsupported => "Unsupported".to_owned(),
        };
        let (name, tag) = (&self.name, self.tag);
        format!(
            "::narukom::FieldDescriptor {{ name: {name:?}, tag: {tag}, kind: ::narukom::FieldKind::{kind} }}"
        )
    }

    fn getter(&self) -> String {
        let field = &self.rust;
        let (place, value) = match &self.kind {
            FieldShape::Number(_, variant, _) => ("", format!("{variant}(value.into())")),
            FieldShape::Enum(_) => ("", "Enum(value)".to_owned()),
            FieldShape::Text if self.optional => (".as_deref()", "Text(value)".to_owned()),
            FieldShape::Bytes if self.optional => (".as_deref()", "Bytes(value)".to_owned()),
            FieldShape::Text => (".as_str()", "Text(value)".to_owned()),
            FieldShape::Bytes => (".as_slice()", "Bytes(value)".to_owned()),
            FieldShape::Message(_) => (".as_ref()", "Message(value.as_message())".to_owned()),
            FieldShape::Unsupported => return "::narukom::FieldValue::Unsupported".to_owned(),
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
        self.optional || matches!(self.kind, FieldShape::Message(_))
    }

    fn setter(&self) -> String {
        let (name, field) = (&self.name, &self.rust);
        let read = match &self.kind {
            FieldShape::Number(_, _, read) => read,
            FieldShape::Text => "text",
            FieldShape::Bytes => "bytes",
            FieldShape::Enum(_) => "enumeration",
            FieldShape::Message(rust) => {
                let message = format!("::narukom::generated::message::<{rust}>(value, {name:?})?");
                return format!("{{ self.{field} = {message}.map(Into::into); Ok(()) }}");
            }
            FieldShape::Unsupported => {
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

    /// The expression for the message inside the field.
    fn inner_message(&self) -> Option<String> {
        let FieldShape::Message(_) = self.kind else { return None };
        Some(format!("Some(self.{}.get_or_insert_default().as_message_mut())", self.rust))
    }
}

impl FieldShape {
    fn of(field: &FieldDescriptorProto, types: &TypePaths) -> Result<FieldShape, Error> {
        let in_oneof = field.oneof_index.is_some() && !field.proto3_optional();
        let type_name = field.type_name();
        if !type_name.is_empty() && !types.is_map_entry(type_name) {
            types.rust_path(type_name)?;
        }
        if in_oneof || field.label() == Label::Repeated {
            return Ok(FieldShape::Unsupported);
        }
        Ok(match field.r#type() {
            Type::Bool => FieldShape::Number("Bool", "Bool", "boolean"),
            Type::Int32 | Type::Sint32 | Type::Sfixed32 => FieldShape::Number("I32", "Int", "int32"),
            Type::Int64 | Type::Sint64 | Type::Sfixed64 => FieldShape::Number("I64", "Int", "int64"),
            Type::Uint32 | Type::Fixed32 => FieldShape::Number("U32", "Uint", "uint32"),
            Type::Uint64 | Type::Fixed64 => FieldShape::Number("U64", "Uint", "uint64"),
            Type::Float => FieldShape::Number("F32", "Float", "float32"),
            Type::Double => FieldShape::Number("F64", "Float", "float64"),
            Type::String => FieldShape::Text,
            Type::Bytes => FieldShape::Bytes,
            _ if types.is_foreign(type_name) => FieldShape::Unsupported,
            Type::Enum => FieldShape::Enum(types.rust_path(type_name)?),
            Type::Message => FieldShape::Message(types.rust_path(type_name)?),
            Type::Group => FieldShape::Unsupported,
        })
    }
}
