//! Modules that are loaded into a run, exchanged and taken out of it.

use std::path::Path;

use super::findings::{Refusal, refusal_with, unknown, unusable};
use super::plan::{Desk, Plan, Step};
use super::roster::Roster;
use super::settings;
use crate::agent::{ActivityProfile, ChartProfile, Listed, Profile};
use crate::list::ListEdit;
use crate::module::{Module, ModuleFile};
use crate::parameters::Parameters;
use crate::records::ModuleEntry;
use crate::registry::{Registry, both_names};
use crate::talws::orders::{Instances, Orders};

/// What agents are made of from now on, and what those are told that notice.
pub(super) struct Equipment {
    pub(super) registry: Registry,
    pub(super) told: Vec<(Profile, Orders)>,
}

impl Desk<'_> {
    /// A module that was not there comes; an agent that is named gets all its activities.
    pub(super) fn load_module(&self) -> Result<Plan, Refusal> {
        let file = self.module_file(Path::new(&self.change.file))?;
        let name = file.note().module();
        if self.roster.registry.module(name).is_some() {
            let hint = format!("`monas module reload {name} FILE` puts another file in its place");
            return Err(refusal_with("E0365", format!("module `{name}` is loaded already"), hint));
        }
        let meant = if self.change.agent.is_empty() { None } else { Some(self.agent()?) };
        let module = file.load()?;
        let registry = self.with_module(&module)?;
        let told = meant.map(|profile| {
            let place = profile.activities.len();
            let listed = module.activity_names().map(|name| {
                listed(
                    &registry,
                    &ActivityProfile { name: name.into(), parameters: Parameters::new(), policy: None },
                )
            });
            self.enlisted(profile, place, listed.collect::<Result<_, _>>()?)
        });
        let told = told.transpose()?.into_iter().collect();
        Ok(Step::Equip(Box::new(Equipment { registry, told })).into())
    }

    /// The activities of a module leave the lists of all agents.
    pub(super) fn unload_module(&self) -> Result<Plan, Refusal> {
        let module = self.module()?;
        let mut told = Vec::new();
        for profile in &self.roster.profiles {
            if let Some(chart) =
                profile.charts.iter().find(|chart| !states(chart, profile, module).is_empty())
            {
                let message = format!(
                    "the statechart `{}` of `{}` needs activities of module `{}`",
                    chart.model,
                    profile.name,
                    module.name()
                );
                let hint = "have the agent take another model, or remove it, first";
                return Err(refusal_with("E0365", message, hint));
            }
            let places = places(profile, module);
            if places.is_empty() {
                continue;
            }
            let mut without = profile.clone();
            // From the last on, so that the places of the others stay what they are.
            let edits = places.into_iter().rev().map(|place| {
                without.activities.remove(place);
                ListEdit::Remove(place)
            });
            let edits = edits.collect();
            told.push((without, Orders { edits, ..Orders::default() }));
        }
        let registry = self.roster.registry.without_module(module.name());
        Ok(Step::Equip(Box::new(Equipment { registry, told })).into())
    }

    /// A module takes the place of one of its name: all agents go on with new instances of its activities. Whatever can fail does so here,
    /// while they go on with the old ones.
    pub(super) fn reload_module(&self) -> Result<Plan, Refusal> {
        let old = self.module()?;
        let path = if self.change.file.is_empty() { old.file() } else { Path::new(&self.change.file) };
        let file = self.module_file(path)?;
        if file.note().module() != old.name() {
            let message =
                format!("{} holds module `{}`, not `{}`", path.display(), file.note().module(), old.name());
            return Err(refusal_with("E0365", message, "a module that has another name is loaded beside it"));
        }
        let new = file.load()?;
        let registry = self.with_module(&new)?;
        let mut told = Vec::new();
        for profile in &self.roster.profiles {
            let orders = renewed(profile, old, &registry)?;
            if !orders.edits.is_empty() || !orders.instances.is_empty() {
                told.push((profile.clone(), orders));
            }
        }
        Ok(Step::Equip(Box::new(Equipment { registry, told })).into())
    }

    /// The module that is meant.
    fn module(&self) -> Result<&Module, Refusal> {
        let (name, registry) = (&self.change.module, &self.roster.registry);
        registry.module(name).ok_or_else(|| {
            let message = format!("no module `{name}` is loaded");
            unknown("E0365", message, name, registry.modules().map(Module::name))
        })
    }

    /// The file that is meant: in a replay the same that it was.
    fn module_file(&self, path: &Path) -> Result<ModuleFile, Refusal> {
        let file = ModuleFile::read(path)?;
        file.check()?;
        let (found, meant) = (file.digest(), &self.change.digest);
        if meant.is_empty() || *meant == found {
            return Ok(file);
        }
        let message =
            format!("{} is another file than was meant: its hash is {found}, not {meant}", path.display());
        Err(refusal_with(
            "E0365",
            message,
            "put the file there that it was, or ask again for the one that is there",
        ))
    }

    fn with_module(&self, module: &Module) -> Result<Registry, Refusal> {
        self.roster.registry.with_module(module.clone()).map_err(|error| unusable("E0364", &error))
    }
}

/// What an agent is told that is to go on with new instances of the activities of a module.
fn renewed(profile: &Profile, module: &Module, registry: &Registry) -> Result<Orders, Refusal> {
    let edits = places(profile, module).into_iter().map(|place| {
        Ok::<_, Refusal>(ListEdit::Replace(place, listed(registry, &profile.activities[place])?))
    });
    let edits = edits.collect::<Result<_, _>>()?;
    let mut instances: Vec<(usize, Instances)> = Vec::new();
    for (place, chart) in profile.charts.iter().enumerate() {
        let states = states(chart, profile, module).into_iter().map(|(node, name)| {
            Ok::<_, Refusal>((node, settings::instance(registry, &name, &chart.own.parameters(&name))?))
        });
        let states = states.collect::<Result<Instances, _>>()?;
        if !states.is_empty() {
            instances.push((place, states));
        }
    }
    Ok(Orders { edits, instances, ..Orders::default() })
}

/// A new instance of an activity of a list, with what was set of it.
fn listed(registry: &Registry, known: &ActivityProfile) -> Result<Listed, Refusal> {
    let ActivityProfile { name, parameters, policy } = known.clone();
    let activity = settings::instance(registry, &name, &parameters)?;
    Ok(Listed { name, parameters, policy, activity })
}

/// The places in an agent's list that a module's activities have.
fn places(profile: &Profile, module: &Module) -> Vec<usize> {
    let places = profile.activities.iter().enumerate();
    places.filter(|(_, activity)| has(module, &activity.name)).map(|(place, _)| place).collect()
}

/// The states of a chart whose activities are a module's, with their names. What a generated chart calls it was built with.
fn states(chart: &ChartProfile, profile: &Profile, module: &Module) -> Vec<(yase::NodeId, String)> {
    if chart.is_generated {
        return Vec::new();
    }
    let named = chart.statechart.nodes().filter_map(|(id, node)| Some((id, node.activity.as_deref()?)));
    let elsewhere = || profile.elsewhere.iter().chain(&chart.own.elsewhere);
    let own = named.filter(|(_, name)| has(module, name) && !elsewhere().any(|other| other == name));
    own.map(|(id, name)| (id, name.to_owned())).collect()
}

/// Whether a name means an activity of a module.
fn has(module: &Module, name: &str) -> bool {
    module
        .activities()
        .any(|activity| both_names(activity.name, activity.module).iter().any(|own| own == name))
}

/// A module as it is told.
pub(super) fn entry(module: &Module, roster: &Roster) -> ModuleEntry {
    let uses = |profile: &&Profile| {
        !places(profile, module).is_empty()
            || profile.charts.iter().any(|chart| !states(chart, profile, module).is_empty())
    };
    ModuleEntry {
        host: roster.hub().host().into(),
        name: module.name().into(),
        file: module.file().display().to_string(),
        digest: module.digest().into(),
        package: module.note().field("package").unwrap_or_default().into(),
        activities: module.activity_names().map(str::to_owned).collect(),
        agents: roster.profiles.iter().filter(uses).map(|profile| profile.name.clone()).collect(),
    }
}
