//! Calls of activities: their errors and panics do not propagate beyond this module.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use narukom::Blackboard;
use yase::Activation;

use crate::activity::{Activity, BoxError, Progress};
use crate::activity_context::ActivityContext;
use crate::activity_context::calling;
use crate::call_slot::{self, ActivityFunction};
use crate::parameters::Parameters;

/// Failure of a call of an activity.
#[derive(Debug, thiserror::Error)]
pub enum CallFailure {
    /// It returned an error, which this describes.
    #[error("{0}")]
    Error(String),
    /// It panicked.
    #[error("panicked: {0}")]
    Panic(String),
}

/// An activity to be called, with the blackboard of its region.
pub struct ActivityCall {
    /// The activation at the time the call is prepared.
    pub activation: Activation,
    /// The priority of the state: higher values are called first.
    pub priority: i32,
    /// The duration of the call in simulated time.
    pub duration: Duration,
    /// The number of calls of the activity in this state, including this one.
    pub number: u64,
    /// Whether the activation was called before and returned `Ongoing`.
    pub(crate) is_resumed: bool,
    /// Index of its slot, as in the statistics of the chart.
    pub(crate) slot: usize,
    pub(crate) activity: Box<dyn Activity>,
    pub(crate) context: Arc<ActivityContext>,
    /// Number of the cycle from which it is called, for its log lines.
    pub(crate) cycle: u64,
    /// Whether `start` has been called on the instance.
    pub(crate) is_started: bool,
    /// Whether `execute` has been called.
    pub(crate) is_called: bool,
    pub(crate) blackboard: Box<Blackboard>,
}

/// Duration of a call, and its CPU time if measured.
#[derive(Clone, Copy, Debug)]
pub struct CallTiming {
    /// The duration.
    pub wall: Duration,
    /// The CPU time, if it was measured.
    pub cpu: Option<Duration>,
}

/// The result of an activity's call.
pub(crate) type CallResult = Result<Progress, CallFailure>;

/// A completed call.
pub struct FinishedCall {
    /// The call, with its activity and blackboard.
    pub call: ActivityCall,
    /// The result of the call.
    pub result: CallResult,
    /// None where calls are not measured.
    pub timing: Option<CallTiming>,
}

impl ActivityCall {
    /// Asks the activity to return soon.
    pub fn request_cancellation(&self) {
        self.blackboard.cancellation().request();
    }

    /// The name of the activity.
    pub fn name(&self) -> &str {
        &self.context.name.activity
    }

    /// Calls the activity on this thread.
    pub fn run(mut self) -> FinishedCall {
        let result = self.call();
        FinishedCall { call: self, result, timing: None }
    }

    /// Calls the activity on this thread and accounts the memory it allocates to it.
    pub fn run_with_memory_account(mut self) -> FinishedCall {
        let context = self.context.clone();
        let result = context.account.with_account(|| self.call());
        FinishedCall { call: self, result, timing: None }
    }

    /// Ends the call with a result without calling the activity.
    pub(crate) fn returning(self, result: CallResult) -> FinishedCall {
        FinishedCall { call: self, result, timing: None }
    }

    fn call(&mut self) -> CallResult {
        let ActivityCall { activity, context, cycle, is_started, is_called, blackboard, .. } = self;
        calling(context, *cycle, || {
            if !*is_started {
                start(activity.as_mut(), blackboard)?;
                *is_started = true;
            }
            *is_called = true;
            execute(activity.as_mut(), blackboard)
        })
    }
}

/// Calls `start`.
pub fn start(activity: &mut dyn Activity, blackboard: &mut Blackboard) -> Result<(), CallFailure> {
    call_slot::calls(ActivityFunction::Start);
    reading_declared(activity, blackboard, |activity, blackboard| activity.start(blackboard))
}

/// Calls `execute`.
pub fn execute(activity: &mut dyn Activity, blackboard: &mut Blackboard) -> Result<Progress, CallFailure> {
    call_slot::calls(ActivityFunction::Execute);
    reading_declared(activity, blackboard, |activity, blackboard| activity.execute(blackboard))
}

/// Calls an activity; it fails if it is the first to read a topic on this blackboard and does not
/// declare it, although it declares topics. Later calls pay one comparison for this.
fn reading_declared<T>(
    activity: &mut dyn Activity,
    blackboard: &mut Blackboard,
    call: impl FnOnce(&mut dyn Activity, &mut Blackboard) -> Result<T, BoxError>,
) -> Result<T, CallFailure> {
    let before = blackboard.read_count();
    let result = guarded(|| call(activity, blackboard))?;
    if blackboard.read_count() != before {
        check_read_since(before, activity, blackboard)?;
    }
    Ok(result)
}

#[cold]
fn check_read_since(
    count: usize,
    activity: &dyn Activity,
    blackboard: &Blackboard,
) -> Result<(), CallFailure> {
    let topics = caught(|| activity.topics())?;
    let read = blackboard.read_since(count);
    let mut paths = read.iter().filter_map(|topic| Some(blackboard.hub().declaration(*topic)?.path()));
    match paths.find(|path| topics.is_declared() && !topics.read_paths().contains(path)) {
        Some(path) => Err(CallFailure::Error(format!(
            "it reads `{path}`, which it does not declare: add the topic to its `topics`"
        ))),
        None => Ok(()),
    }
}

/// Calls `stop`.
pub fn stop(activity: &mut dyn Activity, blackboard: &mut Blackboard) -> Result<(), CallFailure> {
    call_slot::calls(ActivityFunction::Stop);
    guarded(|| {
        activity.stop(blackboard);
        Ok(())
    })
}

/// Calls `configure`. A panic is recorded as a fault of the parameters.
pub fn configure(activity: &mut dyn Activity, parameters: &Parameters) {
    if let Err(failure) = caught(|| activity.configure(parameters)) {
        parameters.fail(failure.to_string());
    }
}

/// Calls `configure` of a running activity. It has already accepted such parameters, so it
/// continues whatever the result.
pub fn configure_again(name: &str, activity: &mut dyn Activity, parameters: &Parameters) {
    if let Err(failure) = caught(|| activity.configure(parameters)) {
        tracing::error!(activity = %name, "activity failed to take its parameters: {failure}");
    }
}

/// State that the activity left incomplete affects only the activity itself: it is started again
/// before its next call, or never called again. The blackboard is always consistent, since its
/// operations do not panic.
fn guarded<T>(call: impl FnOnce() -> Result<T, BoxError>) -> Result<T, CallFailure> {
    caught(call)?.map_err(|error| CallFailure::Error(description(error)))
}

/// The description of an error, which is code of the activity too.
fn description(error: BoxError) -> String {
    let described = caught(|| error.to_string());
    let dropped = caught(|| drop(error));
    match (described, dropped) {
        (Ok(text), Ok(())) => text,
        (Ok(text), Err(failure)) => format!("{text} (the end of this error {failure})"),
        (Err(failure), _) => format!("it returned an error whose description {failure}"),
    }
}

/// Runs code of an activity and catches its panic.
pub fn caught<T>(act: impl FnOnce() -> T) -> Result<T, CallFailure> {
    catch_unwind(AssertUnwindSafe(act)).map_err(|payload| CallFailure::Panic(take_panic_message(payload)))
}

/// The message of a panic. Dropping the payload may panic too; the payload of that second panic is
/// leaked.
fn take_panic_message(payload: Box<dyn Any + Send>) -> String {
    let words = panic_message(payload.as_ref());
    if let Err(another) = catch_unwind(AssertUnwindSafe(|| drop(payload))) {
        std::mem::forget(another);
    }
    words
}

/// The message of a panic.
fn panic_message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "without a message".into())
}
