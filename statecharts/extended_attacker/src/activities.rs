//! The activities of the states. A missing one is a compile error here.

use ::monas::generated::Instance;
use ::monas_soccer::activities::{
    AlignWithBall, AssessAttack, BringBallToPass, BringBallToShoot, CoverGoal, LedHandler, LeftKick,
    LookAtGoal, MotionController, PassBall, RightKick, RobotController, SearchBall, SendCalibration, Sensors,
    Stand, SupportMate, TrackBall, TurnAround, TurnToReport, Vision, WaitForBallMessage, WalkToKickOff,
    WalkTowardsBall, WalkTowardsCentre, WalkTowardsGoal,
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
        Instance::of::<AssessAttack>(State::AssessAttack__of__search),
        Instance::of::<TurnAround>(State::TurnAround),
        Instance::of::<WalkTowardsCentre>(State::WalkTowardsCentre),
        Instance::of::<TurnToReport>(State::TurnToReport),
        Instance::of::<AssessAttack>(State::AssessAttack__of__takeAction),
        Instance::of::<TrackBall>(State::TrackBall),
        Instance::of::<LookAtGoal>(State::LookAtGoal),
        Instance::of::<WalkTowardsBall>(
            State::WalkTowardsBall__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__or__CoverGoal__or__center__or__center_for__close__,
        ),
        Instance::of::<AlignWithBall>(State::AlignWithBall),
        Instance::of::<SupportMate>(State::SupportMate),
        Instance::of::<CoverGoal>(State::CoverGoal),
        Instance::of::<LeftKick>(
            State::LeftKick__of__kickBall__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__or__CoverGoal__or__center__or__center_for__close__,
        ),
        Instance::of::<RightKick>(
            State::RightKick__of__kickBall__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__or__CoverGoal__or__center__or__center_for__close__,
        ),
        Instance::of::<BringBallToPass>(State::WalkTowardsBall__of__center),
        Instance::of::<AssessAttack>(State::AssessAttack__of__center),
        Instance::of::<PassBall>(State::passBall),
        Instance::of::<WalkTowardsGoal>(State::WalkTowardsGoal),
        Instance::of::<BringBallToShoot>(
            State::WalkTowardsBall__of__WalkTowardsBall__then__AssessAttack__then____opt__kickBall__end__,
        ),
        Instance::of::<AssessAttack>(
            State::AssessAttack__of__WalkTowardsBall__then__AssessAttack__then____opt__kickBall__end__,
        ),
        Instance::of::<LeftKick>(State::LeftKick__of__kickBall__of____opt__kickBall__end__),
        Instance::of::<RightKick>(State::RightKick__of__kickBall__of____opt__kickBall__end__),
    ]
}
