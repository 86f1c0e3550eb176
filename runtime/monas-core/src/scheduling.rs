//! The scheduling that an agent requests for its threads.

/// The scheduling that an agent requests for its threads.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Scheduling {
    /// Priority for real-time scheduling: 1 to 99, higher values first.
    pub priority: i32,
    /// Whether real-time scheduling is requested.
    pub real_time: bool,
    /// The numbers of the permitted cores; empty for any core.
    pub cores: Vec<usize>,
}
