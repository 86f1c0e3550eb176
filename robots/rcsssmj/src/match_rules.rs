//! Converts the percepts of the server to an announcement of the state of the game.

use monas_robot::{Announcement, Colour, GamePhase, ObjectKind, SetPlay};

use crate::percept::{Game, PlayMode, Side};

/// The size of the field, m.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FieldSize {
    /// Between the goal lines.
    pub length: f64,
    /// Between the touch lines.
    pub width: f64,
    /// Between the posts of a goal.
    pub goal_width: f64,
}

impl Default for FieldSize {
    /// The field `fifa7vs7`, the usual one of the server.
    fn default() -> FieldSize {
        FieldSize { length: 55.0, width: 36.0, goal_width: 3.66 }
    }
}

/// A pose on the field.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(crate) struct FieldPose {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) heading: f64,
}

impl FieldPose {
    /// The same pose in the frame of the team that defends a side, whose x points to the goal to
    /// attack; and back.
    pub(crate) fn for_team(self, side: Side) -> FieldPose {
        match side {
            Side::Left => self,
            Side::Right => {
                let heading = self.heading + std::f64::consts::PI;
                let heading = libm::remainder(heading, std::f64::consts::TAU);
                FieldPose { x: -self.x, y: -self.y, heading }
            }
        }
    }
}

/// The game from the view of one player.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct MatchRules {
    pub(crate) team: String,
    pub(crate) number: u32,
    pub(crate) field: FieldSize,
    /// The length of a half, s.
    pub(crate) half: f64,
    /// The side that the team defends.
    pub(crate) side: Side,
    /// The number of placements of the robot, and the last pose, in the frame of its team.
    placements: u32,
    placed: FieldPose,
    announced: Option<Announcement>,
}

impl MatchRules {
    pub(crate) fn new(team: String, number: u32, field: FieldSize) -> MatchRules {
        let (side, placed) = (Side::Left, FieldPose::default());
        MatchRules { team, number, field, half: 300.0, side, placements: 0, placed, announced: None }
    }

    /// Notes the sides of the teams.
    pub(crate) fn observe(&mut self, game: &Game) {
        if game.right_team == self.team {
            self.side = Side::Right;
        }
    }

    /// Notes that the robot was placed, in the frame of the field.
    pub(crate) fn placed(&mut self, pose: FieldPose) {
        self.placements += 1;
        self.placed = pose.for_team(self.side);
    }

    /// The kind and colour of a goal post. The goal on the left is blue, that on the right yellow:
    /// players tell goals apart by their colours, the server by names.
    pub(crate) fn post(&self, goal: Side, is_upper: bool) -> (ObjectKind, Colour) {
        // For a robot that faces the goal at +x, +y is on the left.
        let is_left = is_upper == (goal == Side::Right);
        (if is_left { ObjectKind::LeftPost } else { ObjectKind::RightPost }, goal_colour(goal))
    }

    /// The colour of a robot; none for this one, which sees its own hands.
    pub(crate) fn robot(&self, team: &str, number: u32) -> Option<Colour> {
        match team == self.team {
            true => (number != self.number).then_some(team_colour(self.side)),
            false => Some(team_colour(opposite(self.side))),
        }
    }

    /// The announcement, if it has changed. The remaining time is in whole seconds.
    pub(crate) fn news(&mut self, game: &Game) -> Option<Announcement> {
        let announcement = self.announcement(game);
        if self.announced == Some(announcement) {
            return None;
        }
        self.announced = Some(announcement);
        Some(announcement)
    }

    fn announcement(&self, game: &Game) -> Announcement {
        let (phase, set_play, to) = phase(game.play_mode, self.side);
        let (own_score, opponent_score) = match self.side {
            Side::Left => (game.left_score, game.right_score),
            Side::Right => (game.right_score, game.left_score),
        };
        let first_half = game.play_time < self.half;
        let end = if first_half { self.half } else { 2.0 * self.half };
        Announcement {
            phase: phase as i32,
            seconds_left: libm::ceil((end - game.play_time).max(0.0)),
            first_half,
            team: if self.side == Side::Left { 1 } else { 2 },
            number: self.number,
            team_colour: team_colour(self.side) as i32,
            goal_to_attack: goal_colour(opposite(self.side)) as i32,
            kick_off: to == Some(self.side),
            own_score,
            opponent_score,
            placements: self.placements,
            placed_x: self.placed.x,
            placed_y: self.placed.y,
            placed_heading: self.placed.heading,
            field_length: self.field.length,
            field_width: self.field.width,
            goal_width: self.field.goal_width,
            set_play: set_play as i32,
            ..Announcement::default()
        }
    }
}

/// Phase of the game, set play, and the team that has it. During a set play of the opponents the
/// robot waits as before a kick-off: the referee moves a robot that comes too near to the touch
/// line.
fn phase(mode: PlayMode, own: Side) -> (GamePhase, SetPlay, Option<Side>) {
    let (set_play, side) = match mode {
        PlayMode::BeforeKickOff => return (GamePhase::Set, SetPlay::NoSetPlay, None),
        PlayMode::PlayOn => return (GamePhase::Playing, SetPlay::NoSetPlay, None),
        PlayMode::GameOver => return (GamePhase::Finished, SetPlay::NoSetPlay, None),
        PlayMode::Goal(side) => return (GamePhase::Set, SetPlay::NoSetPlay, Some(opposite(side))),
        PlayMode::KickOff(side) => (SetPlay::NoSetPlay, side),
        PlayMode::KickIn(side) => (SetPlay::ThrowIn, side),
        PlayMode::CornerKick(side) => (SetPlay::CornerKick, side),
        PlayMode::GoalKick(side) => (SetPlay::GoalKick, side),
        PlayMode::FreeKick(side) => (SetPlay::IndirectFreeKick, side),
        PlayMode::DirectFreeKick(side) => (SetPlay::DirectFreeKick, side),
        PlayMode::PenaltyKick(side) | PlayMode::PenaltyShoot(side) => (SetPlay::PenaltyKick, side),
        // After an offside the other team has the ball.
        PlayMode::Offside(side) => (SetPlay::IndirectFreeKick, opposite(side)),
    };
    (if side == own { GamePhase::Playing } else { GamePhase::Set }, set_play, Some(side))
}

fn opposite(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
    }
}

fn goal_colour(side: Side) -> Colour {
    match side {
        Side::Left => Colour::Blue,
        Side::Right => Colour::Yellow,
    }
}

fn team_colour(side: Side) -> Colour {
    match side {
        Side::Left => Colour::Blue,
        Side::Right => Colour::Red,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(side: Side) -> MatchRules {
        let mut rules = MatchRules::new("Monas".into(), 2, FieldSize::default());
        let mut game = Game::default();
        *(if side == Side::Left { &mut game.left_team } else { &mut game.right_team }) = "Monas".into();
        rules.observe(&game);
        rules
    }

    #[test]
    fn the_team_on_the_right_sees_the_field_from_there() {
        let mut rules = rules(Side::Right);
        rules.placed(FieldPose { x: 3.0, y: 1.0, heading: 1.0 });
        let game = Game { left_score: 1, right_score: 2, play_mode: PlayMode::PlayOn, ..Game::default() };
        let said = rules.news(&game).unwrap();
        assert_eq!((said.placed_x, said.placed_y, said.placements), (-3.0, -1.0, 1));
        assert!((said.placed_heading - (1.0 - std::f64::consts::PI)).abs() < 1e-9);
        assert_eq!((said.own_score, said.opponent_score), (2, 1));
        assert_eq!(said.goal_to_attack(), Colour::Blue);
        assert_eq!(rules.news(&game), None, "nothing has changed");
    }

    #[test]
    fn posts_are_left_and_right_for_who_faces_their_goal() {
        let rules = rules(Side::Left);
        assert_eq!(rules.post(Side::Right, true), (ObjectKind::LeftPost, Colour::Yellow));
        assert_eq!(rules.post(Side::Right, false), (ObjectKind::RightPost, Colour::Yellow));
        assert_eq!(rules.post(Side::Left, true), (ObjectKind::RightPost, Colour::Blue));
    }

    #[test]
    fn robots_have_the_colours_of_their_teams_and_the_own_body_is_none() {
        let rules = rules(Side::Right);
        assert_eq!(rules.robot("Monas", 2), None);
        assert_eq!(rules.robot("Monas", 3), Some(Colour::Red));
        assert_eq!(rules.robot("Other", 2), Some(Colour::Blue));
    }

    #[test]
    fn the_robot_plays_unless_the_ball_is_the_opponents() {
        let phase = |mode| rules(Side::Left).announcement(&Game { play_mode: mode, ..Game::default() });
        assert_eq!(phase(PlayMode::BeforeKickOff).phase(), GamePhase::Set);
        let own = phase(PlayMode::KickOff(Side::Left));
        assert_eq!((own.phase(), own.kick_off), (GamePhase::Playing, true));
        let other = phase(PlayMode::KickIn(Side::Right));
        let expected = (GamePhase::Set, false, SetPlay::ThrowIn);
        assert_eq!((other.phase(), other.kick_off, other.set_play()), expected);
        assert_eq!(phase(PlayMode::Offside(Side::Right)).phase(), GamePhase::Playing);
        assert_eq!(phase(PlayMode::GameOver).phase(), GamePhase::Finished);
    }
}
