//! The activities of the roles: thin adapters that read a blackboard, call functionalities and
//! publish the results.
//!
//! None of them chooses between behaviours; the chart does. Each runs once per activation of its
//! state; kicks, falls and dives continue until the body stands again.

#[cfg(test)]
mod activity_fixture;
mod align_with_ball;
mod assess_attack;
mod bring_ball;
mod cover_goal;
mod keep_goal;
mod kick;
mod led_handler;
mod look_at_goal;
mod motion_controller;
pub mod motion_requests;
mod pass_ball;
mod robot_controller;
mod search_ball;
mod send_calibration;
mod sensors;
pub mod shot;
mod skills;
mod stand;
mod support_mate;
mod team_radio;
mod track_ball;
mod turn_around;
mod turn_to_report;
mod vision;
mod wait_for_ball_message;
mod walk_to_kick_off;
mod walk_towards_ball;
mod walk_towards_centre;
mod walk_towards_goal;

pub use align_with_ball::AlignWithBall;
pub use assess_attack::AssessAttack;
pub use bring_ball::{BringBallToPass, BringBallToShoot};
pub use cover_goal::CoverGoal;
pub use keep_goal::{KeepGoal, ReturnToGoal, StepAside};
pub use kick::{LeftKick, RightKick};
pub use led_handler::LedHandler;
pub use look_at_goal::LookAtGoal;
pub use motion_controller::MotionController;
pub use pass_ball::PassBall;
pub use robot_controller::RobotController;
pub use search_ball::SearchBall;
pub use send_calibration::SendCalibration;
pub use sensors::Sensors;
pub use skills::{LeftDive, LeftFall, RightDive, RightFall};
pub use stand::Stand;
pub use support_mate::SupportMate;
pub use team_radio::TeamRadio;
pub use track_ball::TrackBall;
pub use turn_around::TurnAround;
pub use turn_to_report::TurnToReport;
pub use vision::Vision;
pub use wait_for_ball_message::WaitForBallMessage;
pub use walk_to_kick_off::WalkToKickOff;
pub use walk_towards_ball::WalkTowardsBall;
pub use walk_towards_centre::WalkTowardsCentre;
pub use walk_towards_goal::WalkTowardsGoal;
