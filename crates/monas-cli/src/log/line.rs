//! A line of the log, as it is shown.

use monas::Moment;
use monas::records::foxglove::Log;
use serde_json::json;

use super::Severity;
use crate::arguments::Format;
use crate::console::Console;
use crate::failure::Failure;

/// A line with who wrote it.
pub(super) struct Line<'a> {
    at: Moment,
    pub(super) severity: Severity,
    pub(super) robot: &'a str,
    pub(super) agent: &'a str,
    pub(super) activity: &'a str,
    words: &'a str,
}

impl<'a> Line<'a> {
    pub(super) fn new(robot: &'a str, at: Moment, log: &'a Log) -> Line<'a> {
        // Whoever wrote it is the agent, or the agent and its activity.
        let (agent, activity) = log.name.split_once('/').unwrap_or((&log.name, ""));
        Line { at, severity: Severity::of(log.level()), robot, agent, activity, words: &log.message }
    }

    pub(super) fn write(&self, format: Format, console: &mut Console<'_>) -> Result<(), Failure> {
        let Line { at, severity, robot, agent, activity, words } = self;
        let seconds = at.as_secs_f64();
        match format {
            Format::Json => {
                let object = json!({"seconds": seconds, "level": severity.word(), "robot": robot, "agent": agent,
                    "activity": activity, "message": words});
                writeln!(console.out, "{object}")?;
            }
            Format::Text => {
                let names = [*robot, *agent, *activity].map(str::to_owned);
                let who: Vec<String> = names.into_iter().filter(|name| !name.is_empty()).collect();
                writeln!(console.out, "{seconds:.3} s {} {}: {words}", severity.word(), who.join(" "))?;
            }
        }
        console.out.flush()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use monas::records::foxglove::log::Level;

    use super::*;

    #[test]
    fn who_wrote_a_line_is_the_agent_or_the_agent_and_its_activity() {
        let log = |name: &str| Log { name: name.into(), level: Level::Warning.into(), ..Log::default() };
        for (name, agent, activity) in
            [("", "", ""), ("Goalie", "Goalie", ""), ("Goalie/Dive", "Goalie", "Dive")]
        {
            let log = log(name);
            let line = Line::new("blue-1", Moment::ZERO, &log);
            assert_eq!((line.agent, line.activity, line.severity), (agent, activity, Severity::Warning));
        }
    }
}
