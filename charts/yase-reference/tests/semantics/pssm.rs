//! The semantics `uml` on machines of the kind that the suite of PSSM 1.0 (OMG formal/2019-05-01,
//! clause 9) describes: each is built after the description of the test whose name it bears, and
//! what it does must be one of the traces that the suite admits.
//!
//! An action writes one word into the trace: `n` and the number of a state for its entry, `x` for
//! its exit, `t` and the number of a transition for its effect, `d` for the start of an activity.

mod borders;
mod deferral;
mod events;
mod states;
mod transitions;

use yase::Semantics;

/// Plays a script on a chart under `uml`, and checks that the trace is one of those admitted, each
/// written on a line of its own.
#[track_caller]
fn admits(chart: &str, script: &str, admitted: &str) {
    let log = yase_reference::script::play_with(&yase_reference::chart(chart), script, Semantics::uml());
    let found = words(&log).join(" ");
    let admitted: Vec<&str> = admitted.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    assert!(
        admitted.contains(&found.as_str()),
        "found\n{found}\n\nadmitted\n{}\n\n{}",
        admitted.join("\n"),
        log.join("\n")
    );
}

/// The words that actions raise and activities stand for, in order.
fn words(log: &[String]) -> Vec<String> {
    let mut words = Vec::new();
    for line in log.iter().map(|line| line.trim()) {
        if let Some(state) = line.strip_prefix("start ") {
            words.push(format!("d{}", state.trim_start_matches(|letter: char| !letter.is_ascii_digit())));
        }
        let raised = line.split("raise(").skip(1).filter_map(|rest| rest.split_once(')'));
        words.extend(raised.map(|(word, _)| word.to_owned()));
    }
    words
}
