//! `cargo xtask bodies`: links the crates of bodies into the command `monas`, so that a new crate
//! under `robots/` needs no edit elsewhere.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::TidyFinding;
use super::workspace::Workspace;

/// The lines around a block that this task writes.
const BEGIN: &str = "# bodies, kept in step by `cargo xtask bodies`";
const END: &str = "# end of the bodies";
/// The part of a crate that registers a kind of body.
const REGISTERS: &str = "body_kind!(BodyKind {";

/// Writes what is not in step.
pub(crate) fn run(root: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let workspace = Workspace::read(root)?;
    let crates = body_crates(&workspace);
    for (path, text) in linked(&workspace, &crates)? {
        println!("writing {}", path.display());
        fs::write(root.join(&path), text)?;
    }
    println!("bodies: {}", crates.keys().copied().collect::<Vec<_>>().join(", "));
    Ok(ExitCode::SUCCESS)
}

/// A finding for each file that does not link the bodies as this task would.
pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    let differing = linked(workspace, &body_crates(workspace));
    let finding = |path: PathBuf, message: String| TidyFinding::new(path, 1, message);
    match differing {
        Ok(files) => files
            .into_keys()
            .map(|path| finding(path, "the bodies are not in step: run `cargo xtask bodies`".into()))
            .collect(),
        Err(error) => vec![finding("Cargo.toml".into(), error)],
    }
}

/// The crates under `robots/` that register a kind of body, with their folders.
fn body_crates(workspace: &Workspace) -> BTreeMap<&str, String> {
    let bodies = workspace.crates.iter().filter(|member| {
        member.folder.starts_with("robots")
            && workspace.sources(member).any(|file| file.text.contains(REGISTERS))
    });
    bodies.map(|body| (body.name.as_str(), body.folder.to_string_lossy().replace('\\', "/"))).collect()
}

/// The files that differ from what links these crates, with their new texts.
fn linked(
    workspace: &Workspace,
    crates: &BTreeMap<&str, String>,
) -> Result<BTreeMap<PathBuf, String>, String> {
    let (root, command) = (Path::new("Cargo.toml"), Path::new("cli/monas-cli/Cargo.toml"));
    let program = Path::new("cli/monas-cli/src/bodies.rs");
    let paths = crates.iter().map(|(name, folder)| format!("{name} = {{ path = \"{folder}\" }}"));
    let features = crates.keys().map(|name| format!("    \"dep:{name}\","));
    let dependencies = crates.keys().map(|name| format!("{name} = {{ workspace = true, optional = true }}"));
    let uses = crates.keys().map(|name| format!("use {} as _;\n", name.replace('-', "_")));
    let text = |path: &Path| {
        let file = workspace.file(path).ok_or_else(|| format!("{} is missing", path.display()))?;
        Ok::<_, String>(file.text.clone())
    };
    let mut texts = BTreeMap::new();
    let manifest = with_block(&text(root)?, 0, &paths.collect::<Vec<_>>());
    texts.insert(root, manifest.ok_or("Cargo.toml has no block of bodies")?);
    let manifest = with_block(&text(command)?, 0, &features.collect::<Vec<_>>());
    let manifest = manifest.and_then(|text| with_block(&text, 1, &dependencies.collect::<Vec<_>>()));
    texts.insert(command, manifest.ok_or("monas-cli's Cargo.toml lacks a block of bodies")?);
    let header = "//! Links the bodies, which register themselves. Kept in step by `cargo xtask bodies`.\n\n";
    texts.insert(program, header.chars().chain(uses.collect::<String>().chars()).collect());
    let differs = |(path, text): (&Path, String)| {
        let is_same = workspace.file(path).is_some_and(|file| file.text == text);
        (!is_same).then(|| (path.to_path_buf(), text))
    };
    Ok(texts.into_iter().filter_map(differs).collect())
}

/// A text with other lines in one of its blocks; none if it does not have the block.
fn with_block(text: &str, index: usize, lines: &[String]) -> Option<String> {
    let (start, _) = text.match_indices(BEGIN).nth(index)?;
    let from = start + text[start..].find('\n')? + 1;
    let end = from + text[from..].find(END)?;
    let to = text[..end].rfind('\n')? + 1;
    let body: String = lines.iter().flat_map(|line| [line.as_str(), "\n"]).collect();
    Some(format!("{}{body}{}", &text[..from], &text[to..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_gets_other_lines_and_what_is_around_it_stays() {
        let text = format!("[a]\n{BEGIN}\nold = 1\n  {END}\nb\n{BEGIN}\n{END}\nc\n");
        let expected = format!("[a]\n{BEGIN}\nnew = 2\n  {END}\nb\n{BEGIN}\n{END}\nc\n");
        assert_eq!(with_block(&text, 0, &["new = 2".into()]).as_deref(), Some(&*expected));
        let expected = format!("[a]\n{BEGIN}\nold = 1\n  {END}\nb\n{BEGIN}\nx\n{END}\nc\n");
        assert_eq!(with_block(&text, 1, &["x".into()]).as_deref(), Some(&*expected));
        assert_eq!(with_block(&text, 2, &[]), None);
    }
}
