//! A running machine takes a changed chart.
//!
//! A [`Plan`] says which node of the new chart each node of the old one is; [`Machine::swap`] has a machine go on with the new chart
//! where it stands, between two steps. Whatever is active, set, put off, waiting or running keeps its place if that is beyond doubt, and each
//! has its verdict in the [`Report`]. Where there is doubt the swap is refused, with all that stands against it, and nothing has changed.
//!
//! # What is the same
//!
//! A node is the one with the same path, from the counterpart of its parent on: the name of the root does not matter, and nodes
//! without a name are known by their kind and place. What is not there any more is *moved* if just one node of its name and kind lies
//! inside the counterpart of the nearest composite around it where that name occurs: so it is found when a composite was put
//! around it or taken away. If several could be it, it is gone, unless the caller says what
//! [replaces](Plan::with_replacement) it. A transition is the same if its ends are, and its expression. A timer is known by its
//! region and name, an event by its name.
//!
//! # What happens
//!
//! - Active states stay active. No exit, no entry and no transition action is done, no activity is started or asked to return.
//! - Composites that were put around what is active are active as if they had always been there, without their entry actions. If
//!   one is a region of an AND, its blackboard is filled from the one around it at the beginning of the next step.
//! - Regions that are new in an active AND are entered by default at the beginning of the next step: blackboard, entry actions, START.
//!   The trace has a record of it (`swap`).
//! - Guards and transitions are the new ones from the next step on. Events that waited for running activities are offered again.
//! - An activity that runs or waits goes on if its state is there and has the same activity. Its [`Activation`](crate::Activation) has
//!   new numbers: the report has them, as those of the blackboards, which are the host's.
//! - If the new chart says the same as the old one, nothing happens at all.
//!
//! An active state that is gone, an activity that runs and has no place, a state with an activity that has never run, and a
//! configuration with a hole are refused. History, timers and events that have no place are lost only if the caller [agrees](Plan::accepting_losses). Both charts are
//! compiled with the same vocabulary.
//!
//! # Example
//!
//! A lamp learns to blink while it is on:
//!
//! ```
//! use std::sync::Arc;
//! use yase::expression::parse_transition;
//! use yase::swap::plan;
//! use yase::{Activation, Chart, Host, Machine, Moment, Node, NodeKind, Statechart, Transition, Vocabulary};
//!
//! fn lamp(with: impl FnOnce(&mut Statechart)) -> Arc<Chart> {
//!     let mut lamp = Statechart::new("lamp");
//!     let start = lamp.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//!     with(&mut lamp);
//!     let (off, on) = (lamp.find("off").expect("it is there"), lamp.find("on").expect("it is there"));
//!     for (source, target, text) in [(start, off, ""), (off, on, "button"), (on, off, "button")] {
//!         let (expression, _) = parse_transition(text);
//!         lamp.connect(Transition { expression, ..Transition::new(source, target) });
//!     }
//!     Arc::new(lamp.compile(&Vocabulary::default()).expect("the chart is in order"))
//! }
//!
//! /// A world without messages and activities.
//! struct Dark;
//! impl Host for Dark {
//!     fn start(&mut self, _: Activation) {}
//!     fn cancel(&mut self, _: Activation) {}
//!     fn stop(&mut self, _: Activation) {}
//! }
//!
//! let steady = lamp(|lamp| {
//!     lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "off"));
//!     lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "on"));
//! });
//! let blinking = lamp(|lamp| {
//!     lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "off"));
//!     let on = lamp.add(Statechart::ROOT, Node::new(NodeKind::Or, "on"));
//!     let start = lamp.add(on, Node::new(NodeKind::Start, ""));
//!     let bright = lamp.add(on, Node::new(NodeKind::Basic, "bright"));
//!     lamp.connect(Transition::new(start, bright));
//! });
//!
//! let mut machine = Machine::new(steady.clone());
//! machine.start(Moment::ZERO, &mut Dark);
//! machine.dispatch_name("button");
//! machine.run_to_completion(Moment::ZERO, &mut Dark)?;
//!
//! // `on` is a composite now: where in it?
//! let plan = plan(&steady, &blinking);
//! assert!(machine.swap(&plan).is_err());
//!
//! // at its beginning
//! let report = machine.swap(&plan.with_replacement("lamp/on", "lamp/on/START")?)?;
//! for finding in &report.findings {
//!     println!("{finding}");
//! }
//! machine.run_to_completion(Moment::ZERO, &mut Dark)?;
//! assert!(machine.is_active(blinking.statechart().find("bright").expect("it is there")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod judge;
mod matching;
mod plan;
mod report;

use std::sync::Arc;

use crate::chart::Chart;
use crate::machine::Machine;
use crate::semantics::Semantics;

use judge::Judging;

pub use plan::{Plan, UnknownPath};
pub use report::{Finding, Objection, Refusal, Report, Subject, Verdict};

/// Finds the nodes of an old chart in a new one.
pub fn plan(old: &Arc<Chart>, new: &Arc<Chart>) -> Plan {
    Plan::new(old, new)
}

impl Machine {
    /// Goes on with the new chart of a plan, from the next step on. See [`swap`](crate::swap).
    ///
    /// # Errors
    /// If anything stands against it: the machine is then as it was.
    pub fn swap(&mut self, plan: &Plan) -> Result<Report, Refusal> {
        let (machine, report) = self.swapped(plan)?;
        *self = machine;
        Ok(report)
    }

    /// What [`swap`](Machine::swap) would do now.
    ///
    /// # Errors
    /// As [`swap`](Machine::swap).
    pub fn judge_swap(&self, plan: &Plan) -> Result<Report, Refusal> {
        self.swapped(plan).map(|(_, report)| report)
    }

    fn swapped(&self, plan: &Plan) -> Result<(Machine, Report), Refusal> {
        self.can_swap(plan)?;
        let mut judging = Judging::new(plan);
        let snapshot = judging.translate(&self.snapshot());
        let Judging { mut report, objections, .. } = judging;
        refuse(objections)?;
        let machine = Machine::restore(plan.new.clone(), &snapshot).map_err(|error| {
            let misfits = error.misfits().iter().map(|misfit| Objection::NotClosed(misfit.to_string()));
            Refusal::of(misfits.collect())
        })?;
        let known = self.activations().map(|(activation, _)| activation);
        report.activations = plan.activations(known, &machine);
        let regions = plan.old.regions();
        report.regions = regions.filter_map(|region| Some((region, plan.region(region)?))).collect();
        Ok((machine, report))
    }

    fn can_swap(&self, plan: &Plan) -> Result<(), Refusal> {
        let mut objections = Vec::new();
        if !Arc::ptr_eq(self.chart(), &plan.old) {
            objections.push(Objection::OtherChart);
        }
        let limit = self.semantics().limit;
        if (Semantics { limit, ..plan.new.semantics() }) != self.semantics() {
            objections.push(Objection::OtherSemantics);
        }
        if self.is_mid_step() {
            objections.push(Objection::MidStep);
        }
        refuse(objections)
    }
}

fn refuse(objections: Vec<Objection>) -> Result<(), Refusal> {
    if objections.is_empty() { Ok(()) } else { Err(Refusal::of(objections)) }
}
