//! Changes of a run: the request, and its outcome as text or JSON.

use monas::records::{Change, Changed, Finding, Inquiry};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format};
use serde_json::json;

use super::request::{request, unexpected_reply};
use super::run_selector::RunSelector;

/// Requests a change, and returns its outcome.
pub(crate) fn request_change(change: Change, run: &RunSelector) -> Result<Changed, CommandFailure> {
    let number = std::process::id().into();
    let inquiry = Inquiry { change: Some(Change { number, ..change }), ..Inquiry::default() };
    request(inquiry, run)?.changed.ok_or_else(|| unexpected_reply(run))
}

/// Prints the outcome of a change; `sentence` describes a successful one.
pub(crate) fn print_outcome(
    changed: &Changed,
    sentence: &str,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match format {
        Format::Json => {
            let findings: Vec<_> = changed.findings.iter().map(object).collect();
            let action = changed.action().as_str_name().to_lowercase();
            let object = json!({"done": changed.done, "action": action, "agent": changed.agent, "cycle": changed.cycle,
                "findings": findings});
            writeln!(console.out, "{object}")?;
        }
        Format::Text => {
            let messages: Vec<&str> =
                changed.findings.iter().map(|finding| finding.message.as_str()).collect();
            let brief = yase::migrate::brief_lines(&messages);
            for (finding, message) in changed.findings.iter().zip(&brief) {
                writeln!(console.err, "{}", line(finding, message))?;
            }
            if changed.done {
                writeln!(console.out, "{sentence}")?;
            }
        }
    }
    Ok(match changed.done {
        true => Exit::Success,
        // A finding with a line is an error in a file; others are refused requests.
        false if changed.findings.iter().any(|finding| finding.line > 0) => Exit::Invalid,
        false => Exit::Failure,
    })
}

fn line(finding: &Finding, message: &str) -> String {
    let Finding { code, hint, file, line, column, .. } = finding;
    let position = match (file.is_empty(), line) {
        (true, _) => String::new(),
        (false, 0) => format!("{file}: "),
        (false, line) => format!("{file}:{line}:{column}: "),
    };
    let kind = match (finding.is_error, code.is_empty()) {
        (true, _) => format!("error[{code}]: "),
        (false, false) => format!("warning[{code}]: "),
        (false, true) => String::new(),
    };
    let hint = if hint.is_empty() { String::new() } else { format!("\n  help: {hint}") };
    format!("{position}{kind}{message}{hint}")
}

fn object(finding: &Finding) -> serde_json::Value {
    json!({"code": finding.code, "severity": if finding.is_error { "error" } else { "information" },
        "message": finding.message, "hint": finding.hint, "file": finding.file, "line": finding.line,
        "column": finding.column})
}
