//! Rust paths of a schema's messages and enumerations.

use std::collections::BTreeSet;

use prost_types::{DescriptorProto, FileDescriptorProto};

use crate::error::{Error, ErrorKind};
use crate::names;

/// Maps full names of types, with a dot in front, to Rust paths.
pub(crate) struct TypePaths {
    /// The package that is being generated.
    package: String,
    /// The packages of the schema, imports included.
    known: BTreeSet<String>,
    /// Other packages and their Rust modules.
    modules: Vec<(String, String)>,
}

/// The package of protobuf's well-known types, which prost provides.
const WELL_KNOWN: &str = ".google.protobuf.";

impl TypePaths {
    pub(crate) fn new(package: &str, known: BTreeSet<String>, modules: &[(String, String)]) -> TypePaths {
        TypePaths { package: package.to_owned(), known, modules: modules.to_vec() }
    }

    /// The type's path, relative to the package's module.
    pub(crate) fn rust_path(&self, full_name: &str) -> Result<String, Error> {
        if self.is_foreign(full_name) {
            return Ok(full_name.to_owned());
        }
        if let Some(name) = self.own_name(full_name) {
            return path(name);
        }
        let fitting =
            self.modules.iter().filter_map(|(package, module)| Some((module, inside(full_name, package)?)));
        let longest = fitting.min_by_key(|(_, name)| name.len());
        let (module, name) = longest.ok_or_else(|| unmapped(full_name))?;
        Ok(format!("{module}::{}", path(name)?))
    }

    /// Whether the type does not implement Narukom's traits.
    pub(crate) fn is_foreign(&self, full_name: &str) -> bool {
        full_name.starts_with(WELL_KNOWN)
    }

    /// Whether the type is one of the generated package.
    pub(crate) fn is_own(&self, full_name: &str) -> bool {
        self.own_name(full_name).is_some()
    }

    /// Whether the type is the entry type of a map field.
    pub(crate) fn is_map_entry(&self, full_name: &str) -> bool {
        full_name.ends_with("Entry") && self.own_name(full_name).is_some_and(|name| name.contains('.'))
    }

    /// The name of a type of the generated package. A package whose name continues that of the
    /// generated one is another.
    fn own_name<'a>(&self, full_name: &'a str) -> Option<&'a str> {
        let name = inside(full_name, &self.package)?;
        let fitting = self.known.iter().filter_map(|package| inside(full_name, package));
        fitting.min_by_key(|rest| rest.len()).is_none_or(|rest| rest.len() == name.len()).then_some(name)
    }
}

/// The full names of the types of a file, with a dot in front; those nested in a message before it.
pub(crate) fn full_names(file: &FileDescriptorProto) -> Vec<String> {
    let package = format!(".{}", file.package());
    let mut names: Vec<String> =
        file.enum_type.iter().map(|enumeration| format!("{package}.{}", enumeration.name())).collect();
    file.message_type.iter().for_each(|message| add_names(message, &package, &mut names));
    names
}

fn add_names(message: &DescriptorProto, scope: &str, names: &mut Vec<String>) {
    let name = format!("{scope}.{}", message.name());
    names.extend(message.enum_type.iter().map(|enumeration| format!("{name}.{}", enumeration.name())));
    let is_map_entry =
        |nested: &&DescriptorProto| nested.options.as_ref().is_some_and(|options| options.map_entry());
    message.nested_type.iter().filter(|nested| !is_map_entry(nested)).for_each(|nested| {
        add_names(nested, &name, names);
    });
    names.push(name);
}

/// The name of a type without its package.
pub(crate) fn inside<'a>(full_name: &'a str, package: &str) -> Option<&'a str> {
    full_name.strip_prefix('.')?.strip_prefix(package)?.strip_prefix('.')
}

/// `Outer.Inner` as `outer::Inner`.
fn path(name: &str) -> Result<String, Error> {
    let (outer, inner) = name.rsplit_once('.').map_or((None, name), |(outer, inner)| (Some(outer), inner));
    let modules: String = outer.iter().flat_map(|outer| outer.split('.')).map(module).collect();
    Ok(format!("{modules}{}", names::type_name(inner)?))
}

fn module(message: &str) -> String {
    format!("{}::", names::module_name(message))
}

fn unmapped(full_name: &str) -> Error {
    let name = full_name.trim_start_matches('.');
    let text =
        format!("`{name}` is of another package: say with `Compiler::extern_package` where its Rust code is");
    Error::new(ErrorKind::Unmapped, text)
}
