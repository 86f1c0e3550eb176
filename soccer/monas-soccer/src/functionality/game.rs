//! The state of a player in the game, from the referee or, without a referee, from the chest
//! button.
//!
//! The rules of the league allow play without a referee's computer: the first press of the chest
//! button switches a robot from INITIAL to PENALIZED, each further one between PENALIZED and
//! PLAYING. With a referee, a press penalises or revokes such a penalty, until the referee lifts
//! its own penalty.

/// The phase of the game that the referee announces.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum GamePhase {
    /// Before the game.
    Initial,
    /// Robots walk to their positions.
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
pub enum PlayerState {
    /// Before the game.
    Initial,
    /// Walks to its position.
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

/// Tracks referee and chest button.
#[derive(Clone, Copy, Debug, Default)]
pub struct GameTracker {
    announced: Option<(GamePhase, bool)>,
    /// Whether the button has started the game.
    started: bool,
    /// Whether the button has penalised the robot.
    penalized_by_hand: bool,
}

impl GameTracker {
    /// Processes an announcement: the phase, and whether this robot is penalised.
    pub fn announce(&mut self, phase: GamePhase, penalized: bool) {
        let lifted = matches!(self.announced, Some((_, true))) && !penalized;
        if lifted {
            self.penalized_by_hand = false;
        }
        self.announced = Some((phase, penalized));
    }

    /// Processes a press of the chest button.
    pub fn press_chest_button(&mut self) {
        let first = !self.started && self.announced.is_none();
        self.penalized_by_hand = first || !self.penalized_by_hand;
        self.started = true;
    }

    /// The state of the player.
    pub fn state(&self) -> PlayerState {
        let unannounced = if self.started { GamePhase::Playing } else { GamePhase::Initial };
        let (phase, penalized) = self.announced.unwrap_or((unannounced, false));
        match phase {
            GamePhase::Finished => PlayerState::Finished,
            _ if penalized || self.penalized_by_hand => PlayerState::Penalized,
            GamePhase::Initial => PlayerState::Initial,
            GamePhase::Ready => PlayerState::Ready,
            GamePhase::Set => PlayerState::Set,
            GamePhase::Playing => PlayerState::Playing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_referee_is_followed() {
        let mut game = GameTracker::default();
        assert_eq!(game.state(), PlayerState::Initial);
        let phases = [
            (GamePhase::Initial, PlayerState::Initial),
            (GamePhase::Ready, PlayerState::Ready),
            (GamePhase::Set, PlayerState::Set),
            (GamePhase::Playing, PlayerState::Playing),
            (GamePhase::Finished, PlayerState::Finished),
        ];
        for (phase, state) in phases {
            game.announce(phase, false);
            assert_eq!(game.state(), state);
        }
        game.announce(GamePhase::Playing, true);
        assert_eq!(game.state(), PlayerState::Penalized);
    }

    #[test]
    fn without_a_referee_the_chest_button_starts_and_penalises() {
        let mut game = GameTracker::default();
        for state in
            [PlayerState::Penalized, PlayerState::Playing, PlayerState::Penalized, PlayerState::Playing]
        {
            game.press_chest_button();
            assert_eq!(game.state(), state);
        }
    }

    #[test]
    fn with_a_referee_the_button_penalises_until_the_referee_lifts_it() {
        let mut game = GameTracker::default();
        game.announce(GamePhase::Playing, false);
        game.press_chest_button();
        assert_eq!(game.state(), PlayerState::Penalized);
        game.announce(GamePhase::Playing, true);
        game.announce(GamePhase::Playing, false);
        assert_eq!(game.state(), PlayerState::Playing);
        game.press_chest_button();
        game.press_chest_button();
        assert_eq!(game.state(), PlayerState::Playing);
    }
}
