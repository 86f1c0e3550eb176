//! Code outside of `robots/` does not depend on the kind of a body: no branch on its name, no
//! `cfg`.

use super::TidyFinding;
use super::source::{code, without_tests};
use super::workspace::Workspace;

/// The folder of bodies, and those of tests and of this check, which name kinds.
const EXEMPT_FOLDERS: [&str; 3] = ["robots", "tests", "xtask"];

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    let kinds = kinds(workspace);
    let mut findings = Vec::new();
    for file in workspace.files.iter().filter(|file| {
        let is_code = file.path.extension().is_some_and(|ending| ending == "rs");
        is_code
            && !EXEMPT_FOLDERS.iter().any(|folder| file.path.starts_with(folder))
            && !file.path.components().any(|part| part.as_os_str() == "tests")
    }) {
        let code = without_tests(&code(&file.text));
        for (index, (line, blanked)) in file.text.lines().zip(code.lines()).enumerate() {
            // A literal is blanked out in the code, except for its quotes, which stay in a test's
            // item only if the line is code.
            let is_code = !blanked.trim().is_empty();
            for kind in kinds.iter().filter(|kind| is_code && line.contains(&format!("\"{kind}\""))) {
                let message = format!("`{kind}` is a kind of body: only crates under robots/ name it");
                findings.push(TidyFinding::new(&file.path, index + 1, message));
            }
        }
    }
    findings
}

/// The names of the kinds that crates under `robots/` register.
fn kinds(workspace: &Workspace) -> Vec<String> {
    let mut kinds = Vec::new();
    for file in workspace.files.iter().filter(|file| file.path.starts_with("robots")) {
        for (start, _) in file.text.match_indices("body_kind!(BodyKind {") {
            let name = file.text[start..].split_once("name: \"").and_then(|(_, rest)| rest.split_once('"'));
            kinds.extend(name.map(|(name, _)| name.to_owned()));
        }
    }
    kinds
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAO: (&str, &str) =
        ("robots/nao/src/lib.rs", "monas_robot::body_kind!(BodyKind {\n    name: \"nao\",\n});");

    fn findings(path: &str, text: &str) -> Vec<String> {
        let workspace = Workspace::example(&[NAO, (path, text)]);
        check(&workspace).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_branch_and_a_cfg_on_a_kind_are_found() {
        let found =
            findings("soccer/monas-match/src/plan.rs", "fn f(kind: &str) {\n    if kind == \"nao\" {}\n}");
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with("soccer/monas-match/src/plan.rs:2: `nao` is a kind of body"));
        assert_eq!(findings("cli/a/src/lib.rs", "#[cfg(feature = \"nao\")]\nmod nao;").len(), 1);
    }

    #[test]
    fn bodies_comments_and_tests_may_name_it() {
        assert_eq!(findings("robots/other/src/lib.rs", "const OTHER: &str = \"nao\";"), [""; 0]);
        assert_eq!(findings("cli/a/src/lib.rs", "// a \"nao\" walks"), [""; 0]);
        let tests = "#[cfg(test)]\nmod tests {\n    const KIND: &str = \"nao\";\n}";
        assert_eq!(findings("cli/a/src/lib.rs", tests), [""; 0]);
    }
}
