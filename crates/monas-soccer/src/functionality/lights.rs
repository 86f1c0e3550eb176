//! What the lights tell people beside the field.

use super::game::State;

/// A colour, 0xRRGGBB.
pub type Rgb = u32;

/// Dark.
pub const OFF: Rgb = 0x000000;

/// The colour that the rules give the chest in a state of the game.
pub fn chest(state: State) -> Rgb {
    match state {
        State::Initial | State::Finished => OFF,
        State::Ready => 0x0000ff,
        State::Set => 0xffff00,
        State::Playing => 0x00ff00,
        State::Penalized => 0xff0000,
    }
}

/// The colour of an eye that shows whether the ball is seen: red if it is, for a red ball.
pub fn ball_eye(found: bool) -> Rgb {
    if found { 0xff0000 } else { OFF }
}

/// The colour of an eye that shows how well the robot knows where it stands: from dark to bright green.
pub fn pose_eye(confidence: f64) -> Rgb {
    let green = (255.0 * confidence.clamp(0.0, 1.0)) as u32;
    green << 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_of_play_has_its_colour() {
        let colours = [State::Ready, State::Set, State::Playing, State::Penalized].map(chest);
        assert_eq!(colours, [0x0000ff, 0xffff00, 0x00ff00, 0xff0000]);
        assert_eq!((chest(State::Initial), chest(State::Finished)), (OFF, OFF));
    }

    #[test]
    fn the_eyes_show_ball_and_pose() {
        assert_eq!((ball_eye(true), ball_eye(false)), (0xff0000, OFF));
        assert_eq!((pose_eye(0.0), pose_eye(1.0), pose_eye(f64::NAN)), (OFF, 0x00ff00, OFF));
    }
}
