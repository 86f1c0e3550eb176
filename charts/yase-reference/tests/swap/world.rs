//! A machine in the reference's world, and the work of a host when the chart is migrated.

use std::collections::BTreeMap;
use std::sync::Arc;

use yase::migrate::{MigrationError, MigrationReport, NodeMapping, plan};
use yase::{CompiledChart, Machine, Outcome, Semantics, Timestamp};

use yase_reference::script;
use yase_reference::world::World;

/// A machine that runs, in its world.
pub(crate) struct Stage {
    pub(crate) machine: Machine,
    pub(crate) world: World,
}

impl Stage {
    /// Starts a chart and lets events happen to it at time 0.
    pub(crate) fn new(chart: &str, events: &[&str]) -> Stage {
        Stage::with(Semantics::yase(), chart, events)
    }

    pub(crate) fn with(semantics: Semantics, chart: &str, events: &[&str]) -> Stage {
        let chart = yase_reference::chart(chart);
        let mut world = World::new(&chart);
        let mut machine = Machine::new(script::compile_with(&chart, semantics));
        machine.start(Timestamp::ZERO, &mut world);
        let mut stage = Stage { machine, world };
        stage.step(0);
        for event in events {
            stage.event(event);
        }
        stage
    }

    pub(crate) fn step(&mut self, millis: u64) {
        self.world.now = Timestamp::from_millis(millis);
        self.machine.run_to_completion(self.world.now, &mut self.world).unwrap();
    }

    pub(crate) fn event(&mut self, name: &str) {
        self.machine.dispatch_name(name);
        self.step(0);
    }

    /// The only activity that runs returns.
    pub(crate) fn returns(&mut self) {
        let job = self.world.jobs.remove(0);
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
        rekey(&mut self.world, self.machine.chart(), &report);
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
        let lines = std::mem::take(&mut self.world.log);
        lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join("\n")
    }
}

/// The work of a host: activities and blackboards get new indices.
pub(crate) fn rekey(world: &mut World, chart: &Arc<CompiledChart>, report: &MigrationReport) {
    let activations: BTreeMap<_, _> = report.activations.iter().copied().collect();
    for job in &mut world.jobs {
        if let Some(&activation) = activations.get(&job.activation) {
            job.activation = activation;
        }
    }
    let mut boards = std::mem::take(&mut world.boards);
    let kept = report.regions.iter().filter_map(|(old, new)| Some((*new, boards.remove(old)?)));
    world.boards = kept.collect();
    world.activities = World::new(chart.statechart()).activities;
}

/// The findings of a report, one a line.
pub(crate) fn findings(report: &MigrationReport) -> String {
    report.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
