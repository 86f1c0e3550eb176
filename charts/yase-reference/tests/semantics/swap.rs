//! Migration of a running machine to a changed chart.

mod history;
mod refusals;
mod same;
mod stage;
mod verdicts;
