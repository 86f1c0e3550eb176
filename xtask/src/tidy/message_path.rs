//! Checks the path of a message in ARCHITECTURE.md: the files exist, the functions named are
//! defined there, and the path is no longer than it was.

use std::path::Path;

use super::TidyFinding;
use super::workspace::Workspace;

/// The page that lists the path.
const MAP_FILE: &str = "ARCHITECTURE.md";

/// The heading above the list.
const HEADING: &str = "## The path of a message";

/// The path has at most this many files.
const MAX_FILES: usize = 20;

/// One stop of the path: its line in the map, its file, and what the text says of it.
struct Stop<'a> {
    line: usize,
    file: &'a str,
    text: String,
}

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    let Some(map) = workspace.file(Path::new(MAP_FILE)) else { return Vec::new() };
    let stops = stops(&map.text);
    let mut findings = Vec::new();
    if stops.is_empty() || stops.len() > MAX_FILES {
        let message = format!("the path of a message has {} files: 1 to {MAX_FILES}", stops.len());
        findings.push(TidyFinding::new(MAP_FILE, 1, message));
    }
    for stop in &stops {
        let Some(file) = workspace.file(Path::new(stop.file)) else { continue };
        let missing = functions(&stop.text).filter(|name| !defines(&file.text, name));
        findings.extend(missing.map(|name| {
            TidyFinding::new(MAP_FILE, stop.line, format!("`{}` does not define `{name}`", stop.file))
        }));
    }
    findings
}

/// The numbered items below the heading.
fn stops(map: &str) -> Vec<Stop<'_>> {
    let mut stops: Vec<Stop<'_>> = Vec::new();
    let lines = map.lines().enumerate().skip_while(|(_, line)| *line != HEADING).skip(1);
    for (index, line) in lines.take_while(|(_, line)| !line.starts_with("## ")) {
        let item = line.split_once(". `").filter(|(number, _)| number.parse::<usize>().is_ok());
        match (item, stops.last_mut()) {
            (Some((_, rest)), _) => {
                let (file, text) = rest.split_once('`').unwrap_or((rest, ""));
                stops.push(Stop { line: index + 1, file, text: text.to_owned() });
            }
            (None, Some(stop)) => stop.text.push_str(line),
            (None, None) => {}
        }
    }
    stops
}

/// The functions that a text names in backquotes: `Type::function` and `function`.
fn functions(text: &str) -> impl Iterator<Item = &str> {
    let quoted = text.split('`').skip(1).step_by(2).filter(|name| !name.contains('/'));
    let names = quoted.map(|name| name.rsplit("::").next().unwrap_or(name));
    names.filter(|name| name.starts_with(|first: char| first.is_ascii_lowercase()))
}

fn defines(source: &str, function: &str) -> bool {
    ["(", "<"].iter().any(|end| source.contains(&format!("fn {function}{end}")))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::tidy::workspace::TextFile;

    fn findings(map: &str) -> Vec<String> {
        let file = |path: &str, text: &str| TextFile { path: path.into(), text: text.into() };
        let files = vec![file("ARCHITECTURE.md", map), file("a.rs", "fn step<T>() {}")];
        let workspace = Workspace { root: PathBuf::new(), crates: Vec::new(), files };
        check(&workspace).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn functions_on_the_path_exist() {
        let stops_of = |stop: &str| findings(&format!("# Map\n{HEADING}\n\n{stop}\n"));
        assert!(stops_of("1. `a.rs`: `Machine::step` runs.").is_empty());
        assert_eq!(stops_of("1. `a.rs`: `Machine::leap`\n   and `step` run.").len(), 1);
        assert_eq!(stops_of("nothing")[0], "ARCHITECTURE.md:1: the path of a message has 0 files: 1 to 20");
    }
}
