//! What a change comes to: everything it needs, made ready, or why it cannot be made.

use std::path::Path;

use narukom::Moment;
use yase::{Diagnostic, Source};

use super::findings::{Refusal, refusal, refusal_with, unknown, unusable};
use super::modules::Equipment;
use super::roster::Roster;
use super::settings;
use super::staff::Staff;
use crate::agent::{ActivityProfile, ChartProfile, Listed, Profile};
use crate::binder::Binder;
use crate::chart::Swap;
use crate::config;
use crate::error::Error;
use crate::list::ListEdit;
use crate::parameters::Parameters;
use crate::records::{Action, Change};
use crate::talws::crew::{Member, Place, part};
use crate::talws::orders::{Directive, Orders, Standing};

/// A change that can be made.
pub(super) struct Plan {
    /// What is odd about it.
    pub(super) warnings: Vec<Diagnostic>,
    pub(super) step: Step,
}

/// What is to be done.
pub(super) enum Step {
    /// An agent is told something, and is made of this then.
    Tell(Box<Profile>, Box<Orders>),
    /// Agents begin.
    Launch(Vec<(Profile, Member)>),
    /// A module comes or goes.
    Equip(Box<Equipment>),
    /// An agent leaves.
    Dismiss(String),
}

/// What a change is held against.
pub(super) struct Desk<'a> {
    pub(super) change: &'a Change,
    pub(super) roster: &'a Roster,
    staff: &'a dyn Staff,
    now: Moment,
}

impl Plan {
    /// What a change comes to.
    pub(super) fn of(
        change: &Change,
        roster: &Roster,
        staff: &dyn Staff,
        now: Moment,
    ) -> Result<Plan, Refusal> {
        let desk = Desk { change, roster, staff, now };
        match change.action() {
            Action::NoAction => Err(refusal("E0350", "the change does not say what is to be done")),
            Action::AddAgents => desk.add_agents(|_| true),
            _ if desk.is_of_no_chart() => Err(refusal_with(
                "E0352",
                "a statechart alone cannot be told that",
                "one can be stopped, started, set and swapped; the rest is for its agent",
            )),
            Action::RemoveAgent => desk.agent().map(|profile| Step::Dismiss(profile.name).into()),
            Action::StartAgent if !change.chart.is_empty() => desk.start_chart(),
            Action::StartAgent => desk.start(),
            Action::StopAgent if !change.chart.is_empty() => desk.stop_chart(),
            Action::StopAgent => desk.direct(Directive::Stop, &[Standing::Runs, Standing::Pauses]),
            Action::PauseAgent => desk.direct(Directive::Pause, &[Standing::Runs]),
            Action::ResumeAgent => desk.direct(Directive::Resume, &[Standing::Pauses]),
            Action::StepAgent => desk.direct(Directive::Step, &[Standing::Pauses]),
            Action::AddActivity => desk.add_activity(),
            Action::RemoveActivity => desk.remove_activity(),
            Action::MoveActivity => desk.move_activity(),
            Action::ReplaceActivity => desk.replace_activity(),
            Action::Set => desk.set(),
            Action::RaiseEvent => desk.raise(),
            Action::SwapModel => desk.swap(),
            Action::LoadModule => desk.load_module(),
            Action::UnloadModule => desk.unload_module(),
            Action::ReloadModule => desk.reload_module(),
        }
    }
}

impl Plan {
    /// In a replay: what a change that adds agents comes to for those that had left.
    pub(super) fn of_return(
        change: &Change,
        gone: &[String],
        roster: &Roster,
        staff: &dyn Staff,
        now: Moment,
    ) -> Result<Plan, Refusal> {
        Desk { change, roster, staff, now }.add_agents(|name| gone.iter().any(|gone| gone == name))
    }
}

impl From<Step> for Plan {
    fn from(step: Step) -> Plan {
        Plan { warnings: Vec::new(), step }
    }
}

/// A chart as it is spoken of.
fn named(profile: &Profile, place: usize) -> String {
    let model = profile.charts.get(place).map_or("", |chart| chart.model.as_str());
    format!("statechart `{model}` of `{}`", profile.name)
}

fn tell(profile: Profile, orders: Orders) -> Plan {
    Step::Tell(Box::new(profile), Box::new(orders)).into()
}

impl Desk<'_> {
    /// Whether a chart is named for something that concerns agents as a whole.
    fn is_of_no_chart(&self) -> bool {
        let alone =
            [Action::StartAgent, Action::StopAgent, Action::Set, Action::SwapModel, Action::RaiseEvent];
        !self.change.chart.is_empty() && !alone.contains(&self.change.action())
    }

    /// What the agent that is meant is made of.
    pub(super) fn agent(&self) -> Result<Profile, Refusal> {
        let name = &self.change.agent;
        let known = self.roster.profiles.iter().find(|profile| profile.name == *name);
        known.cloned().ok_or_else(|| {
            let host = self.roster.hub().host();
            let message = format!("no agent of `{host}` is named `{name}`");
            unknown("E0351", message, name, self.roster.profiles.iter().map(|profile| profile.name.as_str()))
        })
    }

    /// Tells an agent that stands like this.
    fn direct(&self, directive: Directive, from: &[Standing]) -> Result<Plan, Refusal> {
        let profile = self.agent()?;
        let standing = self.staff.standing(&profile.name);
        if from.contains(&standing) {
            return Ok(tell(profile, Orders::of([directive])));
        }
        let is = match standing {
            Standing::Runs => "runs",
            Standing::Pauses => "pauses already",
            Standing::Stopped => "has stopped",
            Standing::Stuck => "is stuck",
        };
        let message = format!("`{}` {is}", profile.name);
        Err(match (directive, standing) {
            (Directive::Resume, Standing::Runs) | (Directive::Stop, Standing::Stopped) => {
                refusal("E0352", format!("{message} already"))
            }
            (Directive::Step, Standing::Runs) => {
                refusal_with("E0352", message, "one that pauses can be stepped: pause it first")
            }
            (_, Standing::Stopped) => refusal_with("E0352", message, "start it first"),
            _ => refusal("E0352", message),
        })
    }

    /// A stopped agent begins anew: what it is made of has not been forgotten.
    fn start(&self) -> Result<Plan, Refusal> {
        let profile = self.agent()?;
        if self.staff.standing(&profile.name) != Standing::Stopped {
            return Err(refusal("E0352", format!("`{}` has not stopped", profile.name)));
        }
        let names = self.names();
        let charts =
            self.roster.crew.charts_anew(&profile, &self.place(&profile, &names), &self.roster.registry);
        let charts = charts.map_err(|error| unusable("E0354", &error))?;
        Ok(tell(profile, Orders { charts, ..Orders::of([Directive::Start]) }))
    }

    /// One of an agent's charts becomes idle; its list and its other charts go on.
    fn stop_chart(&self) -> Result<Plan, Refusal> {
        let (profile, place, standing) = self.chart()?;
        if standing == Standing::Stopped {
            return Err(refusal("E0352", format!("{} has stopped already", named(&profile, place))));
        }
        Ok(tell(profile, Orders { only: Some(place), ..Orders::of([Directive::Stop]) }))
    }

    /// One of an agent's charts that is idle begins anew.
    fn start_chart(&self) -> Result<Plan, Refusal> {
        let (profile, place, standing) = self.chart()?;
        if standing != Standing::Stopped {
            return Err(refusal("E0352", format!("{} has not stopped", named(&profile, place))));
        }
        let Roster { crew, registry, .. } = self.roster;
        let (names, failed) = (self.names(), |error: Error| unusable("E0354", &error));
        let binder = Binder::new(registry).map_err(failed)?;
        let runner = crew.chart_anew(&binder, &profile, place, &self.place(&profile, &names));
        let charts = vec![runner.map_err(failed)?];
        Ok(tell(profile, Orders { charts, only: Some(place), ..Orders::of([Directive::Start]) }))
    }

    /// An event comes to the charts of an agent that name it, or to one of them.
    fn raise(&self) -> Result<Plan, Refusal> {
        let (profile, event) = (self.agent()?, &self.change.event);
        let only = match self.change.chart.as_str() {
            "" => None,
            chart => Some(settings::chart(&profile, chart)?),
        };
        if self.staff.standing(&profile.name) == Standing::Stopped {
            return Err(refusal_with("E0352", format!("`{}` has stopped", profile.name), "start it first"));
        }
        let known = self.events(&profile, only)?;
        if !known.contains(event) {
            let message =
                format!("no expression of a statechart of `{}` names the event `{event}`", profile.name);
            return Err(unknown("E0366", message, event, known.iter().map(String::as_str)));
        }
        Ok(tell(profile, Orders { events: vec![event.clone()], only, ..Orders::default() }))
    }

    /// The events that charts name, of an agent or of one of them.
    fn events(&self, profile: &Profile, only: Option<usize>) -> Result<Vec<String>, Refusal> {
        let registry = &self.roster.registry;
        let binder = Binder::new(registry).map_err(|error| unusable("E0354", &error))?;
        let mut known = Vec::new();
        for (place, chart) in profile.charts.iter().enumerate() {
            if only.is_some_and(|only| only != place) {
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

    /// The chart that is meant, of an agent that has not stopped, and whether it does anything.
    fn chart(&self) -> Result<(Profile, usize, Standing), Refusal> {
        let profile = self.agent()?;
        let place = settings::chart(&profile, &self.change.chart)?;
        if self.staff.standing(&profile.name) == Standing::Stopped {
            let message = format!("`{}` has stopped", profile.name);
            return Err(refusal_with("E0352", message, "start it first: all its charts begin anew then"));
        }
        let standing = self.staff.standing_of_chart(&profile.name, place);
        Ok((profile, place, standing))
    }

    fn names(&self) -> Vec<String> {
        self.roster.profiles.iter().map(|profile| profile.name.clone()).collect()
    }

    fn place<'a>(&'a self, profile: &'a Profile, names: &'a [String]) -> Place<'a> {
        let Profile { name, elsewhere, .. } = profile;
        Place { ground: &self.roster.ground, names, agent: name, elsewhere, now: self.now }
    }

    /// Those agents of a text begin that are wanted.
    fn add_agents(&self, is_wanted: impl Fn(&str) -> bool) -> Result<Plan, Refusal> {
        let file = if self.change.file.is_empty() { "agents.xml" } else { &self.change.file };
        let source = Source::new(file, self.change.text.clone());
        let (setup, diagnostics) = config::read(&source, Path::new(file), &self.roster.registry);
        if diagnostics.iter().any(Diagnostic::is_error) {
            return Err(diagnostics);
        }
        if !setup.links.is_empty() {
            let message = "links are opened when a run begins, and cannot be added to it";
            return Err(vec![Diagnostic::error("E0358", 0..0, message).in_source(&source)]);
        }
        if setup.modules.iter().any(|module| self.roster.registry.module(module.name()).is_none()) {
            let message = "the text names a module that the run has not loaded";
            let hint = "load it first: `monas module load FILE`";
            return Err(vec![Diagnostic::error("E0358", 0..0, message).with_hint(hint).in_source(&source)]);
        }
        if setup.agents.is_empty() {
            return Err(vec![Diagnostic::error("E0358", 0..0, "the text holds no agent").in_source(&source)]);
        }
        let mut names = self.names();
        if let Some(agent) = setup.agents.iter().find(|agent| names.contains(&agent.name)) {
            let message = format!("another agent is named `{}`", agent.name);
            return Err(refusal_with("E0311", message, "each agent of a host has a name of its own"));
        }
        names.extend(setup.agents.iter().map(|agent| agent.name.clone()));
        let Roster { crew, ground, registry, .. } = self.roster;
        let failed = |error: Error| unusable("E0354", &error);
        let binder = Binder::new(registry).map_err(failed)?;
        let wanted = setup.agents.into_iter().filter(|agent| is_wanted(&agent.name));
        let members = wanted.map(|agent| {
            let profile = Profile::of(&agent);
            Ok((profile, crew.member(&binder, agent, ground, &names, self.now).map_err(failed)?))
        });
        let members = members.collect::<Result<Vec<_>, Refusal>>()?;
        Ok(Plan { warnings: diagnostics, step: Step::Launch(members) })
    }

    fn add_activity(&self) -> Result<Plan, Refusal> {
        let profile = self.agent()?;
        let listed = self.listed(&self.change.activity)?;
        let count = profile.activities.len();
        let place = self.position(count + 1, count)?;
        let (profile, orders) = self.enlisted(profile, place, vec![listed])?;
        Ok(tell(profile, orders))
    }

    /// An agent with more activities in its list from a place on, and what it is told for that.
    pub(super) fn enlisted(
        &self,
        mut profile: Profile,
        place: usize,
        more: Vec<Listed>,
    ) -> Result<(Profile, Orders), Refusal> {
        let added = more.iter().map(ActivityProfile::of);
        profile.activities.splice(place..place, added.collect::<Vec<_>>());
        if self.staff.has_list(&profile.name) {
            let edits = (place..).zip(more).map(|(place, listed)| ListEdit::Insert(place, listed));
            let edits = edits.collect();
            return Ok((profile, Orders { edits, ..Orders::default() }));
        }
        if profile.frequency.is_none() {
            let message = format!("nothing says how often the list of `{}` is to run", profile.name);
            return Err(refusal_with("E0305", message, "set its `frequency` first"));
        }
        let Roster { crew, ground, .. } = self.roster;
        let part = part(profile.charts.len());
        let list = Box::new(crew.list((&profile.name, part), profile.policy, more, &ground.hub));
        Ok((profile, Orders { list: Some(list), ..Orders::default() }))
    }

    fn remove_activity(&self) -> Result<Plan, Refusal> {
        let mut profile = self.agent()?;
        let place = self.activity(&profile)?;
        profile.activities.remove(place);
        Ok(self.edited(profile, ListEdit::Remove(place)))
    }

    fn move_activity(&self) -> Result<Plan, Refusal> {
        let mut profile = self.agent()?;
        let from = self.activity(&profile)?;
        let count = profile.activities.len();
        let to = self.position(count, count - 1)?;
        let activity = profile.activities.remove(from);
        profile.activities.insert(to, activity);
        Ok(self.edited(profile, ListEdit::Move(from, to)))
    }

    fn replace_activity(&self) -> Result<Plan, Refusal> {
        let mut profile = self.agent()?;
        let place = self.activity(&profile)?;
        let listed = self.listed(&self.change.replacement)?;
        profile.activities[place] = ActivityProfile::of(&listed);
        Ok(self.edited(profile, ListEdit::Replace(place, listed)))
    }

    fn edited(&self, profile: Profile, edit: ListEdit) -> Plan {
        tell(profile, Orders { edits: vec![edit], ..Orders::default() })
    }

    /// The place in its list of the activity that is meant, from 0.
    fn activity(&self, profile: &Profile) -> Result<usize, Refusal> {
        settings::activity(profile, &self.change.activity)
    }

    /// The place that is asked for among so many, from 0; or the one that is taken if none is.
    fn position(&self, count: usize, otherwise: usize) -> Result<usize, Refusal> {
        match self.change.place as usize {
            0 => Ok(otherwise),
            place if place <= count => Ok(place - 1),
            place => Err(refusal("E0353", format!("there is no place {place}: places are 1 to {count}"))),
        }
    }

    /// A new activity with the parameters that the change sets.
    fn listed(&self, name: &str) -> Result<Listed, Refusal> {
        let given = &self.change.settings;
        let parameters = given.iter().fold(Parameters::new(), |all, one| all.with(&one.key, &one.value));
        let activity = settings::instance(&self.roster.registry, name, &parameters)?;
        Ok(Listed { name: name.to_owned(), parameters, policy: None, activity })
    }

    fn set(&self) -> Result<Plan, Refusal> {
        let mut profile = self.agent()?;
        let Change { settings, chart, .. } = self.change;
        let orders = settings::set(&mut profile, settings, chart, &self.roster.registry)?;
        Ok(tell(profile, orders))
    }

    fn swap(&self) -> Result<Plan, Refusal> {
        let mut profile = self.agent()?;
        if self.staff.standing(&profile.name) == Standing::Stopped {
            let message = format!("`{}` has stopped", profile.name);
            return Err(refusal_with("E0352", message, "start it first: a model is swapped while it runs"));
        }
        let place = settings::chart(&profile, &self.change.chart)?;
        let Change { file, text, states, accept_losses, .. } = self.change;
        let crew = &self.roster.crew;
        let failed = |error: Error| unusable("E0355", &error);
        let binder = Binder::new(&self.roster.registry).map_err(failed)?;
        let (bound, warnings) = match text.is_empty() {
            true => (crew.generated(&binder, file, profile.semantics).map_err(failed)?, Vec::new()),
            false => {
                let source = Source::new(file, text.clone());
                let (chart, diagnostics) = aseme::statechart_of(&source);
                if diagnostics.iter().any(Diagnostic::is_error) {
                    return Err(diagnostics);
                }
                (binder.bind(&chart, profile.semantics, Some(&source))?, diagnostics)
            }
        };
        let statechart = bound.chart.statechart().clone();
        let names = self.names();
        let own = profile.charts[place].own.clone();
        let bound = crew.fitting(bound, &own, &self.place(&profile, &names)).map_err(failed)?;
        profile.charts[place] =
            ChartProfile { model: file.clone(), statechart, is_generated: text.is_empty(), own };
        let states = states.iter().map(|state| (state.key.clone(), state.value.clone())).collect();
        let of_agent = Some((&profile.rules[..], profile.name.as_str(), profile.charts.len()));
        let monitors = binder.monitors(of_agent, &profile.charts[place].own.rules, &bound.chart)?;
        let swap = Box::new(Swap { bound, states, accepts_losses: *accept_losses, monitors });
        Ok(Plan { warnings, ..tell(profile, Orders { swap: Some((place, swap)), ..Orders::default() }) })
    }
}
