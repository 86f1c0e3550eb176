//! Colours of the LEDs.

use super::game::PlayerState;

/// A colour, 0xRRGGBB.
pub type Rgb = u32;

/// Dark.
pub const OFF: Rgb = 0x000000;

/// The colour of the chest LED in a state of the game, according to the rules.
pub fn chest(state: PlayerState) -> Rgb {
    match state {
        PlayerState::Initial | PlayerState::Finished => OFF,
        PlayerState::Ready => 0x0000ff,
        PlayerState::Set => 0xffff00,
        PlayerState::Playing => 0x00ff00,
        PlayerState::Penalized => 0xff0000,
    }
}

/// The colour of an eye that shows whether the ball is seen: red if it is, for a red ball.
pub fn ball_eye(found: bool) -> Rgb {
    if found { 0xff0000 } else { OFF }
}

/// The colour of an eye that shows the confidence of localisation: from dark to bright green.
pub fn pose_eye(confidence: f64) -> Rgb {
    let green = (255.0 * confidence.clamp(0.0, 1.0)) as u32;
    green << 8
}

/// The colour of the right foot: white while the robot's team is about to kick off.
pub fn kick_off_foot(state: PlayerState, has_kick_off: bool) -> Rgb {
    let waits = matches!(state, PlayerState::Initial | PlayerState::Ready | PlayerState::Set);
    if waits && has_kick_off { 0xffffff } else { OFF }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_of_play_has_its_colour() {
        let colours =
            [PlayerState::Ready, PlayerState::Set, PlayerState::Playing, PlayerState::Penalized].map(chest);
        assert_eq!(colours, [0x0000ff, 0xffff00, 0x00ff00, 0xff0000]);
        assert_eq!((chest(PlayerState::Initial), chest(PlayerState::Finished)), (OFF, OFF));
    }

    #[test]
    fn the_right_foot_shows_the_kick_off_until_play() {
        assert_eq!(kick_off_foot(PlayerState::Set, true), 0xffffff);
        assert_eq!(kick_off_foot(PlayerState::Set, false), OFF);
        assert_eq!(kick_off_foot(PlayerState::Playing, true), OFF);
    }

    #[test]
    fn the_eyes_show_ball_and_pose() {
        assert_eq!((ball_eye(true), ball_eye(false)), (0xff0000, OFF));
        assert_eq!((pose_eye(0.0), pose_eye(1.0), pose_eye(f64::NAN)), (OFF, 0x00ff00, OFF));
    }
}
