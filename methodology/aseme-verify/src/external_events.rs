//! External events that are assumed for models.

use std::collections::BTreeSet;
use std::sync::Arc;

use yase::Source;
use yase::diagnostic::nearest;
use yase::expression::Trigger;

use crate::check::events::waited;
use crate::check_settings::CheckSettings;
use crate::checked_model::subject_of;

/// Refuses an external event that no trigger of the models names, since the assumption would have
/// no effect. Models that cannot be read are left to their checks.
///
/// # Errors
/// The event, and the events that the models wait for.
pub fn check_external_events(models: &[Arc<Source>], settings: &CheckSettings) -> Result<(), String> {
    if settings.events.is_empty() {
        return Ok(());
    }
    let mut known = BTreeSet::new();
    for model in models {
        let Ok(subject) = subject_of(model) else { return Ok(()) };
        let mut triggers = subject.chart.transitions().filter_map(|(_, it)| it.expression.trigger.as_ref());
        if triggers.any(|trigger| !matches!(trigger, Trigger::OneOf(_))) {
            return Ok(());
        }
        known.extend(waited(&subject).into_keys());
    }
    let Some(unknown) = settings.events.iter().find(|event| !known.contains(*event)) else { return Ok(()) };
    let hint = match nearest(unknown, known.iter().map(String::as_str)) {
        Some(near) => format!("; did you mean `{near}`?"),
        None if known.is_empty() => String::new(),
        None => {
            let names: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
            format!("; there are {}", names.join(", "))
        }
    };
    Err(format!("no transition waits for the event `{unknown}`{hint}"))
}
