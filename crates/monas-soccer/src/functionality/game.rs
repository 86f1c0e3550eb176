//! The state of a player in the game: what the referee says, and what the chest button says where there is no referee.
//!
//! The rules of the league let a team play without a referee's computer: the first press of the chest button takes a robot from INITIAL
//! to PENALIZED, every further one from PENALIZED to PLAYING and back. With a referee a press penalises, or takes such a penalty back,
//! until the referee's own penalty is lifted.

/// The phase of the game that the referee announces.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Phase {
    /// Before the game.
    Initial,
    /// Robots take their places.
    Ready,
    /// Robots wait for the kick-off.
    Set,
    /// The ball is free.
    Playing,
    /// The half is over.
    Finished,
}

/// The state of a player.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum State {
    /// Before the game.
    Initial,
    /// Walks to its place.
    Ready,
    /// Waits for the kick-off.
    Set,
    /// Plays.
    Playing,
    /// Serves a penalty.
    Penalized,
    /// The half is over.
    Finished,
}

/// Follows referee and chest button.
#[derive(Clone, Copy, Debug, Default)]
pub struct Game {
    announced: Option<(Phase, bool)>,
    /// Whether the button has started the game.
    started: bool,
    /// Whether the button has penalised the robot.
    penalized_by_hand: bool,
}

impl Game {
    /// Takes what the referee says: the phase, and whether this robot is penalised.
    pub fn announce(&mut self, phase: Phase, penalized: bool) {
        let lifted = matches!(self.announced, Some((_, true))) && !penalized;
        if lifted {
            self.penalized_by_hand = false;
        }
        self.announced = Some((phase, penalized));
    }

    /// Takes a press of the chest button.
    pub fn press_chest_button(&mut self) {
        let first = !self.started && self.announced.is_none();
        self.penalized_by_hand = first || !self.penalized_by_hand;
        self.started = true;
    }

    /// The state of the player.
    pub fn state(&self) -> State {
        let unannounced = if self.started { Phase::Playing } else { Phase::Initial };
        let (phase, penalized) = self.announced.unwrap_or((unannounced, false));
        match phase {
            Phase::Finished => State::Finished,
            _ if penalized || self.penalized_by_hand => State::Penalized,
            Phase::Initial => State::Initial,
            Phase::Ready => State::Ready,
            Phase::Set => State::Set,
            Phase::Playing => State::Playing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_referee_is_followed() {
        let mut game = Game::default();
        assert_eq!(game.state(), State::Initial);
        let phases = [
            (Phase::Initial, State::Initial),
            (Phase::Ready, State::Ready),
            (Phase::Set, State::Set),
            (Phase::Playing, State::Playing),
            (Phase::Finished, State::Finished),
        ];
        for (phase, state) in phases {
            game.announce(phase, false);
            assert_eq!(game.state(), state);
        }
        game.announce(Phase::Playing, true);
        assert_eq!(game.state(), State::Penalized);
    }

    #[test]
    fn without_a_referee_the_chest_button_starts_and_penalises() {
        let mut game = Game::default();
        for state in [State::Penalized, State::Playing, State::Penalized, State::Playing] {
            game.press_chest_button();
            assert_eq!(game.state(), state);
        }
    }

    #[test]
    fn with_a_referee_the_button_penalises_until_the_referee_lifts_it() {
        let mut game = Game::default();
        game.announce(Phase::Playing, false);
        game.press_chest_button();
        assert_eq!(game.state(), State::Penalized);
        game.announce(Phase::Playing, true);
        game.announce(Phase::Playing, false);
        assert_eq!(game.state(), State::Playing);
        game.press_chest_button();
        game.press_chest_button();
        assert_eq!(game.state(), State::Playing);
    }
}
