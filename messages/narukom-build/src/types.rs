//! Rust paths of a schema's messages and enumerations.

use crate::error::{Error, ErrorKind};
use crate::names;

/// Maps full names of types, with a dot in front, to Rust paths.
pub(crate) struct TypePaths {
    /// The package that is being generated.
    package: String,
    /// Other packages and their Rust modules.
    modules: Vec<(String, String)>,
}

/// The package of protobuf's well-known types, which prost provides.
const WELL_KNOWN: &str = ".google.protobuf.";

impl TypePaths {
    pub(crate) fn new(package: &str, modules: &[(String, String)]) -> TypePaths {
        TypePaths { package: package.to_owned(), modules: modules.to_vec() }
    }

    /// The type's path, relative to the package's module.
    pub(crate) fn rust_path(&self, full_name: &str) -> Result<String, Error> {
        if self.is_foreign(full_name) {
            return Ok(full_name.to_owned());
        }
        if let Some(name) = inside(full_name, &self.package) {
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

    /// Whether the type is the entry type of a map field.
    pub(crate) fn is_map_entry(&self, full_name: &str) -> bool {
        full_name.ends_with("Entry")
            && inside(full_name, &self.package).is_some_and(|name| name.contains('.'))
    }
}

/// The name of a type without its package.
fn inside<'a>(full_name: &'a str, package: &str) -> Option<&'a str> {
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
