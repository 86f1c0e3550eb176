//! For build scripts: compiles `.proto` files to messages with descriptors and field access by
//! name.
//!
//! A build script calls [`compile`] (or a [`Compiler`], if messages of other crates are imported):
//!
//! ```no_run
//! fn main() -> Result<(), narukom_build::Error> {
//!     narukom_build::compile(&["proto/soccer.proto"], &["proto"])
//! }
//! ```
//!
//! and the crate includes the result, one module per package:
//!
//! ```text
//! /// Messages of the soccer team.
//! pub mod messages {
//!     narukom::include_messages!("monas.soccer");
//! }
//! ```
//!
//! The structs are those of prost, with the schema's comments as documentation and maps as
//! `BTreeMap`, so that equal messages have equal encodings. In addition each struct gets an
//! `impl narukom::Message` with a static descriptor (names, fields, enumerations, and the
//! serialised schema for recorders and links) and an `impl narukom::Reflect`, through which
//! transition expressions and tools read and set fields by index.
//!
//! # Requirements on a schema
//!
//! - It uses proto3 and declares a package.
//! - Names follow the style of their kind: fields in `snake_case`, messages and enumerations in
//!   `UpperCamelCase` with acronyms written as words (`RobotId`). Then names are the same in Rust,
//!   in expressions and in tools.
//! - Messages of other packages are mapped to their crate by [`Compiler::extern_package`].
//!
//! Lists, maps, members of a `oneof`, and protobuf's well-known types are fields of the struct, but
//! not accessible by index. A crate that uses the well-known types depends on `prost-types`.
//!
//! `protoc` is not needed: the compiler is protox, which is written in Rust.

mod error;
mod folder;
mod generate;
mod names;
mod schema_names;
mod types;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use prost::Message as _;
use prost_build::Module;
use prost_types::{FileDescriptorProto, FileDescriptorSet};

use crate::types::TypePaths;

pub use error::{Error, ErrorKind};
pub use folder::{compile_folder, modules};

/// Compiles `protos`, whose imports are searched in `includes`, into `OUT_DIR`.
///
/// The short form of [`Compiler::compile`].
pub fn compile(protos: &[impl AsRef<Path>], includes: &[impl AsRef<Path>]) -> Result<(), Error> {
    Compiler::new().compile(protos, includes)
}

/// Compiles `.proto` files to Rust messages.
#[derive(Clone, Debug, Default)]
pub struct Compiler {
    modules: Vec<(String, String)>,
    out_dir: Option<PathBuf>,
}

impl Compiler {
    /// A compiler that writes into `OUT_DIR` and maps no other packages.
    pub fn new() -> Compiler {
        Compiler::default()
    }

    /// Maps the imported package `package` to the Rust module `module`:
    /// `.extern_package("monas.body", "::monas_robot::messages")`.
    pub fn extern_package(mut self, package: &str, module: &str) -> Compiler {
        self.modules.push((package.to_owned(), module.to_owned()));
        self
    }

    /// Writes into `path` instead of `OUT_DIR`, and prints no instructions for Cargo.
    pub fn out_dir(mut self, path: impl Into<PathBuf>) -> Compiler {
        self.out_dir = Some(path.into());
        self
    }

    /// Compiles `protos`, whose imports are searched in `includes`. Writes one file per package, to
    /// be included by `narukom::include_messages!`.
    pub fn compile(&self, protos: &[impl AsRef<Path>], includes: &[impl AsRef<Path>]) -> Result<(), Error> {
        let target = self.target()?;
        let schema = SchemaSet::read(protos, includes)?;
        for package in schema.packages()? {
            let code = self.package(&schema, &package)?;
            write(&target.join(format!("{package}.rs")), code.as_bytes())?;
            let set = schema.descriptor_set(&package).encode_to_vec();
            write(&target.join(format!("{package}.descriptors")), &set)?;
        }
        if self.out_dir.is_none() {
            schema.paths.iter().for_each(|path| println!("cargo:rerun-if-changed={}", path.display()));
        }
        Ok(())
    }

    fn target(&self) -> Result<PathBuf, Error> {
        let target = self.out_dir.clone().or_else(|| std::env::var_os("OUT_DIR").map(PathBuf::from));
        target.ok_or_else(|| {
            Error::new(ErrorKind::Output, "OUT_DIR is not set: not in a build script".to_owned())
        })
    }

    /// The code of a package: its structs by prost, and the implementations of Narukom's traits.
    fn package(&self, schema: &SchemaSet, package: &str) -> Result<String, Error> {
        let known = schema.set.file.iter().map(|file| file.package().to_owned()).collect();
        let types = TypePaths::new(package, known, &self.modules);
        let mut reflection = String::new();
        for file in schema.own_files(package) {
            schema_names::check(file)?;
            generate::file(file, &types, &mut reflection)?;
        }
        let structs = self.structs(schema, package, &types)?;
        Ok(format!(
            "#[allow({LINTS})]\nmod generated {{\n{structs}\n{reflection}\n\
             const FILE_DESCRIPTOR_SET: &[u8] = include_bytes!(\"{package}.descriptors\");\n}}\n\
             #[allow(unreachable_pub, unused_imports)]\npub use generated::*;\n"
        ))
    }

    fn structs(&self, schema: &SchemaSet, package: &str, types: &TypePaths) -> Result<String, Error> {
        let mut config = prost_build::Config::new();
        config.btree_map(["."]).prost_path("::narukom::prost");
        let others = self.modules.iter().filter(|(other, _)| other != package);
        // The path of a package would also be that of the packages whose names continue its name.
        // If the generated package is one of these, the types of the outer one are mapped singly.
        let is_outer = |other: &str| types::inside(&format!(".{package}."), other).is_some();
        let (outer, plain): (Vec<_>, Vec<_>) = others.partition(|(other, _)| is_outer(other));
        for (other, module) in plain {
            config.extern_path(format!(".{other}"), module);
        }
        for name in schema.type_names() {
            if !types.is_own(&name) && outer.iter().any(|(other, _)| types::inside(&name, other).is_some()) {
                config.extern_path(&name, types.rust_path(&name)?);
            }
        }
        let module = Module::from_protobuf_package_name(package);
        let files = schema.set.file.iter();
        let requests =
            files.map(|file| (Module::from_protobuf_package_name(file.package()), file.clone())).collect();
        let generated = config.generate(requests);
        let mut generated = generated.map_err(|error| Error::new(ErrorKind::Schema, error.to_string()))?;
        Ok(generated.remove(&module).unwrap_or_default())
    }
}

/// Lints that generated code violates.
const LINTS: &str =
    "missing_docs, unreachable_pub, unused_qualifications, unused_imports, clippy::all, rustdoc::all";

/// The compiled files with their imports, each after those it imports.
struct SchemaSet {
    set: FileDescriptorSet,
    /// The names of the requested files.
    requested: BTreeSet<String>,
    /// The paths of the files on disk.
    paths: Vec<PathBuf>,
}

impl SchemaSet {
    fn read(protos: &[impl AsRef<Path>], includes: &[impl AsRef<Path>]) -> Result<SchemaSet, Error> {
        let schema = |error: protox::Error| Error::schema(&error);
        let mut compiler = protox::Compiler::new(includes).map_err(schema)?;
        compiler.include_source_info(true).include_imports(true);
        compiler.open_files(protos).map_err(schema)?;
        let own = compiler.files().filter(|file| !file.is_import()).map(|file| file.name().to_owned());
        let paths = compiler.files().filter_map(|file| file.path()).map(Path::to_owned);
        Ok(SchemaSet {
            requested: own.collect(),
            paths: paths.collect(),
            set: compiler.file_descriptor_set(),
        })
    }

    /// The packages of the requested files.
    fn packages(&self) -> Result<BTreeSet<String>, Error> {
        let own = self.set.file.iter().filter(|file| self.requested.contains(file.name()));
        own.map(|file| checked_package(file).map(str::to_owned)).collect()
    }

    fn own_files(&self, package: &str) -> impl Iterator<Item = &FileDescriptorProto> {
        self.set
            .file
            .iter()
            .filter(move |file| file.package() == package && self.requested.contains(file.name()))
    }

    /// The full names of all types, with a dot in front.
    fn type_names(&self) -> impl Iterator<Item = String> {
        self.set.file.iter().flat_map(types::full_names)
    }

    /// The files of a package and all their imports, without source positions.
    fn descriptor_set(&self, package: &str) -> FileDescriptorSet {
        let mut wanted: BTreeSet<&str> = self.own_files(package).map(|file| file.name()).collect();
        // Every file comes after its imports, so one pass from the end finds them all.
        for file in self.set.file.iter().rev() {
            if wanted.contains(file.name()) {
                wanted.extend(file.dependency.iter().map(String::as_str));
            }
        }
        let files = self.set.file.iter().filter(|file| wanted.contains(file.name()));
        FileDescriptorSet {
            file: files.map(|file| FileDescriptorProto { source_code_info: None, ..file.clone() }).collect(),
        }
    }
}

fn checked_package(file: &FileDescriptorProto) -> Result<&str, Error> {
    let name = file.name();
    if file.syntax() != "proto3" {
        return Err(Error::new(
            ErrorKind::Syntax,
            format!("{name}: only `syntax = \"proto3\";` is supported"),
        ));
    }
    let package = file.package();
    let plain = |part: &str| !part.is_empty() && names::field_name(part).is_ok();
    if package.split('.').all(plain) {
        return Ok(package);
    }
    let text = match package {
        "" => format!("{name}: the file declares no package: write for example `package my_team;`"),
        _ => format!("{name}: the package `{package}` is not names in snake_case separated by dots"),
    };
    Err(Error::new(ErrorKind::Package, text))
}

/// Writes a file unless it already has this content, to avoid needless rebuilds.
fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    if fs::read(path).is_ok_and(|present| present == content) {
        return Ok(());
    }
    fs::write(path, content).map_err(|error| Error::output(path, error))
}
