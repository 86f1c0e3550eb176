//! Names of activities that live as long as the process.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// The full name of an activity.
#[derive(PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct ActivityName {
    /// The host.
    pub robot: String,
    /// The agent.
    pub agent: String,
    /// The activity.
    pub activity: String,
}

/// Each name once, and never freed: there are as many as there are activities of agents.
static NAMES: Mutex<BTreeSet<&'static ActivityName>> = Mutex::new(BTreeSet::new());

impl ActivityName {
    /// The only instance of this name.
    pub fn of(robot: &str, agent: &str, activity: &str) -> &'static ActivityName {
        let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
        let (robot, agent, activity) = (robot.into(), agent.into(), activity.into());
        let name = ActivityName { robot, agent, activity };
        if let Some(known) = names.get(&name) {
            return known;
        }
        let name: &'static ActivityName = Box::leak(Box::new(name));
        names.insert(name);
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_stored_once() {
        let address = |name: &str| std::ptr::from_ref(ActivityName::of("red-1", "mind", name));
        assert_eq!(address("a"), address("a"));
        assert_ne!(address("a"), address("b"));
    }
}
