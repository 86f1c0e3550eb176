//! A machine with the reference's host.

use yase::snapshot::{RestoreError, Snapshot};
use yase::{Machine, Outcome, Semantics, Timestamp};

use yase_reference::test_host::TestHost;

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
        let mut machine = Machine::new(yase_reference::script::compile_with(&chart, semantics));
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
        assert!(self.machine.activity_returned(job.activation, Outcome::Done));
        self.step(0);
    }

    pub(crate) fn restore(&self, snapshot: &Snapshot) -> Result<Machine, RestoreError> {
        Machine::restore(self.machine.chart().clone(), snapshot)
    }

    /// Goes on with a snapshot of it that was changed.
    pub(crate) fn edit(&mut self, change: impl FnOnce(&mut Snapshot)) {
        let mut snapshot = self.machine.snapshot();
        change(&mut snapshot);
        self.machine = self.restore(&snapshot).unwrap();
    }

    /// The active nodes without the root.
    pub(crate) fn active(&self) -> String {
        let chart = self.machine.chart();
        let nodes = self.machine.configuration();
        nodes.iter().skip(1).map(|&node| chart.short_path(node)).collect::<Vec<_>>().join(" ")
    }
}
