//! LED display of the player's state.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use crate::functionality::lights;
use crate::{LedRequest, topics};

/// Shows the state of the game on the chest LED, whether the ball is seen on the left eye, and the
/// confidence of localisation on the right eye. MotionController, the only commander of the body,
/// forwards the colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct LedHandler {
    shown: Option<LedRequest>,
}

impl Activity for LedHandler {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let colours = LedRequest {
            chest: blackboard
                .read(topics::GAME_STATE)
                .map_or(lights::OFF, |game| lights::chest(game.state())),
            left_eye: lights::ball_eye(blackboard.read(topics::BALL).is_some_and(|ball| ball.found)),
            right_eye: lights::pose_eye(blackboard.read(topics::POSE).map_or(0.0, |pose| pose.confidence)),
        };
        if self.shown != Some(colours) {
            blackboard.publish(topics::LEDS, colours)?;
            self.shown = Some(colours);
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::GAME_STATE).reads(topics::BALL).reads(topics::POSE);
        topics.publishes(topics::LEDS)
    }
}

monas::activity!(LedHandler);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, GameState, PlayerState, Pose};

    #[test]
    fn the_lights_show_game_ball_and_pose() {
        let (mut stage, mut activity) = (ActivityFixture::new(), LedHandler::default());
        stage.run(&mut activity);
        assert_eq!(stage.latest(topics::LEDS), Some(LedRequest::default()));
        stage.publish(
            topics::GAME_STATE,
            GameState { player_state: PlayerState::Playing.into(), ..Default::default() },
        );
        stage.publish(topics::BALL, Ball { found: true, ..Default::default() });
        stage.publish(topics::POSE, Pose { confidence: 1.0, ..Default::default() });
        stage.run(&mut activity);
        let shown = LedRequest { chest: 0x00ff00, left_eye: 0xff0000, right_eye: 0x00ff00 };
        assert_eq!(stage.latest(topics::LEDS), Some(shown));
        stage.run(&mut activity);
        assert_eq!(stage.count_arrivals(topics::LEDS), 0, "what does not change is not said again");
    }
}
