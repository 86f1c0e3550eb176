//! The activities of the states. A missing one is a compile error here.

mod pass_ball;

use ::monas::generated::Instance;
use ::team::{Kick, look};
pub use pass_ball::PassBall;

use super::states::State;

/// A new instance for each state that has an activity.
pub(crate) fn instances() -> Vec<Instance> {
    vec![
        Instance::new(State::look, look),
        Instance::of::<Kick>(State::kick),
        Instance::of::<PassBall>(State::passBall),
    ]
}
