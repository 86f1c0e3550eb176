//! The registry: names that configurations and models of a program can use.

use std::collections::BTreeMap;
use std::sync::Arc;

use yase::diagnostic::nearest;

use crate::activity::Activity;
use crate::call;
use crate::error::{Error, ErrorKind};
use crate::function::{self, FUNCTIONS, FunctionDeclaration};
use crate::generated::{CHARTS, ChartDeclaration, GeneratedChart};
use crate::guarded_activity::GuardedActivity;
use crate::module::Module;

/// An activity as [`activity!`](crate::activity!) registers it.
#[derive(Clone, Copy, Debug)]
pub struct ActivityDeclaration {
    /// The name that configurations and models use.
    pub name: &'static str,
    /// The module it was registered in.
    pub module: &'static str,
    /// Its name in that module.
    pub code: &'static str,
    /// Whether that is a function rather than a type.
    pub is_function: bool,
    /// Constructs an instance.
    pub make: fn() -> Box<dyn Activity>,
}

/// Every activity registered in the crates of this program.
#[doc(hidden)]
#[linkme::distributed_slice]
pub static ACTIVITIES: [ActivityDeclaration];

/// Adds an activity to the registry, so that configurations and models can name it.
///
/// ```
/// use monas_core::{Activity, Blackboard, BoxError, Progress};
///
/// #[derive(Default)]
/// struct PassBall;
/// impl Activity for PassBall {
///     fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
///         Ok(Progress::Done)
///     }
/// }
/// fn stand(_: &mut Blackboard) {}
///
/// monas_core::activity!(PassBall as "passBall"); // a type is made by `Default`
/// monas_core::activity!(fn stand);
///
/// let registry = monas_core::Registry::linked();
/// assert_eq!(registry.activity("passBall").unwrap().name(), "PassBall");
/// assert!(registry.activity("stand").is_ok());
/// ```
///
/// The linker drops a crate that the program does not mention, with its activities: write `use
/// its_name as _;` in the program.
#[macro_export]
macro_rules! activity {
    (fn $function:ident) => {
        $crate::activity!(@ ::core::stringify!($function), $function, true, ::std::boxed::Box::new($function));
    };
    (fn $function:ident as $name:expr) => {
        $crate::activity!(@ $name, $function, true, ::std::boxed::Box::new($function));
    };
    ($type:ident) => {
        $crate::activity!(@ ::core::stringify!($type), $type, false, ::std::boxed::Box::<$type>::default());
    };
    ($type:ty as $name:expr) => {
        $crate::activity!(@ $name, $type, false, ::std::boxed::Box::<$type>::default());
    };
    (@ $name:expr, $code:ty, $is_function:literal, $made:expr) => {
        const _: () = {
            #[allow(unsafe_code)] // the section of the executable that the linker collects
            #[$crate::linked::linkme::distributed_slice($crate::linked::ACTIVITIES)]
            #[linkme(crate = $crate::linked::linkme)]
            static DECLARATION: $crate::linked::ActivityDeclaration = $crate::linked::ActivityDeclaration {
                name: $name,
                module: ::core::module_path!(),
                code: ::core::stringify!($code),
                is_function: $is_function,
                make: || $made,
            };
        };
    };
}

/// Constructs an instance, or returns why it cannot.
type ActivityConstructor = Arc<dyn Fn() -> Result<Box<dyn Activity>, String> + Send + Sync>;

/// Entries under one name: one constructor, or several, which makes the name ambiguous.
#[derive(Clone)]
struct RegistryEntry {
    constructors: Vec<(String, ActivityConstructor)>,
}

/// Activities and functions by name, in alphabetical order.
///
/// A name that two crates register is available as `crate::Name` only.
#[derive(Clone, Default)]
pub struct Registry {
    activities: BTreeMap<String, RegistryEntry>,
    functions: BTreeMap<String, Vec<FunctionDeclaration>>,
    charts: BTreeMap<String, Vec<ChartDeclaration>>,
    /// By name.
    modules: BTreeMap<String, Module>,
}

impl Registry {
    /// A registry with only the built-in functions of expressions, `abs`, `min` and `max`.
    pub fn empty() -> Registry {
        let mut registry = Registry::default();
        for declaration in FUNCTIONS.iter().filter(|declaration| function::is_own(declaration)) {
            registry.functions.entry(declaration.name.into()).or_default().push(*declaration);
        }
        registry
    }

    /// All registrations of [`activity!`](crate::activity!) and [`function!`](crate::function!) in
    /// this program.
    pub fn linked() -> Registry {
        let mut registry = Registry::empty();
        for declaration in ACTIVITIES {
            let make: ActivityConstructor = Arc::new(|| Ok((declaration.make)()));
            registry.insert_both(declaration.name, declaration.module, &make);
        }
        for declaration in FUNCTIONS.iter().filter(|declaration| !function::is_own(declaration)) {
            registry.functions.entry(declaration.name.into()).or_default().push(*declaration);
        }
        for declaration in CHARTS {
            let package = package(declaration.module);
            for name in [declaration.name.into(), format!("{package}::{}", declaration.name)] {
                registry.charts.entry(name).or_default().push(*declaration);
            }
        }
        // The linker's order is unspecified.
        registry.charts.values_mut().for_each(|same| same.sort_by_key(|chart| chart.module));
        registry.functions.values_mut().for_each(|same| same.sort_by_key(|function| function.module));
        registry.activities.values_mut().for_each(|entry| entry.constructors.sort_by(|a, b| a.0.cmp(&b.0)));
        registry
    }

    /// Adds an activity under a name, for programs and tests that build their registry themselves.
    pub fn with<A, F>(mut self, name: impl Into<String>, make: F) -> Registry
    where
        A: Activity + 'static,
        F: Fn() -> A + Send + Sync + 'static,
    {
        self.insert(name.into(), "this program", Arc::new(move || Ok(Box::new(make()))));
        self
    }

    /// This registry with the activities of a module, which replaces one of the same name.
    ///
    /// # Errors
    /// [`ErrorKind::Module`]: the name of one of its activities is taken, and would become
    /// ambiguous.
    pub fn with_module(&self, module: Module) -> Result<Registry, Error> {
        let mut registry = self.without_module(module.name());
        for activity in module.activities() {
            let constructors =
                registry.activities.get(activity.name).map(|entry| entry.constructors.as_slice());
            if let Some((taken, _)) = constructors.and_then(<[_]>::first) {
                let message =
                    format!("activity `{}` of module `{}` is also in {taken}", activity.name, module.name());
                let hint =
                    format!("give it another name: `monas::activity!(.. as \"Other{}\")`", activity.name);
                return Err(Error::new(ErrorKind::Module, message).with_hint(hint));
            }
            let made = *activity;
            registry.insert_both(
                activity.name,
                activity.module,
                &(Arc::new(move || made.make()) as ActivityConstructor),
            );
        }
        registry.modules.insert(module.name().to_owned(), module);
        Ok(registry)
    }

    /// This registry without the activities of the module of that name, if any.
    #[must_use]
    pub fn without_module(&self, name: &str) -> Registry {
        let mut registry = self.clone();
        if let Some(module) = registry.modules.remove(name) {
            for activity in module.activities() {
                for name in both_names(activity.name, activity.module) {
                    registry.activities.remove(&name);
                }
            }
        }
        registry
    }

    /// Its modules, by name.
    pub fn modules(&self) -> impl Iterator<Item = &Module> {
        self.modules.values()
    }

    /// The module of that name.
    pub fn module(&self, name: &str) -> Option<&Module> {
        self.modules.get(name)
    }

    /// Inserts it under its name, and under that with its crate's.
    fn insert_both(&mut self, name: &str, module: &str, make: &ActivityConstructor) {
        for name in both_names(name, module) {
            self.insert(name, module, make.clone());
        }
    }

    fn insert(&mut self, name: String, module: &str, make: ActivityConstructor) {
        let entry = self.activities.entry(name).or_insert_with(|| RegistryEntry { constructors: Vec::new() });
        entry.constructors.push((module.to_owned(), make));
    }

    /// A new instance of an activity.
    ///
    /// # Errors
    /// [`ErrorKind::UnknownActivity`] names the nearest known activity,
    /// [`ErrorKind::AmbiguousActivity`] the candidates. A panic in a module during construction is
    /// [`ErrorKind::Module`].
    pub fn activity(&self, name: &str) -> Result<Box<dyn Activity>, Error> {
        match self.activities.get(name).map(|entry| entry.constructors.as_slice()) {
            Some([(module, make)]) => made(make).map_err(|reason| {
                let message = format!("activity `{name}` of {module} cannot be made: {reason}");
                Error::new(ErrorKind::Module, message)
            }),
            Some(several) => Err(ambiguous(name, several)),
            None => Err(self.unknown(name)),
        }
    }

    /// The path of the Rust module that registers an activity; none if the name is unknown or
    /// ambiguous.
    pub fn activity_module(&self, name: &str) -> Option<&str> {
        match self.activities.get(name)?.constructors.as_slice() {
            [(module, _)] => Some(module),
            _ => None,
        }
    }

    fn unknown(&self, name: &str) -> Error {
        let error = Error::new(ErrorKind::UnknownActivity, format!("unknown activity `{name}`"));
        match nearest(name, self.activities.keys().map(String::as_str)) {
            Some(known) => error.with_hint(format!("did you mean `{known}`?")),
            None => error,
        }
    }

    /// The generated statechart of that name, if any, with a new instance of each of its
    /// activities.
    ///
    /// # Errors
    /// [`ErrorKind::AmbiguousChart`] if two crates register that name; [`ErrorKind::Invalid`] if
    /// its code is inconsistent or panics.
    pub fn chart(&self, name: &str) -> Option<Result<GeneratedChart, Error>> {
        match self.charts.get(name)?.as_slice() {
            [only] => Some(match call::caught(|| (only.make)()) {
                Ok(made) => made.map_err(Error::invalid),
                Err(failure) => {
                    let message = format!("the statechart `{name}` cannot be made: {failure}");
                    Err(Error::new(ErrorKind::Invalid, message))
                }
            }),
            several => {
                let modules: Vec<&str> = several.iter().map(|chart| chart.module).collect();
                let message =
                    format!("the statechart `{name}` is registered in {}", modules.join(" and in "));
                let error = Error::new(ErrorKind::AmbiguousChart, message);
                Some(Err(match modules.first() {
                    Some(module) => error.with_hint(format!("write `{}::{name}`", package(module))),
                    None => error,
                }))
            }
        }
    }

    /// The names of all generated statecharts.
    pub fn chart_names(&self) -> impl Iterator<Item = &str> {
        self.charts.keys().map(String::as_str).filter(|name| !name.contains("::"))
    }

    /// The names of all activities, ambiguous ones qualified by crate.
    pub fn activity_names(&self) -> impl Iterator<Item = &str> {
        let plain_is_ambiguous =
            |name: &str| self.activities.get(name).is_some_and(|e| e.constructors.len() > 1);
        self.activities
            .iter()
            .filter(move |(name, entry)| match name.rsplit_once("::") {
                Some((_, plain)) => plain_is_ambiguous(plain),
                None => entry.constructors.len() == 1,
            })
            .map(|(name, _)| name.as_str())
    }

    /// The names of all functions.
    pub fn function_names(&self) -> impl Iterator<Item = &str> {
        self.functions.keys().map(String::as_str)
    }

    /// The type environment of expressions: the topics of the program and the functions of the
    /// registry.
    ///
    /// # Errors
    /// [`ErrorKind::AmbiguousFunction`] if two functions have the same name.
    pub fn vocabulary(&self) -> Result<yase::TypeEnvironment, Error> {
        Ok(crate::vocabulary::vocabulary(narukom::TOPICS, &self.functions()?))
    }

    /// All functions, one per name.
    ///
    /// # Errors
    /// [`ErrorKind::AmbiguousFunction`] if two have the same name.
    pub(crate) fn functions(&self) -> Result<Vec<FunctionDeclaration>, Error> {
        self.functions.iter().map(|(name, same)| only(name, same)).collect()
    }
}

/// A new activity, or why it cannot be constructed.
fn made(make: &ActivityConstructor) -> Result<Box<dyn Activity>, String> {
    let made = call::caught(|| make()).map_err(|failure| failure.to_string()).flatten();
    made.and_then(GuardedActivity::made)
}

impl std::fmt::Debug for Registry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Registry")
            .field("activities", &self.activity_names().collect::<Vec<_>>())
            .field("functions", &self.function_names().collect::<Vec<_>>())
            .field("charts", &self.chart_names().collect::<Vec<_>>())
            .field("modules", &self.modules.keys())
            .finish()
    }
}

/// The names of an activity: its own, and that qualified by its crate.
pub fn both_names(name: &str, module: &str) -> [String; 2] {
    [format!("{}::{name}", package(module)), name.to_owned()]
}

/// The crate of a module.
pub(crate) fn package(module: &str) -> &str {
    module.split("::").next().unwrap_or(module)
}

fn ambiguous(name: &str, constructors: &[(String, ActivityConstructor)]) -> Error {
    let modules: Vec<&str> = constructors.iter().map(|(module, _)| module.as_str()).collect();
    let message = format!("activity `{name}` is registered in {}", modules.join(" and in "));
    let error = Error::new(ErrorKind::AmbiguousActivity, message);
    match modules.first() {
        Some(module) if !name.contains("::") => {
            error.with_hint(format!("write `{}::{name}`", package(module)))
        }
        _ => error,
    }
}

fn only(name: &str, same: &[FunctionDeclaration]) -> Result<FunctionDeclaration, Error> {
    match same {
        [function] => Ok(*function),
        several => {
            let modules: Vec<&str> = several.iter().map(|function| function.module).collect();
            let message = format!("function `{name}` is registered in {}", modules.join(" and in "));
            Err(Error::new(ErrorKind::AmbiguousFunction, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use narukom::Blackboard;

    use super::*;

    fn stand(_: &mut Blackboard) {}
    crate::activity!(fn stand as "RegistryTestStand");

    /// A registry with registrations of two crates.
    fn of_two_crates() -> Registry {
        let mut registry = Registry::empty();
        for (module, name) in [("red::legs", "Walk"), ("blue", "Walk"), ("blue", "Kick")] {
            let qualified = format!("{}::{name}", package(module));
            registry.insert(qualified, module, Arc::new(|| Ok(Box::new(stand))));
            registry.insert(name.into(), module, Arc::new(|| Ok(Box::new(stand))));
        }
        registry
    }

    #[test]
    fn registered_activities_are_linked() {
        let registry = Registry::linked();
        assert!(registry.activity_names().any(|name| name == "RegistryTestStand"));
        for name in ["abs", "max", "min"] {
            assert!(registry.function_names().any(|known| known == name), "{name}");
        }
        assert_eq!(registry.functions().unwrap().len(), registry.function_names().count());
    }

    #[test]
    fn built_in_functions_need_no_registry() {
        let names: Vec<String> = Registry::empty().function_names().map(String::from).collect();
        assert_eq!(names, ["abs", "max", "min"]);
        let role = "Liveness:\nr = a | b\nConstants:\nnear = 0.3\nTransitions:\nCONDITION -> a : [abs(0 - near) < max(1, 2)]\n";
        let (chart, findings) = aseme_models::statechart_of(&yase::Source::new("r.srm", role));
        assert_eq!(findings, []);
        assert!(chart.compile(&Registry::empty().vocabulary().unwrap()).is_ok());
    }

    #[test]
    fn an_unknown_name_is_reported_with_the_nearest() {
        let error = of_two_crates().activity("Kik").err().unwrap();
        assert_eq!((error.kind(), error.hint()), (ErrorKind::UnknownActivity, Some("did you mean `Kick`?")));
        assert_eq!(error.to_string(), "unknown activity `Kik`");
    }

    #[test]
    fn a_name_of_two_crates_needs_the_crate() {
        let registry = of_two_crates();
        let error = registry.activity("Walk").err().unwrap();
        assert_eq!(error.kind(), ErrorKind::AmbiguousActivity);
        assert_eq!(error.to_string(), "activity `Walk` is registered in red::legs and in blue");
        assert_eq!(error.hint(), Some("write `red::Walk`"));
        assert!(registry.activity("red::Walk").is_ok() && registry.activity("blue::Walk").is_ok());
        assert_eq!(registry.activity_names().collect::<Vec<_>>(), ["Kick", "blue::Walk", "red::Walk"]);
    }

    #[test]
    fn a_module_brings_its_names_and_takes_them_with_it() {
        let eyes = || Module::for_test("eyes", &["monas_core"]);
        let with = Registry::empty().with_module(eyes()).unwrap();
        assert!(
            with.activity("RegistryTestStand").is_ok()
                && with.activity("monas_core::RegistryTestStand").is_ok()
        );
        assert_eq!(with.modules().map(Module::name).collect::<Vec<_>>(), ["eyes"]);
        assert!(with.with_module(eyes()).is_ok(), "it may come again");
        let without = with.without_module("eyes");
        assert_eq!((without.activity_names().count(), without.modules().count()), (0, 0));
        let error = with.with_module(Module::for_test("other", &["monas_core"])).err().unwrap();
        assert_eq!(error.kind(), ErrorKind::Module);
        assert!(error.to_string().contains("of module `other` is also in monas_core::"), "{error}");
    }

    #[test]
    fn two_functions_of_one_name_are_refused() {
        let mut registry = Registry::linked();
        let twin = FunctionDeclaration { module: "elsewhere", ..registry.functions["abs"][0] };
        registry.functions.entry("abs".into()).or_default().push(twin);
        let error = registry.functions().err().unwrap();
        assert_eq!(error.kind(), ErrorKind::AmbiguousFunction);
        assert_eq!(
            error.to_string(),
            "function `abs` is registered in monas_core::function and in elsewhere"
        );
    }
}
