//! The time for which the referee hides what its whistle has said.

use std::time::Duration;

use narukom::Timestamp;

use crate::{GameControlData, LeagueState};

/// Hides the begin of play and a goal from players for a while: the league lets robots hear the
/// referee's whistle before the GameController announces it.
#[derive(Clone, Debug)]
pub struct WhistleDelay {
    delay: Duration,
    /// What players have been shown last, and since when it differs from the true state.
    shown: Option<GameControlData>,
    hidden_since: Option<Timestamp>,
}

impl WhistleDelay {
    /// Hides for this time: 15 s in the league, zero to hide nothing.
    pub fn new(delay: Duration) -> WhistleDelay {
        WhistleDelay { delay, shown: None, hidden_since: None }
    }

    /// What players may know of the true state now: its clocks and penalties always; the state, the
    /// score and who kicks once the delay has passed.
    pub fn shown(&mut self, truth: &GameControlData, now: Timestamp) -> GameControlData {
        let hidden = self.shown.take().filter(|shown| is_whistled(shown.state, truth.state));
        let shown = match hidden {
            Some(before) if now.since(*self.hidden_since.get_or_insert(now)) < self.delay => {
                let mut shown = truth.clone();
                (shown.state, shown.set_play) = (before.state, before.set_play);
                (shown.kicking_team, shown.secondary_seconds) =
                    (before.kicking_team, before.secondary_seconds);
                for (team, before) in shown.teams.iter_mut().zip(&before.teams) {
                    team.score = before.score;
                }
                shown
            }
            _ => {
                self.hidden_since = None;
                truth.clone()
            }
        };
        self.shown = Some(shown.clone());
        shown
    }
}

/// Whether a whistle announces this change of state.
fn is_whistled(from: LeagueState, to: LeagueState) -> bool {
    matches!(
        (from, to),
        (LeagueState::Set, LeagueState::Playing) | (LeagueState::Playing, LeagueState::Ready)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Competition;

    #[test]
    fn play_and_goals_are_hidden_until_the_whistle_must_have_been_heard() {
        let at = |seconds| Timestamp::ZERO + Duration::from_secs(seconds);
        let mut whistle = WhistleDelay::new(Duration::from_secs(15));
        let mut truth = GameControlData::new(Competition::default(), [1, 2]);
        let mut state = |truth: &GameControlData, time| {
            let shown = whistle.shown(truth, at(time));
            assert_eq!(shown.seconds_left, truth.seconds_left, "the clock is never hidden");
            (shown.state, shown.teams[0].score)
        };
        truth.state = LeagueState::Set;
        assert_eq!(state(&truth, 0), (LeagueState::Set, 0));
        (truth.state, truth.seconds_left) = (LeagueState::Playing, 599);
        assert_eq!(state(&truth, 1), (LeagueState::Set, 0));
        assert_eq!(state(&truth, 15), (LeagueState::Set, 0));
        assert_eq!(state(&truth, 16), (LeagueState::Playing, 0));
        (truth.state, truth.teams[0].score) = (LeagueState::Ready, 1);
        assert_eq!(state(&truth, 20), (LeagueState::Playing, 0));
        assert_eq!(state(&truth, 35), (LeagueState::Ready, 1));
        truth.state = LeagueState::Set;
        assert_eq!(state(&truth, 36), (LeagueState::Set, 1), "SET has no whistle");
    }
}
