//! `monas module build`: builds this program and a module in one call of cargo.
//!
//! Types of two builds are equal only if cargo gives their crates the same names, which depend on
//! features, profile and all dependencies. That holds if both are built in one call, or in calls
//! with the same choices; therefore the module is built together with the package of this program.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use monas::{BuildFingerprint, ModuleFile};
use monas_project::Project;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, report};
use serde_json::{Value, json};
use yase::Diagnostic;

pub(crate) fn execute(
    package: Option<&str>,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let here = env::current_dir().map_err(|error| CommandFailure::failed(format, error))?;
    let workspace = Workspace::around(&here).map_err(|reason| CommandFailure::Failed(format, reason))?;
    let packages =
        workspace.modules(package).map_err(|wrong| CommandFailure::Invalid(format, vec![*wrong]))?;
    let built = workspace.build(&packages).map_err(|reason| CommandFailure::Failed(format, reason))?;
    let mut wrong = Vec::new();
    for file in &built {
        monas::seal_module(file)
            .map_err(|error| CommandFailure::Failed(format, format!("{}: {error}", file.display())))?;
        match format {
            Format::Text => writeln!(console.out, "{}", file.display())?,
            Format::Json => writeln!(console.out, "{}", json!({ "module": file }))?,
        }
        wrong.extend(ModuleFile::read(file).and_then(|module| module.check()).err().unwrap_or_default());
    }
    report::write(console, format, &wrong)?;
    Ok(if wrong.is_empty() { Exit::Success } else { Exit::Invalid })
}

/// A workspace as described by `cargo metadata`.
struct Workspace {
    folder: PathBuf,
    metadata: Value,
    /// The package of this program.
    program: String,
}

impl Workspace {
    fn around(folder: &Path) -> Result<Workspace, String> {
        let mut cargo = cargo(folder);
        cargo.args(["metadata", "--no-deps", "--format-version", "1"]);
        let said = cargo.output().map_err(|error| format!("cargo: {error}"))?;
        if !said.status.success() {
            return Err(String::from_utf8_lossy(&said.stderr).trim().to_owned());
        }
        let metadata: Value =
            serde_json::from_slice(&said.stdout).map_err(|error| format!("cargo: {error}"))?;
        let program = program_of(&metadata, env::current_exe().ok().as_deref());
        let program = match program {
            Some(program) => program,
            None => team_of(&metadata, folder)?,
        };
        Ok(Workspace { folder: folder.to_path_buf(), metadata, program })
    }

    /// The packages of the workspace that are modules: the named one, or all.
    fn modules(&self, wanted: Option<&str>) -> Result<Vec<String>, Box<Diagnostic>> {
        let all: Vec<(String, String)> = packages(&self.metadata)
            .filter_map(|package| {
                let module =
                    targets(package).find(|target| is_cdylib(target) && has_kind(target, "cdylib"))?;
                Some((text(package, "name"), text(module, "name")))
            })
            .collect();
        let names = || all.iter().flat_map(|(package, library)| [package.as_str(), library.as_str()]);
        match wanted {
            None if all.is_empty() => Err(Box::new(
                Diagnostic::error("E0367", 0..0, "no package of this workspace is a module")
                    .with_hint("a module is a library with `crate-type = [\"cdylib\"]`; `monas new activity NAME --module` creates one"),
            )),
            None => Ok(all.into_iter().map(|(package, _)| package).collect()),
            Some(wanted) => match all.iter().find(|(package, library)| package == wanted || library == wanted) {
                Some((package, _)) => Ok(vec![package.clone()]),
                None => {
                    let message = format!("no package of this workspace is the module `{wanted}`");
                    Err(Box::new(Diagnostic::error("E0367", 0..0, message).with_nearest(wanted, names())))
                }
            },
        }
    }

    /// Builds packages together with the program's. Returns the files of the modules.
    fn build(&self, modules: &[String]) -> Result<Vec<PathBuf>, String> {
        let mut cargo = cargo(&self.folder);
        cargo.args(arguments(&self.program, modules, &BuildFingerprint::own(), self.target_folder()));
        let said = cargo.stderr(Stdio::inherit()).output().map_err(|error| format!("cargo: {error}"))?;
        if !said.status.success() {
            return Err("cargo has reported errors".into());
        }
        Ok(String::from_utf8_lossy(&said.stdout).lines().filter_map(library).collect())
    }

    /// The target triple of this program, if it was built for a named target.
    fn target_folder(&self) -> Option<String> {
        let program = env::current_exe().ok()?;
        let inside = program.strip_prefix(self.metadata["target_directory"].as_str()?).ok()?;
        let first = inside.components().next()?.as_os_str().to_string_lossy().into_owned();
        (BuildFingerprint::own().field("target") == Some(first.as_str())).then_some(first)
    }
}

fn cargo(folder: &Path) -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(folder);
    cargo
}

/// The arguments of cargo.
fn arguments(
    program: &str,
    modules: &[String],
    own: &BuildFingerprint,
    target: Option<String>,
) -> Vec<OsString> {
    let mut arguments: Vec<OsString> =
        ["build", "--message-format", "json-render-diagnostics"].map(Into::into).into();
    for package in std::iter::once(program).chain(modules.iter().map(String::as_str)) {
        arguments.extend(["--package".into(), package.into()]);
    }
    let profile = own.field("profile").and_then(|profile| profile.split(',').next()).unwrap_or_default();
    // The folder of the profile `dev` is named `debug`.
    let profile = if profile == "debug" { "dev" } else { profile };
    arguments.extend(["--profile".into(), profile.into()]);
    for feature in own.field("features").unwrap_or_default().split_whitespace() {
        arguments.extend(["--features".into(), format!("monas/{feature}").into()]);
    }
    arguments.extend(target.into_iter().flat_map(|target| ["--target".into(), target.into()]));
    arguments
}

fn packages(metadata: &Value) -> impl Iterator<Item = &Value> {
    metadata["packages"].as_array().into_iter().flatten()
}

fn targets(package: &Value) -> impl Iterator<Item = &Value> {
    package["targets"].as_array().into_iter().flatten()
}

fn text(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap_or_default().to_owned()
}

/// Whether the target is a shared library.
fn is_cdylib(target: &Value) -> bool {
    target["crate_types"].as_array().into_iter().flatten().any(|kind| kind == "cdylib")
}

fn has_kind(target: &Value, wanted: &str) -> bool {
    target["kind"].as_array().into_iter().flatten().any(|kind| kind == wanted)
}

/// The package of this program, if the program was built in the workspace.
fn program_of(metadata: &Value, program: Option<&Path>) -> Option<String> {
    let program = program?;
    let folder = metadata["target_directory"].as_str()?;
    let name = program.strip_prefix(folder).ok()?.file_stem()?.to_str()?;
    let has =
        |package: &&Value| targets(package).any(|target| has_kind(target, "bin") && target["name"] == name);
    packages(metadata).find(has).map(|package| text(package, "name"))
}

/// The team's package, as named by the workspace.
fn team_of(metadata: &Value, folder: &Path) -> Result<String, String> {
    let project = Project::around(&folder.join("Cargo.toml")).map_err(|wrong| wrong.to_string())?;
    let manifest = project.team().join("Cargo.toml");
    let manifest = std::fs::canonicalize(&manifest).unwrap_or(manifest);
    let is_it = |package: &&Value| Path::new(&text(package, "manifest_path")) == manifest;
    let team = packages(metadata).find(is_it).map(|package| text(package, "name"));
    team.ok_or_else(|| format!("{} is not a package of the workspace", manifest.display()))
}

/// The file of a module in a message of cargo.
fn library(line: &str) -> Option<PathBuf> {
    let said: Value = serde_json::from_str(line).ok()?;
    let is_module = said["reason"] == "compiler-artifact"
        && is_cdylib(&said["target"])
        && has_kind(&said["target"], "cdylib");
    let mut files = said["filenames"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let is_library =
        |file: &&str| Path::new(file).extension().is_some_and(|end| end == env::consts::DLL_EXTENSION);
    files.find(is_library).filter(|_| is_module).map(PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata() -> Value {
        json!({"target_directory": "/t", "packages": [
            {"name": "team", "manifest_path": "/p/Cargo.toml",
                "targets": [{"name": "my-robot", "kind": ["bin"], "crate_types": ["bin"]}]},
            {"name": "team-eyes", "manifest_path": "/p/eyes/Cargo.toml", "targets": [
                {"name": "eyes", "kind": ["cdylib", "rlib"], "crate_types": ["cdylib", "rlib"]},
                {"name": "other", "kind": ["example"], "crate_types": ["cdylib"]}]},
        ]})
    }

    #[test]
    fn the_package_of_this_program_is_found_by_its_name() {
        let found = |program: &str| program_of(&metadata(), Some(Path::new(program)));
        assert_eq!(found("/t/debug/my-robot").as_deref(), Some("team"));
        assert_eq!(found("/t/debug/deps/other"), None);
        assert_eq!(found("/usr/bin/my-robot"), None, "it was built elsewhere");
    }

    #[test]
    fn modules_are_libraries_that_can_be_loaded() {
        let workspace = Workspace { folder: "/p".into(), metadata: metadata(), program: "team".into() };
        for wanted in [None, Some("eyes"), Some("team-eyes")] {
            assert_eq!(workspace.modules(wanted).unwrap(), ["team-eyes"], "{wanted:?}");
        }
        let wrong = workspace.modules(Some("eye")).err().unwrap().to_string();
        assert!(
            wrong.contains("no package of this workspace is the module `eye` (did you mean `eyes`?)"),
            "{wrong}"
        );
    }

    #[test]
    fn cargo_builds_both_with_the_features_and_profile_of_the_program() {
        let words = |arguments: Vec<OsString>| -> Vec<String> {
            arguments.into_iter().map(|word| word.to_string_lossy().into_owned()).collect()
        };
        let own = arguments("team", &["team-eyes".into()], &BuildFingerprint::own(), Some("t".into()));
        let said = words(own).join(" ");
        let begin =
            "build --message-format json-render-diagnostics --package team --package team-eyes --profile ";
        assert!(said.starts_with(begin) && said.ends_with(" --target t"), "{said}");
        assert_eq!(said.contains("--features monas/zenoh"), cfg!(feature = "zenoh"), "{said}");
    }

    #[test]
    fn the_files_of_modules_are_taken_from_cargos_output() {
        let said = |kind: &str| {
            let target = json!({"name": "eyes", "kind": [kind], "crate_types": ["cdylib"]});
            let files = ["/t/libeyes.rlib", "/t/libeyes.so", "/t/libeyes.dylib", "/t/eyes.dll"];
            json!({"reason": "compiler-artifact", "target": target, "filenames": files}).to_string()
        };
        assert!(library(&said("cdylib")).is_some_and(|file| file.to_string_lossy().contains("eyes")));
        assert_eq!(library(&said("example")), None);
        assert_eq!(library("{\"reason\": \"build-finished\"}"), None);
    }
}
