//! The activities of the states. A missing one is a compile error here.

use ::monas::generated::Instance;
use ::monas_soccer::activities::{
    KeepGoal, LedHandler, LeftDive, LeftFall, MotionController, ReturnToGoal, RightDive, RightFall,
    RobotController, SearchBall, SendCalibration, Sensors, Stand, StepAside, TrackBall, Vision,
    WaitForBallMessage, WalkToKickOff,
};

use super::states::State;

/// A new instance for each state that has an activity.
pub(crate) fn instances() -> Vec<Instance> {
    vec![
        Instance::of::<RobotController>(State::RobotController),
        Instance::of::<LedHandler>(State::LedHandler),
        Instance::of::<MotionController>(State::MotionController),
        Instance::of::<Stand>(State::Stand),
        Instance::of::<SendCalibration>(State::SendCalibration),
        Instance::of::<Sensors>(State::Sensors),
        Instance::of::<Vision>(State::Vision),
        Instance::of::<WalkToKickOff>(State::WalkToKickOff),
        Instance::of::<WaitForBallMessage>(State::WaitForBallMessage),
        Instance::of::<SearchBall>(State::SearchBall),
        Instance::of::<ReturnToGoal>(State::ReturnToGoal),
        Instance::of::<TrackBall>(State::TrackBall),
        Instance::of::<KeepGoal>(State::KeepGoal),
        Instance::of::<StepAside>(State::StepAside),
        Instance::of::<RightFall>(State::RightFall),
        Instance::of::<LeftFall>(State::LeftFall),
        Instance::of::<RightDive>(State::RightDive),
        Instance::of::<LeftDive>(State::LeftDive),
    ]
}
