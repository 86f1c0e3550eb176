//! Activities that another process executes.

use monas_core::activity::{Activity, BoxError, Progress, Topics};
use narukom::Blackboard;

/// Placeholder for an activity executed by another process; a link delivers its publications.
#[derive(Debug)]
pub(crate) struct RemoteActivity {
    name: String,
}

impl RemoteActivity {
    pub(crate) fn new(name: &str) -> RemoteActivity {
        RemoteActivity { name: name.into() }
    }
}

impl Activity for RemoteActivity {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn topics(&self) -> Topics {
        Topics::declared()
    }
}
