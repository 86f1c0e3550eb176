//! Guards what an activity does beside its calls: its name, its topics and its end.

use narukom::Blackboard;

use crate::activity::{Activity, BoxError, Progress, Topics};
use crate::call;
use crate::parameters::Parameters;

/// The name of an activity whose own function panics.
const UNNAMED: &str = "activity";

/// An activity whose `name`, `topics` and `Drop` may panic without effect on others. Its other
/// functions are called through [`call`], which catches their panics and attributes them.
pub(crate) struct GuardedActivity {
    /// None while it is being dropped.
    activity: Option<Box<dyn Activity>>,
    name: String,
}

impl GuardedActivity {
    /// Guards an activity.
    pub(crate) fn of(activity: Box<dyn Activity>) -> Box<dyn Activity> {
        GuardedActivity::named(activity).0
    }

    /// Guards an activity that has just been constructed.
    ///
    /// # Errors
    /// Its name cannot be determined.
    pub(crate) fn made(activity: Box<dyn Activity>) -> Result<Box<dyn Activity>, String> {
        let (guarded, failure) = GuardedActivity::named(activity);
        failure.map_or(Ok(guarded), Err)
    }

    fn named(activity: Box<dyn Activity>) -> (Box<dyn Activity>, Option<String>) {
        let named = call::caught(|| activity.name().to_owned());
        let (name, failure) = match named {
            Ok(name) => (name, None),
            Err(failure) => (UNNAMED.to_owned(), Some(failure.to_string())),
        };
        (Box::new(GuardedActivity { activity: Some(activity), name }), failure)
    }
}

impl Activity for GuardedActivity {
    fn configure(&mut self, parameters: &Parameters) {
        if let Some(activity) = self.activity.as_deref_mut() {
            activity.configure(parameters);
        }
    }

    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.activity.as_deref_mut().map_or(Ok(()), |activity| activity.start(blackboard))
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self.activity.as_deref_mut().map_or(Ok(Progress::Done), |activity| activity.execute(blackboard))
    }

    fn stop(&mut self, blackboard: &mut Blackboard) {
        if let Some(activity) = self.activity.as_deref_mut() {
            activity.stop(blackboard);
        }
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn topics(&self) -> Topics {
        let Some(activity) = self.activity.as_deref() else { return Topics::undeclared() };
        call::caught(|| activity.topics()).unwrap_or_else(|failure| {
            tracing::error!(activity = %self.name, "activity failed to declare its topics: {failure}");
            Topics::undeclared()
        })
    }
}

impl Drop for GuardedActivity {
    fn drop(&mut self) {
        let activity = self.activity.take();
        if let Err(failure) = call::caught(|| drop(activity)) {
            tracing::error!(activity = %self.name, "activity failed to end: {failure}");
        }
    }
}
