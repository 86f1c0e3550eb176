//! Calls of activities: nothing that they do gets past here.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use narukom::Blackboard;

use crate::activity::{Activity, BoxError, Progress};
use crate::parameters::Parameters;

/// Why a call of an activity came to nothing.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// It returned an error.
    #[error("{0}")]
    Error(BoxError),
    /// It panicked.
    #[error("panicked: {0}")]
    Panic(String),
}

/// Calls `start`.
pub(crate) fn start(activity: &mut dyn Activity, blackboard: &mut Blackboard) -> Result<(), Failure> {
    guarded(|| activity.start(blackboard))
}

/// Calls `execute`.
pub(crate) fn execute(activity: &mut dyn Activity, blackboard: &mut Blackboard) -> Result<Progress, Failure> {
    guarded(|| activity.execute(blackboard))
}

/// Calls `stop`.
pub(crate) fn stop(activity: &mut dyn Activity, blackboard: &mut Blackboard) -> Result<(), Failure> {
    guarded(|| {
        activity.stop(blackboard);
        Ok(())
    })
}

/// Calls `configure`. That it panicked is a fault of the parameters.
pub(crate) fn configure(activity: &mut dyn Activity, parameters: &Parameters) {
    if let Err(failure) = caught(|| activity.configure(parameters)) {
        parameters.fail(failure.to_string());
    }
}

/// Calls `configure` of an activity that is at work: it has shown that it takes such parameters, so it goes on whatever comes of them.
pub(crate) fn configure_again(name: &str, activity: &mut dyn Activity, parameters: &Parameters) {
    if let Err(failure) = caught(|| activity.configure(parameters)) {
        tracing::error!(activity = %name, "activity failed to take its parameters: {failure}");
    }
}

/// Whatever the activity left half done is its own affair: it is started again before it is called again, or never
/// called. The blackboard is whole at any time, since its own operations do not panic.
fn guarded<T>(call: impl FnOnce() -> Result<T, BoxError>) -> Result<T, Failure> {
    caught(call)?.map_err(Failure::Error)
}

/// Does something of an activity's; that it panics ends here.
pub(crate) fn caught<T>(act: impl FnOnce() -> T) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(act)).map_err(|payload| Failure::Panic(last_words(payload)))
}

/// What a panic said. What it carried ends here, and if that panics too, what that carried is left alone.
fn last_words(payload: Box<dyn Any + Send>) -> String {
    let words = spoken(payload.as_ref());
    if let Err(another) = catch_unwind(AssertUnwindSafe(|| drop(payload))) {
        std::mem::forget(another);
    }
    words
}

/// What a panic said.
fn spoken(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "without a message".into())
}
