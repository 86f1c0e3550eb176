//! A line of the log, as text or JSON.

use monas::Timestamp;
use monas::records::foxglove::Log;
use monas_terminal::{CommandFailure, CommandOutput, Format};
use serde_json::json;

use super::Severity;

/// A line with its origin.
pub(crate) struct LogLine<'a> {
    at: Timestamp,
    pub(crate) severity: Severity,
    pub(crate) robot: &'a str,
    pub(crate) agent: &'a str,
    pub(crate) activity: &'a str,
    words: &'a str,
}

impl<'a> LogLine<'a> {
    pub(crate) fn new(robot: &'a str, at: Timestamp, log: &'a Log) -> LogLine<'a> {
        // The name is that of the agent, or `AGENT/ACTIVITY`.
        let (agent, activity) = log.name.split_once('/').unwrap_or((&log.name, ""));
        LogLine { at, severity: Severity::of(log.level()), robot, agent, activity, words: &log.message }
    }

    pub(crate) fn write(
        &self,
        format: Format,
        console: &mut CommandOutput<'_>,
    ) -> Result<(), CommandFailure> {
        let LogLine { at, severity, robot, agent, activity, words } = self;
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
    fn the_author_of_a_line_is_the_agent_with_its_activity() {
        let log = |name: &str| Log { name: name.into(), level: Level::Warning.into(), ..Log::default() };
        for (name, agent, activity) in
            [("", "", ""), ("Goalie", "Goalie", ""), ("Goalie/Dive", "Goalie", "Dive")]
        {
            let log = log(name);
            let line = LogLine::new("blue-1", Timestamp::ZERO, &log);
            assert_eq!((line.agent, line.activity, line.severity), (agent, activity, Severity::Warning));
        }
    }
}
