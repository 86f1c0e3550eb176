//! Wraps an activity of a module: a panic that leaves the module would end the process, so it is
//! caught inside.

use narukom::Blackboard;

use crate::activity::{Activity, BoxError, Progress, Topics};
use crate::call::{self, CallFailure};
use crate::parameters::Parameters;
use crate::registry::ActivityDeclaration;

/// An activity called only by code of its module.
pub(crate) struct PanicBoundary {
    /// None while it is being dropped.
    activity: Option<Box<dyn Activity>>,
    name: String,
    topics: Topics,
}

impl PanicBoundary {
    /// A new instance; `make` of the declaration runs here, in the module.
    pub(crate) fn made(declaration: &ActivityDeclaration) -> Result<Box<dyn Activity>, String> {
        let made = call::caught(|| {
            let activity = (declaration.make)();
            let (name, topics) = (activity.name().to_owned(), activity.topics());
            PanicBoundary { activity: Some(activity), name, topics }
        });
        made.map(|made| Box::new(made) as Box<dyn Activity>).map_err(panic_error)
    }
}

/// The text of a failure. The panic payload is dropped here too.
fn panic_error(failure: CallFailure) -> String {
    call::caught(move || failure.to_string()).unwrap_or_else(|_| "failed without a description".into())
}

impl Activity for PanicBoundary {
    fn configure(&mut self, parameters: &Parameters) {
        let Some(activity) = self.activity.as_deref_mut() else { return };
        if let Err(failure) = call::caught(|| activity.configure(parameters)) {
            parameters.fail(panic_error(failure));
        }
    }

    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let Some(activity) = self.activity.as_deref_mut() else { return Ok(()) };
        call::start(activity, blackboard).map_err(|failure| panic_error(failure).into())
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(activity) = self.activity.as_deref_mut() else { return Ok(Progress::Done) };
        call::execute(activity, blackboard).map_err(|failure| panic_error(failure).into())
    }

    fn stop(&mut self, blackboard: &mut Blackboard) {
        let Some(activity) = self.activity.as_deref_mut() else { return };
        if let Err(failure) = call::stop(activity, blackboard) {
            tracing::error!(activity = %self.name, "activity failed to stop: {}", panic_error(failure));
        }
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn topics(&self) -> Topics {
        self.topics.clone()
    }
}

impl Drop for PanicBoundary {
    fn drop(&mut self) {
        let activity = self.activity.take();
        if let Err(failure) = call::caught(|| drop(activity)) {
            tracing::error!(activity = %self.name, "activity failed to end: {}", panic_error(failure));
        }
    }
}

#[cfg(test)]
mod tests {
    use narukom::{Hub, Timestamp};

    use super::*;

    /// Panics in the named functions.
    struct Fragile(&'static str);

    impl Fragile {
        fn touch(&self, part: &str) {
            assert_ne!(self.0, part, "{part} is broken");
        }
    }

    impl Activity for Fragile {
        fn configure(&mut self, _: &Parameters) {
            self.touch("configure");
        }
        fn start(&mut self, _: &mut Blackboard) -> Result<(), BoxError> {
            self.touch("start");
            Err("cannot start".into())
        }
        fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
            self.touch("execute");
            Ok(Progress::ongoing())
        }
        fn stop(&mut self, _: &mut Blackboard) {
            self.touch("stop");
        }
        fn name(&self) -> &str {
            self.touch("name");
            "fragile"
        }
        fn topics(&self) -> Topics {
            self.touch("topics");
            Topics::declared()
        }
    }

    impl Drop for Fragile {
        fn drop(&mut self) {
            self.touch("drop");
        }
    }

    fn declared(make: fn() -> Box<dyn Activity>) -> ActivityDeclaration {
        ActivityDeclaration { name: "Fragile", module: "eyes", code: "Fragile", is_function: false, make }
    }

    #[test]
    fn an_activity_that_behaves_is_as_it_would_be_without_the_guard() {
        let mut blackboard = Hub::with_linked_topics("local").unwrap().blackboard("test");
        blackboard.process_messages(Timestamp::ZERO);
        let mut activity = PanicBoundary::made(&declared(|| Box::new(Fragile("nothing")))).unwrap();
        assert_eq!((activity.name(), activity.topics()), ("fragile", Topics::declared()));
        assert_eq!(activity.start(&mut blackboard).unwrap_err().to_string(), "cannot start");
        assert_eq!(activity.execute(&mut blackboard).unwrap(), Progress::ongoing());
        let parameters = Parameters::new();
        activity.configure(&parameters);
        assert_eq!(parameters.faults(), []);
    }

    #[test]
    fn panics_become_errors_of_the_host() {
        let mut blackboard = Hub::with_linked_topics("local").unwrap().blackboard("test");
        let broken = |make| PanicBoundary::made(&declared(make)).unwrap();
        let part: fn(&'static str) -> String =
            |part| format!("panicked: assertion `left != right` failed: {part} is broken");
        let said = |failure: BoxError, name| {
            assert!(failure.to_string().starts_with(&part(name)), "{failure}");
        };
        said(broken(|| Box::new(Fragile("start"))).start(&mut blackboard).unwrap_err(), "start");
        said(broken(|| Box::new(Fragile("execute"))).execute(&mut blackboard).unwrap_err(), "execute");
        broken(|| Box::new(Fragile("stop"))).stop(&mut blackboard);
        drop(broken(|| Box::new(Fragile("drop"))));
        let parameters = Parameters::new();
        broken(|| Box::new(Fragile("configure"))).configure(&parameters);
        assert!(parameters.faults()[0].message.starts_with(&part("configure")));
        let makes: [fn() -> Box<dyn Activity>; 2] = [|| panic!("no camera"), || Box::new(Fragile("name"))];
        for make in makes {
            let failure = PanicBoundary::made(&declared(make)).err().unwrap();
            assert!(failure.starts_with("panicked: "), "{failure}");
        }
    }
}
