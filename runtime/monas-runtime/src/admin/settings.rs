//! Settings of a running agent: its attributes, as in its configuration, and the parameters of its
//! activities.

use std::collections::BTreeSet;

use super::findings::{ChangeRefusal, build_refusal, refusal, refusal_with, unknown};
use crate::agent_update::{AgentCommand, AgentUpdate};
use crate::list::ListEdit;
use monas_config::{Grammar, is_written};
use monas_core::activity::Activity;
use monas_core::agent::{ActivityProfile, AgentProfile, ChartProfile, ChartSettings, FailurePolicy};
use monas_core::call;
use monas_core::error::ErrorKind;
use monas_core::frequency::{Frequency, Hz};
use monas_core::parameters::Parameters;
use monas_core::records::Setting;
use monas_core::registry::Registry;

/// Sets attributes (`frequency`) and parameters (`Vision.speed`) in the profile of an agent, or of
/// one of its charts if that is named. Applies all settings or none.
pub(crate) fn set(
    profile: &mut AgentProfile,
    settings: &[Setting],
    chart_name: &str,
    registry: &Registry,
) -> Result<AgentUpdate, ChangeRefusal> {
    if settings.is_empty() {
        let hint = "name an attribute, or a parameter of an activity: `frequency=50`, `Vision.speed=0.5`";
        return Err(refusal_with("E0353", "no setting is given", hint));
    }
    if !chart_name.is_empty() {
        let index = chart(profile, chart_name)?;
        return set_chart(profile, index, settings, registry);
    }
    if let Some(position) = chart_with(profile, settings) {
        return set_chart(profile, position, settings, registry);
    }
    let mut orders = AgentUpdate::default();
    let mut configured: Vec<usize> = Vec::new();
    for Setting { key, value } in settings {
        match key.split_once('.') {
            Some((name, parameter)) => {
                let index = activity(profile, name)?;
                let known = &mut profile.activities[index];
                if parameter == "on_failure" {
                    let policy = policy(value).ok_or_else(|| refusal("E0306", unknown_policy(key, value)))?;
                    known.policy = Some(policy);
                    orders.edits.push(ListEdit::SetPolicy(index, policy));
                    continue;
                }
                known.parameters = known.parameters.clone().with(parameter, value);
                configured.push(index);
            }
            None => orders.commands.push(attribute(profile, key, value)?),
        }
    }
    configured.sort_unstable();
    configured.dedup();
    for index in configured {
        let ActivityProfile { name, parameters, .. } = &profile.activities[index];
        // A separate instance validates them first, so that the running one never receives invalid
        // values.
        instance(registry, name, parameters)?;
        orders.edits.push(ListEdit::Configure(index, parameters.clone()));
    }
    Ok(orders)
}

/// An attribute with its value.
enum SettingValue {
    Frequency(Frequency),
    Priority(i32),
    RealTime(bool),
    StatisticsEvery(Option<u64>),
    Policy(FailurePolicy),
}

/// Parses the new value of an attribute of an agent or a statechart.
fn given(element: &str, key: &str, value: &str) -> Result<SettingValue, ChangeRefusal> {
    let grammar = Grammar::agents();
    let rule = grammar.element(element).and_then(|rule| rule.attribute_named(key));
    let known = ["frequency", "priority", "is_real_time", "stats_cycle", "on_failure"];
    let is_known = |key: &str| key == "thread_frequency" || known.contains(&key);
    let Some(rule) = rule.filter(|rule| is_known(rule.key())) else {
        let message = match rule {
            Some(rule) => {
                format!("`{}` of an {element} applies only at its start and cannot be set", rule.key())
            }
            None => format!("an {element} has no attribute `{key}`"),
        };
        return Err(unknown("E0304", message.replace("an statechart", "a statechart"), key, known));
    };
    let unread = || refusal("E0306", format!("`{key}` is `{value}`, expected {}", rule.kind().expected()));
    if !rule.kind().allows(value) {
        return Err(unread());
    }
    let value = value.trim();
    Ok(match rule.key() {
        "thread_frequency" => SettingValue::Frequency(Hz(value.parse::<f64>().map_err(|_| unread())?)),
        "priority" => SettingValue::Priority(value.parse().map_err(|_| unread())?),
        "is_real_time" => SettingValue::RealTime(is_written(value, "1") || value == "true"),
        "stats_cycle" => {
            let cycles: u64 = value.parse().map_err(|_| unread())?;
            SettingValue::StatisticsEvery((cycles > 0).then_some(cycles))
        }
        _ => SettingValue::Policy(policy(value).ok_or_else(unread)?),
    })
}

fn attribute(profile: &mut AgentProfile, key: &str, value: &str) -> Result<AgentCommand, ChangeRefusal> {
    Ok(match given("agent", key, value)? {
        SettingValue::Frequency(frequency) => {
            profile.frequency = Some(frequency);
            AgentCommand::Frequency(frequency)
        }
        SettingValue::Priority(priority) => {
            profile.priority = priority;
            AgentCommand::Scheduling(priority, profile.real_time)
        }
        SettingValue::RealTime(is_wanted) => {
            profile.real_time = is_wanted;
            AgentCommand::Scheduling(profile.priority, is_wanted)
        }
        SettingValue::StatisticsEvery(cycles) => {
            profile.statistics_every = cycles;
            AgentCommand::StatisticsEvery(cycles)
        }
        SettingValue::Policy(policy) => {
            profile.policy = policy;
            AgentCommand::Policy(policy)
        }
    })
}

/// Sets attributes and parameters of one chart of an agent. Applies all settings or none.
fn set_chart(
    profile: &mut AgentProfile,
    index: usize,
    settings: &[Setting],
    registry: &Registry,
) -> Result<AgentUpdate, ChangeRefusal> {
    let chart = &profile.charts[index];
    let mut own = chart.settings.clone();
    let mut configured: Vec<&str> = Vec::new();
    for Setting { key, value } in settings {
        match key.split_once('.') {
            Some((name, parameter)) => {
                known_in_chart(chart, name)?;
                let known = own.of_activity_mut(name);
                if parameter == "on_failure" {
                    let policy = policy(value).ok_or_else(|| refusal("E0306", unknown_policy(key, value)))?;
                    known.policy = Some(policy);
                } else {
                    known.parameters = known.parameters.clone().with(parameter, value);
                    configured.push(name);
                }
            }
            None => set_own(&mut own, given("statechart", key, value)?),
        }
    }
    for name in configured {
        // A separate instance validates them first, so that the running one never receives invalid
        // values.
        charts_instance(chart, registry, name, &own.parameters(name))?;
    }
    profile.charts[index].settings = own.clone();
    Ok(AgentUpdate { chart_settings: Some((index, Box::new(own))), ..AgentUpdate::default() })
}

fn set_own(own: &mut ChartSettings, given: SettingValue) {
    match given {
        SettingValue::Frequency(frequency) => own.frequency = Some(frequency),
        SettingValue::Priority(priority) => own.priority = Some(priority),
        SettingValue::RealTime(is_wanted) => own.real_time = Some(is_wanted),
        SettingValue::StatisticsEvery(steps) => own.statistics_every = Some(steps),
        SettingValue::Policy(policy) => own.policy = Some(policy),
    }
}

/// The names of the activities of a chart's states.
fn named_in(chart: &ChartProfile) -> impl Iterator<Item = &str> {
    chart.statechart.nodes().filter_map(|(_, node)| node.activity.as_deref())
}

fn known_in_chart(chart: &ChartProfile, name: &str) -> Result<(), ChangeRefusal> {
    if named_in(chart).any(|known| known == name) {
        return Ok(());
    }
    let message = format!("the statechart `{}` has no activity `{name}`", chart.model);
    let known: BTreeSet<&str> = named_in(chart).collect();
    Err(unknown("E0353", message, name, known))
}

/// A new instance of a chart's activity. Activities of a generated chart come from the chart.
fn charts_instance(
    chart: &ChartProfile,
    registry: &Registry,
    name: &str,
    parameters: &Parameters,
) -> Result<Box<dyn Activity>, ChangeRefusal> {
    if !chart.is_generated {
        return instance(registry, name, parameters);
    }
    let generated = registry.chart(&chart.model).and_then(Result::ok);
    match generated.and_then(|generated| generated.into_activity(name)) {
        Some(activity) => configured(activity, name, parameters),
        None => Err(refusal("E0312", format!("the statechart `{}` has no activity `{name}`", chart.model))),
    }
}

/// The chart of an activity that is set by its name alone: the only chart that has it, if the
/// agent's list does not.
fn chart_with(profile: &AgentProfile, settings: &[Setting]) -> Option<usize> {
    let names: Vec<&str> = settings.iter().filter_map(|one| Some(one.key.split_once('.')?.0)).collect();
    let name = names.first().filter(|_| names.len() == settings.len())?;
    let is_listed =
        activity(profile, name).is_ok() || profile.activities.iter().any(|one| one.name == **name);
    let mut having =
        (0..profile.charts.len()).filter(|index| named_in(&profile.charts[*index]).any(|one| one == *name));
    having.next().filter(|_| !is_listed && having.next().is_none())
}

fn policy(name: &str) -> Option<FailurePolicy> {
    FailurePolicy::NAMES.into_iter().find(|(known, _)| *known == name).map(|(_, policy)| policy)
}

fn unknown_policy(key: &str, value: &str) -> String {
    let known = FailurePolicy::NAMES.map(|(name, _)| format!("`{name}`")).join(", ");
    format!("`{key}` is `{value}`, expected one of {known}")
}

/// Index of an activity in its list, by its name or its position from 1.
pub(crate) fn activity(profile: &AgentProfile, name: &str) -> Result<usize, ChangeRefusal> {
    let count = profile.activities.len();
    if let Some(index) = name.parse::<usize>().ok().filter(|position| (1..=count).contains(position)) {
        return Ok(index - 1);
    }
    let indices: Vec<usize> = (0..count).filter(|index| profile.activities[*index].name == name).collect();
    match indices[..] {
        [index] => Ok(index),
        [] => {
            let message = format!("the list of `{}` has no activity `{name}`", profile.name);
            Err(unknown("E0353", message, name, profile.activities.iter().map(|known| known.name.as_str())))
        }
        _ => {
            let numbers: Vec<String> = indices.iter().map(|index| (index + 1).to_string()).collect();
            let message = format!("the list of `{}` has several activities `{name}`", profile.name);
            Err(refusal_with("E0353", message, format!("name its place: {}", numbers.join(", "))))
        }
    }
}

/// Index of a chart, by its model or its position from 1; the only chart if none is named.
pub(crate) fn chart(profile: &AgentProfile, name: &str) -> Result<usize, ChangeRefusal> {
    let count = profile.charts.len();
    let models = || profile.charts.iter().map(|chart| chart.model.as_str());
    let named = profile.charts.iter().position(|chart| chart.model == name);
    let numbered = || name.parse::<usize>().ok().filter(|index| (1..=count).contains(index));
    match (name, count) {
        (_, 0) => Err(refusal("E0355", format!("`{}` has no statechart", profile.name))),
        ("", 1) => Ok(0),
        ("", _) => {
            let message = format!("`{}` has several statecharts", profile.name);
            Err(unknown("E0355", message, name, models()))
        }
        _ => named.or_else(|| numbered().map(|number| number - 1)).ok_or_else(|| {
            let message = format!("`{}` has no statechart `{name}`", profile.name);
            unknown("E0355", message, name, models())
        }),
    }
}

/// A new activity of the registry that accepts these parameters.
pub(crate) fn instance(
    registry: &Registry,
    name: &str,
    parameters: &Parameters,
) -> Result<Box<dyn Activity>, ChangeRefusal> {
    let activity = registry.activity(name).map_err(|error| {
        let code = match error.kind() {
            ErrorKind::AmbiguousActivity => "E0313",
            ErrorKind::Module => "E0364",
            _ => "E0312",
        };
        build_refusal(code, &error)
    })?;
    configured(activity, name, parameters)
}

/// Configures an activity with these parameters, if it accepts them.
fn configured(
    mut activity: Box<dyn Activity>,
    name: &str,
    parameters: &Parameters,
) -> Result<Box<dyn Activity>, ChangeRefusal> {
    // Accesses noted earlier belong to other instances.
    let parameters = parameters.without_accesses();
    call::configure(&mut *activity, &parameters);
    let faults = parameters.faults().into_iter().flat_map(|fault| {
        let code = if fault.unknown { "E0314" } else { "E0315" };
        let message = format!("activity `{name}`: {}", fault.message);
        match fault.nearest {
            Some(near) => refusal_with(code, message, format!("did you mean `{near}`?")),
            None => refusal(code, message),
        }
    });
    match faults.collect::<ChangeRefusal>() {
        none if none.is_empty() => Ok(activity),
        faults => Err(faults),
    }
}
