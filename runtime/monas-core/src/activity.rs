//! Activities: the units of behaviour of which agents consist.

use std::any::type_name;
use std::time::Duration;

use narukom::Blackboard;

use crate::parameters::Parameters;

/// An error of any type, returned by activities.
pub type BoxError = Box<dyn std::error::Error + Send + Sync>;

/// Whether a call of an activity has finished its work.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[must_use]
pub enum Progress {
    /// The work is finished; the state that runs the activity has completed.
    Done,
    /// The work continues: call again after this delay (at least 1 ms), or earlier when a message
    /// of another publisher arrives on a topic that the activity has read. In an agent's list every
    /// activity is called once per cycle, whatever it returns.
    Ongoing(Duration),
}

impl Progress {
    /// The work continues; call again after 10 ms.
    pub const fn ongoing() -> Progress {
        Progress::Ongoing(Duration::from_millis(10))
    }

    /// The work continues; call again after this delay.
    pub const fn after(delay: Duration) -> Progress {
        Progress::Ongoing(delay)
    }
}

/// A unit of behaviour with one task: ordinary code (functionalities) between the messages it reads
/// from its blackboard and those it publishes there.
///
/// Every function that takes a [`&mut Blackboard`](Blackboard) and returns nothing, a [`Progress`]
/// or a `Result` of either is an activity. A type implements the trait to keep state between calls:
///
/// ```
/// use monas_core::{Activity, Blackboard, BoxError, Parameters, Progress};
///
/// #[derive(Default)]
/// struct Counter {
///     count: u64,
///     step: u64,
/// }
///
/// impl Activity for Counter {
///     fn configure(&mut self, parameters: &Parameters) {
///         self.step = parameters.number("step").unwrap_or(1.0) as u64;
///     }
///     fn execute(&mut self, _blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
///         self.count += self.step;
///         Ok(Progress::Done)
///     }
/// }
///
/// monas_core::activity!(Counter);
/// ```
///
/// An activity does not block: it returns [`Progress::Ongoing`] and is called again. An activity
/// with long calls polls [`Blackboard::is_cancelled`] and returns soon after a cancellation, since
/// its state waits to be exited. It reads time and random numbers only from [`Blackboard::now`] and
/// [`Blackboard::random`], so that equal seeds give equal runs.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an activity",
    label = "neither a type with `impl Activity` nor a function on a blackboard",
    note = "a function is an activity if it is `fn(&mut Blackboard)` and returns `()`, `Progress` or a `Result` of these",
    note = "in a closure, write the type of the argument: `|blackboard: &mut Blackboard| ..`"
)]
pub trait Activity: Send {
    /// Takes its parameters, before it starts and again after each change. Keys that it does not
    /// query are errors.
    fn configure(&mut self, parameters: &Parameters) {
        let _ = parameters;
    }

    /// Prepares for the first call; also called before an activity is restarted.
    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let _ = blackboard;
        Ok(())
    }

    /// Executes one call.
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError>;

    /// Ends ongoing work: the state was exited, or the agent stops.
    fn stop(&mut self, blackboard: &mut Blackboard) {
        let _ = blackboard;
    }

    /// Its name in logs and tables; by default the name of the type or function.
    fn name(&self) -> &str {
        short_name(type_name::<Self>())
    }

    /// The topics it reads and publishes, for checks of models and for drawings.
    fn topics(&self) -> Topics {
        Topics::undeclared()
    }
}

impl<F, R> Activity for F
where
    F: FnMut(&mut Blackboard) -> R + Send,
    R: IntoProgress,
{
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        self(blackboard).into_progress()
    }
}

/// Return types of functions that are activities.
#[diagnostic::on_unimplemented(
    message = "an activity cannot return `{Self}`",
    label = "not a progress",
    note = "an activity returns `()`, `Progress`, or a `Result` of these whose error converts into `BoxError`"
)]
pub trait IntoProgress {
    /// Converts to a progress or an error; `()` is [`Progress::Done`].
    fn into_progress(self) -> Result<Progress, BoxError>;
}

impl IntoProgress for () {
    fn into_progress(self) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }
}

impl IntoProgress for Progress {
    fn into_progress(self) -> Result<Progress, BoxError> {
        Ok(self)
    }
}

impl<P: IntoProgress, E: Into<BoxError>> IntoProgress for Result<P, E> {
    fn into_progress(self) -> Result<Progress, BoxError> {
        self.map_err(Into::into)?.into_progress()
    }
}

/// Paths of the topics that an activity reads and publishes, if it declares them.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Topics {
    declared: bool,
    reads: Vec<&'static str>,
    ends_on: Vec<&'static str>,
    publishes: Vec<&'static str>,
    skills: Vec<&'static str>,
}

impl Topics {
    /// The activity declares nothing; checks do not apply to it.
    pub fn undeclared() -> Topics {
        Topics::default()
    }

    /// The activity reads and publishes only the topics added here. A call fails if it is the
    /// first one on its blackboard to read another topic.
    pub fn declared() -> Topics {
        Topics { declared: true, ..Topics::default() }
    }

    /// Adds a topic that is read.
    pub fn reads<K>(mut self, topic: narukom::Topic<K>) -> Topics {
        self.reads.push(topic.path());
        self
    }

    /// Adds a topic that is read and whose messages end the activity. An activity without such a
    /// topic ends by itself, in the call in which it starts or after a time.
    ///
    /// A guard after the activity must not read what is derived from this topic elsewhere: it would
    /// read what was derived from an older message (M29 of `monas model check`).
    pub fn ends_on<K>(mut self, topic: narukom::Topic<K>) -> Topics {
        self.ends_on.push(topic.path());
        self.reads(topic)
    }

    /// Adds a topic that is published.
    pub fn publishes<K>(mut self, topic: narukom::Topic<K>) -> Topics {
        self.publishes.push(topic.path());
        self
    }

    /// Adds a skill of the body that the activity requests through the topics that it publishes, by
    /// the name that bodies give it: `KICK_LEFT`. A missing skill is reported before a run.
    pub fn performs(mut self, skill: &'static str) -> Topics {
        self.skills.push(skill);
        self
    }

    /// Whether topics are declared.
    pub fn is_declared(&self) -> bool {
        self.declared
    }

    /// The paths of the topics that are read.
    pub fn read_paths(&self) -> &[&'static str] {
        &self.reads
    }

    /// The paths of the topics whose messages end the activity.
    pub fn ending_paths(&self) -> &[&'static str] {
        &self.ends_on
    }

    /// The paths of the topics that are published.
    pub fn published_paths(&self) -> &[&'static str] {
        &self.publishes
    }

    /// The skills of the body that are requested.
    pub fn skills(&self) -> &[&'static str] {
        &self.skills
    }
}

/// The last segment of a type's path, without generic arguments; `closure` for a closure.
fn short_name(path: &'static str) -> &'static str {
    let path = path.split('<').next().unwrap_or(path);
    match path.rsplit("::").next() {
        Some("{{closure}}") => "closure",
        Some(name) => name,
        None => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hello(_: &mut Blackboard) {}
    fn waits(_: &mut Blackboard) -> Progress {
        Progress::ongoing()
    }
    fn fails(_: &mut Blackboard) -> Result<(), std::num::ParseIntError> {
        "x".parse::<u8>().map(|_| ())
    }
    #[derive(Default)]
    struct Generic<T>(T);
    impl<T: Send> Activity for Generic<T> {
        fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
            Ok(Progress::Done)
        }
    }

    fn name(activity: impl Activity) -> String {
        activity.name().to_owned()
    }

    #[test]
    fn name_is_the_last_segment_of_the_type() {
        assert_eq!(name(hello), "hello");
        assert_eq!(name(waits), "waits");
        assert_eq!(name(fails), "fails");
        assert_eq!(name(Generic(Some(1))), "Generic");
        assert_eq!(name(|_: &mut Blackboard| {}), "closure");
    }

    #[test]
    fn ongoing_asks_for_ten_milliseconds() {
        assert_eq!(Progress::ongoing(), Progress::after(Duration::from_millis(10)));
    }

    #[test]
    fn results_of_functions_become_progress() {
        assert_eq!(().into_progress().unwrap(), Progress::Done);
        assert_eq!(Ok::<_, BoxError>(Progress::ongoing()).into_progress().unwrap(), Progress::ongoing());
        let error = "x".parse::<u8>().map(|_| ()).into_progress().unwrap_err();
        assert_eq!(error.to_string(), "invalid digit found in string");
    }
}
