//! Migration of a running machine to a changed chart.
//!
//! A [`NodeMapping`] assigns a node of the new chart to each node of the old one; [`Machine::swap`]
//! makes a machine continue with the new chart, between two steps. Everything that is active, set,
//! deferred, waiting or running is kept if its counterpart is unambiguous, and the
//! [`MigrationReport`] lists the disposition of each item. Otherwise the migration is rejected with
//! all conflicts, and nothing has changed.
//!
//! # Matching
//!
//! A node corresponds to the node with the same path below the counterpart of its parent: the name
//! of the root does not matter, and nodes without a name are identified by their kind and position.
//! If there is none, the node is *moved* if exactly one node of its name and kind lies inside the
//! counterpart of the nearest enclosing composite in which that name occurs: this finds nodes after
//! a composite was added or removed around them. If there are several candidates the node is lost,
//! unless the caller supplies a [replacement](NodeMapping::with_replacement). A transition
//! corresponds if its ends do and its expression is equal. A timer is identified by its scope and
//! name, an event by its name.
//!
//! # Effects
//!
//! - Active states stay active. No exit, entry or transition action is executed, no activity is
//!   started or requested to return.
//! - Composites added around active nodes are active as if they had always been there, without
//!   their entry actions. If one is a region of an AND, its blackboard is filled from the enclosing
//!   one at the beginning of the next step.
//! - New regions of an active AND are entered by default at the beginning of the next step:
//!   blackboard, entry actions, START. The trace has a record of it (`swap`).
//! - Guards and transitions are those of the new chart from the next step on. Events that waited
//!   for running activities are offered again.
//! - A running or waiting activity continues if its state exists and has the same activity. Its
//!   [`Activation`](crate::Activation) gets new numbers: the report lists them, and those of the
//!   blackboards, which belong to the host.
//! - If the charts are equivalent, nothing happens.
//!
//! The migration is rejected for an active state without counterpart, a running activity without
//! counterpart, an active state with a new activity, or an incomplete configuration. History,
//! timers and events without counterpart are lost only if the caller
//! [accepts](NodeMapping::accepting_losses) it. Both charts are compiled with the same type
//! environment.
//!
//! # Example
//!
//! A lamp that is on is changed to blink:
//!
//! ```
//! use std::sync::Arc;
//! use yase::expression::parse_transition;
//! use yase::migrate::plan;
//! use yase::{Activation, CompiledChart, Host, Machine, Timestamp, Node, NodeKind, Statechart, Transition, TypeEnvironment};
//!
//! fn lamp(with: impl FnOnce(&mut Statechart)) -> Arc<CompiledChart> {
//!     let mut lamp = Statechart::new("lamp");
//!     let start = lamp.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//!     with(&mut lamp);
//!     let (off, on) = (lamp.find("off").expect("it is there"), lamp.find("on").expect("it is there"));
//!     for (source, target, text) in [(start, off, ""), (off, on, "button"), (on, off, "button")] {
//!         let (expression, _) = parse_transition(text);
//!         lamp.connect(Transition { expression, ..Transition::new(source, target) });
//!     }
//!     Arc::new(lamp.compile(&TypeEnvironment::default()).expect("the chart is in order"))
//! }
//!
//! /// A host without messages and activities.
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
//! machine.start(Timestamp::ZERO, &mut Dark);
//! machine.dispatch_name("button");
//! machine.run_to_completion(Timestamp::ZERO, &mut Dark)?;
//!
//! // `on` is a composite now: which of its states becomes active?
//! let plan = plan(&steady, &blinking);
//! assert!(machine.swap(&plan).is_err());
//!
//! // its START
//! let report = machine.swap(&plan.with_replacement("lamp/on", "lamp/on/START")?)?;
//! for finding in &report.findings {
//!     println!("{finding}");
//! }
//! machine.run_to_completion(Timestamp::ZERO, &mut Dark)?;
//! assert!(machine.is_active(blinking.statechart().find("bright").expect("it is there")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod matching;
mod plan;
mod report;
mod translate;

use std::sync::Arc;

use crate::compile::CompiledChart;
use crate::machine::Machine;
use crate::semantics::Semantics;

use translate::SnapshotTranslator;

pub use plan::{NodeMapping, UnknownPath};
pub use report::{
    Conflict, Disposition, MigratedItem, MigrationError, MigrationFinding, MigrationReport, brief_lines,
};

/// Maps the nodes of an old chart to those of a new one.
pub fn plan(old: &Arc<CompiledChart>, new: &Arc<CompiledChart>) -> NodeMapping {
    NodeMapping::new(old, new)
}

impl Machine {
    /// Continues with the new chart of a mapping, from the next step on. See
    /// [`migrate`](crate::migrate).
    ///
    /// # Errors
    /// If there is any conflict: the machine is then unchanged.
    pub fn swap(&mut self, plan: &NodeMapping) -> Result<MigrationReport, MigrationError> {
        let (machine, report) = self.swapped(plan)?;
        *self = machine;
        Ok(report)
    }

    /// The result that [`swap`](Machine::swap) would have now.
    ///
    /// # Errors
    /// As [`swap`](Machine::swap).
    pub fn judge_swap(&self, plan: &NodeMapping) -> Result<MigrationReport, MigrationError> {
        self.swapped(plan).map(|(_, report)| report)
    }

    fn swapped(&self, plan: &NodeMapping) -> Result<(Machine, MigrationReport), MigrationError> {
        self.can_swap(plan)?;
        let mut judging = SnapshotTranslator::new(plan);
        let snapshot = judging.translate(&self.snapshot());
        let SnapshotTranslator { mut report, conflicts: objections, .. } = judging;
        refuse(objections)?;
        let machine = Machine::restore(plan.new.clone(), &snapshot).map_err(|error| {
            let misfits = error.issues().iter().map(|misfit| Conflict::NotClosed(misfit.to_string()));
            MigrationError::of(misfits.collect())
        })?;
        let known = self.activations().map(|(activation, _)| activation);
        report.activations = plan.activations(known, &machine);
        let regions = plan.old.regions();
        report.regions = regions.filter_map(|region| Some((region, plan.region(region)?))).collect();
        Ok((machine, report))
    }

    fn can_swap(&self, plan: &NodeMapping) -> Result<(), MigrationError> {
        let mut objections = Vec::new();
        if !Arc::ptr_eq(self.chart(), &plan.old) {
            objections.push(Conflict::OtherChart);
        }
        let limit = self.semantics().limit;
        if (Semantics { limit, ..plan.new.semantics() }) != self.semantics() {
            objections.push(Conflict::OtherSemantics);
        }
        if self.is_mid_step() {
            objections.push(Conflict::MidStep);
        }
        refuse(objections)
    }
}

fn refuse(objections: Vec<Conflict>) -> Result<(), MigrationError> {
    if objections.is_empty() { Ok(()) } else { Err(MigrationError::of(objections)) }
}
