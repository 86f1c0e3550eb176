//! The time for which the referee hides what its whistle has said.

use std::time::Duration;

use narukom::Timestamp;

use crate::{GameControlData, LeagueState, TeamData};

/// Hides the begin of play and a goal from players for a while: the league lets robots hear the
/// referee's whistle before the GameController announces it.
///
/// As in the league's GameController, a goal soon after the begin of play is hidden for its own
/// time, in which players are shown PLAYING; whatever is announced without this whistle, such as a
/// penalty kick, ends the hiding.
#[derive(Clone, Debug)]
pub struct WhistleDelay {
    delay: Duration,
    /// The true state at the last call.
    truth: Option<GameControlData>,
    /// The state before the last whistle, and when that was.
    hidden: Option<(GameControlData, Timestamp)>,
}

impl WhistleDelay {
    /// Hides for this time: 15 s in the league, zero to hide nothing.
    pub fn new(delay: Duration) -> WhistleDelay {
        WhistleDelay { delay, truth: None, hidden: None }
    }

    /// The part of the true state that players may know now: its clocks and penalties always; the
    /// state, the score and the kicking team once the delay has passed.
    pub fn shown(&mut self, truth: &GameControlData, now: Timestamp) -> GameControlData {
        if let Some(before) = self.truth.replace(truth.clone()) {
            if is_whistled(&before, truth) {
                self.hidden = Some((before, now));
            } else if is_announced(&before, truth) {
                self.hidden = None;
            }
        }
        let mut shown = truth.clone();
        match &self.hidden {
            Some((before, since)) if now.since(*since) < self.delay => {
                (shown.state, shown.set_play) = (before.state, before.set_play);
                (shown.kicking_team, shown.secondary_seconds) =
                    (before.kicking_team, before.secondary_seconds);
                for (team, before) in shown.teams.iter_mut().zip(&before.teams) {
                    team.score = before.score;
                }
            }
            _ => self.hidden = None,
        }
        shown
    }
}

/// Whether the whistle announces this change: of the begin of play, or of a goal. Set plays that
/// begin with READY, such as a penalty kick, are announced by the GameController.
fn is_whistled(from: &GameControlData, to: &GameControlData) -> bool {
    match (from.state, to.state) {
        (LeagueState::Set, LeagueState::Playing) => true,
        (_, LeagueState::Ready) => {
            // The order of the teams changes with their sides.
            let scored = |team: &TeamData| {
                from.teams.iter().any(|before| before.number == team.number && before.score < team.score)
            };
            to.teams.iter().any(scored)
        }
        _ => false,
    }
}

/// Whether the GameController announces this change at once. The end of a set play is none: it
/// would end the hiding of a kick-off.
fn is_announced(from: &GameControlData, to: &GameControlData) -> bool {
    let begins_set_play = to.set_play.is_some() && to.set_play != from.set_play;
    from.state != to.state || from.is_first_half != to.is_first_half || begins_set_play
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Competition, SetPlay};

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

    /// The state and the score of the first team shown to players at these seconds.
    fn shown(steps: &[(u64, &GameControlData)]) -> Vec<(LeagueState, u8)> {
        let mut whistle = WhistleDelay::new(Duration::from_secs(15));
        let shown = |(seconds, truth): &(u64, &GameControlData)| {
            let shown = whistle.shown(truth, Timestamp::ZERO + Duration::from_secs(*seconds));
            (shown.state, shown.teams[0].score)
        };
        steps.iter().map(shown).collect()
    }

    fn data(state: LeagueState) -> GameControlData {
        GameControlData { state, ..GameControlData::new(Competition::default(), [1, 2]) }
    }

    #[test]
    fn a_penalty_kick_and_the_second_half_are_shown_at_once() {
        let (set, playing) = (data(LeagueState::Set), data(LeagueState::Playing));
        let kick = GameControlData {
            set_play: Some(SetPlay::PenaltyKick),
            kicking_team: Some(2),
            ..data(LeagueState::Ready)
        };
        let expected = [(LeagueState::Playing, 0), (LeagueState::Ready, 0)];
        assert_eq!(shown(&[(0, &playing), (1, &kick)]), expected);
        // The begin of play is hidden, and the penalty kick says that it has begun.
        let expected = [(LeagueState::Set, 0), (LeagueState::Set, 0), (LeagueState::Ready, 0)];
        assert_eq!(shown(&[(0, &set), (1, &playing), (5, &kick)]), expected);
        let mut ahead = playing;
        ahead.teams[1].score = 2;
        let mut second = GameControlData { is_first_half: false, ..data(LeagueState::Ready) };
        second.teams = [ahead.teams[1].clone(), ahead.teams[0].clone()];
        assert_eq!(shown(&[(0, &ahead), (1, &second)])[1], (LeagueState::Ready, 2));
    }

    #[test]
    fn a_goal_soon_after_the_kick_off_is_hidden_for_its_own_time() {
        let (set, playing) = (data(LeagueState::Set), data(LeagueState::Playing));
        let mut goal = data(LeagueState::Ready);
        goal.teams[0].score = 1;
        let steps = [(0, &set), (1, &playing), (6, &goal), (16, &goal), (20, &goal), (21, &goal)];
        let expected = [
            (LeagueState::Set, 0),
            (LeagueState::Set, 0),
            (LeagueState::Playing, 0),
            (LeagueState::Playing, 0),
            (LeagueState::Playing, 0),
            (LeagueState::Ready, 1),
        ];
        assert_eq!(shown(&steps), expected);
    }
}
