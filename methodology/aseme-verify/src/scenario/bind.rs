//! Resolution of the names in a scenario, in a chart and among the program's symbols.

use std::time::Duration;

use yase::diagnostic::{Suggestions, nearest};
use yase::expression::{
    Action, ActionKind, Effect, EventInterner, Guard, Name, NameScope, Origin, Path, ScriptInterner,
    TextPosition, compile_actions, parse_actions_at, parse_transition_at,
};
use yase::{CompiledChart, Diagnostic, NodeId, Outcome, Span, TopicId, TypeEnvironment};

use super::{
    Expectation, ExpectationKind, ExpectedTimer, ScenarioPart, ScenarioStep, ScenarioText, StepLines,
    StepStimulus, TimerReference,
};
use crate::properties::names;
use aseme::srm::duration;
use aseme::text;

/// The hint for an unknown stimulus.
const STIMULUS_FORMS: &str = "a step is `start`, `messages`, `event NAME`, `return STATE`, `ongoing STATE`, `fail STATE`, `wait 100ms` or `timer NAME`";

type BindResult<T> = Result<T, Vec<Diagnostic>>;

impl ScenarioText {
    /// Resolves the names of a scenario.
    ///
    /// # Errors
    /// Invalid lines (E0890), states and events that the chart does not have (E0845, E0846), states
    /// without an activity that return (E0893), actions that are not messages (E0894), timers
    /// (E0895), durations (E0896), and invalid values and conditions.
    pub fn bind(
        &self,
        chart: &CompiledChart,
        vocabulary: &TypeEnvironment,
    ) -> Result<Vec<ScenarioStep>, Vec<Diagnostic>> {
        let blanked = text::without_comments(&self.source.text);
        let binder = ScenarioBinder {
            script: self,
            blanked: &blanked,
            chart,
            vocabulary,
            suggestions: Suggestions::default(),
        };
        let (mut steps, mut found) = (Vec::new(), Vec::new());
        for lines in &self.steps {
            match binder.step(lines) {
                Ok(step) => steps.push(step),
                Err(wrong) => found.extend(wrong),
            }
        }
        match found.is_empty() {
            true => Ok(steps),
            false => Err(found.into_iter().map(|wrong| wrong.in_source(&self.source)).collect()),
        }
    }
}

struct ScenarioBinder<'a> {
    script: &'a ScenarioText,
    blanked: &'a str,
    chart: &'a CompiledChart,
    vocabulary: &'a TypeEnvironment,
    suggestions: Suggestions,
}

/// The parsed content of an indented line.
enum StepDetail {
    Data(Vec<Effect>),
    Expected(ExpectationKind),
}

impl ScenarioBinder<'_> {
    fn step(&self, lines: &StepLines) -> BindResult<ScenarioStep> {
        let mut found = Vec::new();
        let mut cause = self.cause(lines.cause).map_err(|wrong| found.push(wrong));
        let (mut data, mut expected) = (Vec::new(), Vec::new());
        if let Some(topic) = cause.as_ref().ok().and_then(|cause| self.own_message(cause)) {
            data.push((Effect::Publish { topic }, self.passage(lines.cause)));
            cause = Ok(StepStimulus::Messages);
        }
        for &span in &lines.details {
            let passage = self.passage(span);
            match self.detail(span) {
                Ok(StepDetail::Data(effects)) => {
                    data.extend(effects.into_iter().map(|effect| (effect, passage.clone())));
                }
                Ok(StepDetail::Expected(kind)) => expected.push(Expectation { passage, kind }),
                Err(wrong) => found.extend(wrong),
            }
        }
        match cause {
            Ok(cause) if found.is_empty() => {
                Ok(ScenarioStep { passage: self.passage(lines.cause), cause, data, expected })
            }
            _ => Err(found),
        }
    }

    fn passage(&self, span: Span) -> ScenarioPart {
        ScenarioPart { source: self.script.source.clone(), span }
    }

    fn text(&self, span: Span) -> &str {
        &self.blanked[span.start..span.end]
    }

    /// The first word of a line and the remaining text.
    fn split(&self, span: Span) -> (&str, Span) {
        let text = self.text(span);
        let end = text.find(char::is_whitespace).unwrap_or(text.len());
        (&text[..end], text::trimmed(self.blanked, Span::new(span.start + end, span.end)))
    }

    fn cause(&self, span: Span) -> Result<StepStimulus, Diagnostic> {
        let (word, rest) = self.split(span);
        let is_alone = rest.start == rest.end;
        match (word, is_alone) {
            ("start", true) => Ok(StepStimulus::Start),
            ("messages", true) => Ok(StepStimulus::Messages),
            ("event", false) => {
                names::event(&self.name(rest), self.chart, self.vocabulary).map(StepStimulus::Event)
            }
            ("return", false) => Ok(StepStimulus::Return(self.actor(rest)?, Outcome::Done)),
            ("ongoing", false) => Ok(StepStimulus::Return(self.actor(rest)?, Outcome::Ongoing)),
            ("fail", false) => Ok(StepStimulus::Return(self.actor(rest)?, Outcome::Failed)),
            ("wait", false) => self.duration(rest).map(StepStimulus::Wait),
            ("timer", false) => self.timer(rest).map(StepStimulus::Timer),
            _ => {
                let message = format!("`{}` is not a step", self.text(span));
                Err(Diagnostic::error("E0890", span, message).with_hint(STIMULUS_FORMS))
            }
        }
    }

    /// The topic of the own host whose message the event of a step stands for.
    fn own_message(&self, cause: &StepStimulus) -> Option<TopicId> {
        let StepStimulus::Event(event) = cause else { return None };
        let events = self.chart.events();
        events.topic(*event).filter(|_| events.host(*event).is_none())
    }

    fn detail(&self, span: Span) -> BindResult<StepDetail> {
        let expected = |kind| Ok(StepDetail::Expected(kind));
        let (word, rest) = self.split(span);
        match word {
            "in" => expected(ExpectationKind::In(self.states(rest)?)),
            "not" if self.split(rest).0 == "in" => {
                expected(ExpectationKind::NotIn(self.states(self.split(rest).1)?))
            }
            "starts" => expected(ExpectationKind::Starts(self.actors(rest)?)),
            "publishes" => expected(ExpectationKind::Publishes(self.topics(rest)?)),
            "timer" => expected(self.timer_left(rest).map_err(|wrong| vec![wrong])?),
            _ if word.starts_with('[') => expected(ExpectationKind::Holds(self.condition(span)?)),
            _ => self.data(span).map(StepDetail::Data),
        }
    }

    fn name(&self, span: Span) -> Name {
        Name { text: self.text(span).to_owned(), position: TextPosition(span) }
    }

    /// The parts between commas; there is at least one.
    fn list(&self, span: Span) -> Vec<Span> {
        let (mut parts, mut start) = (Vec::new(), span.start);
        for part in self.text(span).split(',') {
            parts.push(text::trimmed(self.blanked, Span::new(start, start + part.len())));
            start += part.len() + 1;
        }
        parts
    }

    fn states(&self, span: Span) -> BindResult<Vec<NodeId>> {
        all(self.list(span).into_iter().map(|part| names::state(&self.name(part), self.chart)))
    }

    /// A state with an activity.
    fn actor(&self, span: Span) -> Result<NodeId, Diagnostic> {
        let node = names::state(&self.name(span), self.chart)?;
        match self.chart.activity(node) {
            Some(_) => Ok(node),
            None => {
                let message = format!("the state `{}` has no activity", self.text(span));
                Err(Diagnostic::error("E0893", span, message)
                    .with_hint("only a state without children has an activity"))
            }
        }
    }

    fn actors(&self, span: Span) -> BindResult<Vec<NodeId>> {
        if self.text(span) == "nothing" {
            return Ok(Vec::new());
        }
        all(self.list(span).into_iter().map(|part| self.actor(part)))
    }

    fn topics(&self, span: Span) -> BindResult<Vec<TopicId>> {
        if self.text(span) == "nothing" {
            return Ok(Vec::new());
        }
        let publish = |part: Span| {
            let (mut start, mut is_quoted) = (part.start, false);
            // the path of a topic in backquotes is one segment
            let ends_segment = |letter: char| {
                is_quoted ^= letter == '`';
                letter == '.' && !is_quoted
            };
            let segments = self.text(part).split(ends_segment).map(|segment| {
                let span = Span::new(start, start + segment.len());
                start = span.end + 1;
                Name { text: segment.trim_matches('`').to_owned(), position: TextPosition(span) }
            });
            let path = Path { segments: segments.collect(), position: TextPosition(part) };
            Action { kind: ActionKind::Publish(path), position: TextPosition(part) }
        };
        let actions: Vec<Action> = self.list(span).into_iter().map(publish).collect();
        let topic = |effect: &Effect| match effect {
            Effect::Publish { topic } => Some(*topic),
            _ => None,
        };
        Ok(self.compiled(&actions)?.iter().filter_map(topic).collect())
    }

    /// Messages that arrive.
    fn data(&self, span: Span) -> BindResult<Vec<Effect>> {
        let (actions, wrong) = parse_actions_at(self.text(span), span.start);
        if wrong.iter().any(Diagnostic::is_error) {
            return Err(wrong);
        }
        let is_data =
            |action: &&Action| !matches!(action.kind, ActionKind::Assign { .. } | ActionKind::Publish(_));
        if let Some(action) = actions.iter().find(is_data) {
            let wrong = Diagnostic::error("E0894", action.position.0, format!("`{action}` is not a message"));
            return Err(vec![
                wrong.with_hint("write messages as `Message.field = value` or `publish.Message`"),
            ]);
        }
        self.compiled(&actions).map(Vec::from)
    }

    fn compiled(&self, actions: &[Action]) -> BindResult<Box<[Effect]>> {
        compile_actions(actions, &mut self.names(&mut EventInterner::new(), &mut ScriptInterner::new()))
    }

    fn names<'n>(&'n self, events: &'n mut EventInterner, scripts: &'n mut ScriptInterner) -> NameScope<'n> {
        NameScope {
            vocabulary: self.vocabulary,
            constants: &self.chart.statechart().constants,
            timers: &[],
            events,
            scripts,
            states: &|_| None,
            suggestions: &self.suggestions,
        }
    }

    /// `[condition]`
    fn condition(&self, span: Span) -> BindResult<Guard> {
        let (expression, wrong) = parse_transition_at(self.text(span), span.start);
        if wrong.iter().any(Diagnostic::is_error) {
            return Err(wrong);
        }
        if !expression.actions.is_empty() {
            let wrong = Diagnostic::error("E0890", span, "unexpected text after the condition");
            return Err(vec![wrong.with_hint("an expectation is one condition in brackets")]);
        }
        let (mut events, mut scripts) = (EventInterner::new(), ScriptInterner::new());
        let compiled = expression.compile(&mut self.names(&mut events, &mut scripts))?;
        let none = || vec![Diagnostic::error("E0890", span, "the brackets are empty")];
        let guard = compiled.guard.ok_or_else(none)?;
        match guard.sources().iter().all(|source| source.origin == Origin::Own) {
            true => Ok(guard),
            false => {
                let wrong =
                    Diagnostic::error("E0894", span, "it reads the message of a specific host or activity");
                Err(vec![
                    wrong.with_hint(
                        "in a scenario only the chart publishes: remove the prefix of the message",
                    ),
                ])
            }
        }
    }

    fn duration(&self, span: Span) -> Result<Duration, Diagnostic> {
        duration(self.text(span)).ok_or_else(|| {
            let message = format!("`{}` is not a duration", self.text(span));
            Diagnostic::error("E0896", span, message).with_hint("write it as `100ms` or `2s`")
        })
    }

    /// `NAME` or `BLACKBOARD NAME`.
    fn timer(&self, span: Span) -> Result<TimerReference, Diagnostic> {
        let text = self.text(span);
        let (board, name) = match text.rfind(char::is_whitespace) {
            Some(at) => {
                let board = text::trimmed(self.blanked, Span::new(span.start, span.start + at));
                (Some(names::state(&self.name(board), self.chart)?), text[at..].trim())
            }
            None => (None, text),
        };
        let node = |region| self.chart.region_node(region);
        let named = self.chart.timers().filter(|(_, timer)| *timer == name);
        let fitting: Vec<NodeId> = named.filter_map(|(region, _)| node(region)).collect();
        match fitting.as_slice() {
            several if board.is_some() => board.filter(|board| several.contains(board)),
            [one] => Some(*one),
            _ => None,
        }
        .map(|region| TimerReference { region, name: name.to_owned() })
        .ok_or_else(|| self.no_timer(span, name, &fitting))
    }

    fn no_timer(&self, span: Span, name: &str, fitting: &[NodeId]) -> Diagnostic {
        let boards: Vec<String> =
            fitting.iter().map(|&node| format!("`{} {name}`", self.chart.names().name(node))).collect();
        if !boards.is_empty() {
            let message = format!("`{}` is ambiguous: several timers have this name", self.text(span));
            let wrong = Diagnostic::error("E0895", span, message);
            return wrong.with_hint(format!("write the blackboard before its name: {}", boards.join(", ")));
        }
        let wrong =
            Diagnostic::error("E0895", span, format!("no action of the chart starts a timer `{name}`"));
        match nearest(name, self.chart.timers().map(|(_, timer)| timer)) {
            Some(near) => wrong.with_hint(format!("did you mean `{near}`?")),
            None => wrong.with_hint("a timer is one that an action `StartTimeout(name, 100ms)` starts"),
        }
    }

    /// `NAME: 80ms`, `NAME: over`, `NAME: unset`
    fn timer_left(&self, span: Span) -> Result<ExpectationKind, Diagnostic> {
        let Some(colon) = self.text(span).find(':') else {
            let wrong = Diagnostic::error("E0895", span, "the expected state of the timer is missing");
            return Err(
                wrong.with_hint("write `timer NAME: 80ms`, `timer NAME: over` or `timer NAME: unset`")
            );
        };
        let part = |start, end| text::trimmed(self.blanked, Span::new(start, end));
        let timer = self.timer(part(span.start, span.start + colon))?;
        let said = part(span.start + colon + 1, span.end);
        let left = match self.text(said) {
            "over" => ExpectedTimer::Over,
            "unset" => ExpectedTimer::Unset,
            _ => ExpectedTimer::Runs(self.duration(said)?),
        };
        Ok(ExpectationKind::Timer(timer, left))
    }
}

/// All results, or all errors.
fn all<T>(results: impl Iterator<Item = Result<T, Diagnostic>>) -> BindResult<Vec<T>> {
    let (mut values, mut found) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(wrong) => found.push(wrong),
        }
    }
    if found.is_empty() { Ok(values) } else { Err(found) }
}
