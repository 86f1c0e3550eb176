//! Generated statecharts: the items from which `monas generate` builds crates, and their
//! registration.
//!
//! A generated crate holds a [typed chart](yase_codegen::typed) and an [`Instance`] of its activity
//! for each state that has one. It registers both with [`statechart!`](crate::statechart!) under a
//! name, which a configuration uses in place of a model file:
//!
//! ```xml
//! <agent><name>Goalie</name><statechart>goalie</statechart></agent>
//! ```
//!
//! It runs like an interpreted chart, with the same blackboards, wake-ups and records.

mod words;

pub use words::words;
pub use yase_codegen::typed::*;

use yase::Statechart;

use crate::activity::Activity;
use crate::guarded_activity::GuardedActivity;

/// The activity of a state.
pub struct Instance {
    pub(crate) node: NodeId,
    pub(crate) activity: Box<dyn Activity>,
}

impl Instance {
    /// An activity for a state.
    pub fn new(state: impl Into<NodeId>, activity: impl Activity + 'static) -> Instance {
        Instance { node: state.into(), activity: GuardedActivity::of(Box::new(activity)) }
    }

    /// An activity of type `A` for a state.
    pub fn of<A: Activity + Default + 'static>(state: impl Into<NodeId>) -> Instance {
        Instance::new(state, A::default())
    }
}

impl std::fmt::Debug for Instance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Instance({}, {})", self.node.0, self.activity.name())
    }
}

/// A generated statechart with its activities.
#[derive(Debug)]
pub struct GeneratedChart {
    pub(crate) chart: TypedChart,
    pub(crate) instances: Vec<Instance>,
}

impl GeneratedChart {
    /// A chart with the activities of its states.
    pub fn new(chart: TypedChart, instances: Vec<Instance>) -> GeneratedChart {
        GeneratedChart { chart, instances }
    }

    /// The chart as data.
    pub fn statechart(&self) -> &Statechart {
        self.chart.statechart()
    }

    /// The activity of that name, of the first state that has it.
    pub fn into_activity(self, name: &str) -> Option<Box<dyn Activity>> {
        let GeneratedChart { chart, instances } = self;
        let is_it = |node| chart.statechart().node(node).activity.as_deref() == Some(name);
        instances.into_iter().find(|instance| is_it(instance.node)).map(|instance| instance.activity)
    }
}

/// A generated statechart as [`statechart!`](crate::statechart!) registers it.
#[derive(Clone, Copy, Debug)]
pub struct ChartDeclaration {
    /// The name that configurations use.
    pub name: &'static str,
    /// The module it was registered in.
    pub module: &'static str,
    /// Constructs the chart with new activities.
    pub make: fn() -> Result<GeneratedChart, Vec<Diagnostic>>,
}

/// Every statechart registered in the crates of this program.
#[doc(hidden)]
#[linkme::distributed_slice]
pub static CHARTS: [ChartDeclaration];

/// Whether a chart is registered at the root of a crate of the same name, as crates written by
/// `monas generate` do.
pub fn is_generated_crate(chart: &str) -> bool {
    CHARTS.iter().any(|declaration| declaration.name == chart && declaration.module == chart)
}

/// Expansion of [`statechart!`](crate::statechart!).
///
/// # Errors
/// Diagnostics of the chart.
#[doc(hidden)]
pub fn assembled(
    chart: fn() -> Result<TypedChart, Vec<Diagnostic>>,
    instances: fn() -> Vec<Instance>,
) -> Result<GeneratedChart, Vec<Diagnostic>> {
    Ok(GeneratedChart { chart: chart()?, instances: instances() })
}

/// Adds a generated statechart to the registry, so that configurations can name it: its name, the
/// function that constructs it, and the function that constructs its activities.
///
/// ```
/// use monas_core::generated::{Diagnostic, TypedChartBuilder, Instance, NodeId, NodeKind, TypedChart};
///
/// fn chart() -> Result<TypedChart, Vec<Diagnostic>> {
///     let mut chart = TypedChartBuilder::new("sleeper");
///     chart.add(NodeId(1), NodeId(0), NodeKind::Start, "");
///     chart.add(NodeId(2), NodeId(0), NodeKind::Basic, "sleep");
///     chart.activity(NodeId(2), "sleep");
///     chart.connect(NodeId(1), NodeId(2), "");
///     chart.finish()
/// }
/// fn sleep(_: &mut monas_core::Blackboard) {}
/// fn instances() -> Vec<Instance> {
///     vec![Instance::new(NodeId(2), sleep)]
/// }
/// monas_core::statechart!("sleeper" = chart, instances);
///
/// let chart = monas_core::Registry::linked().chart("sleeper").expect("it is registered")?;
/// assert_eq!(chart.statechart().nodes().len(), 3);
/// # Ok::<(), monas_core::Error>(())
/// ```
#[macro_export]
macro_rules! statechart {
    ($name:literal = $chart:path, $instances:path) => {
        const _: () = {
            #[allow(unsafe_code)] // the section of the executable that the linker collects
            #[$crate::linked::linkme::distributed_slice($crate::linked::CHARTS)]
            #[linkme(crate = $crate::linked::linkme)]
            static DECLARATION: $crate::linked::ChartDeclaration = $crate::linked::ChartDeclaration {
                name: $name,
                module: ::core::module_path!(),
                make: || $crate::linked::assembled($chart, $instances),
            };
        };
    };
}
