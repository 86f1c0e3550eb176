//! The agents of a host at work, whatever time they run in.

use crate::agent::Profile;
use crate::records::AgentEntry;
use crate::talws::crew::Member;
use crate::talws::orders::{Asked, Orders, Standing};

/// Agents that can be told what to do.
pub(in crate::talws) trait Staff {
    /// Whether an agent does anything.
    fn standing(&self, agent: &str) -> Standing;

    /// Whether a chart of an agent does anything, by its place.
    fn standing_of_chart(&self, agent: &str, place: usize) -> Standing;

    /// What a chart of an agent is doing: a snapshot of its machine in JSON, and a drawing.
    fn told(&self, agent: &str, place: usize) -> Result<Vec<String>, String>;

    /// Whether it has a list, be it an empty one.
    fn has_list(&self, agent: &str) -> bool;

    /// How many cycles it has had.
    fn cycles(&self, agent: &str) -> u64;

    /// Tells it what to do, and what there is to say of that.
    ///
    /// # Errors
    /// What stands against it: nothing has changed.
    fn obey(&mut self, agent: &str, orders: Orders) -> Result<Vec<String>, Vec<String>>;

    /// A new agent begins, as somebody asked.
    ///
    /// # Errors
    /// The system gives no thread.
    fn launch(&mut self, member: Member, asked: Option<&Asked>) -> Result<(), String>;

    /// An agent leaves for good.
    ///
    /// # Errors
    /// It cannot be stopped.
    fn dismiss(&mut self, agent: &str) -> Result<(), String>;

    /// An agent as it is now.
    fn entry(&self, profile: &Profile) -> AgentEntry;
}
