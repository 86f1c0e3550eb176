//! How an attack of two stands: who takes which part, whether a pass or a shot is open, and what has come of it.
//!
//! All of it is judged by one player from what it sees and from what its team mates tell, so two players may differ for a moment. Parts are
//! given with a margin: where it is in doubt who is nearer to the ball, nobody has one.

use nalgebra::{Point2, Vector2};

use super::aim::shot_target;
use super::field::Field;
use super::geometry::{angle_of, distance_to_segment, wrap};

/// Whoever is this near to the ball has it in its reach, metres.
pub const REACH: f64 = 0.35;
/// By so much the center has to be nearer to the ball than the other one, metres.
const MARGIN: f64 = 0.4;
/// How near a robot may be to the way of a pass or a shot, metres: robot, ball and a bit.
const WAY: f64 = 0.3;
/// How far a pass goes at least and at most, metres.
const PASS: (f64, f64) = (0.7, 3.5);
/// How far off the target a robot faces that kicks, radians.
const FACING: f64 = 0.22;
/// For so long after a pass the ball is the other one's, and for so long a shot is what has just come of an attack, seconds.
const PASSED: f64 = 8.0;
const SHOT: f64 = 1.0;
/// So far ahead the way of a rolling ball is looked at, seconds.
const FORESIGHT: f64 = 0.4;

/// A part in the attack.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// Goes to the ball and passes it.
    Center,
    /// Goes towards the goal, and shoots.
    CenterFor,
}

/// A field player of the own team. Places are those of the field frame of the team.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Player {
    /// Its number.
    pub number: u32,
    /// Where it stands.
    pub place: Point2<f64>,
    /// Where it faces, radians.
    pub heading: f64,
    /// How far the ball is from it.
    pub ball_distance: f64,
    /// Seconds since it has passed.
    pub since_pass: f64,
    /// Seconds since it has kicked otherwise.
    pub since_shot: f64,
}

/// All that is judged by. Places are those of the field frame of the team.
#[derive(Clone, PartialEq, Debug)]
pub struct Scene<'a> {
    /// The field.
    pub field: Field,
    /// Where the ball is, and how it rolls.
    pub ball: Point2<f64>,
    /// Its velocity.
    pub rolling: Vector2<f64>,
    /// Whether the ball lies where a foot of the judging player kicks it.
    pub at_foot: bool,
    /// The player that judges.
    pub own: Player,
    /// The others that play in the field.
    pub mates: &'a [Player],
    /// Opponents that were seen.
    pub opponents: &'a [Point2<f64>],
}

/// How an attack stands, for the player that judges.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Standing {
    /// No robot has the ball in its reach.
    pub ball_is_free: bool,
    /// The center is nearer to the ball than every robot known.
    pub center_is_closest: bool,
    /// The other one is the farthest, by more than doubt.
    pub center_for_is_farthest: bool,
    /// The own part.
    pub part: Option<Part>,
    /// This player, at the ball, faces the other one with nobody in between.
    pub pass_is_open: bool,
    /// The center has passed lately.
    pub ball_is_passed: bool,
    /// This player, at the ball, faces a part of the goal with nobody in between.
    pub path_is_clear: bool,
    /// Where the other one of the two stands.
    pub mate: Option<Point2<f64>>,
    /// One of the team has shot just now.
    pub shot_at_goal: bool,
    /// An opponent has the ball.
    pub opponent_has_ball: bool,
    /// The ball is over a line, or about to roll over it.
    pub ball_is_out: bool,
}

/// Judges a scene. What a team can judge that is not two players is judged too.
pub fn judge(scene: &Scene<'_>) -> Standing {
    let alone = Standing {
        ball_is_free: ball_is_free(scene),
        shot_at_goal: players(scene).any(|it| it.since_shot < SHOT),
        opponent_has_ball: opponent_has_ball(scene),
        ball_is_out: ball_is_out(scene),
        ..Standing::default()
    };
    let Some((center, center_for)) = parts(scene) else { return alone };
    let (part, mate) = match scene.own.number {
        number if number == center.number => (Some(Part::Center), Some(center_for.place)),
        number if number == center_for.number => (Some(Part::CenterFor), Some(center.place)),
        _ => (None, None),
    };
    Standing {
        center_is_closest: scene.opponents.iter().all(|it| (it - scene.ball).norm() > center.ball_distance),
        center_for_is_farthest: center_for.ball_distance > center.ball_distance + MARGIN,
        part,
        mate,
        pass_is_open: part == Some(Part::Center) && pass_is_open(scene, center_for.place),
        ball_is_passed: center.since_pass < PASSED,
        path_is_clear: part == Some(Part::CenterFor) && path_is_clear(scene),
        ..alone
    }
}

fn players<'a>(scene: &'a Scene<'_>) -> impl Iterator<Item = &'a Player> {
    scene.mates.iter().chain([&scene.own])
}

/// The center and the other one: the nearest to the ball and the farthest. While a pass is under way it is who has passed, and who is nearest of the others.
fn parts<'a>(scene: &'a Scene<'_>) -> Option<(&'a Player, &'a Player)> {
    let nearest_but = |but: Option<u32>| {
        let others = players(scene).filter(move |it| Some(it.number) != but);
        others.min_by(|a, b| a.ball_distance.total_cmp(&b.ball_distance).then(a.number.cmp(&b.number)))
    };
    let passers = players(scene).filter(|it| it.since_pass < PASSED);
    if let Some(passer) = passers.min_by(|a, b| a.since_pass.total_cmp(&b.since_pass)) {
        return Some((passer, nearest_but(Some(passer.number))?));
    }
    let nearest = nearest_but(None)?;
    let others = players(scene).filter(|it| it.number != nearest.number);
    let farthest =
        others.max_by(|a, b| a.ball_distance.total_cmp(&b.ball_distance).then(a.number.cmp(&b.number)));
    Some((nearest, farthest?))
}

fn ball_is_free(scene: &Scene<'_>) -> bool {
    let of_team = players(scene).all(|it| it.ball_distance > REACH);
    of_team && scene.opponents.iter().all(|it| (it - scene.ball).norm() > REACH)
}

fn opponent_has_ball(scene: &Scene<'_>) -> bool {
    let own = players(scene).map(|it| it.ball_distance).fold(f64::INFINITY, f64::min);
    scene.opponents.iter().map(|it| (it - scene.ball).norm()).any(|it| it < REACH && it < own)
}

fn ball_is_out(scene: &Scene<'_>) -> bool {
    let Field { length, width, .. } = scene.field;
    let then = scene.ball + scene.rolling * FORESIGHT;
    then.x.abs() > length / 2.0 || then.y.abs() > width / 2.0
}

fn pass_is_open(scene: &Scene<'_>, receiver: Point2<f64>) -> bool {
    let way = (receiver - scene.ball).norm();
    (PASS.0..PASS.1).contains(&way) && faces(scene, receiver) && is_free(scene, receiver)
}

fn path_is_clear(scene: &Scene<'_>) -> bool {
    let target = shot_target(&scene.field, scene.ball, scene.opponents);
    faces(scene, target) && is_free(scene, target)
}

/// Whether the player stands at the ball so that a kick goes there.
fn faces(scene: &Scene<'_>, target: Point2<f64>) -> bool {
    scene.at_foot && wrap(angle_of(&(target - scene.ball)) - scene.own.heading).abs() < FACING
}

fn is_free(scene: &Scene<'_>, target: Point2<f64>) -> bool {
    scene.opponents.iter().all(|it| distance_to_segment(*it, scene.ball, target).0 > WAY)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn player(number: u32, x: f64, y: f64) -> Player {
        let place = Point2::new(x, y);
        let far = f64::INFINITY;
        Player {
            number,
            place,
            heading: 0.0,
            ball_distance: place.coords.norm(),
            since_pass: far,
            since_shot: far,
        }
    }

    /// The ball lies in the middle of the field; player 2 judges.
    fn scene<'a>(own: Player, mates: &'a [Player], opponents: &'a [Point2<f64>]) -> Scene<'a> {
        let (ball, rolling) = (Point2::origin(), Vector2::zeros());
        Scene { field: Field::LEAGUE_2010, ball, rolling, at_foot: false, own, mates, opponents }
    }

    #[test]
    fn both_agree_on_who_takes_which_part() {
        let (near, far) = (player(2, -1.0, 0.0), player(3, -1.0, 1.5));
        let one = judge(&scene(near, &[far], &[]));
        let other = judge(&scene(far, &[near], &[]));
        assert_eq!((one.part, other.part), (Some(Part::Center), Some(Part::CenterFor)));
        assert_eq!((one.mate, other.mate), (Some(far.place), Some(near.place)));
        for it in [one, other] {
            assert!(it.ball_is_free && it.center_is_closest && it.center_for_is_farthest);
        }
    }

    #[test]
    fn of_three_the_one_in_between_has_no_part() {
        let (near, far) = (player(3, -0.5, 0.0), player(4, -2.5, 0.0));
        assert_eq!(judge(&scene(player(2, -1.0, 0.0), &[near, far], &[])).part, None);
    }

    #[test]
    fn a_ball_in_reach_of_anybody_is_not_free() {
        let (own, mate) = (player(2, -1.0, 0.0), player(3, -2.0, 0.0));
        let judged = |own, mate, opponent| judge(&scene(own, &[mate], &[opponent])).ball_is_free;
        let away = Point2::new(2.0, 0.0);
        assert!(judged(own, mate, away));
        assert!(!judged(player(2, 0.2, 0.0), mate, away));
        assert!(!judged(own, player(3, 0.0, 0.3), away));
        assert!(!judged(own, mate, Point2::new(0.0, -0.3)));
    }

    #[test]
    fn rules_fail_where_an_opponent_is_nearer_or_the_two_are_equally_near() {
        let (own, mate) = (player(2, -1.0, 0.0), player(3, -2.0, 0.0));
        assert!(!judge(&scene(own, &[mate], &[Point2::new(0.0, 0.8)])).center_is_closest);
        assert!(!judge(&scene(own, &[player(3, 0.0, 1.1)], &[])).center_for_is_farthest);
    }

    #[test]
    fn a_pass_is_open_when_the_center_faces_the_other_and_nobody_is_between() {
        let center = Player { heading: 0.5, ..player(2, -0.15, -0.05) };
        let other = player(3, 1.5, 0.8);
        let open = |at_foot, own, mate, opponents: &[Point2<f64>]| {
            judge(&Scene { at_foot, ..scene(own, &[mate], opponents) }).pass_is_open
        };
        assert!(open(true, center, other, &[]));
        assert!(!open(false, center, other, &[]), "the ball is not at its foot");
        assert!(!open(true, Player { heading: 0.0, ..center }, other, &[]), "it faces elsewhere");
        assert!(!open(true, center, other, &[Point2::new(0.8, 0.3)]), "somebody is between");
        assert!(!open(true, center, player(3, 0.5, 0.27), &[]), "the other is too near");
        assert!(!open(true, other, center, &[]), "it is not the center");
    }

    #[test]
    fn after_a_pass_the_parts_stay_though_the_other_is_nearer_now() {
        let passer = Player { since_pass: 2.0, ..player(2, -1.0, 0.0) };
        let other = Player { heading: 0.0, ..player(3, -0.15, 0.0) };
        let it = judge(&Scene { at_foot: true, ..scene(other, &[passer], &[]) });
        assert!(it.part == Some(Part::CenterFor) && it.ball_is_passed && it.path_is_clear);
        let it = judge(&scene(passer, &[other], &[]));
        assert!(it.part == Some(Part::Center) && it.ball_is_passed && !it.shot_at_goal);
        let forgotten = Player { since_pass: PASSED, ..passer };
        let it = judge(&scene(forgotten, &[other], &[]));
        assert!(it.part == Some(Part::CenterFor) && !it.ball_is_passed);
    }

    #[test]
    fn a_path_is_clear_when_part_of_the_goal_is() {
        let passer = Player { since_pass: 2.0, ..player(2, -1.0, 0.0) };
        let shooter = |heading| Player { heading, ..player(3, -0.15, 0.0) };
        let clear = |heading, opponents: &[Point2<f64>]| {
            judge(&Scene { at_foot: true, ..scene(shooter(heading), &[passer], opponents) }).path_is_clear
        };
        assert!(clear(0.0, &[]) && !clear(0.5, &[]));
        assert!(!clear(0.0, &[Point2::new(0.5, 0.0)]), "all of it is covered");
    }

    #[test]
    fn each_outcome_is_seen() {
        let (own, mate) = (player(2, -1.0, 0.0), player(3, -2.0, 0.0));
        let nothing = judge(&scene(own, &[mate], &[Point2::new(1.0, 0.0)]));
        assert!(!nothing.shot_at_goal && !nothing.opponent_has_ball && !nothing.ball_is_out);
        let shot = Player { since_shot: 0.5, ..mate };
        assert!(judge(&scene(own, &[shot], &[])).shot_at_goal);
        assert!(judge(&scene(own, &[mate], &[Point2::new(0.3, 0.0)])).opponent_has_ball);
        let contested = player(2, 0.2, 0.0);
        assert!(!judge(&scene(contested, &[mate], &[Point2::new(0.3, 0.0)])).opponent_has_ball);
        for (place, rolling, is_out) in [
            ((0.0, 1.9), (0.0, 1.0), true),
            ((0.0, 1.9), (0.0, -1.0), false),
            ((3.1, 0.0), (0.0, 0.0), true),
            ((1.0, 1.0), (0.5, 0.5), false),
        ] {
            let (ball, rolling) = (Point2::new(place.0, place.1), Vector2::new(rolling.0, rolling.1));
            assert_eq!(judge(&Scene { ball, rolling, ..scene(own, &[mate], &[]) }).ball_is_out, is_out);
        }
    }
}
