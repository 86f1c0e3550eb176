//! Agents and links from elements: Listing 4.17 of the thesis, read with diagnostics.

mod charts;
mod limits;
mod monitors;
mod publishers;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use monas_robot::{
    BodyEnvironment, BodyKind, BodyOption, BodySettings, CameraOutput, Disturbances, FieldColours,
    IMAGE_WIDTHS, OptionKind,
};
use yase::{Diagnostic, Source};

use super::colours;
use super::element::{Attribute, Element};
use super::grammar::{self, Grammar};
use super::layers::Layers;
use super::links::LinkReader;
use super::modules;
use super::paths;
use super::resolve::{resolve, sort};
use super::values::Values;
use super::{poses, urdf};
use monas_core::activity::Activity;
use monas_core::agent::{Agent, FailurePolicy, ListedActivity};
use monas_core::call;
use monas_core::error::ErrorKind;
use monas_core::frequency::Hz;
use monas_core::module::Module;
use monas_core::parameters::Parameters;
use monas_core::registry::Registry;
use monas_link::LinkConfig;

/// The setup of a host from a file.
#[derive(Debug, Default)]
pub struct HostSetup {
    /// The agents that run on it.
    pub agents: Vec<Agent>,
    /// Its links to other processes and hosts.
    pub links: Vec<LinkConfig>,
    /// Its loaded modules; the registry of a run with these agents contains them.
    pub modules: Vec<Module>,
    /// The body that the configuration names.
    pub body: Option<BodySettings>,
    /// The text they were read from.
    pub source: Option<Arc<Source>>,
}

/// Reads the agents and links of a file, with diagnostics of the file and of the models it names.
///
/// A file whose diagnostics hold no [error](Diagnostic::is_error) can be run.
pub fn load(path: impl AsRef<Path>, registry: &Registry) -> (HostSetup, Vec<Diagnostic>) {
    load_with(path, registry, &Layers::new())
}

/// As [`load`], with layers that override the file.
pub fn load_with(
    path: impl AsRef<Path>,
    registry: &Registry,
    layers: &Layers,
) -> (HostSetup, Vec<Diagnostic>) {
    let resolved = resolve(path.as_ref(), &Grammar::agents(), layers);
    let elements = resolved.elements.clone();
    assembled(&elements, path.as_ref(), registry, resolved.into_diagnostics())
}

/// As [`load`], from a text in memory; models are resolved relative to `path`.
pub fn read(source: &Arc<Source>, path: &Path, registry: &Registry) -> (HostSetup, Vec<Diagnostic>) {
    let (elements, diagnostics) = Grammar::agents().read(source);
    assembled(&elements, path, registry, diagnostics)
}

/// As [`read`], for agents of a run: a module that the registry lacks is an error and is not
/// loaded, since loading executes code.
pub fn read_without_loading(
    source: &Arc<Source>,
    path: &Path,
    registry: &Registry,
) -> (HostSetup, Vec<Diagnostic>) {
    let (elements, mut diagnostics) = Grammar::agents().read(source);
    let loading = ModuleLoading::Refused;
    let setup = assemble_with(&elements, path, registry, BodyEnvironment::Own, loading, &mut diagnostics);
    sort(&mut diagnostics);
    (setup, diagnostics)
}

fn assembled(
    elements: &[Element],
    path: &Path,
    registry: &Registry,
    mut diagnostics: Vec<Diagnostic>,
) -> (HostSetup, Vec<Diagnostic>) {
    let setup = assemble(elements, path, registry, BodyEnvironment::Own, &mut diagnostics);
    sort(&mut diagnostics);
    (setup, diagnostics)
}

/// The agents and links described by checked elements, with the errors that the grammar cannot
/// detect, and what the body cannot do in its surroundings; models are resolved relative to `path`.
pub fn assemble(
    elements: &[Element],
    path: &Path,
    registry: &Registry,
    surroundings: BodyEnvironment,
    diagnostics: &mut Vec<Diagnostic>,
) -> HostSetup {
    assemble_with(elements, path, registry, surroundings, ModuleLoading::Allowed, diagnostics)
}

/// Whether modules that the registry lacks are loaded.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ModuleLoading {
    Allowed,
    Refused,
}

fn assemble_with(
    elements: &[Element],
    path: &Path,
    registry: &Registry,
    surroundings: BodyEnvironment,
    loading: ModuleLoading,
    diagnostics: &mut Vec<Diagnostic>,
) -> HostSetup {
    let grammar = Grammar::agents();
    let (registry, setup) = (registry.clone(), HostSetup::default());
    let mut reader = AgentReader { path, registry, loading, grammar: &grammar, diagnostics, setup };
    reader.setup.source = elements.first().map(|element| element.source().clone());
    // Modules are read first: their activities are known to all elements of the file.
    modules::read(&mut reader, elements);
    // Links are read first: activities executed elsewhere are checked against them.
    reader.links(elements);
    reader.body(elements, surroundings);
    reader.agents(elements);
    reader.unpublished(elements);
    reader.limits(elements, surroundings);
    reader.setup
}

pub(crate) struct AgentReader<'a> {
    pub(crate) path: &'a Path,
    /// Including the modules of the file.
    pub(crate) registry: Registry,
    pub(crate) loading: ModuleLoading,
    pub(crate) grammar: &'a Grammar,
    pub(crate) diagnostics: &'a mut Vec<Diagnostic>,
    pub(crate) setup: HostSetup,
}

impl AgentReader<'_> {
    fn links(&mut self, elements: &[Element]) {
        for element in elements {
            if element.is("agents") {
                self.links(element.children());
            } else if element.is("link") {
                let mut reader =
                    LinkReader { path: self.path, grammar: self.grammar, diagnostics: self.diagnostics };
                self.setup.links.extend(reader.link(element));
            }
        }
    }

    fn body(&mut self, elements: &[Element], surroundings: BodyEnvironment) {
        for element in elements {
            if element.is("agents") {
                self.body(element.children(), surroundings);
            } else if element.is("body") {
                if self.setup.body.is_some() {
                    let found = element.error("E0329", element.name_span(), "a robot has one body");
                    self.diagnostics.push(found.with_hint("remove one of the two `body`"));
                }
                let before = self.diagnostics.len();
                let settings = self.body_settings(element);
                if !self.diagnostics[before..].iter().any(Diagnostic::is_error) {
                    self.body_faults(element, &settings, surroundings);
                }
                self.setup.body = Some(settings);
            }
        }
    }

    fn body_settings(&mut self, element: &Element) -> BodySettings {
        let values = Values::of(element, self.grammar);
        let kind = values.text("kind").unwrap_or(BodyKind::DEFAULT).to_owned();
        if let Err(error) = BodyKind::named(&kind) {
            let found = match values.given("kind") {
                Some(given) => given.error("E0328", error.to_string()),
                None => element.error("E0328", element.name_span(), error.to_string()),
            };
            let linked = BodyKind::linked();
            let found = found.with_nearest(&kind, linked.iter().map(|linked| linked.name));
            self.diagnostics.push(match found.hint {
                Some(_) => found,
                None => found.with_hint("link the crate of the body: `use its_name as _;`"),
            });
        }
        let options = self.body_options(&kind, &values);
        let vision = values.word("vision", &CameraOutput::NAMES).unwrap_or_default();
        BodySettings {
            kind,
            options,
            address: values.text("address").map(str::to_owned),
            vision,
            image_width: values
                .given("image_width")
                .and_then(|given| self.image_width(given, &values, vision)),
            colours: values.given("colours").and_then(|given| self.colours(given, vision)),
            disturbances: Disturbances {
                delay: values.duration("delay").unwrap_or_default(),
                noise: values.number("noise").unwrap_or_default(),
                loss: values.number("loss").unwrap_or_default(),
            },
        }
    }

    fn image_width(&mut self, given: &Attribute, values: &Values<'_>, vision: CameraOutput) -> Option<u32> {
        self.check_for_images(given, vision);
        values.word("image_width", &IMAGE_WIDTHS)
    }

    /// Reports an attribute that only images need.
    fn check_for_images(&mut self, given: &Attribute, vision: CameraOutput) {
        if vision != CameraOutput::Images {
            let name = &given.name;
            let message = format!("`body` has `{name}`, which images need, but lacks the attribute `vision`");
            self.diagnostics.push(given.name_error("E0305", message).with_hint("add `vision=\"images\"`"));
        }
    }

    /// The colours in the file that an attribute names; none, with diagnostics, if they are not
    /// usable.
    fn colours(&mut self, given: &Attribute, vision: CameraOutput) -> Option<FieldColours> {
        self.check_for_images(given, vision);
        let file = self.file(given, "`monas vision --calibrate` makes a colour table")?;
        let (colours, found) = colours::load(&file);
        self.diagnostics.extend(found);
        colours
    }

    /// The file that an attribute names; none, with a diagnostic, if there is none.
    fn file(&mut self, given: &Attribute, hint: &str) -> Option<PathBuf> {
        let value = given.value.trim();
        match paths::locate(self.path, value) {
            Ok(found) => Some(found),
            Err(near) => {
                let diagnostic = given.error("E0316", format!("no file `{value}`"));
                self.diagnostics.push(match near {
                    Some(near) => diagnostic.with_hint(format!("did you mean `{near}`?")),
                    None => diagnostic.with_hint(hint),
                });
                None
            }
        }
    }

    /// The options that the kind of the body has; files are found as everywhere in a configuration.
    fn body_options(&mut self, kind: &str, values: &Values<'_>) -> BTreeMap<String, String> {
        // An unknown kind has already been reported.
        let Ok(kind) = BodyKind::named(kind) else { return BTreeMap::new() };
        let mut options = BTreeMap::new();
        for given in values.parameters() {
            let Some(option) = kind.options.iter().find(|option| option.name == given.name) else {
                let message = format!("a body of kind `{}` has no option `{}`", kind.name, given.name);
                let known = kind.options.iter().map(|option| option.name);
                let diagnostic = given.name_error("E0304", message).with_nearest(&given.name, known.clone());
                let names = known.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
                self.diagnostics.push(match (&diagnostic.hint, names.is_empty()) {
                    (Some(_), _) => diagnostic,
                    (None, true) => diagnostic.with_hint("its kind has no options"),
                    (None, false) => diagnostic.with_hint(format!("its options are {names}")),
                });
                continue;
            };
            if let Some(value) = self.option_value(option, given) {
                options.insert(option.name.to_owned(), value);
            }
        }
        options
    }

    /// The value of an option, which has to be of its kind; none, with a diagnostic, otherwise.
    fn option_value(&mut self, option: &BodyOption, given: &Attribute) -> Option<String> {
        let value = given.value.trim();
        if let Err(fault) = option.check(value) {
            let diagnostic = given.error("E0306", fault.message);
            let diagnostic = diagnostic.with_nearest(value, option.kind.words().iter().copied());
            self.diagnostics.push(match diagnostic.hint {
                Some(_) => diagnostic,
                None => diagnostic.with_hint(option.doc),
            });
            return None;
        }
        Some(match option.kind {
            OptionKind::Flag if grammar::flag(value) == Some(true) => "1".to_owned(),
            OptionKind::Flag => "0".to_owned(),
            OptionKind::File => self.file(given, option.doc)?.to_string_lossy().into_owned(),
            OptionKind::Poses(anatomy) => {
                let file = self.file(given, option.doc)?;
                self.diagnostics.extend(poses::load(&file, anatomy()).1);
                file.to_string_lossy().into_owned()
            }
            OptionKind::Anatomy(model) => {
                let file = self.file(given, option.doc)?;
                self.diagnostics.extend(urdf::load_variant(&file, model()).1);
                file.to_string_lossy().into_owned()
            }
            _ => value.to_owned(),
        })
    }

    /// Reports what the kind of the body finds wrong with settings that have no other errors.
    fn body_faults(&mut self, element: &Element, settings: &BodySettings, surroundings: BodyEnvironment) {
        for fault in settings.faults(surroundings) {
            self.diagnostics.push(match element.attribute(fault.attribute) {
                Some(given) => given.error("E0306", fault.message),
                None => element.error("E0306", element.name_span(), fault.message),
            });
        }
    }

    fn agents(&mut self, elements: &[Element]) {
        for element in elements {
            if element.is("agents") {
                self.agents(element.children());
            } else if element.is("agent") {
                self.agent(element);
            } else if element.is("provider") {
                self.provider(element);
            }
        }
    }

    fn agent(&mut self, element: &Element) {
        let name = element.children_named("name").next().map(Element::text).unwrap_or_default();
        let (mut agent, enabled) = self.settings(element, name.to_owned());
        let parts = element.children_named("activity").chain(element.children_named("statechart"));
        let parts: Vec<&Element> = parts.collect();
        if parts.is_empty() && element.children().iter().all(|child| child.is("name")) {
            let message = format!("agent `{}` has no activity and no statechart", agent.name);
            let hint = "give it an `activity`, or a `statechart` that names a model";
            self.diagnostics.push(element.error("E0319", element.name_span(), message).with_hint(hint));
        }
        for part in parts {
            agent =
                if part.is("activity") { self.activity(part, agent) } else { self.statechart(part, agent) };
        }
        for part in element.children_named("monitor") {
            agent = self.monitor(part, agent);
        }
        self.add(element, agent, enabled);
    }

    /// A provider is an agent with one activity of the same name.
    fn provider(&mut self, element: &Element) {
        let name = element.text().to_owned();
        let (agent, enabled) = self.settings(element, name.clone());
        let agent = match self.instance(element, &name, &Parameters::new()) {
            Some(activity) => agent.named_activity(name, activity),
            None => agent,
        };
        self.add(element, agent, enabled);
    }

    /// The attributes of an agent, and whether it is enabled.
    fn settings(&mut self, element: &Element, name: String) -> (Agent, bool) {
        let values = Values::of(element, self.grammar);
        let mut agent = Agent::idle(name);
        agent.frequency = values.number("thread_frequency").map(|hertz: f64| Hz(hertz));
        agent.workers = values.number("workers");
        agent.cores = self.cores(&values);
        let real_time = values.flag("is_real_time").unwrap_or_default();
        let agent = agent
            .urgency(values.number("priority").unwrap_or_default(), real_time)
            .statistics_every(values.number("stats_cycle").unwrap_or_default())
            .on_failure(values.word("on_failure", &FailurePolicy::NAMES).unwrap_or_default());
        (agent, is_enabled(&values))
    }

    /// The CPU cores of its threads.
    fn cores(&mut self, values: &Values<'_>) -> Vec<usize> {
        let Some(given) = values.given("cores") else { return Vec::new() };
        let cores: Result<Vec<usize>, _> = given.value.split_whitespace().map(str::parse).collect();
        cores.unwrap_or_else(|_| {
            let message = format!("`cores` is `{}`, expected numbers of cores, such as `2 3`", given.value);
            self.diagnostics.push(given.error("E0306", message));
            Vec::new()
        })
    }

    fn activity(&mut self, element: &Element, agent: Agent) -> Agent {
        let values = Values::of(element, self.grammar);
        let parameters = parameters(&values);
        let activity = self.instance(element, element.text(), &parameters);
        match activity.filter(|_| is_enabled(&values)) {
            Some(activity) => agent.listed(ListedActivity {
                name: element.text().to_owned(),
                parameters,
                policy: values.word("on_failure", &FailurePolicy::NAMES),
                activity,
            }),
            None => agent,
        }
    }

    /// An activity with its parameters; none, with a diagnostic, if the name is unknown.
    fn instance(
        &mut self,
        element: &Element,
        name: &str,
        parameters: &Parameters,
    ) -> Option<Box<dyn Activity>> {
        if name.is_empty() {
            return None; // which has been said
        }
        match self.registry.activity(name) {
            Ok(mut activity) => {
                call::configure(&mut *activity, parameters);
                self.faults(element, parameters);
                Some(activity)
            }
            Err(error) => {
                let code = if error.kind() == ErrorKind::AmbiguousActivity { "E0313" } else { "E0312" };
                let diagnostic = element.error(code, element.text_span(), error.to_string());
                self.diagnostics.push(match error.hint() {
                    Some(hint) => diagnostic.with_hint(hint),
                    None => diagnostic,
                });
                None
            }
        }
    }

    fn faults(&mut self, element: &Element, parameters: &Parameters) {
        for fault in parameters.faults() {
            let given = element.attributes().iter().find(|attribute| attribute.name == fault.key);
            let message = format!("activity `{}`: {}", element.text(), fault.message);
            let diagnostic = match given {
                Some(attribute) if fault.unknown => attribute.name_error("E0314", message),
                Some(attribute) => attribute.error("E0315", message),
                None => element.error("E0315", element.name_span(), message),
            };
            self.diagnostics.push(match fault.nearest {
                Some(known) => diagnostic.with_hint(format!("did you mean `{known}`?")),
                None => diagnostic,
            });
        }
    }

    fn add(&mut self, element: &Element, agent: Agent, enabled: bool) {
        if agent.frequency.is_none() && !agent.activities.is_empty() {
            let values = Values::of(element, self.grammar);
            if values.given("thread_frequency").is_none() {
                let message = format!("agent `{}` has activities and no `thread_frequency`", agent.name);
                let hint = "add its cycles per second: `thread_frequency=\"10\"`";
                self.diagnostics.push(element.error("E0305", element.name_span(), message).with_hint(hint));
            }
        }
        if enabled {
            self.refuse_namesake(element, &agent.name);
            self.setup.agents.push(agent);
        }
    }

    fn refuse_namesake(&mut self, element: &Element, name: &str) {
        if !name.is_empty() && self.setup.agents.iter().any(|agent| agent.name == name) {
            let named = element.children_named("name").next().unwrap_or(element);
            let message = format!("another agent is named `{name}`");
            let hint = "give each agent of a host a unique name";
            self.diagnostics.push(element.error("E0311", named.text_span(), message).with_hint(hint));
        }
    }
}

/// The parameters of an activity.
fn parameters(values: &Values<'_>) -> Parameters {
    values.parameters().fold(Parameters::new(), |all, one| all.with(&*one.name, &*one.value))
}

/// Whether an element is enabled.
pub(crate) fn is_enabled(values: &Values<'_>) -> bool {
    values.flag("enable").unwrap_or(true)
}
