//! Random changes of agents, valid and invalid.

use monas::records::{Action, Change, Setting};
use narukom::Random;

/// The models of the agent `y`.
pub(crate) const MODELS: [&str; 3] = ["m = W . V", "m = (W | V) . V", "m = (W . V . W)~"];

/// Any change of the agents `x0` to `x3`, which have lists of the activities `W` and `V`, of `y`,
/// which has a chart of them, and of agents that are added and removed.
pub(crate) fn any_change(number: u64, random: &mut Random) -> Change {
    let mut below = |count: usize| (random.uniform() * count as f64) as usize;
    let actions = [
        Action::StartAgent,
        Action::StopAgent,
        Action::PauseAgent,
        Action::ResumeAgent,
        Action::ResumeAgent,
        Action::StepAgent,
        Action::AddAgents,
        Action::RemoveAgent,
        Action::AddActivity,
        Action::RemoveActivity,
        Action::MoveActivity,
        Action::ReplaceActivity,
        Action::Set,
        Action::SwapModel,
        Action::StartAgent,
    ];
    let action = actions[below(actions.len())];
    let agent = match action {
        Action::SwapModel => "y".to_owned(),
        Action::AddAgents | Action::RemoveAgent => format!("new{}", below(5)),
        _ => ["x0", "x1", "x2", "x3", "y"][below(5)].to_owned(),
    };
    let text = match action {
        Action::AddAgents => {
            format!(
                "<agent frequency='{}'><name>{agent}</name><activity>W</activity></agent>",
                1 + below(200)
            )
        }
        Action::SwapModel => MODELS[below(3)].to_owned(),
        _ => String::new(),
    };
    let frequency = (1 + below(500)).to_string();
    let policy = ["skip", "restart", "sometimes"][below(3)];
    let set = [("frequency", frequency.as_str()), ("on_failure", policy), ("priority", "3")];
    Change {
        number,
        activity: ["W", "V", "1", "2", "U"][below(5)].into(),
        replacement: ["W", "V"][below(2)].into(),
        place: below(4) as u32,
        settings: if action == Action::Set { settings(&set[..1 + below(3)]) } else { Vec::new() },
        file: if action == Action::SwapModel { "m.srm".into() } else { String::new() },
        text,
        accept_losses: true,
        action: action.into(),
        agent,
        ..Change::default()
    }
}

fn settings(given: &[(&str, &str)]) -> Vec<Setting> {
    given.iter().map(|(key, value)| Setting { key: (*key).into(), value: (*value).into() }).collect()
}
