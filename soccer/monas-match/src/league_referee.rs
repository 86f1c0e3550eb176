//! The referee's end of the league's protocol: the referee of the match announces its decisions to
//! robots elsewhere.

use std::collections::BTreeMap;
use std::time::Duration;

use monas::{BoxError, Timestamp};
use monas_gamecontroller::{
    Competition, Connection, ControlSender, GameControlData, JerseyColour, LeagueState, MAX_PLAYERS, Penalty,
    RuleBook, TeamData, WhistleDelay,
};
use monas_sim::{FieldSide, GameState, Offence, SharedField, SimulatedWorld, TeamColour};

use crate::league::{LeagueEnd, LeagueJournal};

/// The referee of a match as a GameController.
pub(crate) struct LeagueReferee {
    sender: ControlSender,
    competition: Competition,
    whistle: WhistleDelay,
    /// The state that was sent last.
    announced: Option<GameState>,
    /// The connections of players that were reported last.
    connections: BTreeMap<(u8, u8), Connection>,
}

impl LeagueReferee {
    pub(crate) fn new(sender: ControlSender, rules: RuleBook, whistle_delay: Duration) -> LeagueReferee {
        LeagueReferee {
            sender,
            competition: Competition::of(rules),
            whistle: WhistleDelay::new(whistle_delay),
            announced: None,
            connections: BTreeMap::new(),
        }
    }

    fn note_connections(&mut self, now: Timestamp, journal: &mut LeagueJournal) {
        for ((team, player), connection) in self.sender.online().players(now) {
            if self.connections.insert((team, player), connection) == Some(connection) {
                continue;
            }
            let text = match connection {
                Connection::Good => "is online",
                Connection::Bad => "has a bad connection",
                Connection::Offline => "is offline",
            };
            journal.note(format!("player {player} of team {team} {text}"));
        }
    }
}

impl LeagueEnd for LeagueReferee {
    fn exchange(
        &mut self,
        pitch: &SharedField,
        now: Timestamp,
        journal: &mut LeagueJournal,
    ) -> Result<(), BoxError> {
        let state = pitch.with_world(|world| world.referee().state());
        if self.sender.is_due(now) || self.announced != Some(state) {
            self.announced = Some(state);
            let messages = pitch.messages_sent();
            let truth = pitch.with_world(|world| control_data(world, self.competition, messages));
            match self.sender.send(&self.whistle.shown(&truth, now), now) {
                Ok(()) => journal.counts.control = self.sender.sent(),
                Err(error) => journal.warn(format!("the referee cannot announce: {error}")),
            }
        }
        let reports = journal.read(|| self.sender.receive(now));
        journal.counts.reports += reports.len() as u64;
        self.note_connections(now, journal);
        Ok(())
    }
}

/// The state of a match as control data; players that are not in the line-up are substitutes.
fn control_data(world: &SimulatedWorld, competition: Competition, messages: [u32; 2]) -> GameControlData {
    let referee = world.referee();
    // Only this rule book can announce that the game is stopped.
    let competition = match competition {
        Competition::HumanoidSoccer { size, .. } => {
            Competition::HumanoidSoccer { size, is_stopped: referee.is_stopped() }
        }
        other => other,
    };
    let left = usize::from(referee.defends()[1] == FieldSide::Left);
    let order = [left, 1 - left];
    let numbers = order.map(|team| world.teams()[team].number);
    let count = |team: usize| world.robots().iter().filter(|robot| robot.team == team).count();
    let is_before_play = !matches!(referee.state(), GameState::Playing | GameState::Finished);
    GameControlData {
        players_per_team: count(0).max(count(1)) as u8,
        state: state(referee.state()),
        is_first_half: referee.half() == 1,
        kicking_team: is_before_play.then(|| world.teams()[referee.kick_off_team()].number),
        seconds_left: referee.seconds_remaining().ceil() as i16,
        teams: order.map(|team| team_data(world, team, messages[team])),
        ..GameControlData::new(competition, numbers)
    }
}

fn team_data(world: &SimulatedWorld, team: usize, messages: u32) -> TeamData {
    let referee = world.referee();
    let colour = match referee.colours()[team] {
        TeamColour::Blue => JerseyColour::Blue,
        TeamColour::Red => JerseyColour::Red,
    };
    let mut data = TeamData::new(world.teams()[team].number, colour);
    data.score = u8::try_from(referee.score()[team]).unwrap_or(u8::MAX);
    data.message_budget = (world.radio().message_budget - f64::from(messages)) as u16;
    for number in 1..=MAX_PLAYERS as u8 {
        let robot = world.robots().iter().position(|robot| (robot.team, robot.number) == (team, number));
        let Some(player) = data.player_mut(number) else { continue };
        match robot {
            None => player.penalty = Some(Penalty::Substitute),
            Some(robot) => {
                let served = referee.penalty(robot);
                player.penalty = served.map(|served| penalty(served.offence));
                player.seconds_left = served.map_or(0.0, |served| served.remaining).ceil() as u8;
            }
        }
    }
    data
}

fn penalty(offence: Offence) -> Penalty {
    match offence {
        Offence::Pushing => Penalty::Pushing,
        Offence::BallHolding => Penalty::BallHolding,
        Offence::IllegalDefender => Penalty::IllegalPosition,
        Offence::Announced => Penalty::PickUp,
    }
}

fn state(state: GameState) -> LeagueState {
    match state {
        GameState::Initial => LeagueState::Initial,
        GameState::Ready => LeagueState::Ready,
        GameState::Set => LeagueState::Set,
        GameState::Playing => LeagueState::Playing,
        GameState::Finished => LeagueState::Finished,
    }
}

#[cfg(test)]
mod tests {
    use monas_sim::{RefereeCall, Setup};

    use super::*;

    #[test]
    fn a_game_that_a_person_stops_is_announced_where_the_rules_can_say_so() {
        let mut world = SimulatedWorld::new(Setup::three_against_three(1)).unwrap();
        let halted = |world: &SimulatedWorld, rules| {
            control_data(world, Competition::of(rules), [0, 0]).competition.is_stopped()
        };
        assert!(!halted(&world, RuleBook::HumanoidSoccer));
        world.call(RefereeCall::Stop).unwrap();
        assert!(halted(&world, RuleBook::HumanoidSoccer));
        assert!(!halted(&world, RuleBook::StandardPlatform));
    }
}
