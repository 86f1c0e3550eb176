//! The structure of the chart.

use ::monas::generated::{Diagnostic, NodeKind, TypedChart, TypedChartBuilder};

use super::states::State;
use super::transitions::transitions;

/// The chart, with a function for each of its guards and values.
///
/// # Errors
/// Only if it was edited and is inconsistent.
pub fn chart() -> Result<TypedChart, Vec<Diagnostic>> {
    let mut chart = TypedChartBuilder::new("player");
    states(&mut chart);
    transitions(&mut chart);
    chart.finish()
}

/// The states and connectors, in the order of the document.
fn states(chart: &mut TypedChartBuilder) {
    chart.add(State::START, State::player, NodeKind::Start, "");
    chart.add(State::look, State::player, NodeKind::Basic, "look");
    chart.activity(State::look, "look");
    chart.add(State::kick, State::player, NodeKind::Basic, "kick");
    chart.activity(State::kick, "kick");
    chart.add(State::passBall, State::player, NodeKind::Basic, "passBall");
    chart.activity(State::passBall, "passBall");
    chart.add(State::END, State::player, NodeKind::End, "");
}
