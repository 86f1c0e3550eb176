//! A chart that runs takes another model: see [`yase::swap`]. What its states, activities and blackboards were doing goes on.

use narukom::Moment;
use yase::Activation;
use yase::swap::plan;

use super::desk::Desk;
use super::post::Posts;
use super::{Home, Runner};
use crate::binder::BoundChart;
use crate::listener::Listeners;
use crate::monitors::Monitors;

/// Another model for a chart that runs.
pub(crate) struct Swap {
    pub(crate) bound: BoundChart,
    /// By path: the states of the new chart in which states that are gone go on.
    pub(crate) states: Vec<(String, String)>,
    pub(crate) accepts_losses: bool,
    /// The properties of the agent, along the new chart: they begin anew.
    pub(crate) monitors: Option<Monitors>,
}

impl Runner {
    /// Goes on with another model, from the next step on. Says what became of what was active.
    ///
    /// # Errors
    /// All that stands against it; nothing has changed then.
    pub(crate) fn swap(&mut self, swap: Swap, now: Moment) -> Result<Vec<String>, Vec<String>> {
        let BoundChart { chart, functions, activities } = swap.bound;
        let mut plan = plan(self.machine.chart(), &chart);
        for (old, new) in &swap.states {
            plan = plan.with_replacement(old, new).map_err(|error| vec![error.to_string()])?;
        }
        if swap.accepts_losses {
            plan = plan.accepting_losses();
        }
        let listeners = self.desk.listeners().clone();
        let agent = self.desk.agent.clone();
        let mut machine = self.machine.clone();
        let report = machine
            .swap(&plan)
            .map_err(|refusal| refusal.reasons().iter().map(ToString::to_string).collect::<Vec<String>>())?;
        let monitors = swap.monitors;
        let home = self.home(&agent, &listeners, now);
        let desk = Desk::new(&chart, home, functions).map_err(|error| vec![error.to_string()])?;
        let known = |old: Activation| {
            report.activations.iter().find(|(known, _)| *known == old).map(|(_, activation)| *activation)
        };
        let old = std::mem::replace(&mut self.desk, desk);
        self.desk.take_over(old, &report.regions, known, |node| plan.node(node));
        let posts = Posts::new(&chart, activities, &self.hub, &agent);
        let old = std::mem::replace(&mut self.posts, posts);
        self.posts.take_over(old, |node| plan.node(node), known);
        self.machine = machine;
        if let Some(monitors) = monitors {
            self.follow(monitors);
        }
        Ok(report.findings.iter().map(ToString::to_string).collect())
    }

    fn home<'a>(&'a self, agent: &'a str, listeners: &'a Listeners, now: Moment) -> Home<'a> {
        Home { hub: &self.hub, agent, number: self.desk.number(), seed: self.desk.seed(), listeners, now }
    }
}
