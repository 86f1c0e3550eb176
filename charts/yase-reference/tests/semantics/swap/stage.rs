//! A machine with the reference's host, and what a host does when the chart is migrated.

use std::collections::BTreeMap;
use std::sync::Arc;

use yase::migrate::{MigrationError, MigrationReport, NodeMapping, plan};
use yase::{CompiledChart, Machine, Outcome, Semantics, Timestamp};

use yase_reference::script;
use yase_reference::test_host::TestHost;

/// A running machine and its host.
pub(crate) struct Stage {
    pub(crate) machine: Machine,
    pub(crate) host: TestHost,
}

impl Stage {
    /// Starts a chart and lets events happen to it at time 0.
    pub(crate) fn new(chart: &str, events: &[&str]) -> Stage {
        Stage::with(Semantics::yase(), chart, events)
    }

    pub(crate) fn with(semantics: Semantics, chart: &str, events: &[&str]) -> Stage {
        let chart = yase_reference::chart(chart);
        let mut host = TestHost::new(&chart);
        let mut machine = Machine::new(script::compile_with(&chart, semantics));
        machine.start(Timestamp::ZERO, &mut host);
        let mut stage = Stage { machine, host };
        stage.step(0);
        for event in events {
            stage.event(event);
        }
        stage
    }

    pub(crate) fn step(&mut self, millis: u64) {
        self.host.now = Timestamp::from_millis(millis);
        self.machine.run_to_completion(self.host.now, &mut self.host).unwrap();
    }

    pub(crate) fn event(&mut self, name: &str) {
        self.machine.dispatch_name(name);
        self.step(0);
    }

    /// The only activity that runs returns.
    pub(crate) fn returns(&mut self) {
        let job = self.host.jobs.remove(0);
        assert!(self.machine.activity_returned(job.activation, Outcome::Done), "it is still known");
        self.step(0);
    }

    pub(crate) fn plan(&self, new: &str) -> NodeMapping {
        plan(
            self.machine.chart(),
            &script::compile_with(&yase_reference::chart(new), self.machine.semantics()),
        )
    }

    pub(crate) fn swap(&mut self, plan: &NodeMapping) -> Result<MigrationReport, MigrationError> {
        let report = self.machine.swap(plan)?;
        rekey(&mut self.host, self.machine.chart(), &report);
        Ok(report)
    }

    /// Asserts that the migration is refused and nothing has changed; returns the diagnostics.
    pub(crate) fn refusal(&mut self, plan: &NodeMapping) -> String {
        let before = self.machine.snapshot();
        let refusal = self.machine.swap(plan).unwrap_err();
        assert_eq!(self.machine.snapshot(), before);
        assert_eq!(self.machine.judge_swap(plan).unwrap_err(), refusal);
        refusal.reasons().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    }

    /// The active nodes without the root.
    pub(crate) fn active(&self) -> String {
        let chart = self.machine.chart();
        let nodes = self.machine.configuration();
        nodes.iter().skip(1).map(|&node| chart.short_path(node)).collect::<Vec<_>>().join(" ")
    }

    /// The lines logged since the last call.
    pub(crate) fn lines(&mut self) -> String {
        let lines = std::mem::take(&mut self.host.log);
        lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join("\n")
    }
}

/// The host's part of a migration: activities and blackboards get new indices.
pub(crate) fn rekey(host: &mut TestHost, chart: &Arc<CompiledChart>, report: &MigrationReport) {
    let activations: BTreeMap<_, _> = report.activations.iter().copied().collect();
    for job in &mut host.jobs {
        if let Some(&activation) = activations.get(&job.activation) {
            job.activation = activation;
        }
    }
    let mut boards = std::mem::take(&mut host.boards);
    let kept = report.regions.iter().filter_map(|(old, new)| Some((*new, boards.remove(old)?)));
    host.boards = kept.collect();
    host.activities = TestHost::new(chart.statechart()).activities;
}

/// The findings of a report, one a line.
pub(crate) fn findings(report: &MigrationReport) -> String {
    report.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
