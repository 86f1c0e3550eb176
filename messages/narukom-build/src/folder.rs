//! Compilation of all `.proto` files or all Rust files of a folder, without listing them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use prost_types::FileDescriptorProto;

use crate::error::{Error, ErrorKind};
use crate::{Compiler, SchemaSet, names, write};

/// Compiles every `.proto` file of a folder, and writes `messages.rs` with the messages of all
/// packages into `OUT_DIR`:
///
/// ```text
/// include!(concat!(env!("OUT_DIR"), "/messages.rs"));
/// ```
///
/// Files added to the folder later are compiled too. Messages of one package may be used in
/// another; all are in one module, so their names must be unique.
pub fn compile_folder(folder: impl AsRef<Path>) -> Result<(), Error> {
    let target = Compiler::new().target()?;
    compile_into(folder.as_ref(), &target)?;
    println!("cargo:rerun-if-changed={}", folder.as_ref().display());
    Ok(())
}

fn compile_into(folder: &Path, target: &Path) -> Result<(), Error> {
    let protos = files(folder, "proto")?;
    let packages = match protos.is_empty() {
        true => Default::default(),
        false => {
            let schema = SchemaSet::read(&protos, &[folder])?;
            let packages = schema.packages()?;
            check_unique(&schema)?;
            packages
        }
    };
    let compiler = packages
        .iter()
        .fold(Compiler::new().out_dir(target), |compiler, package| compiler.extern_package(package, "crate"));
    if !protos.is_empty() {
        compiler.compile(&protos, &[folder])?;
    }
    let module = |(index, package)| {
        format!(
            "mod package_{index} {{\n    include!(concat!(env!(\"OUT_DIR\"), \"/{package}.rs\"));\n}}\n\
             #[allow(unused_imports)]\npub use package_{index}::*;\n"
        )
    };
    let text: String = packages.iter().enumerate().map(module).collect();
    write(&target.join("messages.rs"), text.as_bytes())
}

/// The packages share one module: without this check, the compiler would report ambiguous names of
/// generated code.
fn check_unique(schema: &SchemaSet) -> Result<(), Error> {
    let mut known: BTreeMap<&str, &FileDescriptorProto> = BTreeMap::new();
    for file in schema.set.file.iter().filter(|file| schema.requested.contains(file.name())) {
        let messages = file.message_type.iter().map(|message| message.name());
        for name in messages.chain(file.enum_type.iter().map(|enumeration| enumeration.name())) {
            if let Some(other) = known.insert(name, file) {
                let text = format!(
                    "{} and {} both declare `{name}`, in the packages `{}` and `{}`: name one of them otherwise, \
                     since the packages of a folder share one module",
                    other.name(),
                    file.name(),
                    other.package(),
                    file.package()
                );
                return Err(Error::new(ErrorKind::Name, text));
            }
        }
    }
    Ok(())
}

/// Finds every Rust file of a folder except `lib.rs`, `main.rs` and `build.rs`, and writes
/// `modules.rs` into `OUT_DIR`, which declares each as a public module of that name:
///
/// ```text
/// include!(concat!(env!("OUT_DIR"), "/modules.rs"));
/// ```
///
/// Files added to the folder later become part of the crate too. A subfolder with a `mod.rs` is
/// also a module.
pub fn modules(folder: impl AsRef<Path>) -> Result<(), Error> {
    let target = Compiler::new().target()?;
    modules_into(folder.as_ref(), &target)?;
    println!("cargo:rerun-if-changed={}", folder.as_ref().display());
    Ok(())
}

fn modules_into(folder: &Path, target: &Path) -> Result<(), Error> {
    let folder = fs::canonicalize(folder).map_err(|error| unreadable(folder, &error))?;
    let mut text = String::new();
    for file in files(&folder, "rs")?.into_iter().chain(folders(&folder)?) {
        let stem = if file.ends_with("mod.rs") { file.parent() } else { Some(file.as_path()) };
        let name = stem.and_then(Path::file_stem).unwrap_or_default().to_string_lossy().into_owned();
        if ["lib", "main", "build"].contains(&name.as_str()) {
            continue;
        }
        let Some(module) = module_name(&name) else {
            let text = format!(
                "{}: `{name}` cannot be the name of a module: small letters, digits and `_`",
                file.display()
            );
            return Err(Error::new(ErrorKind::Name, text));
        };
        // Modules that no code references must not be reported as dead code.
        text += &format!("#[path = {:?}]\npub mod {module};\n", file.display().to_string());
    }
    write(&target.join("modules.rs"), text.as_bytes())
}

/// The identifier of a module; `None` if the name cannot be one. Keywords are written as raw
/// identifiers, except those that cannot be.
fn module_name(name: &str) -> Option<String> {
    let is_name = name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    let module = names::identifier(name);
    (is_name && module.trim_start_matches("r#") == name).then_some(module)
}

/// The files of a folder with that extension, sorted by name.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, Error> {
    let is_wanted = |path: &PathBuf| path.is_file() && path.extension().is_some_and(|found| found == ending);
    Ok(entries(folder)?.into_iter().filter(is_wanted).collect())
}

/// The `mod.rs` of each subfolder that has one.
fn folders(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    Ok(entries(folder)?.into_iter().map(|path| path.join("mod.rs")).filter(|path| path.is_file()).collect())
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let entries = fs::read_dir(folder).map_err(|error| unreadable(folder, &error))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort(); // T directory order is unspecified
    Ok(paths)
}

fn unreadable(folder: &Path, error: &std::io::Error) -> Error {
    Error::new(ErrorKind::Schema, format!("{} cannot be read: {error}", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    fn read(target: &tempfile::TempDir, name: &str) -> String {
        fs::read_to_string(target.path().join(name)).unwrap()
    }

    #[test]
    fn each_rust_file_is_a_module() {
        let (source, target) = (
            folder(&[
                ("b.rs", ""),
                ("a.rs", ""),
                ("lib.rs", ""),
                ("match.rs", ""),
                ("build.rs", ""),
                ("c/mod.rs", ""),
                ("d.txt", ""),
            ]),
            folder(&[]),
        );
        modules_into(source.path(), target.path()).unwrap();
        let text = read(&target, "modules.rs");
        let names: Vec<&str> = text.lines().filter(|line| line.starts_with("pub mod")).collect();
        assert_eq!(names, ["pub mod a;", "pub mod b;", "pub mod r#match;", "pub mod c;"]);
        fs::write(source.path().join("Wrong-Name.rs"), "").unwrap();
        let said = modules_into(source.path(), target.path()).unwrap_err().to_string();
        assert!(said.contains("`Wrong-Name` cannot be the name of a module"), "{said}");
        let reserved = folder(&[("super.rs", "")]);
        let error = modules_into(reserved.path(), target.path()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Name);
    }

    #[test]
    fn proto_files_of_all_packages_are_compiled() {
        let target = folder(&[]);
        compile_into(folder(&[]).path(), target.path()).unwrap();
        assert_eq!(read(&target, "messages.rs"), "");
        let source = folder(&[
            ("a.proto", "syntax = \"proto3\"; package one; message A { uint32 n = 1; }"),
            ("b.proto", "syntax = \"proto3\"; package two; import \"a.proto\"; message B { one.A a = 1; }"),
        ]);
        compile_into(source.path(), target.path()).unwrap();
        let text = read(&target, "messages.rs");
        assert!(text.contains("/one.rs") && text.contains("/two.rs"), "{text}");
        assert!(read(&target, "two.rs").contains("crate::A"), "{}", read(&target, "two.rs"));
    }

    #[test]
    fn packages_of_a_folder_do_not_declare_the_same_name() {
        let source = folder(&[
            ("a.proto", "syntax = \"proto3\"; package one; message Ball { uint32 n = 1; }"),
            ("b.proto", "syntax = \"proto3\"; package two; enum Ball { NONE = 0; }"),
        ]);
        let error = compile_into(source.path(), folder(&[]).path()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Name);
        let said = error.to_string();
        assert!(said.contains("a.proto and b.proto both declare `Ball`"), "{said}");
    }
}
