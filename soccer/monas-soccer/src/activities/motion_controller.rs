//! The only commander of the body.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use monas_robot::{Skill, topics as body};
use narukom::Timestamp;

use crate::functionality::head::{Gaze, HeadController};
use crate::functionality::motion::{BodyReport, MotionArbiter, PendingRequest, Posture};
use crate::functionality::walk::{GaitLimits, Walk};
use crate::{HeadMode, MotionPhase, MotionState, PlayerState, convert, topics};

/// Commands the body according to the requests of the behaviours, as far as game and body allow.
///
/// The robot moves in READY and PLAYING only; otherwise it stands still and looks ahead. A walk
/// that is not requested again within half a second ends. A fallen robot gets up in every state of
/// the game.
///
/// Parameters `walk_forward`, `walk_backward`, `walk_sideways` (m/s) and `walk_turn` (rad/s):
/// limits of the requested gait.
#[derive(Clone, Debug)]
pub struct MotionController {
    gait: GaitLimits,
    motion: MotionArbiter,
    head: HeadController,
    scanning_since: Option<Timestamp>,
    last_state: Option<MotionState>,
}

/// Limits of the gait in the simulator and, approximately, of a Nao.
const GAIT: GaitLimits = GaitLimits { forward: 0.3, backward: 0.15, sideways: 0.15, turn: 1.2 };

impl Default for MotionController {
    fn default() -> MotionController {
        MotionController {
            gait: GAIT,
            motion: MotionArbiter::new(GAIT),
            head: HeadController::default(),
            scanning_since: None,
            last_state: None,
        }
    }
}

impl Activity for MotionController {
    fn configure(&mut self, parameters: &Parameters) {
        let speed = |key, speed: &mut f64| {
            let positive =
                |text: &str| text.parse().ok().filter(|value: &f64| value.is_finite() && *value > 0.0);
            *speed = parameters.read(key, "a speed above 0", positive).unwrap_or(*speed);
        };
        speed("walk_forward", &mut self.gait.forward);
        speed("walk_backward", &mut self.gait.backward);
        speed("walk_sideways", &mut self.gait.sideways);
        speed("walk_turn", &mut self.gait.turn);
        self.motion.set_gait(self.gait);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        // Without sensor readings there is no body to command.
        let Some(report) = blackboard.read(body::SENSORS).map(convert::report) else {
            return Ok(Progress::Done);
        };
        let now = blackboard.now();
        let allowed = may_move(blackboard);
        let order = self.motion.step(now, report, request(blackboard), allowed);
        let gaze = self.gaze(blackboard, allowed);
        let lights = blackboard.read(topics::LEDS).copied().unwrap_or_default();
        blackboard.publish(body::ACTUATORS, convert::actuators(&order, (gaze.yaw, gaze.pitch), lights))?;
        let state = MotionState {
            phase: phase(report, &order.walk).into(),
            done: self.motion.done(),
            result: convert::motion_result(self.motion.end()).into(),
        };
        if self.last_state != Some(state) {
            blackboard.publish(topics::MOTION_STATE, state)?;
            self.last_state = Some(state);
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(body::SENSORS).reads(topics::GAME_STATE).reads(topics::MOTION);
        let topics = topics.reads(topics::HEAD).reads(topics::LEDS);
        let topics = topics.publishes(body::ACTUATORS).publishes(topics::MOTION_STATE);
        topics.performs(Skill::StandUp.as_str_name())
    }
}

impl MotionController {
    fn gaze(&mut self, blackboard: &Blackboard, allowed: bool) -> Gaze {
        let request = blackboard.read(topics::HEAD).filter(|_| allowed);
        let mode = request.map_or(HeadMode::Ahead, |request| request.mode());
        if mode != HeadMode::Scan {
            self.scanning_since = None;
        }
        match (mode, request) {
            (HeadMode::Look, Some(request)) => Gaze { yaw: request.yaw, pitch: request.pitch },
            (HeadMode::Scan, _) => {
                let now = blackboard.now();
                self.head.scan(now.since(*self.scanning_since.get_or_insert(now)))
            }
            _ => Gaze::default(),
        }
    }
}

fn may_move(blackboard: &Blackboard) -> bool {
    let state = blackboard.read(topics::GAME_STATE).map(|game| game.player_state());
    matches!(state, Some(PlayerState::Ready | PlayerState::Playing))
}

fn request(blackboard: &Blackboard) -> Option<PendingRequest> {
    let sample = blackboard.sample(topics::MOTION)?;
    let age: Duration = blackboard.now().since(sample.header.published);
    Some(sample.request(age))
}

fn phase(report: BodyReport, walk: &Walk) -> MotionPhase {
    match report.posture {
        Posture::Upright if *walk == Walk::STILL => MotionPhase::Standing,
        Posture::Upright => MotionPhase::Walking,
        Posture::Busy | Posture::Lifted => MotionPhase::Busy,
        Posture::Fallen => MotionPhase::Fallen,
    }
}

monas::activity!(MotionController);

#[cfg(test)]
mod tests {
    use monas_robot::{Posture as BodyPosture, Sensors, Skill, SkillResult};

    use super::*;
    use crate::activities::activity_fixture::{ActivityFixture, TICK};
    use crate::{GameState, HeadRequest, LedRequest, MotionKind, MotionRequest, MotionResult};

    fn playing() -> GameState {
        GameState { player_state: PlayerState::Playing.into(), ..GameState::default() }
    }

    fn felt(posture: BodyPosture, skill_done: u64) -> Sensors {
        Sensors { posture: posture.into(), skill_done, ..Sensors::default() }
    }

    fn walk(vx: f64) -> MotionRequest {
        MotionRequest { kind: MotionKind::Walk.into(), vx, ..MotionRequest::default() }
    }

    #[test]
    fn without_a_body_nothing_is_commanded() {
        let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
        stage.run(&mut activity);
        assert_eq!(stage.latest(body::ACTUATORS), None);
        assert_eq!(stage.latest(topics::MOTION_STATE), None);
    }

    #[test]
    fn it_walks_in_ready_and_playing_only() {
        for state in [
            PlayerState::Initial,
            PlayerState::Ready,
            PlayerState::Set,
            PlayerState::Playing,
            PlayerState::Penalized,
            PlayerState::Finished,
        ] {
            let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
            stage.publish(body::SENSORS, felt(BodyPosture::Standing, 0)).publish(topics::MOTION, walk(0.2));
            stage.publish(
                topics::GAME_STATE,
                GameState { player_state: state.into(), ..GameState::default() },
            );
            stage.run(&mut activity);
            let walks = stage.latest(body::ACTUATORS).unwrap().walk_x > 0.0;
            assert_eq!(walks, matches!(state, PlayerState::Ready | PlayerState::Playing), "{state:?}");
        }
    }

    #[test]
    fn a_walk_that_is_not_repeated_ends() {
        let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
        stage.publish(body::SENSORS, felt(BodyPosture::Standing, 0)).publish(topics::GAME_STATE, playing());
        stage.publish(topics::MOTION, walk(0.2)).run(&mut activity);
        assert_eq!(stage.latest(body::ACTUATORS).unwrap().walk_x, 0.2);
        stage.wait(6 * TICK).run(&mut activity);
        assert_eq!(stage.latest(body::ACTUATORS).unwrap().walk_x, 0.0);
    }

    #[test]
    fn a_kick_is_commanded_once_and_reported_when_the_body_stands_again() {
        let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
        let kick = MotionRequest { kind: MotionKind::KickLeft.into(), number: 4, ..MotionRequest::default() };
        stage.publish(body::SENSORS, felt(BodyPosture::Standing, 9)).publish(topics::GAME_STATE, playing());
        stage.publish(topics::MOTION, kick).run(&mut activity);
        let actuators = stage.latest(body::ACTUATORS).unwrap();
        assert_eq!((actuators.skill(), actuators.skill_number), (Skill::KickLeft, 10));
        stage.publish(body::SENSORS, felt(BodyPosture::Busy, 9)).wait(TICK).run(&mut activity);
        let state = stage.latest(topics::MOTION_STATE).unwrap();
        assert_eq!((state.phase(), state.done), (MotionPhase::Busy, 0));
        stage.publish(body::SENSORS, felt(BodyPosture::Standing, 10)).wait(TICK).run(&mut activity);
        let state = stage.latest(topics::MOTION_STATE).unwrap();
        assert_eq!((state.phase(), state.done), (MotionPhase::Standing, 4));
        assert_eq!(stage.latest(body::ACTUATORS).unwrap().skill_number, 10);
    }

    #[test]
    fn how_a_motion_ended_is_reported() {
        for (result, expected) in [
            (SkillResult::Performed, MotionResult::Performed),
            (SkillResult::Refused, MotionResult::Refused),
            (SkillResult::Interrupted, MotionResult::Interrupted),
        ] {
            let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
            let kind = MotionKind::KickLeft.into();
            stage
                .publish(topics::GAME_STATE, playing())
                .publish(body::SENSORS, felt(BodyPosture::Standing, 0));
            stage.publish(topics::MOTION, MotionRequest { kind, number: 1, ..MotionRequest::default() });
            stage.run(&mut activity);
            assert_eq!(stage.latest(topics::MOTION_STATE).unwrap().result(), MotionResult::NoResult);
            let ended = Sensors { skill_result: result.into(), ..felt(BodyPosture::Standing, 1) };
            stage.publish(body::SENSORS, ended).wait(TICK).run(&mut activity);
            let state = stage.latest(topics::MOTION_STATE).unwrap();
            assert_eq!((state.done, state.result()), (1, expected));
        }
    }

    #[test]
    fn a_robot_that_lies_gets_up() {
        let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
        stage.publish(body::SENSORS, felt(BodyPosture::Fallen, 0)).run(&mut activity);
        assert_eq!(stage.latest(body::ACTUATORS).unwrap().skill(), Skill::StandUp);
        assert_eq!(stage.latest(topics::MOTION_STATE).unwrap().phase(), MotionPhase::Fallen);
    }

    #[test]
    fn gaze_and_light_requests_are_executed() {
        let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
        let look = HeadRequest { mode: HeadMode::Look.into(), yaw: 0.5, pitch: 0.1 };
        stage.publish(body::SENSORS, felt(BodyPosture::Standing, 0)).publish(topics::GAME_STATE, playing());
        stage.publish(
            topics::LEDS,
            LedRequest { chest: 7, left_eye: 8, right_eye: 9, left_foot: 5, right_foot: 6 },
        );
        stage.publish(topics::HEAD, look).run(&mut activity);
        let actuators = stage.latest(body::ACTUATORS).unwrap();
        assert_eq!((actuators.head_yaw, actuators.head_pitch), (0.5, 0.1));
        assert_eq!((actuators.chest, actuators.left_eye, actuators.right_eye), (7, 8, 9));
        assert_eq!((actuators.left_foot, actuators.right_foot), (5, 6));
        stage.publish(topics::HEAD, HeadRequest { mode: HeadMode::Scan.into(), ..look }).run(&mut activity);
        assert_eq!(stage.latest(body::ACTUATORS).unwrap().head_yaw, 0.0, "a sweep begins in the middle");
        stage.wait(3 * TICK).run(&mut activity);
        assert!(stage.latest(body::ACTUATORS).unwrap().head_yaw > 0.3);
    }

    #[test]
    fn the_gait_is_a_parameter() {
        let (mut stage, mut activity) = (ActivityFixture::new(), MotionController::default());
        activity.configure(&Parameters::new().with("walk_forward", "0.1"));
        stage.publish(body::SENSORS, felt(BodyPosture::Standing, 0)).publish(topics::GAME_STATE, playing());
        stage.publish(topics::MOTION, walk(0.2)).run(&mut activity);
        assert!((stage.latest(body::ACTUATORS).unwrap().walk_x - 0.1).abs() < 1e-12);
        let parameters = Parameters::new().with("walk_forward", "0");
        activity.configure(&parameters);
        assert_eq!(parameters.faults().len(), 1);
    }
}
