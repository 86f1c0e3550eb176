//! Both interpreters play one case, and their logs are compared.
//!
//! All contents of trace records are compared, and so are all calls of the host, the reports, the
//! configuration after each step and the error that ends a chart. Two things are not compared,
//! since the rules leave them open: the order and number of guard evaluations within a micro-step,
//! and the description of a livelock.

use std::collections::BTreeSet;
use std::sync::Arc;

use yase::statechart::{NodeId, Statechart};
use yase::{Activation, Chooser, Machine, Outcome, ScopeId, Timestamp, TopicId};

use crate::chooser::{ChoicePolicy, ReferenceChooser};
use crate::random::Case;
use crate::script::{self, ByMicroSteps, Interpreter};
use crate::stepper::Stepper;
use crate::test_host::{TestHost, vocabulary};

/// Result of a case.
pub(crate) enum CaseResult {
    /// Both logs are equal.
    Same(Vec<String>),
    Different(Difference),
    /// The compiler rejects the chart.
    Refused(String),
}

pub(crate) struct Difference {
    pub expected: Vec<String>,
    pub found: Vec<String>,
}

pub(crate) fn judge(case: &Case) -> CaseResult {
    let chart = match case.chart.compile_with(&vocabulary(), case.semantics) {
        Ok(chart) => Arc::new(chart),
        Err(found) => {
            return CaseResult::Refused(found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"));
        }
    };
    let timers = chart.timers().map(|(region, name)| (region, name.to_owned())).collect();
    let expected = by_reference(case, timers);
    let mut machine = Machine::new(chart);
    machine.set_chooser(chooser(&case.policy));
    for found in
        [by_machine(case, machine.clone(), false), by_machine(case, ByMicroSteps(machine.clone()), false)]
    {
        if expected != found {
            return CaseResult::Different(Difference { expected, found });
        }
    }
    // A machine without an observer records no micro-steps: everything else must be equal.
    let is_micro_step = |line: &String| line.starts_with(|first: char| first.is_ascii_digit());
    let reported: Vec<String> = expected.iter().filter(|line| !is_micro_step(line)).cloned().collect();
    let found = by_machine(case, machine, true);
    match reported == found {
        true => CaseResult::Same(expected),
        false => CaseResult::Different(Difference { expected: reported, found }),
    }
}

fn host(case: &Case) -> TestHost {
    TestHost { verbose: true, reads: true, ..TestHost::new(&case.chart) }
}

fn by_reference(case: &Case, timers: Vec<(ScopeId, String)>) -> Vec<String> {
    let mut host = host(case);
    let chooser = ReferenceChooser::new(case.policy.clone());
    let mut watched = LoggingInterpreter {
        inner: Stepper::new(&case.chart, case.semantics, chooser, timers),
        chart: &case.chart,
    };
    script::run(&mut watched, &case.script, &mut host);
    host.say(format!("asked {:?}", watched.inner.chooser.reported()));
    normal(host.log)
}

fn by_machine<M: SteppedMachine>(case: &Case, machine: M, silent: bool) -> Vec<String> {
    let mut host = TestHost { silent, ..host(case) };
    let mut watched = LoggingInterpreter { inner: machine, chart: &case.chart };
    script::run(&mut watched, &case.script, &mut host);
    host.say(format!("asked {:?}", watched.inner.machine().chooser().choices()));
    normal(host.log)
}

fn chooser(policy: &ChoicePolicy) -> Chooser {
    match policy {
        ChoicePolicy::Declared => Chooser::declared(),
        ChoicePolicy::Seeded(seed) => Chooser::seeded(*seed),
        ChoicePolicy::Scripted(choices) => Chooser::scripted(choices.clone()),
    }
}

/// An interpreter that also logs its configuration after each step.
struct LoggingInterpreter<'c, I> {
    inner: I,
    chart: &'c Statechart,
}

trait Configured: Interpreter {
    fn has(&self, node: NodeId) -> bool;
}

impl Configured for Stepper<'_> {
    fn has(&self, node: NodeId) -> bool {
        self.is_active(node)
    }
}

impl<M: SteppedMachine> Configured for M {
    fn has(&self, node: NodeId) -> bool {
        self.machine().is_active(node)
    }
}

/// A machine, however it is stepped.
trait SteppedMachine: Interpreter {
    fn machine(&self) -> &Machine;
}

impl SteppedMachine for Machine {
    fn machine(&self) -> &Machine {
        self
    }
}

impl SteppedMachine for ByMicroSteps {
    fn machine(&self) -> &Machine {
        &self.0
    }
}

impl<I: Configured> LoggingInterpreter<'_, I> {
    fn show(&self, host: &mut TestHost) {
        let active = self.chart.nodes().filter(|(id, _)| self.inner.has(*id));
        let numbers: Vec<String> = active.map(|(id, _)| id.0.to_string()).collect();
        host.say(format!("  active {}", numbers.join(" ")));
    }
}

impl<I: Configured> Interpreter for LoggingInterpreter<'_, I> {
    fn start(&mut self, now: Timestamp, host: &mut TestHost) {
        self.inner.start(now, host);
        self.show(host);
    }

    fn event(&mut self, name: &str) {
        self.inner.event(name);
    }

    fn message(&mut self, topic: TopicId) {
        self.inner.message(topic);
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.inner.returned(activation, outcome)
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        self.inner.resumed(activation)
    }

    fn step(&mut self, now: Timestamp, host: &mut TestHost) -> Result<(), String> {
        let result = self.inner.step(now, host);
        self.show(host);
        result
    }

    fn needs_step(&self, now: Timestamp) -> bool {
        self.inner.needs_step(now)
    }

    fn next_deadline(&self) -> Option<Timestamp> {
        self.inner.next_deadline()
    }

    fn regions(&self) -> usize {
        self.inner.regions()
    }
}

fn normal(log: Vec<String>) -> Vec<String> {
    log.into_iter().map(normal_line).collect()
}

fn normal_line(line: String) -> String {
    if let Some(error) = line.strip_prefix("error: ") {
        let branch = error.contains("CHOICE");
        return if branch { line } else { "error: endless".into() };
    }
    match line.split_once("; read ") {
        None => line,
        Some((rest, reads)) => {
            let reads: BTreeSet<&str> = reads.split(", ").collect();
            format!("{rest}; read {}", reads.into_iter().collect::<Vec<_>>().join(", "))
        }
    }
}

/// A case and the first difference of the logs.
pub(crate) fn describe(case: &Case, difference: &Difference) -> String {
    let Difference { expected, found } = difference;
    let same = expected.iter().zip(found).take_while(|(a, b)| a == b).count();
    let one = |log: &[String]| log.get(same).cloned().unwrap_or_else(|| "(nothing)".into());
    format!(
        "{:?} {:?}\n{:?}\n{}{:?}\n\n{}\nexpected {}\nfound    {}\n",
        case.variant,
        case.policy,
        case.semantics,
        chart_text(&case.chart),
        case.script,
        expected[same.saturating_sub(14)..same].join("\n"),
        one(expected),
        one(found)
    )
}

fn chart_text(chart: &Statechart) -> String {
    let mut text = String::new();
    for (id, node) in chart.nodes() {
        text += &format!("{} {:?}", chart.path(id), node.kind);
        for (title, actions) in [("entry", &node.entry), ("exit", &node.exit)] {
            for action in actions {
                text += &format!(" | {title} {action}");
            }
        }
        if !node.defer.is_empty() {
            text += &format!(" | defer {:?}", node.defer);
        }
        if let Some(activity) = &node.activity {
            text += &format!(" | {activity} {:?}", node.duration);
        }
        text.push('\n');
    }
    for (_, transition) in chart.transitions() {
        let flags = [(transition.interrupts, " interrupts"), (transition.internal, " internal")];
        text += &format!("{} -> {}", chart.path(transition.source), chart.path(transition.target));
        text.extend(flags.iter().filter(|(set, _)| *set).map(|(_, name)| *name));
        if let Some(weight) = transition.weight {
            text += &format!(" weight {weight}");
        }
        text += &format!(" !{} : {}\n", transition.priority, transition.expression);
    }
    text
}
