//! Replaces the model of a running chart: see [`yase::migrate`]. Active states, running activities
//! and blackboards are kept.

use narukom::Timestamp;
use yase::Activation;
use yase::migrate::{Disposition, MigrationError, plan};

use super::chart_host::ChartHost;
use super::{ChartContext, ChartRunner};
use crate::binder::BoundChart;
use crate::listener::ListenerSet;
use crate::monitors::Monitors;

/// A new model for a running chart.
pub struct ModelSwap {
    /// The new chart.
    pub bound: BoundChart,
    /// Pairs of paths: a removed state, and the state of the new chart that continues it.
    pub states: Vec<(String, String)>,
    /// Whether history, timers and events that the new chart does not have may be lost. An active
    /// state without a counterpart is always a reason against the swap.
    pub accepts_losses: bool,
    /// Whether it is only judged: nothing changes then.
    pub is_dry_run: bool,
    /// The properties of the agent on the new chart; their monitors start anew.
    pub monitors: Option<Monitors>,
}

impl ChartRunner {
    /// Continues with another model from the next step on. Reports what became of the active
    /// states.
    ///
    /// # Errors
    /// All reasons that prevent the swap; nothing has changed then.
    pub fn swap(&mut self, swap: ModelSwap, now: Timestamp) -> Result<Vec<String>, Vec<String>> {
        let BoundChart { chart, functions, activities } = swap.bound;
        let mut plan = plan(self.machine.chart(), &chart);
        for (old, new) in &swap.states {
            plan = plan.with_replacement(old, new).map_err(|error| vec![error.to_string()])?;
        }
        if swap.accepts_losses {
            plan = plan.accepting_losses();
        }
        let reasons = |refusal: MigrationError| -> Vec<String> {
            refusal.reasons().iter().map(ToString::to_string).collect()
        };
        if swap.is_dry_run {
            let report = self.machine.judge_swap(&plan).map_err(reasons)?;
            let is_changed = |disposition: &Disposition| !matches!(disposition, Disposition::Kept);
            let is_reported = |path: &str| report.findings.iter().any(|finding| finding.name == path);
            let others =
                plan.nodes().filter(|(path, disposition)| is_changed(disposition) && !is_reported(path));
            let others = others.map(|(path, disposition)| match disposition {
                Disposition::Lost(why) => format!("state `{path}`, not active: lost, {why}"),
                other => format!("state `{path}`, not active: {other}"),
            });
            return Ok(report.findings.iter().map(ToString::to_string).chain(others).collect());
        }
        let listeners = self.host.listeners().clone();
        let agent = self.host.agent.clone();
        let mut machine = self.machine.clone();
        let report = machine.swap(&plan).map_err(reasons)?;
        let monitors = swap.monitors;
        let home = self.chart_context(&agent, &listeners, now);
        let host =
            ChartHost::new(&chart, home, functions, activities).map_err(|error| vec![error.to_string()])?;
        let known = |old: Activation| {
            report.activations.iter().find(|(known, _)| *known == old).map(|(_, activation)| *activation)
        };
        let old = std::mem::replace(&mut self.host, host);
        self.host.take_over(old, &report.regions, known, |node| plan.node(node));
        self.machine = machine;
        if let Some(monitors) = monitors {
            self.set_monitors(monitors);
        }
        Ok(report.findings.iter().map(ToString::to_string).collect())
    }

    fn chart_context<'a>(
        &'a self,
        agent: &'a str,
        listeners: &'a ListenerSet,
        now: Timestamp,
    ) -> ChartContext<'a> {
        ChartContext {
            hub: &self.hub,
            agent,
            number: self.host.number(),
            seed: self.host.seed(),
            listeners,
            now,
        }
    }
}
