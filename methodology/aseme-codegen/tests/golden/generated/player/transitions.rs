//! The transitions of the chart.

use ::monas::generated::TypedChartBuilder;

use super::states::State;

/// The transitions, in the order of the document, each with its guard.
pub(crate) fn transitions(chart: &mut TypedChartBuilder) {
    chart.connect(State::START, State::look, "");
    chart.connect(State::look, State::kick, "");
    chart.connect(State::kick, State::passBall, "");
    chart.connect(State::passBall, State::END, "");
}
