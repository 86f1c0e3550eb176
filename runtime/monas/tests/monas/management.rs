//! Agents that are changed while they run.

mod charts;
mod many;
mod of_one_chart;
mod panics;
mod real_time;
mod replayed;
mod saved;
mod simulated;
mod watched;

use monas::records::{Action, Change, Changed, Setting};
use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Registry};

/// A change of an agent.
pub(crate) fn change(action: Action, agent: &str) -> Change {
    Change { action: action.into(), agent: agent.into(), ..Change::default() }
}

fn settings(given: &[(&str, &str)]) -> Vec<Setting> {
    given.iter().map(|(key, value)| Setting { key: (*key).into(), value: (*value).into() }).collect()
}

/// Asserts that a change was applied.
pub(crate) fn made(changed: &Changed) {
    assert!(changed.done, "{:?}", changed.findings);
}

/// The code and text of the only reason of a rejection.
fn refused(changed: &Changed) -> (String, String) {
    assert!(!changed.done, "it was made");
    assert_eq!(changed.findings.len(), 1, "{:?}", changed.findings);
    let finding = &changed.findings[0];
    let hint = if finding.hint.is_empty() { String::new() } else { format!("; {}", finding.hint) };
    (finding.code.clone(), format!("{}{hint}", finding.message))
}

/// An activity that records its calls: `A` for a call, `A start`, `A stop`, `A 0.5` for its
/// parameter.
struct ReportingActivity<N> {
    name: &'static str,
    note: N,
}

impl<N: Fn(String) + Send> Activity for ReportingActivity<N> {
    fn configure(&mut self, parameters: &Parameters) {
        if let Some(speed) = parameters.number("speed") {
            (self.note)(format!("{} {speed}", self.name));
        }
    }

    fn start(&mut self, _: &mut Blackboard) -> Result<(), BoxError> {
        (self.note)(format!("{} start", self.name));
        Ok(())
    }

    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        (self.note)(self.name.into());
        Ok(Progress::Done)
    }

    fn stop(&mut self, _: &mut Blackboard) {
        (self.note)(format!("{} stop", self.name));
    }
}

/// Activities that record their calls.
fn reporting(names: &[&'static str], note: impl Fn(String) + Clone + Send + Sync + 'static) -> Registry {
    names.iter().copied().fold(Registry::empty(), |registry, name| {
        let note = note.clone();
        registry.with(name, move || ReportingActivity { name, note: note.clone() })
    })
}
