//! What can be set of an agent that runs: its attributes, as its configuration has them, and the parameters of its activities.

use super::findings::{Refusal, refusal, refusal_with, unknown, unusable};
use crate::activity::Activity;
use crate::agent::{ActivityProfile, Policy, Profile};
use crate::config::{Grammar, is_written};
use crate::error::ErrorKind;
use crate::frequency::Hz;
use crate::list::ListEdit;
use crate::parameters::Parameters;
use crate::records::Setting;
use crate::registry::Registry;
use crate::talws::orders::{Directive, Orders};

/// Sets attributes (`frequency`) and parameters (`Vision.speed`) in what an agent is made of; all of them, or none.
pub(super) fn set(
    profile: &mut Profile,
    settings: &[Setting],
    registry: &Registry,
) -> Result<Orders, Refusal> {
    if settings.is_empty() {
        let hint = "name an attribute, or a parameter of an activity: `frequency=50`, `Vision.speed=0.5`";
        return Err(refusal_with("E0353", "nothing is to be set", hint));
    }
    let mut orders = Orders::default();
    let mut configured: Vec<usize> = Vec::new();
    for Setting { key, value } in settings {
        match key.split_once('.') {
            Some((name, parameter)) => {
                let place = activity(profile, name)?;
                let known = &mut profile.activities[place];
                if parameter == "on_failure" {
                    let policy = policy(value).ok_or_else(|| refusal("E0306", unknown_policy(key, value)))?;
                    known.policy = Some(policy);
                    orders.edits.push(ListEdit::SetPolicy(place, policy));
                    continue;
                }
                known.parameters = known.parameters.clone().with(parameter, value);
                configured.push(place);
            }
            None => orders.directives.push(attribute(profile, key, value)?),
        }
    }
    configured.sort_unstable();
    configured.dedup();
    for place in configured {
        let ActivityProfile { name, parameters, .. } = &profile.activities[place];
        // Another instance tries them first, so that the one that runs never sees what it would refuse.
        instance(registry, name, parameters)?;
        orders.edits.push(ListEdit::Configure(place, parameters.clone()));
    }
    Ok(orders)
}

fn attribute(profile: &mut Profile, key: &str, value: &str) -> Result<Directive, Refusal> {
    let grammar = Grammar::agents();
    let rule = grammar.element("agent").and_then(|agent| agent.attribute_named(key));
    let known = ["thread_frequency", "priority", "is_real_time", "stats_cycle", "on_failure"];
    let Some(rule) = rule.filter(|rule| known.contains(&rule.key())) else {
        let message = match rule {
            Some(rule) => format!("`{}` of an agent is what it begins with, and cannot be set", rule.key()),
            None => format!("an agent has no attribute `{key}`"),
        };
        return Err(unknown("E0304", message, key, known));
    };
    if !rule.kind().allows(value) {
        let message = format!("`{key}` is `{value}`, expected {}", rule.kind().expected());
        return Err(refusal("E0306", message));
    }
    let value = value.trim();
    let unread = || refusal("E0306", format!("`{key}` is `{value}`, expected {}", rule.kind().expected()));
    Ok(match rule.key() {
        "thread_frequency" => {
            let frequency = Hz(value.parse::<f64>().map_err(|_| unread())?);
            profile.frequency = Some(frequency);
            Directive::Frequency(frequency)
        }
        "priority" => {
            profile.priority = value.parse().map_err(|_| unread())?;
            Directive::Scheduling(profile.priority, profile.real_time)
        }
        "is_real_time" => {
            profile.real_time = is_written(value, "1") || value == "true";
            Directive::Scheduling(profile.priority, profile.real_time)
        }
        "stats_cycle" => {
            let cycles: u64 = value.parse().map_err(|_| unread())?;
            profile.statistics_every = (cycles > 0).then_some(cycles);
            Directive::StatisticsEvery(profile.statistics_every)
        }
        _ => {
            let policy = policy(value).ok_or_else(unread)?;
            profile.policy = policy;
            Directive::Policy(policy)
        }
    })
}

fn policy(name: &str) -> Option<Policy> {
    Policy::NAMES.into_iter().find(|(known, _)| *known == name).map(|(_, policy)| policy)
}

fn unknown_policy(key: &str, value: &str) -> String {
    let known = Policy::NAMES.map(|(name, _)| format!("`{name}`")).join(", ");
    format!("`{key}` is `{value}`, expected one of {known}")
}

/// The place in its list of an activity, by its name or its place from 1.
pub(super) fn activity(profile: &Profile, name: &str) -> Result<usize, Refusal> {
    let count = profile.activities.len();
    if let Some(place) = name.parse::<usize>().ok().filter(|place| (1..=count).contains(place)) {
        return Ok(place - 1);
    }
    let places: Vec<usize> = (0..count).filter(|place| profile.activities[*place].name == name).collect();
    match places[..] {
        [place] => Ok(place),
        [] => {
            let message = format!("the list of `{}` has no activity `{name}`", profile.name);
            Err(unknown("E0353", message, name, profile.activities.iter().map(|known| known.name.as_str())))
        }
        _ => {
            let places: Vec<String> = places.iter().map(|place| (place + 1).to_string()).collect();
            let message = format!("the list of `{}` has several activities `{name}`", profile.name);
            Err(refusal_with("E0353", message, format!("name its place: {}", places.join(", "))))
        }
    }
}

/// The place of a chart, by its model or its place from 1; the only one if none is named.
pub(super) fn chart(profile: &Profile, name: &str) -> Result<usize, Refusal> {
    let count = profile.charts.len();
    let models = || profile.charts.iter().map(|chart| chart.model.as_str());
    let named = profile.charts.iter().position(|chart| chart.model == name);
    let numbered = || name.parse::<usize>().ok().filter(|place| (1..=count).contains(place));
    match (name, count) {
        (_, 0) => Err(refusal("E0355", format!("`{}` has no statechart", profile.name))),
        ("", 1) => Ok(0),
        ("", _) => {
            let message = format!("`{}` has several statecharts", profile.name);
            Err(unknown("E0355", message, name, models()))
        }
        _ => named.or_else(|| numbered().map(|place| place - 1)).ok_or_else(|| {
            let message = format!("`{}` has no statechart `{name}`", profile.name);
            unknown("E0355", message, name, models())
        }),
    }
}

/// A new activity that takes these parameters.
pub(super) fn instance(
    registry: &Registry,
    name: &str,
    parameters: &Parameters,
) -> Result<Box<dyn Activity>, Refusal> {
    let mut activity = registry.activity(name).map_err(|error| {
        let code = match error.kind() {
            ErrorKind::AmbiguousActivity => "E0313",
            ErrorKind::Module => "E0364",
            _ => "E0312",
        };
        unusable(code, &error)
    })?;
    // What has been asked for before was asked by others.
    let parameters = parameters.iter().fold(Parameters::new(), |all, (key, value)| all.with(key, value));
    activity.configure(&parameters);
    let faults = parameters.faults().into_iter().flat_map(|fault| {
        let code = if fault.unknown { "E0314" } else { "E0315" };
        let message = format!("activity `{name}`: {}", fault.message);
        match fault.nearest {
            Some(near) => refusal_with(code, message, format!("did you mean `{near}`?")),
            None => refusal(code, message),
        }
    });
    match faults.collect::<Refusal>() {
        none if none.is_empty() => Ok(activity),
        faults => Err(faults),
    }
}
