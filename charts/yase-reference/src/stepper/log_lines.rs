//! Log line of a micro-step: R23.

use yase::statechart::{NodeId, StateNames, TransitionId};

use super::{Failure, Line, StaticPath, Stepper, topic};
use crate::test_host::TestHost;

/// The part of a line that is known when the micro-step begins.
#[derive(Default)]
pub(crate) struct Heading<'a> {
    pub event: Option<&'a str>,
    pub fired: &'a [StaticPath],
    pub preempted: &'a [StaticPath],
    pub held: &'a [StaticPath],
    pub deferring: Option<NodeId>,
}

impl Stepper<'_> {
    fn names(&self, nodes: &[NodeId]) -> String {
        nodes.iter().map(|&node| self.name(node)).collect::<Vec<_>>().join(", ")
    }

    fn path_names(&self, paths: &[StaticPath]) -> String {
        paths.iter().map(|path| self.chain(&path.segments)).collect::<Vec<_>>().join(", ")
    }

    /// `a -> CONDITION -> b`, with ` + ` before a segment that does not continue the previous one.
    fn chain(&self, segments: &[TransitionId]) -> String {
        let mut text = String::new();
        let mut at = None;
        for &id in segments {
            let transition = self.chart.transition(id);
            if at != Some(transition.source) {
                let plus = if text.is_empty() { "" } else { " + " };
                text += &format!("{plus}{}", self.name(transition.source));
            }
            text += &format!(" -> {}", self.name(transition.target));
            at = Some(transition.target);
        }
        text
    }

    fn event_name(&self, event: &str) -> String {
        match topic(event) {
            Some(_) => event.to_lowercase(), // messages are named by their topic
            None => self.known_name(event).unwrap_or_else(|| "?".to_owned()),
        }
    }

    pub(crate) fn print(&mut self, heading: &Heading<'_>, host: &mut TestHost) {
        let idle = heading.held.is_empty() && heading.deferring.is_none();
        let selected = match (heading.fired.is_empty(), heading.event.is_some() && idle) {
            (false, _) => self.path_names(heading.fired),
            (true, true) => "dropped".to_owned(),
            (true, false) => "nothing".to_owned(),
        };
        let event = heading.event.map_or("-".to_owned(), |event| self.event_name(event));
        let mut text = format!("{} {event}: {selected}", self.now);
        let parts = [
            ("preempt", self.path_names(heading.preempted)),
            ("hold", self.path_names(heading.held)),
            ("defer in", heading.deferring.map(|node| self.name(node)).unwrap_or_default()),
        ];
        for (title, part) in parts {
            add(&mut text, title, &part);
        }
        self.finish_line(text, host);
    }

    pub(crate) fn print_start(&mut self, host: &mut TestHost) {
        self.finish_line(format!("{} start", self.now), host);
    }

    pub(crate) fn print_finish(&mut self, host: &mut TestHost) {
        self.finish_line(format!("{} finish", self.now), host);
    }

    fn finish_line(&mut self, mut text: String, host: &mut TestHost) {
        let line = std::mem::take(&mut self.line);
        add(&mut text, "exit", &self.names(&line.exits));
        add(&mut text, "then", &self.chain(&line.taken));
        add(&mut text, "do", &line.effects.join(", "));
        add(&mut text, "enter", &self.names(&line.entries));
        add(&mut text, "read", &self.reads(&line));
        host.say(text);
    }

    fn reads(&self, line: &Line) -> String {
        let one = |&(id, value): &(TransitionId, Option<bool>)| {
            let value = value.map_or("error".to_owned(), |value| value.to_string());
            let transition = self.chart.transition(id);
            format!("{} -> {} = {value}", self.name(transition.source), self.name(transition.target))
        };
        line.reads.iter().map(one).collect::<Vec<_>>().join(", ")
    }

    pub(crate) fn describe(&self, failure: &Failure) -> String {
        match failure {
            Failure::NoBranch(choice) => {
                let names = StateNames::of(self.chart);
                format!("no outgoing transition of CHOICE `{}` is enabled", names.name(*choice))
            }
            Failure::Endless => "endless".to_owned(),
        }
    }
}

fn add(text: &mut String, title: &str, part: &str) {
    if !part.is_empty() {
        *text += &format!("; {title} {part}");
    }
}
