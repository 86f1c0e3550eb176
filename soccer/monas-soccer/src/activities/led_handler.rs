//! LED display of the player's state.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use crate::{LedRequest, convert, topics};

/// Shows the state of the game on the chest LED, the colour of the team on the left foot and the
/// kick-off on the right one, as the rules require; the left eye shows whether the ball is seen,
/// the right eye the confidence of localisation. MotionController, the only commander of the body,
/// forwards the colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct LedHandler {
    shown: Option<LedRequest>,
}

impl Activity for LedHandler {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let colours = convert::lights(
            blackboard.read(topics::GAME_STATE),
            blackboard.read(topics::BALL).is_some_and(|ball| ball.found),
            blackboard.read(topics::POSE).map_or(0.0, |pose| pose.confidence),
        );
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
    use crate::{Ball, Colour, GameState, PlayerState, Pose};

    #[test]
    fn the_lights_show_game_team_ball_and_pose() {
        let (mut stage, mut activity) = (ActivityFixture::new(), LedHandler::default());
        stage.run(&mut activity);
        assert_eq!(stage.latest(topics::LEDS), Some(LedRequest::default()));
        stage.publish(
            topics::GAME_STATE,
            GameState {
                player_state: PlayerState::Playing.into(),
                team_colour: Colour::Red.into(),
                kick_off_own: true,
                ..Default::default()
            },
        );
        stage.publish(topics::BALL, Ball { found: true, ..Default::default() });
        stage.publish(topics::POSE, Pose { confidence: 1.0, ..Default::default() });
        stage.run(&mut activity);
        let shown = LedRequest {
            chest: 0x00ff00,
            left_eye: 0xff0000,
            right_eye: 0x00ff00,
            left_foot: 0xff0000,
            right_foot: 0,
        };
        assert_eq!(stage.latest(topics::LEDS), Some(shown));
        stage.run(&mut activity);
        assert_eq!(stage.count_arrivals(topics::LEDS), 0, "what does not change is not said again");
    }
}
