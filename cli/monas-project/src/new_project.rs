//! Creates a project that builds, runs and passes its tests at once.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::{Error, ErrorKind};
use crate::packages::{is_locked, package_folder};

/// The files of a project with their texts; double braces mark placeholders.
const FILES: [(&str, &str); 25] = [
    ("Cargo.toml", include_str!("template/Cargo.toml.txt")),
    (".gitignore", include_str!("template/gitignore.txt")),
    ("README.md", include_str!("template/README.md.txt")),
    ("src/main.rs", include_str!("template/src/main.rs.txt")),
    ("tests/project.rs", include_str!("template/tests/project.rs.txt")),
    ("activities/Cargo.toml", include_str!("template/activities/Cargo.toml.txt")),
    ("activities/build.rs", include_str!("template/activities/build.rs.txt")),
    ("activities/lib.rs", include_str!("template/activities/lib.rs.txt")),
    ("activities/greet.rs", include_str!("template/activities/greet.rs.txt")),
    ("activities/say.rs", include_str!("template/activities/say.rs.txt")),
    ("functionalities/Cargo.toml", include_str!("template/functionalities/Cargo.toml.txt")),
    ("functionalities/build.rs", include_str!("template/functionalities/build.rs.txt")),
    ("functionalities/lib.rs", include_str!("template/functionalities/lib.rs.txt")),
    ("functionalities/counting.rs", include_str!("template/functionalities/counting.rs.txt")),
    ("messages/Cargo.toml", include_str!("template/messages/Cargo.toml.txt")),
    ("messages/build.rs", include_str!("template/messages/build.rs.txt")),
    ("messages/lib.rs", include_str!("template/messages/lib.rs.txt")),
    ("messages/topics.rs", include_str!("template/messages/topics.rs.txt")),
    ("messages/greeting.proto", include_str!("template/messages/greeting.proto.txt")),
    ("models/greeter.srm", include_str!("template/models/greeter.srm.txt")),
    ("statecharts/.gitkeep", ""),
    ("modules/.gitkeep", ""),
    ("config/agents.xml", include_str!("template/config/agents.xml.txt")),
    ("rustfmt.toml", "edition = \"2024\"\n"),
    (".gitattributes", "Cargo.lock linguist-generated\n"),
];

/// The crates of Monas that a project uses.
const CRATES: [&str; 5] = ["monas", "monas-cli", "narukom", "narukom-build", "yase"];

/// Names of the project's packages, and names with a meaning to Cargo or Rust.
pub(crate) const RESERVED_NAMES: [&str; 12] = [
    "activities",
    "alloc",
    "aseme",
    "core",
    "functionalities",
    "messages",
    "monas",
    "monas-cli",
    "narukom",
    "std",
    "test",
    "yase",
];

/// Folders of Cargo's target folder, whose names Cargo refuses for programs.
const TARGET_FOLDERS: [&str; 4] = ["build", "deps", "examples", "incremental"];

/// Creates a project in a new or empty folder, whose name becomes that of the project. `monas` says
/// where the project finds the crates of Monas: a checkout, the address of a git repository, or a
/// version; without it, the checkout that this crate was built from. Returns the files.
///
/// # Errors
/// The name cannot be used, the folder is not empty, or a file cannot be written.
pub fn create_project(folder: &Path, monas: Option<&str>) -> Result<Vec<PathBuf>, Error> {
    // The name of `.` is that of the present folder.
    let absolute = std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf());
    let name = absolute.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned();
    check(&name).map_err(|message| Error::new(ErrorKind::Argument, message))?;
    if fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) || folder.is_file() {
        let message = format!("{} exists and is not empty", folder.display());
        return Err(Error::new(ErrorKind::File, message));
    }
    let (dependencies, checkout) =
        dependencies(monas).map_err(|message| Error::new(ErrorKind::Argument, message))?;
    if checkout.as_ref().is_some_and(|checkout| is_used(&name, checkout)) {
        let message = format!("`{name}` is a crate that Monas uses: use for example `team-{name}`");
        return Err(Error::new(ErrorKind::Argument, message));
    }
    let topic = name.replace('-', "_");
    let fill = |text: &str| {
        let text = text.replace("{{name}}", &name).replace("{{topic}}", &topic);
        text.replace("{{dependencies}}", &dependencies)
    };
    let mut written = Vec::new();
    for (file, text) in FILES {
        let path = folder.join(file);
        write(&path, &fill(text)).map_err(|error| Error::file("write", &path, &error))?;
        written.push(path);
    }
    // The versions that Monas itself is built and tested with.
    if let Some(lock) = checkout.map(|checkout| checkout.join("Cargo.lock")).filter(|lock| lock.is_file()) {
        let path = folder.join("Cargo.lock");
        fs::copy(lock, &path).map_err(|error| Error::file("write", &path, &error))?;
        written.push(path);
    }
    Ok(written)
}

pub(crate) fn write(path: &Path, text: &str) -> io::Result<()> {
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    monas_files::write(path, text)
}

/// Whether the name is valid for a package and as the prefix of topics.
fn check(name: &str) -> Result<(), String> {
    let is_plain = name.starts_with(|first: char| first.is_ascii_lowercase())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_');
    if !is_plain {
        return Err(format!(
            "`{name}` cannot be the name of a project: use lower-case letters, digits, `-` and `_`, starting with a letter, for example `my-team`"
        ));
    }
    let module = name.replace('-', "_");
    let is_reserved = RESERVED_NAMES.contains(&name) || TARGET_FOLDERS.contains(&name);
    match is_reserved || aseme_codegen::generate::identifier(&[&module]) != module {
        true => Err(format!("`{name}` is reserved by Rust or Monas: use for example `team-{name}`")),
        false => Ok(()),
    }
}

/// Whether the name is that of a crate of Monas, or of one that these use. Cargo does not lock
/// two packages of one name, or cannot tell them apart.
fn is_used(name: &str, checkout: &Path) -> bool {
    is_locked(&checkout.join("Cargo.lock"), name)
        || package_folder(checkout, name).is_some_and(|folder| !folder.starts_with(checkout.join("examples")))
}

/// The dependency lines of the crates of Monas, and the folder of its checkout if it is local.
fn dependencies(monas: Option<&str>) -> Result<(String, Option<PathBuf>), String> {
    let lines = |value: &dyn Fn(&str) -> String| -> String {
        // A project without matches needs neither the field nor the soccer team.
        let features = |name: &str| if name == "monas-cli" { ", default-features = false" } else { "" };
        CRATES.iter().map(|name| format!("{name} = {{ {}{} }}\n", value(name), features(name))).collect()
    };
    match monas {
        Some(address) if address.contains("://") || address.starts_with("git@") => {
            Ok((lines(&|_| format!("git = {address:?}")), None))
        }
        Some(version) if version.starts_with(|first: char| first.is_ascii_digit()) => {
            Ok((lines(&|_| format!("version = {version:?}")), None))
        }
        path => {
            let built_from = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
            let path = Path::new(path.unwrap_or(built_from));
            let checkout =
                fs::canonicalize(path).ok().filter(|path| path.join("runtime/monas/Cargo.toml").is_file());
            let Some(checkout) = checkout else {
                return Err(format!(
                    "there is no checkout of Monas at {}: give its place with --monas PATH, --monas https://... or --monas VERSION",
                    path.display()
                ));
            };
            let at = |name: &str| format!("path = {:?}", checkout.join(folder(name)).display().to_string());
            Ok((lines(&at), Some(checkout.clone())))
        }
    }
}

/// The folder of a crate in a checkout of Monas.
fn folder(name: &str) -> String {
    let parent = match name {
        "aseme" => "methodology",
        "monas" => "runtime",
        "monas-cli" => "cli",
        "monas-match" | "monas-sim" | "monas-soccer" => "soccer",
        "monas-robot" => "robots",
        "yase" => "charts",
        _ => "messages",
    };
    format!("{parent}/{name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_packages() {
        for name in ["my-team", "a", "team_2"] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
        for name in ["", "My-Team", "2-teams", "a b", "../a", "std", "monas", "fn", "messages"] {
            assert!(check(name).is_err(), "{name}");
        }
    }

    #[test]
    fn names_that_cargo_cannot_build_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["build", "deps", "examples", "incremental", "aseme", "monas-core", "serde"] {
            let refused = create_project(&folder.path().join(name), None).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::Argument, "{name}");
            assert!(refused.to_string().contains(&format!("`team-{name}`")), "{refused}");
            assert!(!folder.path().join(name).exists(), "{name}");
        }
    }

    #[test]
    fn monas_is_taken_from_a_folder_a_repository_or_a_registry() {
        let (text, checkout) = dependencies(None).unwrap();
        assert!(checkout.is_some_and(|checkout| checkout.join("Cargo.lock").is_file()));
        assert_eq!(text.lines().filter(|line| line.contains("path = ")).count(), CRATES.len());
        let (text, _) = dependencies(Some("https://example.org/monas.git")).unwrap();
        assert!(text.contains("narukom = { git = \"https://example.org/monas.git\" }\n"), "{text}");
        assert!(dependencies(Some("0.1.0")).unwrap().0.contains("monas = { version = \"0.1.0\" }\n"));
        assert!(dependencies(Some("/nowhere")).unwrap_err().contains("--monas PATH"));
    }

    #[test]
    fn nothing_is_left_to_be_filled_in() {
        for (file, text) in FILES {
            let filled = ["{{name}}", "{{topic}}", "{{dependencies}}"]
                .iter()
                .fold(text.to_owned(), |text, key| text.replace(key, ""));
            assert!(!filled.contains("{{") && !filled.contains("}}"), "{file}");
        }
    }
}
