//! The plan of a change: everything it needs, prepared, or the reasons for its refusal.

use std::path::Path;

use narukom::Timestamp;
use yase::{Diagnostic, Source};

use super::agent_control::AgentControl;
use super::findings::{ChangeRefusal, build_refusal, refusal, refusal_with, unknown};
use super::host_admin::HostAdmin;
use super::module_update::ModuleUpdate;
use super::settings;
use crate::agent_factory::{ChartSite, PreparedAgent, part};
use crate::agent_update::{AgentCommand, AgentStatus, AgentUpdate};
use crate::list::ListEdit;
use monas_core::agent::{ActivityProfile, AgentProfile, ChartProfile, ListedActivity};
use monas_core::binder::Binder;
use monas_core::chart_runner::ModelSwap;
use monas_core::error::Error;
use monas_core::parameters::Parameters;
use monas_core::records::{Action, Change};

/// A validated change.
pub(crate) struct ChangePlan {
    /// Warnings about it.
    pub(crate) warnings: Vec<Diagnostic>,
    pub(crate) step: PlanStep,
}

/// One step of a plan.
pub(crate) enum PlanStep {
    /// Applies an update to an agent, which has this profile afterwards.
    Update(Box<AgentProfile>, Box<AgentUpdate>),
    /// Starts agents.
    Launch(Vec<(AgentProfile, PreparedAgent)>),
    /// Loads, reloads or unloads a module.
    UpdateModules(Box<ModuleUpdate>),
    /// Removes an agent.
    Remove(String),
}

/// The data for the validation of a change.
pub(crate) struct PlanContext<'a> {
    pub(crate) change: &'a Change,
    pub(crate) host: &'a HostAdmin,
    control: &'a dyn AgentControl,
    now: Timestamp,
}

impl ChangePlan {
    /// The plan of a change.
    pub(crate) fn of(
        change: &Change,
        host: &HostAdmin,
        control: &dyn AgentControl,
        now: Timestamp,
    ) -> Result<ChangePlan, ChangeRefusal> {
        let context = PlanContext { change, host, control, now };
        match change.action() {
            action if change.dry_run && action != Action::SwapModel => Err(refusal_with(
                "E0352",
                "this action has no dry run",
                "only the exchange of a model can be judged before it happens",
            )),
            Action::NoAction => Err(refusal("E0350", "the change has no action")),
            Action::AddAgents => context.add_agents(|_| true),
            _ if context.rejects_chart() => Err(refusal_with(
                "E0352",
                "this action is not available for a single statechart",
                "a statechart can be stopped, started, set and exchanged; use the agent for other actions",
            )),
            Action::RemoveAgent => context.agent().map(|profile| PlanStep::Remove(profile.name).into()),
            Action::StartAgent if !change.chart.is_empty() => context.start_chart(),
            Action::StartAgent => context.start(),
            Action::StopAgent if !change.chart.is_empty() => context.stop_chart(),
            Action::StopAgent => {
                context.command_plan(AgentCommand::Stop, &[AgentStatus::Running, AgentStatus::Paused])
            }
            Action::PauseAgent => context.command_plan(AgentCommand::Pause, &[AgentStatus::Running]),
            Action::ResumeAgent => context.command_plan(AgentCommand::Resume, &[AgentStatus::Paused]),
            Action::StepAgent => context.command_plan(AgentCommand::Step, &[AgentStatus::Paused]),
            Action::AddActivity => context.add_activity(),
            Action::RemoveActivity => context.remove_activity(),
            Action::MoveActivity => context.move_activity(),
            Action::ReplaceActivity => context.replace_activity(),
            Action::Set => context.set(),
            Action::RaiseEvent => context.raise(),
            Action::SwapModel => context.swap(),
            Action::LoadModule => context.load_module(),
            Action::UnloadModule => context.unload_module(),
            Action::ReloadModule => context.reload_module(),
        }
    }
}

impl ChangePlan {
    /// In a replay: the plan of a change that adds agents, for those that had been removed.
    pub(crate) fn of_return(
        change: &Change,
        gone: &[String],
        host: &HostAdmin,
        control: &dyn AgentControl,
        now: Timestamp,
    ) -> Result<ChangePlan, ChangeRefusal> {
        PlanContext { change, host, control, now }.add_agents(|name| gone.iter().any(|gone| gone == name))
    }
}

impl From<PlanStep> for ChangePlan {
    fn from(step: PlanStep) -> ChangePlan {
        ChangePlan { warnings: Vec::new(), step }
    }
}

/// The name of a chart in messages.
fn named(profile: &AgentProfile, index: usize) -> String {
    let model = profile.charts.get(index).map_or("", |chart| chart.model.as_str());
    format!("statechart `{model}` of `{}`", profile.name)
}

fn update_plan(profile: AgentProfile, orders: AgentUpdate) -> ChangePlan {
    PlanStep::Update(Box::new(profile), Box::new(orders)).into()
}

impl PlanContext<'_> {
    /// Whether the change names a chart although its action concerns the whole agent.
    fn rejects_chart(&self) -> bool {
        let alone =
            [Action::StartAgent, Action::StopAgent, Action::Set, Action::SwapModel, Action::RaiseEvent];
        !self.change.chart.is_empty() && !alone.contains(&self.change.action())
    }

    /// The profile of the agent that the change names.
    pub(crate) fn agent(&self) -> Result<AgentProfile, ChangeRefusal> {
        let name = &self.change.agent;
        let known = self.host.profiles.iter().find(|profile| profile.name == *name);
        known.cloned().ok_or_else(|| {
            let host = self.host.hub().host();
            let message = format!("no agent of `{host}` is named `{name}`");
            unknown("E0351", message, name, self.host.profiles.iter().map(|profile| profile.name.as_str()))
        })
    }

    /// The plan of a command for an agent with one of these statuses.
    fn command_plan(
        &self,
        directive: AgentCommand,
        from: &[AgentStatus],
    ) -> Result<ChangePlan, ChangeRefusal> {
        let profile = self.agent()?;
        let standing = self.control.status(&profile.name);
        if from.contains(&standing) {
            return Ok(update_plan(profile, AgentUpdate::of([directive])));
        }
        let is = match standing {
            AgentStatus::Running => "runs",
            AgentStatus::Paused => "pauses already",
            AgentStatus::Stopped => "has stopped",
            AgentStatus::Stuck => "is stuck",
        };
        let message = format!("`{}` {is}", profile.name);
        Err(match (directive, standing) {
            (AgentCommand::Resume, AgentStatus::Running) | (AgentCommand::Stop, AgentStatus::Stopped) => {
                refusal("E0352", format!("{message} already"))
            }
            (AgentCommand::Step, AgentStatus::Running) => {
                refusal_with("E0352", message, "only a paused agent can be stepped: pause it first")
            }
            (_, AgentStatus::Stopped) => refusal_with("E0352", message, "start it first"),
            _ => refusal("E0352", message),
        })
    }

    /// Starts a stopped agent from the beginning, from its profile.
    fn start(&self) -> Result<ChangePlan, ChangeRefusal> {
        let profile = self.agent()?;
        if self.control.status(&profile.name) != AgentStatus::Stopped {
            return Err(refusal("E0352", format!("`{}` has not stopped", profile.name)));
        }
        let names = self.names();
        let charts = self.host.factory.rebuild_charts(
            &profile,
            &self.chart_site(&profile, &names),
            &self.host.registry,
        );
        let charts = charts.map_err(|error| build_refusal("E0354", &error))?;
        Ok(update_plan(profile, AgentUpdate { charts, ..AgentUpdate::of([AgentCommand::Start]) }))
    }

    /// Stops one chart of an agent; its list and its other charts continue.
    fn stop_chart(&self) -> Result<ChangePlan, ChangeRefusal> {
        let (profile, index, standing) = self.chart()?;
        if standing == AgentStatus::Stopped {
            return Err(refusal("E0352", format!("{} has stopped already", named(&profile, index))));
        }
        Ok(update_plan(profile, AgentUpdate { only: Some(index), ..AgentUpdate::of([AgentCommand::Stop]) }))
    }

    /// Starts an idle chart of an agent from the beginning.
    fn start_chart(&self) -> Result<ChangePlan, ChangeRefusal> {
        let (profile, index, standing) = self.chart()?;
        if standing != AgentStatus::Stopped {
            return Err(refusal("E0352", format!("{} has not stopped", named(&profile, index))));
        }
        let HostAdmin { factory, registry, .. } = self.host;
        let (names, failed) = (self.names(), |error: Error| build_refusal("E0354", &error));
        let binder = Binder::new(registry).map_err(failed)?;
        let runner = factory.rebuild_chart(&binder, &profile, index, &self.chart_site(&profile, &names));
        let charts = vec![runner.map_err(failed)?];
        Ok(update_plan(
            profile,
            AgentUpdate { charts, only: Some(index), ..AgentUpdate::of([AgentCommand::Start]) },
        ))
    }

    /// Raises an event in the charts of an agent that name it, or in one of them.
    fn raise(&self) -> Result<ChangePlan, ChangeRefusal> {
        let (profile, event) = (self.agent()?, &self.change.event);
        let only = match self.change.chart.as_str() {
            "" => None,
            chart => Some(settings::chart(&profile, chart)?),
        };
        if self.control.status(&profile.name) == AgentStatus::Stopped {
            return Err(refusal_with("E0352", format!("`{}` has stopped", profile.name), "start it first"));
        }
        let known = self.events(&profile, only)?;
        if !known.contains(event) {
            let message =
                format!("no expression of a statechart of `{}` names the event `{event}`", profile.name);
            return Err(unknown("E0366", message, event, known.iter().map(String::as_str)));
        }
        Ok(update_plan(profile, AgentUpdate { events: vec![event.clone()], only, ..AgentUpdate::default() }))
    }

    /// The events named by the charts of an agent, or by one of them.
    fn events(&self, profile: &AgentProfile, only: Option<usize>) -> Result<Vec<String>, ChangeRefusal> {
        let registry = &self.host.registry;
        let binder = Binder::new(registry).map_err(|error| build_refusal("E0354", &error))?;
        let mut known = Vec::new();
        for (index, chart) in profile.charts.iter().enumerate() {
            if only.is_some_and(|only| only != index) {
                continue;
            }
            let generated = registry.chart(&chart.model).filter(|_| chart.is_generated).and_then(Result::ok);
            let compiled = binder.compiled(&chart.statechart, generated.as_ref())?;
            let events = (0..compiled.events().len() as u32).map(yase::expression::EventId);
            known.extend(events.map(|event| compiled.events().name(event).to_owned()));
        }
        known.retain(|name| name != "?");
        Ok(known)
    }

    /// The chart that the change names, of an agent that is not stopped, and the chart's status.
    fn chart(&self) -> Result<(AgentProfile, usize, AgentStatus), ChangeRefusal> {
        let profile = self.agent()?;
        let index = settings::chart(&profile, &self.change.chart)?;
        if self.control.status(&profile.name) == AgentStatus::Stopped {
            let message = format!("`{}` has stopped", profile.name);
            return Err(refusal_with("E0352", message, "start it first, which restarts all its charts"));
        }
        let standing = self.control.chart_status(&profile.name, index);
        Ok((profile, index, standing))
    }

    fn names(&self) -> Vec<String> {
        self.host.profiles.iter().map(|profile| profile.name.clone()).collect()
    }

    fn chart_site<'a>(&'a self, profile: &'a AgentProfile, names: &'a [String]) -> ChartSite<'a> {
        let AgentProfile { name, elsewhere, .. } = profile;
        ChartSite { context: &self.host.context, names, agent: name, elsewhere, now: self.now }
    }

    /// Adds the agents of a text that satisfy a condition.
    fn add_agents(&self, is_wanted: impl Fn(&str) -> bool) -> Result<ChangePlan, ChangeRefusal> {
        let file = if self.change.file.is_empty() { "agents.xml" } else { &self.change.file };
        let source = Source::new(file, self.change.text.clone());
        let (setup, diagnostics) =
            monas_config::read_without_loading(&source, Path::new(file), &self.host.registry);
        if diagnostics.iter().any(Diagnostic::is_error) {
            return Err(diagnostics);
        }
        if !setup.links.is_empty() {
            let message = "links are opened at the start of a run and cannot be added later";
            return Err(vec![Diagnostic::error("E0358", 0..0, message).in_source(&source)]);
        }
        if setup.agents.is_empty() {
            return Err(vec![Diagnostic::error("E0358", 0..0, "the text holds no agent").in_source(&source)]);
        }
        let mut names = self.names();
        if let Some(agent) = setup.agents.iter().find(|agent| names.contains(&agent.name)) {
            let message = format!("another agent is named `{}`", agent.name);
            return Err(refusal_with("E0311", message, "give each agent of a host a unique name"));
        }
        names.extend(setup.agents.iter().map(|agent| agent.name.clone()));
        let HostAdmin { factory, context: ground, registry, .. } = self.host;
        let failed = |error: Error| build_refusal("E0354", &error);
        let binder = Binder::new(registry).map_err(failed)?;
        let wanted = setup.agents.into_iter().filter(|agent| is_wanted(&agent.name));
        let members = wanted.map(|agent| {
            let profile = AgentProfile::of(&agent);
            Ok((profile, factory.prepare_agent(&binder, agent, ground, &names, self.now).map_err(failed)?))
        });
        let members = members.collect::<Result<Vec<_>, ChangeRefusal>>()?;
        Ok(ChangePlan { warnings: diagnostics, step: PlanStep::Launch(members) })
    }

    fn add_activity(&self) -> Result<ChangePlan, ChangeRefusal> {
        let profile = self.agent()?;
        let listed = self.listed(&self.change.activity)?;
        let count = profile.activities.len();
        let index = self.position(count + 1, count)?;
        let (profile, orders) = self.with_new_activity(profile, index, vec![listed])?;
        Ok(update_plan(profile, orders))
    }

    /// The profile of an agent with more activities in its list from an index on, and the update
    /// for it.
    pub(crate) fn with_new_activity(
        &self,
        mut profile: AgentProfile,
        index: usize,
        more: Vec<ListedActivity>,
    ) -> Result<(AgentProfile, AgentUpdate), ChangeRefusal> {
        let added = more.iter().map(ActivityProfile::of);
        profile.activities.splice(index..index, added.collect::<Vec<_>>());
        if self.control.has_list(&profile.name) {
            let edits = (index..).zip(more).map(|(position, listed)| ListEdit::Insert(position, listed));
            let edits = edits.collect();
            return Ok((profile, AgentUpdate { edits, ..AgentUpdate::default() }));
        }
        if profile.frequency.is_none() {
            let message = format!("the list of `{}` has no frequency", profile.name);
            return Err(refusal_with("E0305", message, "set its `frequency` first"));
        }
        let HostAdmin { factory, context: ground, .. } = self.host;
        let part = part(profile.charts.len());
        let list = Box::new(factory.list((&profile.name, part), profile.policy, more, &ground.hub));
        Ok((profile, AgentUpdate { list: Some(list), ..AgentUpdate::default() }))
    }

    fn remove_activity(&self) -> Result<ChangePlan, ChangeRefusal> {
        let mut profile = self.agent()?;
        let index = self.activity(&profile)?;
        profile.activities.remove(index);
        Ok(self.edited(profile, ListEdit::Remove(index)))
    }

    fn move_activity(&self) -> Result<ChangePlan, ChangeRefusal> {
        let mut profile = self.agent()?;
        let from = self.activity(&profile)?;
        let count = profile.activities.len();
        let to = self.position(count, count - 1)?;
        let activity = profile.activities.remove(from);
        profile.activities.insert(to, activity);
        Ok(self.edited(profile, ListEdit::Move(from, to)))
    }

    fn replace_activity(&self) -> Result<ChangePlan, ChangeRefusal> {
        let mut profile = self.agent()?;
        let index = self.activity(&profile)?;
        let listed = self.listed(&self.change.replacement)?;
        profile.activities[index] = ActivityProfile::of(&listed);
        Ok(self.edited(profile, ListEdit::Replace(index, listed)))
    }

    fn edited(&self, profile: AgentProfile, edit: ListEdit) -> ChangePlan {
        update_plan(profile, AgentUpdate { edits: vec![edit], ..AgentUpdate::default() })
    }

    /// Index in the list of the activity that the change names, from 0.
    fn activity(&self, profile: &AgentProfile) -> Result<usize, ChangeRefusal> {
        settings::activity(profile, &self.change.activity)
    }

    /// The requested index among `count`, from 0; `otherwise` if none is requested.
    fn position(&self, count: usize, otherwise: usize) -> Result<usize, ChangeRefusal> {
        match self.change.place as usize {
            0 => Ok(otherwise),
            place if place <= count => Ok(place - 1),
            index => Err(refusal("E0353", format!("there is no place {index}: places are 1 to {count}"))),
        }
    }

    /// A new activity with the parameters of the change.
    fn listed(&self, name: &str) -> Result<ListedActivity, ChangeRefusal> {
        let given = &self.change.settings;
        let parameters = given.iter().fold(Parameters::new(), |all, one| all.with(&one.key, &one.value));
        let activity = settings::instance(&self.host.registry, name, &parameters)?;
        Ok(ListedActivity { name: name.to_owned(), parameters, policy: None, activity })
    }

    fn set(&self) -> Result<ChangePlan, ChangeRefusal> {
        let mut profile = self.agent()?;
        let Change { settings, chart, .. } = self.change;
        let orders = settings::set(&mut profile, settings, chart, &self.host.registry)?;
        Ok(update_plan(profile, orders))
    }

    fn swap(&self) -> Result<ChangePlan, ChangeRefusal> {
        let mut profile = self.agent()?;
        if self.control.status(&profile.name) == AgentStatus::Stopped {
            let message = format!("`{}` has stopped", profile.name);
            return Err(refusal_with("E0352", message, "start it first: a model is swapped while it runs"));
        }
        let index = settings::chart(&profile, &self.change.chart)?;
        let Change { file, text, states, accept_losses, .. } = self.change;
        let factory = &self.host.factory;
        let failed = |error: Error| build_refusal("E0355", &error);
        let binder = Binder::new(&self.host.registry).map_err(failed)?;
        let (bound, warnings) = match text.is_empty() {
            true => (factory.generated(&binder, file, profile.semantics).map_err(failed)?, Vec::new()),
            false => {
                let source = Source::new(file, text.clone());
                let (chart, diagnostics) = aseme_models::statechart_of(&source);
                if diagnostics.iter().any(Diagnostic::is_error) {
                    return Err(diagnostics);
                }
                (binder.bind(&chart, None, profile.semantics, Some(&source))?, diagnostics)
            }
        };
        let statechart = bound.chart.statechart().clone();
        let names = self.names();
        let own = profile.charts[index].settings.clone();
        let bound = factory.fitting(bound, &own, &self.chart_site(&profile, &names)).map_err(failed)?;
        let (model, is_generated) = (file.clone(), text.is_empty());
        let compiled = (!is_generated).then(|| binder.model(&bound));
        profile.charts[index] = ChartProfile { model, statechart, compiled, is_generated, settings: own };
        let states = states.iter().map(|state| (state.key.clone(), state.value.clone())).collect();
        let of_agent = Some((&profile.property_sets[..], profile.name.as_str(), profile.charts.len()));
        let monitors =
            binder.monitors(of_agent, &profile.charts[index].settings.property_sets, &bound.chart)?;
        let swap = Box::new(ModelSwap {
            bound,
            states,
            accepts_losses: *accept_losses,
            is_dry_run: self.change.dry_run,
            monitors,
        });
        Ok(ChangePlan {
            warnings,
            ..update_plan(profile, AgentUpdate { swap: Some((index, swap)), ..AgentUpdate::default() })
        })
    }
}
