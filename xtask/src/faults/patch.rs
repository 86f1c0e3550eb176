//! A fault as a file: prose, `Rule:`, one `Caught by:` for each test, and unified diffs.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;

/// A fault that can be injected into the sources.
pub(crate) struct Fault {
    pub(crate) name: String,
    /// The rule that it violates.
    pub(crate) rule: String,
    /// The tests that detect it.
    pub(crate) tests: Vec<FaultTest>,
    /// The file of each diff, and the diff.
    pub(crate) diffs: Vec<(String, String)>,
}

/// A test that detects a fault.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct FaultTest {
    /// The arguments of cargo that select its program, such as `-p yase --test rules`.
    pub(crate) program: String,
    /// Its full name in the program.
    pub(crate) name: String,
}

/// All faults of a folder, sorted by name.
pub(crate) fn read(folder: &Path) -> Result<Vec<Fault>, Box<dyn Error>> {
    let mut faults = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "patch") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            faults.push(parse(name, &fs::read_to_string(&path)?)?);
        }
    }
    faults.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(faults)
}

fn parse(name: String, text: &str) -> Result<Fault, String> {
    let mut fault = Fault { name, rule: String::new(), tests: Vec::new(), diffs: Vec::new() };
    for line in text.split_inclusive('\n') {
        if let Some(file) = line.strip_prefix("--- a/") {
            fault.diffs.push((file.trim().to_owned(), line.to_owned()));
        } else if let Some((_, diff)) = fault.diffs.last_mut() {
            diff.push_str(line);
        } else if let Some(rule) = line.strip_prefix("Rule: ") {
            fault.rule = rule.trim().to_owned();
        } else if let Some(test) = line.strip_prefix("Caught by: ") {
            let test = test.trim().rsplit_once(' ');
            let (program, name) =
                test.ok_or_else(|| format!("{}: a test is its program and its name", fault.name))?;
            fault.tests.push(FaultTest { program: program.to_owned(), name: name.to_owned() });
        }
    }
    let missing = [
        ("a rule", fault.rule.is_empty()),
        ("tests", fault.tests.is_empty()),
        ("a diff", fault.diffs.is_empty()),
    ];
    match missing.iter().find(|(_, is_missing)| *is_missing) {
        Some((what, _)) => Err(format!("{}: it names no {}", fault.name, what.trim_start_matches("a "))),
        None => Ok(fault),
    }
}

/// The files that the diffs of a fault change, with the fault applied.
pub(crate) fn apply(
    name: &str,
    diffs: &[(String, String)],
    read: impl Fn(&str) -> Result<String, Box<dyn Error>>,
) -> Result<BTreeMap<String, String>, Box<dyn Error>> {
    let mut files = BTreeMap::new();
    for (file, diff) in diffs {
        let sound = read(file).map_err(|error| format!("{name}: {file}: {error}"))?;
        let patch = diffy::Patch::from_str(diff).map_err(|error| format!("{name}: {error}"))?;
        let broken = diffy::apply(&sound, &patch)
            .map_err(|error| format!("{name} does not fit {file} any more: {error}"))?;
        files.insert(file.clone(), broken);
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "Prose.\n\nRule: R1\nCaught by: -p yase --test rules a::b\n\n--- a/x.rs\n+++ b/x.rs\n@@ -1,2 +1,2 @@\n one\n-two\n+three\n";

    #[test]
    fn a_patch_has_a_header_and_diffs() {
        let fault = parse("f".into(), TEXT).unwrap();
        assert_eq!(fault.rule, "R1");
        assert_eq!(
            (fault.tests[0].program.as_str(), fault.tests[0].name.as_str()),
            ("-p yase --test rules", "a::b")
        );
        let files = apply("f", &fault.diffs, |_| Ok("one\ntwo\n".into())).unwrap();
        assert_eq!(files["x.rs"], "one\nthree\n");
    }

    #[test]
    fn mismatched_or_incomplete_input_is_rejected() {
        let fault = parse("f".into(), TEXT).unwrap();
        assert!(apply("f", &fault.diffs, |_| Ok("one\n2\n".into())).is_err());
        assert!(parse("f".into(), &TEXT.replace("Rule", "Role")).is_err());
        assert!(parse("f".into(), &TEXT.replace("Caught", "Seen")).is_err());
        assert!(parse("f".into(), "Rule: R1\nCaught by: -p yase a\n").is_err());
    }
}
