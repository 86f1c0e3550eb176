//! What a chart that runs is doing, for those who look.

use yase::Element;
use yase::export::{Mark, Marks, to_svg_marked};

use super::Runner;

impl Runner {
    /// A snapshot of its machine in JSON, and the chart drawn with what is active set apart.
    pub(crate) fn told(&self) -> Vec<String> {
        let chart = self.machine.chart().statechart();
        let mut marks = Marks::default();
        for node in self.machine.configuration() {
            marks.set(chart, Element::Node(node), Mark::Active);
        }
        // A snapshot is text by its form; one that were not would be seen to be empty.
        let snapshot = serde_json::to_string(&self.machine.snapshot()).unwrap_or_default();
        vec![snapshot, to_svg_marked(chart, &marks)]
    }
}
