//! The activities of the states. A missing one is a compile error here.

use ::monas::generated::Instance;
use ::monas_soccer::activities::{
    AlignWithBall, LedHandler, LeftKick, LookAtGoal, MotionController, RightKick, RobotController,
    SearchBall, SendCalibration, Sensors, Stand, SupportMate, TrackBall, TurnAround, Vision,
    WaitForBallMessage, WalkToKickOff, WalkTowardsBall, WalkTowardsCentre,
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
        Instance::of::<TurnAround>(State::TurnAround),
        Instance::of::<WalkTowardsCentre>(State::WalkTowardsCentre),
        Instance::of::<TrackBall>(State::TrackBall),
        Instance::of::<LookAtGoal>(State::LookAtGoal),
        Instance::of::<WalkTowardsBall>(State::WalkTowardsBall),
        Instance::of::<AlignWithBall>(State::AlignWithBall),
        Instance::of::<SupportMate>(State::SupportMate),
        Instance::of::<LeftKick>(State::LeftKick),
        Instance::of::<RightKick>(State::RightKick),
    ]
}
