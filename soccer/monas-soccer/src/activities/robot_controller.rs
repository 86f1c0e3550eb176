//! The state of the game, from the referee and the chest button.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use monas_robot::{Announcement, Posture, topics as body};
use narukom::{Header, PublisherId};

use crate::functionality::field::FieldModel;
use crate::functionality::game::{GamePhase, GameTracker};
use crate::functionality::placement::PlacementTracker;
use crate::{GameState, Placement, PlayerState, convert, topics};

/// Publishes the state of the game from the referee's announcements, presses of the chest button,
/// and whether the robot was lifted and put down.
/// The place for a kick-off follows from the number in the announcement.
///
/// Parameters are rules of the league that the referee does not announce: `area_depth` and
/// `area_width` (m), the size of the goal area, and `circle_radius` (m) of the centre circle. The
/// defaults are those of 2010.
#[derive(Clone, Debug)]
pub struct RobotController {
    area: (f64, f64),
    circle_radius: f64,
    game: GameTracker,
    last_announcement: Option<(PublisherId, u64)>,
    button: Button,
    placements: PlacementTracker,
    last_state: Option<GameState>,
}

/// The chest button; only the rising edge counts. `seen_until` is the last reading of the sensors.
#[derive(Clone, Copy, Debug, Default)]
struct Button {
    seen_until: u64,
    pressed: bool,
}

impl Default for RobotController {
    fn default() -> RobotController {
        let FieldModel { area_depth, area_width, circle_radius, .. } = FieldModel::LEAGUE_2010;
        RobotController {
            area: (area_depth, area_width),
            circle_radius,
            game: GameTracker::default(),
            last_announcement: None,
            button: Button::default(),
            placements: PlacementTracker::default(),
            last_state: None,
        }
    }
}

impl Activity for RobotController {
    fn configure(&mut self, parameters: &Parameters) {
        self.area.0 = parameters.number("area_depth").unwrap_or(self.area.0);
        self.area.1 = parameters.number("area_width").unwrap_or(self.area.1);
        self.circle_radius = parameters.number("circle_radius").unwrap_or(self.circle_radius);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let announcement = blackboard.sample(body::ANNOUNCEMENT);
        self.feel(blackboard, announcement.map(|sample| sample.message));
        if let Some(announcement) = announcement
            && self.is_news(announcement.header)
        {
            self.game.announce(convert::phase(announcement.message), announcement.penalized);
        }
        let game_state = self.game_state(announcement.map(|sample| sample.message));
        if self.last_state.as_ref() != Some(&game_state) {
            blackboard.publish(topics::GAME_STATE, game_state)?;
            self.last_state = Some(game_state);
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(body::SENSORS).reads(body::ANNOUNCEMENT).publishes(topics::GAME_STATE)
    }
}

impl RobotController {
    fn is_news(&mut self, header: &Header) -> bool {
        let this = Some((header.publisher, header.sequence));
        let is_news = self.last_announcement != this;
        self.last_announcement = this;
        is_news
    }

    fn feel(&mut self, blackboard: &Blackboard, said: Option<&Announcement>) {
        let phase = said.map_or(GamePhase::Initial, convert::phase);
        let is_penalized = said.is_some_and(|said| said.penalized);
        for sensors in blackboard.recent(body::SENSORS, std::time::Duration::MAX) {
            if sensors.measured_at <= self.button.seen_until {
                continue;
            }
            if sensors.chest_button && !self.button.pressed {
                self.game.press_chest_button();
            }
            self.placements.feel(sensors.posture() == Posture::Lifted, phase, is_penalized);
            self.button = Button { seen_until: sensors.measured_at, pressed: sensors.chest_button };
        }
    }

    fn game_state(&self, announcement: Option<&Announcement>) -> GameState {
        let player_state = PlayerState::from(self.game.state()).into();
        let (by_hand, placement) = self.placements.placements();
        let Some(said) = announcement else {
            return GameState { player_state, ..GameState::default() };
        };
        // A body that puts itself at a pose is not lifted.
        let placement = if said.placements > 0 { Placement::KnownPose } else { placement.into() };
        GameState {
            player_state,
            team: said.team,
            number: said.number,
            team_colour: said.team_colour,
            goal_to_attack: said.goal_to_attack,
            own_score: said.own_score,
            opponent_score: said.opponent_score,
            secs_remaining: said.seconds_left,
            first_half: said.first_half,
            kick_off_own: said.kick_off,
            placements: said.placements + by_hand,
            placement: placement.into(),
            placed_x: said.placed_x,
            placed_y: said.placed_y,
            placed_heading: said.placed_heading,
            field_length: said.field_length,
            field_width: said.field_width,
            goal_width: said.goal_width,
            area_depth: self.area.0,
            area_width: self.area.1,
            circle_radius: self.circle_radius,
            set_play: said.set_play,
            ..GameState::default()
        }
        .with_kick_off_pose()
    }
}

monas::activity!(RobotController);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::{ActivityFixture, TICK};

    fn announcement(phase: monas_robot::GamePhase, penalized: bool) -> Announcement {
        Announcement {
            phase: phase.into(),
            penalized,
            team: 3,
            number: 2,
            field_length: 6.0,
            ..Announcement::default()
        }
    }

    #[test]
    fn it_publishes_the_referees_state_when_it_changes() {
        let (mut stage, mut activity) = (ActivityFixture::new(), RobotController::default());
        stage.run(&mut activity);
        assert_eq!(stage.latest(topics::GAME_STATE).unwrap().player_state(), PlayerState::Initial);
        stage
            .publish(body::ANNOUNCEMENT, announcement(monas_robot::GamePhase::Playing, false))
            .run(&mut activity);
        let game = stage.latest(topics::GAME_STATE).unwrap();
        assert_eq!((game.player_state(), game.team, game.number), (PlayerState::Playing, 3, 2));
        assert_eq!(stage.count_arrivals(topics::GAME_STATE), 0);
        stage.wait(TICK).run(&mut activity);
        assert_eq!(stage.count_arrivals(topics::GAME_STATE), 0);
        stage
            .publish(body::ANNOUNCEMENT, announcement(monas_robot::GamePhase::Playing, true))
            .run(&mut activity);
        assert_eq!(stage.latest(topics::GAME_STATE).unwrap().player_state(), PlayerState::Penalized);
    }

    #[test]
    fn a_halted_robot_waits_and_a_set_play_is_published() {
        let (mut stage, mut activity) = (ActivityFixture::new(), RobotController::default());
        for (phase, state) in [
            (monas_robot::GamePhase::Initial, PlayerState::Initial),
            (monas_robot::GamePhase::Ready, PlayerState::Set),
            (monas_robot::GamePhase::Playing, PlayerState::Set),
            (monas_robot::GamePhase::Finished, PlayerState::Finished),
        ] {
            let set_play = monas_robot::SetPlay::CornerKick.into();
            let announced = Announcement { halted: true, set_play, ..announcement(phase, false) };
            stage.publish(body::ANNOUNCEMENT, announced).run(&mut activity);
            let game = stage.latest(topics::GAME_STATE).unwrap();
            assert_eq!((game.player_state(), game.set_play()), (state, crate::SetPlay::CornerKick));
        }
    }

    #[test]
    fn the_size_of_the_goal_area_is_a_parameter() {
        let (mut stage, mut activity) = (ActivityFixture::new(), RobotController::default());
        let announced = announcement(monas_robot::GamePhase::Ready, false);
        stage.publish(body::ANNOUNCEMENT, announced).run(&mut activity);
        assert_eq!(stage.latest(topics::GAME_STATE).unwrap().field().area_depth, 0.6);
        activity.configure(&Parameters::new().with("area_depth", "0.8"));
        stage.publish(body::ANNOUNCEMENT, announced).run(&mut activity);
        assert_eq!(stage.latest(topics::GAME_STATE).unwrap().field().area_depth, 0.8);
    }

    #[test]
    fn a_robot_that_is_put_down_knows_only_that() {
        let (mut stage, mut activity) = (ActivityFixture::new(), RobotController::default());
        stage.publish(body::ANNOUNCEMENT, announcement(monas_robot::GamePhase::Set, false));
        for (measured_at, posture) in [(1, Posture::Lifted), (2, Posture::Lifted), (3, Posture::Standing)] {
            let felt = monas_robot::Sensors { measured_at, posture: posture.into(), ..Default::default() };
            stage.publish(body::SENSORS, felt);
        }
        stage.run(&mut activity);
        let game = stage.latest(topics::GAME_STATE).unwrap();
        assert_eq!((game.placements, game.placement()), (1, Placement::OwnHalf));
        let itself =
            Announcement { placements: 4, placed_x: 1.0, ..announcement(monas_robot::GamePhase::Set, false) };
        stage.publish(body::ANNOUNCEMENT, itself).run(&mut activity);
        let game = stage.latest(topics::GAME_STATE).unwrap();
        assert_eq!((game.placements, game.placement(), game.placed_x), (5, Placement::KnownPose, 1.0));
    }

    #[test]
    fn a_held_chest_button_is_one_press() {
        let (mut stage, mut activity) = (ActivityFixture::new(), RobotController::default());
        for (measured_at, chest_button) in [(1, false), (2, true), (3, true), (4, true)] {
            let felt = monas_robot::Sensors { measured_at, chest_button, ..Default::default() };
            stage.publish(body::SENSORS, felt).run(&mut activity);
        }
        assert_eq!(stage.latest(topics::GAME_STATE).unwrap().player_state(), PlayerState::Penalized);
        for (measured_at, chest_button) in [(5, false), (6, true)] {
            let felt = monas_robot::Sensors { measured_at, chest_button, ..Default::default() };
            stage.publish(body::SENSORS, felt);
        }
        stage.run(&mut activity);
        assert_eq!(stage.latest(topics::GAME_STATE).unwrap().player_state(), PlayerState::Playing);
    }
}
