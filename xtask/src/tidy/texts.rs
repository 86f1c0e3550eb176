//! Text that no file may contain: unfinished code, ignored tests, paths of one machine, stray
//! blanks.

use super::TidyFinding;
use super::source::code;
use super::workspace::{TextFile, Workspace};

/// Never in Rust code.
const BANNED_IN_CODE: [(&str, &str); 6] = [
    ("todo!", "finish it or leave it out"),
    ("unimplemented!", "finish it or leave it out"),
    ("dbg!", "a trace of debugging"),
    ("#[ignore", "a test that is passed over proves nothing; make it an xtask"),
    ("#![allow(missing_docs", "every public item is documented"),
    ("thread::sleep", "tests and libraries use simulated time"),
];

/// The files that may wait for the wall clock.
const MAY_SLEEP: [&str; 4] = [
    "runtime/monas-runtime/src",
    "cli/monas-terminal/src/wall_clock.rs",
    // a signal handler, until the recording is written
    "cli/monas-cli/src/crash_report.rs",
    // a simulation in another process
    "robots/rcsssmj/src/connection.rs",
];

/// Never in any file. Split in two, so that this file does not contain them.
const BANNED_ANYWHERE: [((&str, &str), &str); 5] = [
    (("/wor", "k/"), "a path of one machine"),
    (("/hom", "e/"), "a path of one machine"),
    (("/roo", "t/"), "a path of one machine"),
    (("FIX", "ME"), "fix it"),
    (("TO", "DO"), "do it or leave it out"),
];

/// Greatest length of a file, in lines of code.
const MAX_LINES: usize = 700;

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    workspace.files.iter().flat_map(check_file).collect()
}

fn check_file(file: &TextFile) -> Vec<TidyFinding> {
    let mut findings = Vec::new();
    for (index, line) in file.text.lines().enumerate() {
        findings.extend(line_faults(line).map(|fault| TidyFinding::new(&file.path, index + 1, fault)));
    }
    if !file.text.is_empty() && !file.text.ends_with('\n') {
        findings.push(TidyFinding::new(&file.path, file.text.lines().count(), "the last line does not end"));
    }
    if file.is_rust() {
        findings.extend(code_faults(file));
    }
    findings
}

fn line_faults(line: &str) -> impl Iterator<Item = String> {
    let blanks = [
        (line.contains('\t'), "a tab: indent with blanks"),
        (line.ends_with(' '), "blanks at the end of the line"),
        (line.ends_with('\r'), "a carriage return at the end of the line"),
    ];
    let blanks = blanks.into_iter().filter(|(found, _)| *found).map(|(_, fault)| fault.to_string());
    let named = BANNED_ANYWHERE.iter().map(|((first, second), why)| (format!("{first}{second}"), why));
    blanks.chain(named.filter(|(text, _)| line.contains(text)).map(|(text, why)| format!("`{text}`: {why}")))
}

fn code_faults(file: &TextFile) -> Vec<TidyFinding> {
    let code = code(&file.text);
    let mut findings = Vec::new();
    for (index, line) in code.lines().enumerate() {
        let faults = BANNED_IN_CODE.iter().filter(|(text, _)| line.contains(text) && !may(file, text));
        findings.extend(
            faults.map(|(text, why)| TidyFinding::new(&file.path, index + 1, format!("`{text}`: {why}"))),
        );
    }
    let length = code.lines().filter(|line| !line.trim().is_empty()).count();
    if length > MAX_LINES {
        let message = format!("{length} lines of code: at {MAX_LINES} a file holds more than one idea");
        findings.push(TidyFinding::new(&file.path, 1, message));
    }
    findings
}

fn may(file: &TextFile, text: &str) -> bool {
    text == "thread::sleep"
        && file.path.to_str().is_some_and(|path| MAY_SLEEP.iter().any(|may| path.starts_with(may)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn findings(path: &str, text: &str) -> Vec<String> {
        check_file(&TextFile { path: path.into(), text: text.into() })
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    #[test]
    fn a_clean_file_has_none() {
        assert!(
            findings("a.rs", "//! todo! in a comment is a word\nfn a() -> &'static str {\n    \"dbg!\"\n}\n")
                .is_empty()
        );
    }

    #[test]
    fn unfinished_code_is_found() {
        let text = "fn a() {\n    todo!()\n}\n\n#[test]\n#[ignore = \"slow\"]\nfn b() {}\n";
        let found = findings("a.rs", text);
        assert_eq!(found[0], "a.rs:2: `todo!`: finish it or leave it out");
        assert!(found[1].starts_with("a.rs:6: `#[ignore`"));
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn stray_blanks_are_found_in_any_text() {
        let found = findings("a.md", "one \n\ttwo\nthree");
        assert_eq!(
            found,
            [
                "a.md:1: blanks at the end of the line",
                "a.md:2: a tab: indent with blanks",
                "a.md:3: the last line does not end"
            ]
        );
    }

    #[test]
    fn paths_of_one_machine_are_found() {
        let path = ["/hom", "e/someone/monas"].concat();
        assert!(findings("a.md", &format!("see {path}\n"))[0].contains("a path of one machine"));
    }

    #[test]
    fn sleeping_is_for_the_clock_only() {
        let text = "fn a() { std::thread::sleep(b) }\n";
        assert_eq!(findings("charts/yase/tests/a.rs", text).len(), 1);
        assert!(findings("runtime/monas-runtime/src/clock.rs", text).is_empty());
    }

    #[test]
    fn long_files_are_found() {
        assert!(findings("a.rs", &"fn a() {}\n".repeat(MAX_LINES)).is_empty());
        assert_eq!(findings("a.rs", &"fn a() {}\n".repeat(MAX_LINES + 1)).len(), 1);
        assert!(findings("a.rs", &"// prose\n\n".repeat(MAX_LINES)).is_empty());
    }
}
