//! Checks the names that a schema declares, and says where a wrong one is.

use prost_types::{DescriptorProto, FileDescriptorProto};

use crate::error::Error;
use crate::names;

/// The numbers of protobuf's descriptors, of which the paths of source positions consist.
mod tags {
    pub(super) const FILE_MESSAGE: i32 = 4;
    pub(super) const FILE_ENUM: i32 = 5;
    pub(super) const NAME: i32 = 1;
    pub(super) const MESSAGE_FIELD: i32 = 2;
    pub(super) const MESSAGE_NESTED: i32 = 3;
    pub(super) const MESSAGE_ENUM: i32 = 4;
}

/// Checks the names of all types and fields of a file.
pub(crate) fn check(file: &FileDescriptorProto) -> Result<(), Error> {
    for (index, enumeration) in (0..).zip(&file.enum_type) {
        outer_type(enumeration.name()).map_err(located(file, &[tags::FILE_ENUM, index]))?;
    }
    for (index, message) in (0..).zip(&file.message_type) {
        let path = [tags::FILE_MESSAGE, index];
        outer_type(message.name()).map_err(located(file, &path))?;
        check_message(file, message, &path)?;
    }
    Ok(())
}

/// Nested types are in modules of their own, where generated code does not look for Rust's types.
fn outer_type(name: &str) -> Result<(), Error> {
    names::type_name(name)?;
    names::check_shadowing(name)
}

fn check_message(file: &FileDescriptorProto, message: &DescriptorProto, path: &[i32]) -> Result<(), Error> {
    let inside = |tag: i32, index: i32| [path, &[tag, index]].concat();
    for (index, field) in (0..).zip(&message.field) {
        names::field_name(field.name()).map_err(located(file, &inside(tags::MESSAGE_FIELD, index)))?;
    }
    for (index, enumeration) in (0..).zip(&message.enum_type) {
        names::type_name(enumeration.name()).map_err(located(file, &inside(tags::MESSAGE_ENUM, index)))?;
    }
    for (index, nested) in (0..).zip(&message.nested_type) {
        // The types of the entries of maps are not in the text.
        if nested.options.as_ref().is_none_or(|options| !options.map_entry()) {
            let path = inside(tags::MESSAGE_NESTED, index);
            names::type_name(nested.name()).map_err(located(file, &path))?;
            check_message(file, nested, &path)?;
        }
    }
    Ok(())
}

/// Puts file, line and column of the name of a declaration in front of an error.
fn located(file: &FileDescriptorProto, path: &[i32]) -> impl Fn(Error) -> Error {
    let name = [path, &[tags::NAME]].concat();
    let mut locations = file.source_code_info.iter().flat_map(|info| &info.location);
    let position = match locations.find(|location| location.path == name).map(|found| found.span.as_slice()) {
        Some([line, column, ..]) => format!("{}:{}:{}", file.name(), line + 1, column + 1),
        _ => file.name().to_owned(),
    };
    move |error| error.at(&position)
}
