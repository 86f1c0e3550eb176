//! Activities: the pieces of work that agents are made of.

use std::any::type_name;
use std::time::Duration;

use narukom::Blackboard;

use crate::parameters::Parameters;

/// An error of any type, as activities return them.
pub type BoxError = Box<dyn std::error::Error + Send + Sync>;

/// Whether a call of an activity has finished its work.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[must_use]
pub enum Progress {
    /// The work is finished; a state that runs the activity is complete.
    Done,
    /// The work goes on: call again after this delay (at least 1 ms), or earlier when somebody else's message arrives on a topic that
    /// the activity has read. In an agent's list every activity is called once a cycle, whatever it says.
    Ongoing(Duration),
}

impl Progress {
    /// The work goes on; call again after 10 ms.
    pub const fn ongoing() -> Progress {
        Progress::Ongoing(Duration::from_millis(10))
    }

    /// The work goes on; call again after this delay.
    pub const fn after(delay: Duration) -> Progress {
        Progress::Ongoing(delay)
    }
}

/// A piece of work with one task, done by ordinary code (functionalities) between what it reads from its blackboard and what
/// it publishes there.
///
/// Every function that takes a [`&mut Blackboard`](Blackboard) and returns nothing, a [`Progress`] or a `Result` of either is
/// an activity. A type implements the trait when it keeps something between calls:
///
/// ```
/// use monas::{Activity, Blackboard, BoxError, Parameters, Progress};
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
/// monas::activity!(Counter);
/// ```
///
/// An activity does not wait: it returns [`Progress::Ongoing`] and is called again. One whose work takes long looks at
/// [`Blackboard::is_cancelled`] now and then, and returns soon when it is asked to: its state waits to be left. It knows time and chance only through
/// [`Blackboard::now`] and [`Blackboard::random`], so that a run with the same seed is the same run.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an activity",
    label = "neither a type with `impl Activity` nor a function on a blackboard",
    note = "a function is an activity if it is `fn(&mut Blackboard)` and returns `()`, `Progress` or a `Result` of these",
    note = "in a closure, write the type of the argument: `|blackboard: &mut Blackboard| ..`"
)]
pub trait Activity: Send {
    /// Takes its parameters, before it starts and again whenever one is changed. Keys that it does not ask for are errors.
    fn configure(&mut self, parameters: &Parameters) {
        let _ = parameters;
    }

    /// Prepares for the first call; also called before an activity is restarted.
    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let _ = blackboard;
        Ok(())
    }

    /// Does its work once.
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError>;

    /// Ends what goes on, since the state that ran it has been left or the agent stops.
    fn stop(&mut self, blackboard: &mut Blackboard) {
        let _ = blackboard;
    }

    /// Its name in logs and tables: the type's or function's, if not said otherwise.
    fn name(&self) -> &str {
        short_name(type_name::<Self>())
    }

    /// What it reads and publishes, for checks of models and for drawings.
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

/// What a function may return to be an activity.
#[diagnostic::on_unimplemented(
    message = "an activity cannot return `{Self}`",
    label = "not a progress",
    note = "an activity returns `()`, `Progress`, or a `Result` of these whose error converts into `BoxError`"
)]
pub trait IntoProgress {
    /// The progress or error that it stands for; nothing stands for [`Progress::Done`].
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

/// The paths of the topics that an activity reads and publishes, or that it does not say.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Topics {
    declared: bool,
    reads: Vec<&'static str>,
    publishes: Vec<&'static str>,
}

impl Topics {
    /// The activity does not say; checks are silent about it.
    pub fn undeclared() -> Topics {
        Topics::default()
    }

    /// The activity reads and publishes nothing but what is added here.
    pub fn declared() -> Topics {
        Topics { declared: true, ..Topics::default() }
    }

    /// Adds a topic that is read.
    pub fn reads<K>(mut self, topic: narukom::Topic<K>) -> Topics {
        self.reads.push(topic.path());
        self
    }

    /// Adds a topic that is published.
    pub fn publishes<K>(mut self, topic: narukom::Topic<K>) -> Topics {
        self.publishes.push(topic.path());
        self
    }

    /// Whether anything is said at all.
    pub fn is_declared(&self) -> bool {
        self.declared
    }

    /// The paths of the topics that are read.
    pub fn read_paths(&self) -> &[&'static str] {
        &self.reads
    }

    /// The paths of the topics that are published.
    pub fn published_paths(&self) -> &[&'static str] {
        &self.publishes
    }
}

/// The last segment of a type's path, without the arguments of a generic type; `closure` for a closure.
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
