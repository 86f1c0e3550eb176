//! Triggers, guards and actions.

use yase::EventMatching;
use yase::expression::{TransitionExpression, parse_transition};
use yase::statechart::{NodeId, NodeKind};

use super::Maker;

impl Maker<'_, '_> {
    pub(crate) fn trigger(&mut self) -> String {
        let prefixed = self.semantics.matching == EventMatching::TokenPrefix;
        let none = if self.is_hasty() { 2 } else { 5 };
        match self.choices.below(15) {
            number if number < none => String::new(),
            0..8 => self.choices.pick(&["e", "f", "g"]).to_owned(),
            8 => "e | g".to_owned(),
            9 => "not e".to_owned(),
            10 => "*".to_owned(),
            11 => "A".to_owned(),
            12 if prefixed => self.choices.pick(&["e.x", "error", "error.execution"]).to_owned(),
            12 => self.choices.pick(&["error.guard", "error.action", "error.activity"]).to_owned(),
            13 if self.semantics.completion_events => format!("done.state.{}", self.some_state()),
            _ => format!("v{}", self.choices.below(4)),
        }
    }

    /// A guard; the transition itself starts its timer, so that it belongs to the same blackboard.
    pub(crate) fn guard(&mut self) -> String {
        let message = self.choices.pick(&["A", "B", "C"]);
        let number = self.choices.below(4);
        match self.choices.below(14) {
            0 | 12 => format!(" [{message}.n < {number}]"),
            1 | 13 => format!(" [{message}.n == {number}]"),
            2 => format!(" [!({message}.n > {number})]"),
            3 => format!(" [{message} == NULL]"),
            4 => format!(" [{message} != NULL && {message}.n != {number}]"),
            5 => " [false]".to_owned(),
            6 => " [true]".to_owned(),
            7 if self.choices.percent(40) => format!(" [{message}.n < fail() || B.n > 0]"),
            8 => self.timed("v"),
            9 => self.timed("TimeoutCheck(v)"),
            10 => self.timed("v && A.n >= 1"),
            _ => format!(" [In({})]", self.some_state()),
        }
    }

    /// A guard that the transition's own effect makes false, so that a chart becomes stable.
    pub(crate) fn passing_guard(&mut self) -> String {
        let message = self.choices.pick(&["A", "B", "C"]);
        let number = self.choices.below(3);
        match self.choices.below(4) {
            0 => self.timed("v"),
            1 => format!(" [{message} != NULL && {message}.n == {number}]"),
            _ => format!(" [{message}.n == {number}] / {message}.n = {message}.n + 1"),
        }
    }

    fn timed(&mut self, form: &str) -> String {
        self.timers += 1;
        let timer = format!("v{}", self.timers % 4);
        let delay = self.choices.pick(&[20, 10, 30]);
        format!(" [{}] / StartTimeout({timer}, {delay}ms)", form.replace('v', &timer))
    }

    pub(crate) fn some_state(&mut self) -> String {
        let named: Vec<NodeId> = self
            .chart
            .nodes()
            .filter(|(_, node)| {
                matches!(node.kind, NodeKind::Basic | NodeKind::Or | NodeKind::And) && node.name != "c"
            })
            .map(|(id, _)| id)
            .collect();
        match named.is_empty() {
            true => "c".to_owned(),
            false => self.chart.node(self.choices.pick(&named)).name.clone(),
        }
    }

    pub(crate) fn slash_actions(&mut self, percent: usize) -> String {
        if self.choices.percent(percent) { format!(" / {}", self.actions()) } else { String::new() }
    }

    pub(crate) fn actions(&mut self) -> String {
        let count = 1 + self.choices.below(2);
        (0..count).map(|_| self.action()).collect::<Vec<_>>().join(", ")
    }

    fn action(&mut self) -> String {
        let message = self.choices.pick(&["A", "B", "C"]);
        match self.choices.below(9) {
            0 => format!("raise({})", self.choices.pick(&["f", "g", "h"])),
            1 => format!("{message}.n = {}", self.choices.below(4)),
            2 => format!("{message}.n = {message}.n + 1"),
            3 => format!("StartTimeout(v{}, {}ms)", self.choices.below(4), self.choices.pick(&[10, 25])),
            4 => "process_messages".to_owned(),
            5 => "publish_all".to_owned(),
            6 => format!("publish.{message}"),
            7 if self.choices.percent(40) => format!("{message}.n = 2000000"),
            8 if self.choices.percent(50) => format!("B.n = {message}.n"),
            _ => format!("{message}.n = 1"),
        }
    }
}

/// Actions before and after the slash.
pub(crate) fn parse(text: &str) -> TransitionExpression {
    let mut parts = text.split(" / ");
    let head = parts.next().unwrap_or_default();
    let actions: Vec<&str> = parts.collect();
    let text = match actions.is_empty() {
        true => head.to_owned(),
        false => format!("{head} / {}", actions.join(", ")),
    };
    let (expression, found) = parse_transition(&text);
    assert!(found.is_empty(), "{text}: {found:?}");
    expression
}
