//! Modules that are loaded into a run, replaced and unloaded.

use std::path::Path;

use super::change_plan::{ChangePlan, PlanContext, PlanStep};
use super::findings::{ChangeRefusal, build_refusal, refusal_with, unknown};
use super::host_admin::HostAdmin;
use super::settings;
use crate::agent_update::{ActivityInstances, AgentUpdate};
use crate::list::ListEdit;
use monas_core::agent::{ActivityProfile, AgentProfile, ChartProfile, ListedActivity};
use monas_core::module::Module;
use monas_core::parameters::Parameters;
use monas_core::records::ModuleEntry;
use monas_core::registry::{Registry, both_names};
use monas_module::ModuleFile;

/// The new registry, and the updates of the affected agents.
pub(crate) struct ModuleUpdate {
    pub(crate) registry: Registry,
    pub(crate) updates: Vec<(AgentProfile, AgentUpdate)>,
}

impl PlanContext<'_> {
    /// Loads a new module; an agent that is named receives all its activities.
    pub(crate) fn load_module(&self) -> Result<ChangePlan, ChangeRefusal> {
        let file = self.module_file(Path::new(&self.change.file))?;
        let name = file.note().module();
        if self.host.registry.module(name).is_some() {
            let hint = format!("replace it by `monas module reload {name} FILE`");
            return Err(refusal_with("E0365", format!("module `{name}` is loaded already"), hint));
        }
        let meant = if self.change.agent.is_empty() { None } else { Some(self.agent()?) };
        let module = file.load()?;
        let registry = self.with_module(&module)?;
        let updates = meant.map(|profile| {
            let index = profile.activities.len();
            let listed = module.activity_names().map(|name| {
                listed(
                    &registry,
                    &ActivityProfile { name: name.into(), parameters: Parameters::new(), policy: None },
                )
            });
            self.with_new_activity(profile, index, listed.collect::<Result<_, _>>()?)
        });
        let updates = updates.transpose()?.into_iter().collect();
        Ok(PlanStep::UpdateModules(Box::new(ModuleUpdate { registry, updates })).into())
    }

    /// Removes the activities of a module from the lists of all agents.
    pub(crate) fn unload_module(&self) -> Result<ChangePlan, ChangeRefusal> {
        let module = self.module()?;
        let mut updates = Vec::new();
        for profile in &self.host.profiles {
            if let Some(chart) =
                profile.charts.iter().find(|chart| !states(chart, profile, module).is_empty())
            {
                let message = format!(
                    "the statechart `{}` of `{}` needs activities of module `{}`",
                    chart.model,
                    profile.name,
                    module.name()
                );
                let hint = "change the agent's model or remove it first";
                return Err(refusal_with("E0365", message, hint));
            }
            let indices = activity_indices(profile, module);
            if indices.is_empty() {
                continue;
            }
            let mut without = profile.clone();
            // From the last index on, so that the other indices stay valid.
            let edits = indices.into_iter().rev().map(|index| {
                without.activities.remove(index);
                ListEdit::Remove(index)
            });
            let edits = edits.collect();
            updates.push((without, AgentUpdate { edits, ..AgentUpdate::default() }));
        }
        let registry = self.host.registry.without_module(module.name());
        Ok(PlanStep::UpdateModules(Box::new(ModuleUpdate { registry, updates })).into())
    }

    /// Replaces a module by one of the same name: all agents continue with new instances of its
    /// activities. Every step that can fail happens here, while they continue with the old ones.
    pub(crate) fn reload_module(&self) -> Result<ChangePlan, ChangeRefusal> {
        let old = self.module()?;
        let path = if self.change.file.is_empty() { old.file() } else { Path::new(&self.change.file) };
        let file = self.module_file(path)?;
        if file.note().module() != old.name() {
            let message =
                format!("{} holds module `{}`, not `{}`", path.display(), file.note().module(), old.name());
            return Err(refusal_with("E0365", message, "a module with another name is loaded separately"));
        }
        let new = file.load()?;
        let registry = self.with_module(&new)?;
        let mut updates = Vec::new();
        for profile in &self.host.profiles {
            let orders = instance_update(profile, old, &registry)?;
            if !orders.edits.is_empty() || !orders.instances.is_empty() {
                updates.push((profile.clone(), orders));
            }
        }
        Ok(PlanStep::UpdateModules(Box::new(ModuleUpdate { registry, updates })).into())
    }

    /// The module that the change names.
    fn module(&self) -> Result<&Module, ChangeRefusal> {
        let (name, registry) = (&self.change.module, &self.host.registry);
        registry.module(name).ok_or_else(|| {
            let message = format!("no module `{name}` is loaded");
            unknown("E0365", message, name, registry.modules().map(Module::name))
        })
    }

    /// Reads the file that the change names and verifies its digest, if the change has one.
    fn module_file(&self, path: &Path) -> Result<ModuleFile, ChangeRefusal> {
        let file = ModuleFile::read(path)?;
        file.check()?;
        let (found, meant) = (file.digest(), &self.change.digest);
        if meant.is_empty() || *meant == found {
            return Ok(file);
        }
        let message =
            format!("{} is not the requested file: its hash is {found}, not {meant}", path.display());
        Err(refusal_with("E0365", message, "restore the file, or repeat the request for the current one"))
    }

    fn with_module(&self, module: &Module) -> Result<Registry, ChangeRefusal> {
        self.host.registry.with_module(module.clone()).map_err(|error| build_refusal("E0364", &error))
    }
}

/// The update that gives an agent new instances of the activities of a module.
fn instance_update(
    profile: &AgentProfile,
    module: &Module,
    registry: &Registry,
) -> Result<AgentUpdate, ChangeRefusal> {
    let edits = activity_indices(profile, module).into_iter().map(|index| {
        Ok::<_, ChangeRefusal>(ListEdit::Replace(index, listed(registry, &profile.activities[index])?))
    });
    let edits = edits.collect::<Result<_, _>>()?;
    let mut instances: Vec<(usize, ActivityInstances)> = Vec::new();
    for (position, chart) in profile.charts.iter().enumerate() {
        let states = states(chart, profile, module).into_iter().map(|(node, name)| {
            Ok::<_, ChangeRefusal>((
                node,
                settings::instance(registry, &name, &chart.settings.parameters(&name))?,
            ))
        });
        let states = states.collect::<Result<ActivityInstances, _>>()?;
        if !states.is_empty() {
            instances.push((position, states));
        }
    }
    Ok(AgentUpdate { edits, instances, ..AgentUpdate::default() })
}

/// A new instance of a list's activity, with the parameters set for it.
fn listed(registry: &Registry, known: &ActivityProfile) -> Result<ListedActivity, ChangeRefusal> {
    let ActivityProfile { name, parameters, policy } = known.clone();
    let activity = settings::instance(registry, &name, &parameters)?;
    Ok(ListedActivity { name, parameters, policy, activity })
}

/// The indices of a module's activities in an agent's list.
fn activity_indices(profile: &AgentProfile, module: &Module) -> Vec<usize> {
    let indices = profile.activities.iter().enumerate();
    indices.filter(|(_, activity)| is_activity_of(module, &activity.name)).map(|(index, _)| index).collect()
}

/// The states of a chart whose activities belong to a module, with the names of these. Activities
/// of a generated chart are compiled into it.
fn states(chart: &ChartProfile, profile: &AgentProfile, module: &Module) -> Vec<(yase::NodeId, String)> {
    if chart.is_generated {
        return Vec::new();
    }
    let named = chart.statechart.nodes().filter_map(|(id, node)| Some((id, node.activity.as_deref()?)));
    let elsewhere = || profile.elsewhere.iter().chain(&chart.settings.elsewhere);
    let own =
        named.filter(|(_, name)| is_activity_of(module, name) && !elsewhere().any(|other| other == name));
    own.map(|(id, name)| (id, name.to_owned())).collect()
}

/// Whether a name refers to an activity of a module.
fn is_activity_of(module: &Module, name: &str) -> bool {
    module
        .activities()
        .any(|activity| both_names(activity.name, activity.module).iter().any(|own| own == name))
}

/// The entry of a module in a status reply.
pub(crate) fn entry(module: &Module, admin: &HostAdmin) -> ModuleEntry {
    let uses = |profile: &&AgentProfile| {
        !activity_indices(profile, module).is_empty()
            || profile.charts.iter().any(|chart| !states(chart, profile, module).is_empty())
    };
    ModuleEntry {
        host: admin.hub().host().into(),
        name: module.name().into(),
        file: module.file().display().to_string(),
        digest: module.digest().into(),
        package: module.note().field("package").unwrap_or_default().into(),
        activities: module.activity_names().map(str::to_owned).collect(),
        agents: admin.profiles.iter().filter(uses).map(|profile| profile.name.clone()).collect(),
    }
}
