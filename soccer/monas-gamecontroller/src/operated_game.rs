//! A game whose decisions a person makes.

use std::time::Duration;

use narukom::Timestamp;

use crate::{
    Competition, GameControlData, LeagueState, MAX_PLAYERS, OperatorCommand, Penalty, RuleBook, SetPlay,
};

/// Seconds of READY before a kick-off, and before a penalty kick.
const READY_SECONDS: (i16, i16) = (45, 30);
/// Seconds for which the other team stays away from the ball: after a kick-off, and in a set play.
const RESTART_SECONDS: (i16, i16) = (10, 30);
/// Seconds of a penalty, and of one for motion or position in SET.
const PENALTY_SECONDS: (u8, u8) = (45, 15);

/// A game that an operator decides.
///
/// It keeps the clocks and what follows from a decision: a goal leads to READY with the kick-off of
/// the other team, a half-time switch exchanges sides, the time of a half runs while the ball is in
/// play. The durations are those of the Standard Platform League's GameController.
#[derive(Clone, Debug)]
pub struct OperatedGame {
    data: GameControlData,
    half: i16,
    /// The moment up to which whole seconds have been counted.
    counted: Timestamp,
}

impl OperatedGame {
    /// A game of the teams with these numbers that has not begun. Players beyond `players` are
    /// substitutes; the clock starts at `now`.
    pub fn new(rules: RuleBook, teams: [u8; 2], players: u8, half: Duration, now: Timestamp) -> OperatedGame {
        let half = i16::try_from(half.as_secs()).unwrap_or(i16::MAX);
        let mut data = GameControlData::new(Competition::of(rules), teams);
        (data.players_per_team, data.seconds_left) = (players, half);
        for team in &mut data.teams {
            for player in players.saturating_add(1)..=MAX_PLAYERS as u8 {
                if let Some(player) = team.player_mut(player) {
                    player.penalty = Some(Penalty::Substitute);
                }
            }
        }
        OperatedGame { data, half, counted: now }
    }

    /// The present state.
    pub fn data(&self) -> &GameControlData {
        &self.data
    }

    /// Counts the seconds until a moment.
    pub fn advance(&mut self, now: Timestamp) {
        while now.since(self.counted) >= Duration::from_secs(1) {
            self.counted += Duration::from_secs(1);
            self.count_second();
        }
    }

    fn count_second(&mut self) {
        let data = &mut self.data;
        if data.competition.is_stopped() {
            return;
        }
        let is_playing = data.state == LeagueState::Playing;
        if is_playing {
            data.seconds_left = data.seconds_left.saturating_sub(1);
        }
        if data.secondary_seconds > 0 {
            data.secondary_seconds -= 1;
            if is_playing && data.secondary_seconds == 0 {
                (data.set_play, data.kicking_team) = (None, None);
            }
        }
        if matches!(data.state, LeagueState::Playing | LeagueState::Ready | LeagueState::Set) {
            for player in data.teams.iter_mut().flat_map(|team| &mut team.players) {
                player.seconds_left = player.seconds_left.saturating_sub(1);
            }
        }
    }

    /// Carries out a decision.
    ///
    /// # Errors
    /// The state of the game or its rule book does not permit it: the reason, with what does.
    pub fn decide(&mut self, command: OperatorCommand) -> Result<(), String> {
        match command {
            OperatorCommand::Initial => self.stop(LeagueState::Initial),
            OperatorCommand::Standby => {
                self.permit(LeagueState::Standby.number(self.rules()))?;
                self.stop(LeagueState::Standby);
            }
            OperatorCommand::Ready { team } => {
                let team = team.map(|team| self.team(team)).transpose()?;
                self.data.set_play = None;
                self.data.kicking_team = team.map(|team| self.data.teams[team].number);
                self.enter(LeagueState::Ready, READY_SECONDS.0);
            }
            OperatorCommand::Set => {
                self.require(&[LeagueState::Ready], "SET follows READY")?;
                self.enter(LeagueState::Set, 0);
            }
            OperatorCommand::Play => {
                self.require(&[LeagueState::Set], "PLAYING follows SET")?;
                self.enter(LeagueState::Playing, RESTART_SECONDS.0);
            }
            OperatorCommand::Finish => self.stop(LeagueState::Finished),
            OperatorCommand::Half => self.switch_half()?,
            OperatorCommand::Goal { team } => self.count_goal(team)?,
            OperatorCommand::SetPlay { team, kind } => self.restart(team, kind)?,
            OperatorCommand::Penalize { team, player, penalty, seconds } => {
                self.penalize(team, player, penalty, seconds)?;
            }
            OperatorCommand::Return { team, player } => {
                let player = self.player(team, player)?;
                (player.penalty, player.seconds_left) = (None, 0);
            }
            OperatorCommand::Stop { is_stopped: stop } => match &mut self.data.competition {
                Competition::HumanoidSoccer { is_stopped, .. } => *is_stopped = stop,
                Competition::StandardPlatform { .. } => {
                    return Err(
                        "only the Humanoid Soccer League stops a game; `standby` is the nearest".into()
                    );
                }
            },
        }
        Ok(())
    }

    fn rules(&self) -> RuleBook {
        self.data.competition.rules()
    }

    /// Refuses numbers that the rule book does not define.
    fn permit(&self, number: Result<u8, crate::Error>) -> Result<(), String> {
        number.map(drop).map_err(|error| error.to_string())
    }

    fn require(&self, states: &[LeagueState], why: &str) -> Result<(), String> {
        match states.contains(&self.data.state) {
            true => Ok(()),
            false => Err(format!("{why}; the state is {}", self.data.state.to_string().to_uppercase())),
        }
    }

    fn enter(&mut self, state: LeagueState, secondary_seconds: i16) {
        (self.data.state, self.data.secondary_seconds) = (state, secondary_seconds);
    }

    /// Enters a state in which no team kicks.
    fn stop(&mut self, state: LeagueState) {
        (self.data.set_play, self.data.kicking_team) = (None, None);
        self.enter(state, 0);
    }

    /// The index of a team by its number.
    fn team(&self, number: u8) -> Result<usize, String> {
        let numbers = self.data.teams.each_ref().map(|team| team.number);
        let unknown =
            || format!("no team has the number {number}; there are {} and {}", numbers[0], numbers[1]);
        numbers.iter().position(|known| *known == number).ok_or_else(unknown)
    }

    fn player(&mut self, team: u8, number: u8) -> Result<&mut crate::PlayerData, String> {
        let team = self.team(team)?;
        let unknown = || format!("players have the numbers 1 to {MAX_PLAYERS}; {number} is none");
        self.data.teams[team].player_mut(number).ok_or_else(unknown)
    }

    fn count_goal(&mut self, team: u8) -> Result<(), String> {
        self.require(&[LeagueState::Playing], "a goal is scored in PLAYING")?;
        let team = self.team(team)?;
        let score = &mut self.data.teams[team].score;
        *score = score.saturating_add(1);
        self.data.set_play = None;
        self.data.kicking_team = Some(self.data.teams[1 - team].number);
        self.enter(LeagueState::Ready, READY_SECONDS.0);
        Ok(())
    }

    fn restart(&mut self, team: u8, kind: SetPlay) -> Result<(), String> {
        self.require(&[LeagueState::Playing], "a set play restarts PLAYING")?;
        self.permit(kind.number(self.rules()))?;
        let team = self.team(team)?;
        self.data.set_play = Some(kind);
        self.data.kicking_team = Some(self.data.teams[team].number);
        match kind {
            SetPlay::PenaltyKick => self.enter(LeagueState::Ready, READY_SECONDS.1),
            _ => self.enter(LeagueState::Playing, RESTART_SECONDS.1),
        }
        Ok(())
    }

    fn penalize(
        &mut self,
        team: u8,
        player: u8,
        penalty: Penalty,
        seconds: Option<u8>,
    ) -> Result<(), String> {
        self.permit(penalty.number(self.rules()))?;
        let usual = match penalty {
            Penalty::MotionInSet | Penalty::IllegalPositionInSet => PENALTY_SECONDS.1,
            Penalty::Substitute | Penalty::SentOff | Penalty::Manual => 0,
            _ => PENALTY_SECONDS.0,
        };
        let player = self.player(team, player)?;
        (player.penalty, player.seconds_left) = (Some(penalty), seconds.unwrap_or(usual));
        Ok(())
    }

    fn switch_half(&mut self) -> Result<(), String> {
        self.require(&[LeagueState::Finished], "sides are switched after a half")?;
        let data = &mut self.data;
        if !data.is_first_half {
            return Err("the second half is over".into());
        }
        data.teams.swap(0, 1);
        (data.is_first_half, data.seconds_left) = (false, self.half);
        self.stop(LeagueState::Initial);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn game(rules: RuleBook) -> OperatedGame {
        OperatedGame::new(rules, [5, 24], 3, Duration::from_secs(600), Timestamp::ZERO)
    }

    fn decide(game: &mut OperatedGame, line: &str) -> Result<(), String> {
        OperatorCommand::parse(line).and_then(|command| game.decide(command))
    }

    fn at(seconds: u64) -> Timestamp {
        Timestamp::ZERO + Duration::from_secs(seconds)
    }

    #[test]
    fn a_game_goes_from_kick_off_to_kick_off_and_the_clock_runs_in_play_only() {
        let mut game = game(RuleBook::StandardPlatform);
        decide(&mut game, "ready 24").unwrap();
        assert_eq!((game.data.kicking_team, game.data.secondary_seconds), (Some(24), 45));
        game.advance(at(40));
        assert_eq!((game.data.secondary_seconds, game.data.seconds_left), (5, 600));
        decide(&mut game, "set").unwrap();
        decide(&mut game, "play").unwrap();
        game.advance(at(49));
        assert_eq!((game.data.seconds_left, game.data.kicking_team), (591, Some(24)));
        game.advance(at(50));
        assert_eq!((game.data.seconds_left, game.data.kicking_team), (590, None), "the kick-off is over");
        decide(&mut game, "goal 5").unwrap();
        assert_eq!(game.data.teams.each_ref().map(|team| team.score), [1, 0]);
        assert_eq!((game.data.state, game.data.kicking_team), (LeagueState::Ready, Some(24)));
        decide(&mut game, "finish").unwrap();
        decide(&mut game, "half").unwrap();
        assert_eq!(game.data.teams.each_ref().map(|team| (team.number, team.score)), [(24, 0), (5, 1)]);
        assert_eq!((game.data.is_first_half, game.data.seconds_left), (false, 600));
    }

    #[test]
    fn penalties_have_their_time_and_end_by_decision() {
        let mut game = game(RuleBook::StandardPlatform);
        let player = |game: &OperatedGame| *game.data.teams[0].player(2).unwrap();
        assert_eq!(game.data.teams[0].player(4).unwrap().penalty, Some(Penalty::Substitute));
        decide(&mut game, "ready 5").unwrap();
        decide(&mut game, "penalize 5 2 pushing").unwrap();
        game.advance(at(5));
        assert_eq!((player(&game).penalty, player(&game).seconds_left), (Some(Penalty::Pushing), 40));
        game.advance(at(100));
        assert_eq!((player(&game).penalty, player(&game).seconds_left), (Some(Penalty::Pushing), 0));
        decide(&mut game, "return 5 2").unwrap();
        assert_eq!(player(&game).penalty, None);
    }

    #[test]
    fn what_the_state_or_the_rules_do_not_permit_is_refused_with_the_reason() {
        let mut game = game(RuleBook::HumanoidSoccer);
        for (line, reason) in [
            ("goal 5", "a goal is scored in PLAYING; the state is INITIAL"),
            ("play", "PLAYING follows SET; the state is INITIAL"),
            ("standby", "version 19 has no state `standby`"),
            ("ready 7", "no team has the number 7; there are 5 and 24"),
            ("penalize 5 21 pushing", "players have the numbers 1 to 20; 21 is none"),
            ("penalize 5 2 fallen or inactive", "version 19 has no penalty `fallen or inactive`"),
            ("half", "sides are switched after a half; the state is INITIAL"),
        ] {
            assert_eq!(decide(&mut game, line), Err(reason.to_owned()), "{line}");
        }
        decide(&mut game, "stop").unwrap();
        assert!(game.data.competition.is_stopped());
        let refused = decide(&mut self::game(RuleBook::StandardPlatform), "stop");
        assert!(refused.unwrap_err().starts_with("only the Humanoid Soccer League"));
    }

    #[test]
    fn no_team_kicks_where_the_game_does_not_go_on() {
        for line in ["finish", "initial", "standby"] {
            let mut game = game(RuleBook::StandardPlatform);
            for line in ["ready 5", "set", "play", "set-play 24 corner kick", line] {
                decide(&mut game, line).unwrap();
            }
            let GameControlData { set_play, kicking_team, secondary_seconds, .. } = game.data;
            assert_eq!((set_play, kicking_team, secondary_seconds), (None, None, 0), "{line}");
        }
    }

    #[test]
    fn every_decided_state_is_a_packet() {
        for rules in RuleBook::ALL {
            let mut game = game(rules);
            for line in
                ["ready 5", "set", "play", "set-play 24 corner kick", "penalize 24 1 pushing", "goal 24"]
            {
                decide(&mut game, line).unwrap();
                let packet = game.data().encode().unwrap();
                assert_eq!(GameControlData::decode(&packet).unwrap(), *game.data(), "{line}");
            }
        }
    }
}
