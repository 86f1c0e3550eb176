//! Evaluates an attack of two players: who goes to the ball, their parts, whether a pass or a shot
//! is open, and the outcome.
//!
//! Each player evaluates this from its perception and the reports of its team mates, so two players
//! may disagree temporarily. Parts are assigned with a margin: while it is unclear which player is
//! nearer to the ball, no player has a part.

use nalgebra::{Point2, Vector2};

use super::aim::shot_target;
use super::field::{FieldModel, Goal};
use super::geometry::{angle_of, distance_to_segment, wrap};

/// Distance within which a robot has the ball in reach, metres.
pub const REACH: f64 = 0.35;
/// Least difference between the distances of center and partner from the ball, metres.
const CENTER_MARGIN: f64 = 0.4;
/// Least distance of robots from the line of a pass or shot, metres: robot, ball and a margin.
const LINE_CLEARANCE: f64 = 0.3;
/// Least and greatest length of a pass, metres.
const PASS_LENGTH: (f64, f64) = (0.7, 3.5);
/// Accepted error of the heading for a kick, radians.
const KICK_HEADING_ERROR: f64 = 0.22;
/// Time after a pass for which the ball belongs to the partner, seconds: it rolls, and the partner
/// walks to it and round it.
const PASS_TIME: f64 = 20.0;
/// Time for which a shot counts as outcome, seconds.
const SHOT_TIME: f64 = 1.0;
/// Margin by which an opponent must be nearer to the ball than the team to count as having it,
/// metres: reports of mates that walk to the ball are old.
const POSSESSION_MARGIN: f64 = 0.1;
/// Distance from the goal beyond which a pass is better than a shot, metres: from 2 m and more a
/// goalie lets in a few of a hundred shots.
const SHOT_LENGTH: f64 = 1.8;
/// Distance from the ball within which the center has its part, metres. A player that is farther
/// away walks to the ball as it would alone.
const CENTER_DISTANCE: f64 = 1.2;
/// Prediction time for a rolling ball, seconds.
const PREDICTION_TIME: f64 = 0.4;
/// Cost of turning by a radian, metres of walk.
const TURN_COST: f64 = 0.15;
/// Cost of walking round the ball by a radian, metres of walk.
const ROUND_COST: f64 = 0.25;
/// Time for which a player leaves the ball to its mates after a pass, seconds, and the
/// corresponding cost, metres of walk.
const YIELD: f64 = 6.0;
const YIELD_COST: f64 = 2.0;

/// A part in the attack.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AttackRole {
    /// Walks to the ball and passes it.
    Center,
    /// Walks towards the goal and shoots.
    CenterFor,
}

/// A field player of the own team. Positions are in the field frame of the team.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AttackPlayer {
    /// Its position.
    pub position: Point2<f64>,
    /// Its heading, radians.
    pub heading: f64,
    /// Its distance from the ball, metres.
    pub ball_distance: f64,
    /// Its handicap on the way to the ball, as metres of straight walk.
    pub handicap: f64,
    /// Seconds since its last pass.
    pub since_pass: f64,
    /// Seconds since its last other kick.
    pub since_shot: f64,
}

/// Inputs of the evaluation. Positions are in the field frame of the team.
#[derive(Clone, PartialEq, Debug)]
pub struct AttackSituation<'a> {
    /// The field.
    pub field: FieldModel,
    /// The position of the ball.
    pub ball: Point2<f64>,
    /// Its velocity.
    pub rolling: Vector2<f64>,
    /// Whether the ball lies at a kick point of the evaluating player.
    pub at_foot: bool,
    /// The evaluating player.
    pub own: AttackPlayer,
    /// The other field players.
    pub mates: &'a [AttackPlayer],
    /// Positions of opponents that were seen.
    pub opponents: &'a [Point2<f64>],
    /// Whether the opponents stand still. Then a shot at once is better than a pass.
    pub opponents_stand: bool,
}

/// The state of an attack from the view of the evaluating player.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct AttackState {
    /// No robot but the nearest of the team has the ball within reach.
    pub ball_is_free: bool,
    /// The center is nearer to the ball than every other known robot.
    pub center_is_closest: bool,
    /// The partner is the farthest, by more than the margin.
    pub center_for_is_farthest: bool,
    /// The player's own part.
    pub part: Option<AttackRole>,
    /// This player is at the ball and faces the partner, with no robot in between.
    pub pass_is_open: bool,
    /// The center has passed recently.
    pub ball_is_passed: bool,
    /// This player is at the ball and faces a part of the goal, with no robot in between.
    pub path_is_clear: bool,
    /// The position of the partner.
    pub mate: Option<Point2<f64>>,
    /// A player of the team has just shot.
    pub shot_at_goal: bool,
    /// An opponent has the ball.
    pub opponent_has_ball: bool,
    /// The ball is over a line or about to cross it.
    pub ball_is_out: bool,
    /// The distance by which the path to the ball is shorter for the team mate with the shortest,
    /// metres; zero if it is not shorter.
    pub mate_lead: f64,
    /// An opponent is nearer to the ball than every player of the team.
    pub opponent_leads: bool,
}

/// Evaluates a situation. Conditions that do not need two players are evaluated for any number.
pub fn evaluate(scene: &AttackSituation<'_>) -> AttackState {
    let alone = AttackState {
        ball_is_free: ball_is_free(scene),
        shot_at_goal: players(scene).any(|it| it.since_shot < SHOT_TIME),
        opponent_has_ball: opponent_has_ball(scene),
        ball_is_out: ball_is_out(scene),
        mate_lead: mate_lead(scene),
        opponent_leads: opponent_leads(scene),
        ..AttackState::default()
    };
    let is_kept_out = scene.field.in_own_area(scene.ball, 0.0);
    let Some((center, center_for)) = parts(scene).filter(|_| !is_kept_out) else { return alone };
    let pays = pass_pays(scene, center_for.position);
    let is_passed = center.since_pass < PASS_TIME;
    // At the ball, with the goal covered, it shoots as it would alone.
    let is_covered = scene.at_foot && faces_goal(scene) && !path_is_clear(scene);
    // At the ball, facing a partner that no pass can reach, it does not wait.
    let is_blocked =
        scene.at_foot && faces(scene, center_for.position) && !pass_is_open(scene, center_for.position);
    let (part, mate) = match (std::ptr::eq(center, &scene.own), std::ptr::eq(center_for, &scene.own)) {
        // The part of the center ends with its pass.
        (true, _) if is_passed => (None, None),
        _ if !is_passed && (!pays || center.ball_distance > CENTER_DISTANCE) => (None, None),
        (true, _) if is_blocked => (None, None),
        (true, _) => (Some(AttackRole::Center), Some(center_for.position)),
        (_, true) if is_passed && is_covered => (None, None),
        (_, true) => (Some(AttackRole::CenterFor), Some(center.position)),
        _ => (None, None),
    };
    AttackState {
        center_is_closest: scene.opponents.iter().all(|it| (it - scene.ball).norm() > center.ball_distance),
        center_for_is_farthest: center_for.ball_distance > center.ball_distance + CENTER_MARGIN,
        part,
        mate,
        pass_is_open: part == Some(AttackRole::Center) && pass_is_open(scene, center_for.position),
        ball_is_passed: is_passed,
        path_is_clear: part == Some(AttackRole::CenterFor) && path_is_clear(scene),
        ..alone
    }
}

fn players<'a>(scene: &'a AttackSituation<'_>) -> impl Iterator<Item = &'a AttackPlayer> {
    scene.mates.iter().chain([&scene.own])
}

/// The center and its partner: the player with the shortest way to the ball and the one that is
/// farthest from it. During a pass: the player that has passed, and the nearest of the others.
fn parts<'a>(scene: &'a AttackSituation<'_>) -> Option<(&'a AttackPlayer, &'a AttackPlayer)> {
    let but = |but: &'a AttackPlayer| players(scene).filter(move |it| !std::ptr::eq(*it, but));
    let by_distance = |a: &&AttackPlayer, b: &&AttackPlayer| a.ball_distance.total_cmp(&b.ball_distance);
    let passers = players(scene).filter(|it| it.since_pass < PASS_TIME);
    if let Some(passer) = passers.min_by(|a, b| a.since_pass.total_cmp(&b.since_pass)) {
        return Some((passer, but(passer).min_by(by_distance)?));
    }
    let nearest = players(scene).min_by(|a, b| cost(scene, a).total_cmp(&cost(scene, b)))?;
    Some((nearest, but(nearest).max_by(by_distance)?))
}

/// The path to the position behind the ball, as metres of straight walk.
fn cost(scene: &AttackSituation<'_>, player: &AttackPlayer) -> f64 {
    let (to_ball, shot) = (scene.ball - player.position, scene.field.goal(Goal::Opponent) - scene.ball);
    let yields = if player.since_pass < YIELD { YIELD_COST } else { 0.0 };
    let turn = wrap(angle_of(&to_ball) - player.heading).abs();
    let round = wrap(angle_of(&shot) - angle_of(&to_ball)).abs();
    player.ball_distance + TURN_COST * turn + ROUND_COST * round + player.handicap + yields
}

fn opponent_leads(scene: &AttackSituation<'_>) -> bool {
    let own = players(scene).map(|it| it.ball_distance).fold(f64::INFINITY, f64::min);
    scene.opponents.iter().any(|it| (it - scene.ball).norm() < own)
}

fn mate_lead(scene: &AttackSituation<'_>) -> f64 {
    let mates = scene.mates.iter().map(|mate| cost(scene, mate));
    (cost(scene, &scene.own) - mates.fold(f64::INFINITY, f64::min)).max(0.0)
}

fn ball_is_free(scene: &AttackSituation<'_>) -> bool {
    let of_team = players(scene).filter(|it| it.ball_distance <= REACH).count();
    of_team <= 1 && scene.opponents.iter().all(|it| (it - scene.ball).norm() > REACH)
}

fn opponent_has_ball(scene: &AttackSituation<'_>) -> bool {
    let own = players(scene).map(|it| it.ball_distance).fold(f64::INFINITY, f64::min);
    scene
        .opponents
        .iter()
        .map(|it| (it - scene.ball).norm())
        .any(|it| it < REACH && it < own - POSSESSION_MARGIN)
}

fn ball_is_out(scene: &AttackSituation<'_>) -> bool {
    let FieldModel { length, width, .. } = scene.field;
    let then = scene.ball + scene.rolling * PREDICTION_TIME;
    then.x.abs() > length / 2.0 || then.y.abs() > width / 2.0
}

fn pass_is_open(scene: &AttackSituation<'_>, receiver: Point2<f64>) -> bool {
    let distance = (receiver - scene.ball).norm();
    (PASS_LENGTH.0..PASS_LENGTH.1).contains(&distance) && faces(scene, receiver) && is_free(scene, receiver)
}

/// Whether a pass is better than a shot: the goal is far, the receiver is not behind the ball, and
/// opponents may take a ball that was shot from afar.
fn pass_pays(scene: &AttackSituation<'_>, receiver: Point2<f64>) -> bool {
    let (shot, pass) = (scene.field.goal(Goal::Opponent) - scene.ball, receiver - scene.ball);
    let aside = wrap(angle_of(&pass) - angle_of(&shot)).abs();
    shot.norm() > SHOT_LENGTH && aside < MAX_PASS_ANGLE && !scene.opponents_stand
}

/// Greatest angle between a pass and a shot, radians.
const MAX_PASS_ANGLE: f64 = 0.7;

fn path_is_clear(scene: &AttackSituation<'_>) -> bool {
    faces_goal(scene) && is_free(scene, shot_target(&scene.field, scene.ball, scene.opponents))
}

/// Whether the player stands at the ball so that a kick goes to the least covered part of the goal.
fn faces_goal(scene: &AttackSituation<'_>) -> bool {
    faces(scene, shot_target(&scene.field, scene.ball, scene.opponents))
}

/// Whether the player stands at the ball so that a kick goes to the target.
fn faces(scene: &AttackSituation<'_>, target: Point2<f64>) -> bool {
    scene.at_foot && wrap(angle_of(&(target - scene.ball)) - scene.own.heading).abs() < KICK_HEADING_ERROR
}

fn is_free(scene: &AttackSituation<'_>, target: Point2<f64>) -> bool {
    scene.opponents.iter().all(|it| distance_to_segment(*it, scene.ball, target).0 > LINE_CLEARANCE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn player(x: f64, y: f64) -> AttackPlayer {
        let position = Point2::new(x, y);
        let far = f64::INFINITY;
        AttackPlayer {
            position,
            heading: 0.0,
            ball_distance: position.coords.norm(),
            handicap: 0.0,
            since_pass: far,
            since_shot: far,
        }
    }

    /// The ball lies in the middle of the field.
    fn scene<'a>(
        own: AttackPlayer,
        mates: &'a [AttackPlayer],
        opponents: &'a [Point2<f64>],
    ) -> AttackSituation<'a> {
        let (ball, rolling) = (Point2::origin(), Vector2::zeros());
        AttackSituation {
            field: FieldModel::LEAGUE_2010,
            ball,
            rolling,
            at_foot: false,
            own,
            mates,
            opponents,
            opponents_stand: false,
        }
    }

    #[test]
    fn both_agree_on_their_roles() {
        let (near, far) = (player(-1.0, 0.0), player(1.2, 1.0));
        let one = evaluate(&scene(near, &[far], &[]));
        let other = evaluate(&scene(far, &[near], &[]));
        assert_eq!((one.part, other.part), (Some(AttackRole::Center), Some(AttackRole::CenterFor)));
        assert_eq!((one.mate, other.mate), (Some(far.position), Some(near.position)));
        for it in [one, other] {
            assert!(it.ball_is_free && it.center_is_closest && it.center_for_is_farthest);
        }
    }

    #[test]
    fn the_middle_one_of_three_has_no_part() {
        let (near, far) = (player(-0.5, 0.0), player(-2.5, 0.0));
        assert_eq!(evaluate(&scene(player(-1.0, 0.0), &[near, far], &[])).part, None);
    }

    #[test]
    fn a_ball_in_reach_of_two_players_or_an_opponent_is_not_free() {
        let (own, mate) = (player(-1.0, 0.0), player(-2.0, 0.0));
        let judged = |own, mate, opponent| evaluate(&scene(own, &[mate], &[opponent])).ball_is_free;
        let away = Point2::new(2.0, 0.0);
        assert!(judged(own, mate, away));
        assert!(judged(player(0.2, 0.0), mate, away), "it takes the ball");
        assert!(!judged(player(0.2, 0.0), player(0.0, 0.3), away));
        assert!(!judged(own, mate, Point2::new(0.0, -0.3)));
    }

    #[test]
    fn rules_fail_where_an_opponent_is_nearer_or_the_two_are_equally_near() {
        let (own, mate) = (player(-1.0, 0.0), player(-2.0, 0.0));
        assert!(!evaluate(&scene(own, &[mate], &[Point2::new(0.0, 0.8)])).center_is_closest);
        assert!(!evaluate(&scene(own, &[player(0.0, 1.1)], &[])).center_for_is_farthest);
    }

    #[test]
    fn a_pass_is_open_when_the_center_faces_its_partner_and_no_robot_is_between() {
        let center = AttackPlayer { heading: 0.5, ..player(-0.15, -0.05) };
        let other = player(1.5, 0.8);
        let open = |at_foot, own, mate, opponents: &[Point2<f64>]| {
            evaluate(&AttackSituation { at_foot, ..scene(own, &[mate], opponents) }).pass_is_open
        };
        assert!(open(true, center, other, &[]));
        assert!(!open(false, center, other, &[]), "the ball is not at its foot");
        assert!(!open(true, AttackPlayer { heading: 0.0, ..center }, other, &[]), "it faces elsewhere");
        assert!(!open(true, center, other, &[Point2::new(0.8, 0.3)]), "a robot is between");
        assert!(!open(true, center, player(0.5, 0.27), &[]), "the other is too near");
        assert!(!open(true, other, center, &[]), "it is not the center");
    }

    #[test]
    fn after_a_pass_the_parts_stay_though_the_other_is_nearer_now() {
        let passer = AttackPlayer { since_pass: 2.0, ..player(-1.0, 0.0) };
        let other = AttackPlayer { heading: 0.0, ..player(-0.15, 0.0) };
        let it = evaluate(&AttackSituation { at_foot: true, ..scene(other, &[passer], &[]) });
        assert!(it.part == Some(AttackRole::CenterFor) && it.ball_is_passed && it.path_is_clear);
        let it = evaluate(&scene(passer, &[other], &[]));
        assert!(it.part.is_none() && it.ball_is_passed && !it.shot_at_goal, "it has done its part");
        let forgotten = AttackPlayer { since_pass: PASS_TIME, ..player(0.9, 0.5) };
        let it = evaluate(&scene(forgotten, &[other], &[]));
        assert!(it.part == Some(AttackRole::CenterFor) && !it.ball_is_passed);
    }

    #[test]
    fn against_opponents_that_stand_still_none_passes() {
        let (own, mates) = (player(-0.4, 0.0), [player(1.2, 0.5)]);
        let scene = scene(own, &mates, &[]);
        assert_eq!(evaluate(&scene).part, Some(AttackRole::Center));
        assert_eq!(evaluate(&AttackSituation { opponents_stand: true, ..scene }).part, None);
    }

    #[test]
    fn a_path_is_clear_when_part_of_the_goal_is() {
        let passer = AttackPlayer { since_pass: 2.0, ..player(-1.0, 0.0) };
        let shooter = |heading| AttackPlayer { heading, ..player(-0.15, 0.0) };
        let clear = |heading, opponents: &[Point2<f64>]| {
            evaluate(&AttackSituation { at_foot: true, ..scene(shooter(heading), &[passer], opponents) })
                .path_is_clear
        };
        assert!(clear(0.0, &[]) && !clear(0.5, &[]));
        assert!(!clear(0.0, &[Point2::new(0.5, 0.0)]), "all of it is covered");
    }

    #[test]
    fn the_shorter_way_counts_with_its_turns() {
        let lead = |own, mate| evaluate(&scene(own, &[mate], &[])).mate_lead;
        let (behind, before) = (player(-1.0, 0.0), player(1.0, 0.0));
        assert_eq!(lead(behind, before), 0.0);
        assert!(lead(before, behind) > 0.8, "it would have to walk round the ball: {}", lead(before, behind));
        assert!((lead(player(-1.5, 0.0), behind) - 0.5).abs() < 1e-9);
        let down = AttackPlayer { handicap: 1.0, ..behind };
        assert_eq!(lead(player(-1.5, 0.0), down), 0.0, "one that lies is no help");
        assert_eq!(evaluate(&scene(behind, &[], &[])).mate_lead, 0.0);
        let passer = AttackPlayer { since_pass: 1.0, ..behind };
        assert_eq!(lead(player(-1.5, 0.0), passer), 0.0, "it does not run after its own pass");
    }

    #[test]
    fn no_pass_is_planned_where_a_shot_is_better_or_backwards() {
        let (own, mate) = (player(-1.0, 0.0), player(1.2, 0.7));
        let part =
            |ball: Point2<f64>, mate| evaluate(&AttackSituation { ball, ..scene(own, &[mate], &[]) }).part;
        assert_eq!(part(Point2::origin(), mate), Some(AttackRole::Center));
        assert_eq!(part(Point2::new(1.3, 0.0), mate), None, "the goal is near enough");
        assert_eq!(part(Point2::new(-2.7, 0.0), mate), None, "no field player may enter the own area");
        assert_eq!(part(Point2::origin(), player(-1.0, 1.5)), None, "the mate is behind the ball");
    }

    #[test]
    fn at_a_covered_goal_the_receiver_acts_as_it_would_alone() {
        let passer = AttackPlayer { since_pass: 2.0, ..player(-1.0, 0.0) };
        let part = |opponents: &[Point2<f64>]| {
            evaluate(&AttackSituation { at_foot: true, ..scene(player(-0.15, 0.0), &[passer], opponents) })
                .part
        };
        assert_eq!(part(&[]), Some(AttackRole::CenterFor));
        assert_eq!(part(&[Point2::new(0.5, 0.0)]), None);
    }

    #[test]
    fn at_the_ball_a_pass_that_is_not_open_is_not_waited_for() {
        let center = AttackPlayer { heading: 0.5, ..player(-0.15, -0.05) };
        let part = |at_foot, center, opponents: &[Point2<f64>]| {
            evaluate(&AttackSituation { at_foot, ..scene(center, &[player(1.5, 0.8)], opponents) }).part
        };
        let between = [Point2::new(0.8, 0.3)];
        assert_eq!(part(true, center, &[]), Some(AttackRole::Center));
        assert_eq!(part(true, center, &between), None);
        assert_eq!(part(false, center, &between), Some(AttackRole::Center), "it may open until then");
        let turning = AttackPlayer { heading: 0.0, ..center };
        assert_eq!(part(true, turning, &between), Some(AttackRole::Center));
    }

    #[test]
    fn each_outcome_is_seen() {
        let (own, mate) = (player(-1.0, 0.0), player(-2.0, 0.0));
        let nothing = evaluate(&scene(own, &[mate], &[Point2::new(1.0, 0.0)]));
        assert!(!nothing.shot_at_goal && !nothing.opponent_has_ball && !nothing.ball_is_out);
        let shot = AttackPlayer { since_shot: 0.5, ..mate };
        assert!(evaluate(&scene(own, &[shot], &[])).shot_at_goal);
        assert!(evaluate(&scene(own, &[mate], &[Point2::new(0.3, 0.0)])).opponent_has_ball);
        let contested = player(0.2, 0.0);
        assert!(!evaluate(&scene(contested, &[mate], &[Point2::new(0.3, 0.0)])).opponent_has_ball);
        for (position, rolling, is_out) in [
            ((0.0, 1.9), (0.0, 1.0), true),
            ((0.0, 1.9), (0.0, -1.0), false),
            ((3.1, 0.0), (0.0, 0.0), true),
            ((1.0, 1.0), (0.5, 0.5), false),
        ] {
            let (ball, rolling) = (Point2::new(position.0, position.1), Vector2::new(rolling.0, rolling.1));
            assert_eq!(
                evaluate(&AttackSituation { ball, rolling, ..scene(own, &[mate], &[]) }).ball_is_out,
                is_out
            );
        }
    }
}
