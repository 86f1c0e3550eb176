//! Import circles: top-level modules of a crate that import each other, directly or over others.
//! The modules of a circle can be understood, tested and moved only together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::TidyFinding;
use super::allowances::{Check, Measure};
use super::source::{code, without_tests};
use super::workspace::{Crate, TextFile, Workspace};

/// The most modules in a circle.
const MAX_MODULES: usize = 3;

/// The modules that each top-level module imports.
type Imports = BTreeMap<String, BTreeSet<String>>;

pub(crate) fn measures(workspace: &Workspace) -> Vec<Measure> {
    workspace.crates.iter().map(|member| measure(workspace, member)).collect()
}

fn measure(workspace: &Workspace, member: &Crate) -> Measure {
    let imports = imports(workspace, member);
    let circle = largest_circle(&imports);
    let message = format!("`{}`: a circle of {} modules: {}", member.name, circle.len(), circle.join(", "));
    let finding = TidyFinding::new(member.folder.join("Cargo.toml"), 1, message);
    Measure {
        owner: member.name.clone(),
        check: Check::Circle,
        count: circle.len(),
        limit: MAX_MODULES,
        findings: vec![finding],
    }
}

fn imports(workspace: &Workspace, member: &Crate) -> Imports {
    let source = member.folder.join("src");
    let mut modules: Vec<(Vec<String>, String)> = Vec::new();
    let mut exports = BTreeMap::new();
    for file in workspace.sources(member) {
        let Some(path) = file.path.strip_prefix(&source).ok().map(module_path) else { continue };
        let code = without_tests(&code(&file.text));
        if path.is_empty() {
            exports.extend(reexports(file, &code));
        } else {
            modules.push((path, code));
        }
    }
    let names: BTreeSet<String> = modules.iter().filter_map(|(path, _)| path.first().cloned()).collect();
    let mut imports = Imports::new();
    for (path, code) in &modules {
        let Some(module) = path.first() else { continue };
        let imported = imports.entry(module.clone()).or_default();
        for name in crate_names(code, path.len()) {
            let target = if names.contains(&name) { Some(&name) } else { exports.get(&name) };
            imported.extend(target.filter(|target| *target != module).cloned());
        }
    }
    imports
}

/// The modules that lead to a file, given its path under `src`. The root of a library or program
/// has none.
fn module_path(path: &Path) -> Vec<String> {
    let mut path: Vec<String> =
        path.with_extension("").iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if path.last().is_some_and(|last| last == "mod" || last == "lib" || last == "main") {
        path.pop();
    }
    path
}

/// The names that a root file exports from its modules.
fn reexports(file: &TextFile, code: &str) -> Vec<(String, String)> {
    let mut exports = Vec::new();
    for statement in code.split(';') {
        let Some((before, tree)) = statement.split_once("use ") else { continue };
        if file.path.ends_with("lib.rs") && before.trim_end().rsplit('\n').next().is_some_and(is_public) {
            let tree = tree.trim().trim_start_matches("self::").trim_start_matches("crate::");
            if let Some((module, items)) = tree.split_once("::") {
                exports.extend(leaves(items).into_iter().map(|item| (item, module.to_string())));
            }
        }
    }
    exports
}

fn is_public(before: &str) -> bool {
    before.trim_start().starts_with("pub")
}

/// The names that a tree of imports ends in.
fn leaves(tree: &str) -> Vec<String> {
    let leaf = |item: &str| item.rsplit([':', ' ']).next().unwrap_or(item).to_string();
    tree.split([',', '{', '}']).map(str::trim).map(leaf).filter(|leaf| !leaf.is_empty()).collect()
}

/// The names directly under the crate's root that a module uses, `depth` modules below the root.
fn crate_names(code: &str, depth: usize) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (index, _) in code.match_indices("crate::") {
        if !code[..index].ends_with(is_part) {
            names.extend(heads(&code[index + "crate::".len()..]));
        }
    }
    let supers = "super::".repeat(depth);
    for (index, _) in code.match_indices(&supers) {
        let before = &code[..index];
        if !before.ends_with(is_part) && !before.ends_with("super::") {
            names.extend(heads(&code[index + supers.len()..]));
        }
    }
    names
}

const fn is_part(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_' || c == '$'
}

/// The first names of the paths in a tree of imports.
fn heads(tree: &str) -> Vec<String> {
    let head = |text: &str| text.chars().take_while(|&c| is_part(c)).collect::<String>();
    let Some(group) = tree.strip_prefix('{') else { return vec![head(tree)] };
    let (mut depth, mut start, mut found) = (0_usize, 0, Vec::new());
    for (index, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                found.push(head(group[start..index].trim_start()));
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                found.push(head(group[start..index].trim_start()));
                start = index + 1;
            }
            _ => {}
        }
    }
    found
}

/// The largest set of modules that all reach each other.
fn largest_circle(imports: &Imports) -> Vec<&str> {
    let reached: BTreeMap<&str, BTreeSet<&str>> =
        imports.keys().map(|module| (module.as_str(), reach(imports, module))).collect();
    let circle = |module: &str| -> Vec<&str> {
        let meets = |other: &&&str| {
            **other == module || (reached[module].contains(**other) && reached[**other].contains(module))
        };
        reached.keys().filter(meets).copied().collect()
    };
    let mut largest = Vec::new();
    for module in reached.keys() {
        let circle = circle(module);
        if circle.len() > largest.len() {
            largest = circle;
        }
    }
    largest
}

/// The modules that a module imports, directly or over others.
fn reach<'a>(imports: &'a Imports, module: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open = vec![module];
    while let Some(module) = open.pop() {
        for next in imports.get(module).into_iter().flatten() {
            if reached.insert(next.as_str()) {
                open.push(next);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(files: &[(&str, &str)]) -> String {
        let workspace = Workspace::example(files);
        largest_circle(&imports(&workspace, &workspace.crates[0])).join(" ")
    }

    #[test]
    fn modules_that_import_each_other_are_a_circle() {
        let files = [
            ("m/src/lib.rs", "mod a; mod b; mod c; mod d;"),
            ("m/src/a.rs", "use crate::b::B;"),
            ("m/src/b/deep.rs", "use super::super::c::C;"),
            ("m/src/c.rs", "fn f() { super::a::g() }"),
            ("m/src/d.rs", "use crate::{a::A, b::{self, B}};"),
        ];
        assert_eq!(circle(&files), "a b c");
    }

    #[test]
    fn items_that_the_root_exports_count_for_their_module() {
        let files = [
            ("m/src/lib.rs", "mod a;\nmod b;\n\npub use b::{B, deep::{C, D as E}};"),
            ("m/src/a.rs", "use crate::E;"),
            ("m/src/b.rs", "use crate::a::A;"),
        ];
        assert_eq!(circle(&files), "a b");
    }

    #[test]
    fn tests_comments_and_own_parents_make_no_circle() {
        let files = [
            ("m/src/lib.rs", "mod a; mod b;"),
            ("m/src/a.rs", "// crate::b\n#[cfg(test)]\nmod tests {\n use crate::b::B;\n}\n"),
            ("m/src/a/deep.rs", "use super::b::X;"),
            ("m/src/b.rs", "use crate::a::A;"),
        ];
        assert_eq!(circle(&files).split(' ').count(), 1);
    }
}
