//! Localisation of the robot from odometry, goal posts and lines.
//!
//! Several extended Kalman filters with weights (Quinlan, Middleton, *Multiple Model Kalman
//! Filters: A Localization Technique for RoboCup Soccer*, RoboCup 2009): a robot that does not know
//! where it was put keeps every place that the rules allow until landmarks decide. A sighting
//! multiplies the weight of each hypothesis by its likelihood, of which a small part is left to
//! outliers. Two landmarks in one image give a pose of their own; if no hypothesis is near it, it
//! becomes a new one (sensor resetting: Lenser, Veloso, ICRA 2000), so that a robot which was
//! carried away finds itself. If the goals look alike, the side on which the robot last knew its
//! pose decides between that pose and the one turned by half a turn.

use std::f64::consts::PI;

use nalgebra::{Isometry2, Point2};

use super::field::FieldModel;
use super::geometry::{angle_of, heading, rotation, wrap};
use super::landmarks::{GoalPost, Landmark, LandmarkPlaces, LandmarkSighting, LineSighting};
use super::pose_filter::PoseFilter;
pub use super::pose_filter::{LocalisationModel, PoseEstimate};

/// The estimate of the pose. [Advanced](Localisation::advance) by odometry,
/// [corrected](Localisation::correct) by what an image shows.
#[derive(Clone, Debug)]
pub struct Localisation {
    model: LocalisationModel,
    /// The heaviest first; never empty.
    hypotheses: Vec<PoseHypothesis>,
    /// Whether posts were seen that do not show their goal: then a pose and the one turned by half
    /// a turn about the centre of the field explain every image equally well.
    do_goals_look_alike: bool,
    /// Poses by odometry alone since the robot last knew its pose: where it may be on the field's
    /// two equal halves.
    anchors: Vec<Isometry2<f64>>,
}

#[derive(Clone, Debug)]
struct PoseHypothesis {
    filter: PoseFilter,
    /// The sum over all is 1.
    weight: f64,
}

/// The most hypotheses.
const MAX_HYPOTHESES: usize = 12;
/// Fraction of outliers among the sightings: the least likelihood.
const OUTLIER_FRACTION: f64 = 0.03;
/// Weight of a new hypothesis, and the least weight of one that is kept.
const NEW_WEIGHT: f64 = 0.02;
const LEAST_WEIGHT: f64 = 0.002;
/// Difference below which two hypotheses are one: metres and radians.
const MERGE_DISTANCE: (f64, f64) = (0.3, 0.25);
/// Difference below which a hypothesis explains a pose from two landmarks, in metres, per metre of
/// distance, and in radians.
const EXPLAINED_DIFFERENCE: (f64, f64, f64) = (0.3, 0.15, 0.4);
/// Carpet around the field on which a robot can stand, metres.
const CARPET_BORDER: f64 = 0.7;
/// Confidence below which any two landmarks give a hypothesis, not only both posts of a goal.
const LOST_CONFIDENCE: f64 = 0.5;
/// Confidence from which the robot knows in which half of the field it is.
const KNOWN_HALF_CONFIDENCE: f64 = 0.8;

impl Localisation {
    /// Hypotheses of equal weight; at the centre, with no certainty, if there are none.
    pub fn new(model: LocalisationModel, starts: &[PoseEstimate]) -> Localisation {
        let anywhere = [PoseEstimate {
            field_from_robot: Isometry2::identity(),
            place_deviation: 3.0,
            turn_deviation: 3.0,
        }];
        let starts = if starts.is_empty() { &anywhere } else { starts };
        let weight = 1.0 / starts.len() as f64;
        let mut hypotheses = Vec::with_capacity(MAX_HYPOTHESES.max(starts.len()) + 1);
        hypotheses
            .extend(starts.iter().map(|start| PoseHypothesis { filter: PoseFilter::new(start), weight }));
        let anchors = starts.iter().map(|start| start.field_from_robot).collect();
        Localisation { model, hypotheses, do_goals_look_alike: false, anchors }
    }

    /// Moves the robot to `old_from_new`, its new pose in its old frame.
    pub fn advance(&mut self, old_from_new: &Isometry2<f64>) {
        let model = &self.model;
        self.hypotheses.iter_mut().for_each(|it| it.filter.advance(model, old_from_new));
        self.anchors.iter_mut().for_each(|anchor| *anchor *= old_from_new);
    }

    /// Adds uncertainty of `position` metres and `turn` radians (standard deviations), as after a
    /// fall.
    pub fn disturb(&mut self, position: f64, turn: f64) {
        self.hypotheses.iter_mut().for_each(|it| it.filter.disturb(position, turn));
    }

    /// Corrects the pose with the landmarks of one image.
    pub fn correct(&mut self, field: &FieldModel, seen: &[LandmarkSighting]) {
        for sighting in seen {
            self.do_goals_look_alike |= matches!(sighting.landmark, Landmark::PostOfEitherGoal(_));
            for hypothesis in &mut self.hypotheses {
                let likelihood = hypothesis.filter.correct(&self.model, field, sighting);
                hypothesis.weight *= likelihood.max(OUTLIER_FRACTION);
            }
            // In between, so that many sightings do not lead to a weight of zero.
            self.normalise();
        }
        self.merge();
        let is_lost = self.confidence() < LOST_CONFIDENCE;
        for (index, one) in seen.iter().enumerate() {
            for other in &seen[index + 1..] {
                if is_lost || are_posts_of_one_goal(one, other) {
                    self.resect(field, one, other);
                }
            }
        }
        self.prune();
    }

    /// Corrects the pose with the lines of one image.
    pub fn correct_by_lines(&mut self, field: &FieldModel, seen: impl IntoIterator<Item = LineSighting>) {
        for line in seen {
            for hypothesis in &mut self.hypotheses {
                let likelihood = hypothesis.filter.correct_by_line(&self.model, field, &line);
                hypothesis.weight *= likelihood.max(OUTLIER_FRACTION);
            }
            self.normalise();
        }
        self.merge();
        self.prune();
    }

    /// The most likely pose of the robot in the field.
    pub fn field_from_robot(&self) -> Isometry2<f64> {
        self.hypotheses.first().map_or(Isometry2::identity(), |best| *best.filter.field_from_robot())
    }

    /// Confidence of the position: 1 if exact, 0.5 at a standard deviation of half a metre, near 0
    /// if unknown; less while other hypotheses have weight, and while landmarks do not match.
    pub fn confidence(&self) -> f64 {
        self.hypotheses.first().map_or(0.0, |best| {
            best.weight * best.filter.trust() / (1.0 + best.filter.position_variance() / 0.25)
        })
    }

    /// The distance of a pose from the nearest anchor: the sum of metres and radians.
    fn distance_to_anchor(&self, pose: &Isometry2<f64>) -> f64 {
        let distance = |known: &Isometry2<f64>| {
            let position = known.translation.vector - pose.translation.vector;
            position.norm() + wrap(heading(known) - heading(pose)).abs()
        };
        self.anchors.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    fn normalise(&mut self) {
        let sum: f64 = self.hypotheses.iter().map(|it| it.weight).sum();
        if sum > 0.0 {
            self.hypotheses.iter_mut().for_each(|it| it.weight /= sum);
        }
    }

    /// Makes one of hypotheses that are near each other, the heaviest first.
    fn merge(&mut self) {
        self.hypotheses.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        let mut kept = 0;
        for index in 0..self.hypotheses.len() {
            let pose = *self.hypotheses[index].filter.field_from_robot();
            let weight = self.hypotheses[index].weight;
            let known =
                self.hypotheses[..kept].iter_mut().find(|it| is_near(&it.filter, &pose, MERGE_DISTANCE));
            match known {
                Some(known) => known.weight += weight,
                None => {
                    self.hypotheses.swap(kept, index);
                    kept += 1;
                }
            }
        }
        self.hypotheses.truncate(kept);
    }

    fn prune(&mut self) {
        self.hypotheses.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        let heavy = self.hypotheses.iter().take_while(|it| it.weight >= LEAST_WEIGHT).count();
        self.hypotheses.truncate(heavy.clamp(1, MAX_HYPOTHESES));
        self.normalise();
        if self.confidence() >= KNOWN_HALF_CONFIDENCE {
            let pose = self.field_from_robot();
            self.anchors.clear();
            self.anchors.push(pose);
        }
    }

    /// Adds the poses from which two landmarks are seen where they are.
    fn resect(&mut self, field: &FieldModel, one: &LandmarkSighting, other: &LandmarkSighting) {
        let (seen_one, seen_other) = (one.position(), other.position());
        let apart = seen_other - seen_one;
        let deviation = |it: &LandmarkSighting| self.model.distance_deviation(it.landmark, it.distance);
        let tolerance = 2.0 * libm::hypot(deviation(one), deviation(other));
        let distance = one.distance.max(other.distance);
        let (first, second) =
            (LandmarkPlaces::new(one.landmark, field), LandmarkPlaces::new(other.landmark, field));
        for at_one in first.as_slice() {
            for at_other in second.as_slice() {
                let between = at_other - at_one;
                let is_possible = between.norm() > 0.3 && (between.norm() - apart.norm()).abs() < tolerance;
                if !is_possible {
                    continue;
                }
                let turn = rotation(angle_of(&between) - angle_of(&apart));
                let middle_seen = nalgebra::center(&seen_one, &seen_other);
                let middle = nalgebra::center(at_one, at_other);
                let position = middle - turn * middle_seen.coords;
                self.propose(field, Isometry2::from_parts(position.coords.into(), turn), distance);
            }
        }
    }

    /// Adds a hypothesis, unless one explains it or it is off the carpet.
    fn propose(&mut self, field: &FieldModel, pose: Isometry2<f64>, distance: f64) {
        let position = pose.translation.vector;
        let is_on_carpet = position.x.abs() < field.length / 2.0 + CARPET_BORDER
            && position.y.abs() < field.width / 2.0 + CARPET_BORDER;
        let near = (EXPLAINED_DIFFERENCE.0 + EXPLAINED_DIFFERENCE.1 * distance, EXPLAINED_DIFFERENCE.2);
        let is_known = self.hypotheses.iter().any(|it| is_near(&it.filter, &pose, near));
        let is_turned = self.do_goals_look_alike
            && self.distance_to_anchor(&turned(&pose)) < self.distance_to_anchor(&pose);
        // One more than the most has room: `prune` drops the lightest.
        if !is_on_carpet || is_known || is_turned || self.hypotheses.len() > MAX_HYPOTHESES {
            return;
        }
        let start = PoseEstimate {
            field_from_robot: pose,
            place_deviation: 0.15 + 0.12 * distance,
            turn_deviation: 0.3,
        };
        self.hypotheses.push(PoseHypothesis { filter: PoseFilter::new(&start), weight: NEW_WEIGHT });
    }
}

/// The pose turned by half a turn about the centre of the field.
fn turned(pose: &Isometry2<f64>) -> Isometry2<f64> {
    rotation(PI) * pose
}

fn are_posts_of_one_goal(one: &LandmarkSighting, other: &LandmarkSighting) -> bool {
    match (one.landmark, other.landmark) {
        (Landmark::Post(goal, GoalPost::Left), Landmark::Post(same, GoalPost::Right))
        | (Landmark::Post(goal, GoalPost::Right), Landmark::Post(same, GoalPost::Left)) => goal == same,
        // Posts of different goals are farther apart: no place fits them.
        (Landmark::PostOfEitherGoal(GoalPost::Left), Landmark::PostOfEitherGoal(GoalPost::Right))
        | (Landmark::PostOfEitherGoal(GoalPost::Right), Landmark::PostOfEitherGoal(GoalPost::Left)) => true,
        _ => false,
    }
}

fn is_near(filter: &PoseFilter, pose: &Isometry2<f64>, (distance, turn): (f64, f64)) -> bool {
    let known = filter.field_from_robot();
    let off = (Point2::from(known.translation.vector) - Point2::from(pose.translation.vector)).norm();
    off < distance && wrap(heading(known) - heading(pose)).abs() < turn
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::functionality::field::Goal;
    use crate::functionality::geometry::pose;

    const FIELD: FieldModel = FieldModel::LEAGUE_2010;

    fn at(x: f64, y: f64, heading: f64, deviation: f64) -> PoseEstimate {
        PoseEstimate {
            field_from_robot: pose(x, y, heading),
            place_deviation: deviation,
            turn_deviation: deviation,
        }
    }

    fn localisation(starts: &[PoseEstimate]) -> Localisation {
        Localisation::new(LocalisationModel::default(), starts)
    }

    fn seen_at(truth: &Isometry2<f64>, landmark: Landmark, position: Point2<f64>) -> LandmarkSighting {
        let position = truth.inverse_transform_point(&position);
        LandmarkSighting {
            landmark,
            distance: libm::hypot(position.x, position.y),
            bearing: libm::atan2(position.y, position.x),
        }
    }

    fn post(truth: &Isometry2<f64>, goal: Goal, post: GoalPost) -> LandmarkSighting {
        let [left, right] = FIELD.posts(goal);
        seen_at(truth, Landmark::Post(goal, post), if post == GoalPost::Right { right } else { left })
    }

    fn goal(truth: &Isometry2<f64>, goal: Goal) -> [LandmarkSighting; 2] {
        [post(truth, goal, GoalPost::Left), post(truth, goal, GoalPost::Right)]
    }

    fn error(filter: &Localisation, truth: &Isometry2<f64>) -> f64 {
        let difference = truth.inverse() * filter.field_from_robot();
        difference.translation.vector.norm() + heading(&difference).abs()
    }

    #[test]
    fn odometry_carries_it_and_makes_it_less_certain() {
        let mut filter = localisation(&[at(-1.0, 0.0, PI / 2.0, 0.05)]);
        let before = filter.confidence();
        for _ in 0..100 {
            filter.advance(&pose(0.01, 0.0, 0.0));
        }
        assert!(error(&filter, &pose(-1.0, 1.0, PI / 2.0)) < 1e-9);
        assert!(filter.confidence() < before);
    }

    #[test]
    fn posts_pull_a_robot_back_that_was_put_down_askew() {
        let truth = pose(0.5, -0.4, 0.2);
        let mut filter = localisation(&[at(0.4, -0.3, 0.1, 0.2)]);
        for _ in 0..40 {
            filter.correct(&FIELD, &goal(&truth, Goal::Opponent));
        }
        assert!(error(&filter, &truth) < 0.06, "{:?}", filter.field_from_robot());
        assert!(filter.confidence() > 0.9, "{}", filter.confidence());
    }

    #[test]
    fn a_post_of_unknown_side_is_taken_for_the_one_that_fits() {
        let truth = pose(1.0, 0.3, 0.05);
        let mut filter = localisation(&[at(1.05, 0.25, 0.0, 0.05)]);
        for _ in 0..60 {
            for mut seen in goal(&truth, Goal::Opponent) {
                seen.landmark = Landmark::Post(Goal::Opponent, GoalPost::Either);
                filter.correct(&FIELD, &[seen]);
            }
        }
        assert!(error(&filter, &truth) < 0.03, "{:?}", filter.field_from_robot());
    }

    #[test]
    fn places_of_the_lines_correct_the_pose_unless_they_are_ambiguous() {
        let truth = pose(-2.0, 0.8, PI);
        let start = at(-1.9, 0.7, PI, 0.1);
        let mut filter = localisation(&[start]);
        let corner = seen_at(&truth, Landmark::Corner, Point2::new(-2.4, 1.1));
        let junction = seen_at(&truth, Landmark::Junction, Point2::new(-3.0, 1.1));
        for _ in 0..40 {
            filter.correct(&FIELD, &[corner, junction]);
        }
        assert!(error(&filter, &truth) < 0.06, "{:?}", filter.field_from_robot());
        let mut unsure = localisation(&[at(-2.0, 0.0, PI, 1.0)]);
        unsure.correct(&FIELD, &[corner]);
        assert_eq!(unsure.field_from_robot(), pose(-2.0, 0.0, PI), "either corner of the area fits");
    }

    fn line(truth: &Isometry2<f64>, from: (f64, f64), to: (f64, f64)) -> LineSighting {
        LineSighting { ends: [from, to].map(|(x, y)| truth.inverse_transform_point(&Point2::new(x, y))) }
    }

    #[test]
    fn lines_and_the_circle_correct_the_pose_unless_they_are_ambiguous() {
        let truth = pose(-1.3, 0.6, 0.2);
        let mut filter = localisation(&[at(-1.4, 0.75, 0.1, 0.15)]);
        // The halfway line, a part of the circle, and the touch line.
        let seen = [
            line(&truth, (0.0, 1.1), (0.0, 0.7)),
            line(&truth, (-0.58, -0.15), (-0.58, 0.15)),
            line(&truth, (-0.6, 2.0), (0.2, 2.0)),
        ];
        for _ in 0..40 {
            filter.correct_by_lines(&FIELD, seen);
        }
        assert!(error(&filter, &truth) < 0.06, "{:?}", filter.field_from_robot());
        let mut unsure = localisation(&[at(1.8, 0.0, 0.0, 0.6)]);
        unsure.correct_by_lines(&FIELD, [line(&pose(1.5, 0.0, 0.0), (2.4, -0.3), (2.4, 0.3))]);
        assert_eq!(unsure.field_from_robot(), pose(1.8, 0.0, 0.0), "the goal line fits, and the area");
        let mut sure = localisation(&[at(1.0, 0.0, 0.0, 0.05)]);
        sure.correct_by_lines(&FIELD, [line(&pose(1.0, 0.0, 0.0), (2.0, -0.3), (1.8, 0.4))]);
        assert_eq!(sure.field_from_robot(), pose(1.0, 0.0, 0.0), "no line is there");
        let without_circle = FieldModel { circle_radius: 0.0, ..FIELD };
        let mut askew = localisation(&[at(1.0, 0.0, 0.0, 0.1)]);
        askew.correct_by_lines(&without_circle, [line(&pose(1.1, 0.0, 0.0), (2.4, -0.3), (2.4, 0.3))]);
        assert!(askew.field_from_robot().translation.x > 1.02, "a field without a circle has lines");
    }

    #[test]
    fn goals_that_look_alike_do_not_turn_the_field_around() {
        let seen = |truth: &Isometry2<f64>| {
            goal(truth, Goal::Opponent).map(|seen| LandmarkSighting {
                landmark: match seen.landmark {
                    Landmark::Post(_, post) => Landmark::PostOfEitherGoal(post),
                    other => other,
                },
                ..seen
            })
        };
        // Put down in the own half. A pose in the other half fits as well.
        let truth = pose(-1.1, 0.5, 0.1);
        let starts = super::super::placement::Placement::OwnHalf.poses(&FIELD);
        let mut filter = localisation(&starts);
        for _ in 0..80 {
            filter.correct(&FIELD, &seen(&truth));
        }
        assert!(error(&filter, &truth) < 0.2, "{:?}", filter.field_from_robot());
        assert!(filter.confidence() > 0.8, "{}", filter.confidence());
        // Carried to a pose that is nearer to the last one than its twin.
        let carried = pose(0.2, 0.9, 0.4);
        let mut filter = localisation(&[at(1.0, -0.8, -0.4, 0.05)]);
        for _ in 0..3 {
            filter.correct(&FIELD, &seen(&carried));
        }
        assert!(error(&filter, &carried) < 0.1, "{:?}", filter.field_from_robot());
        let twin = turned(&carried);
        let is_twin = |it: &PoseHypothesis| is_near(&it.filter, &twin, MERGE_DISTANCE);
        assert!(!filter.hypotheses.iter().any(is_twin), "{:?}", filter.hypotheses);
    }

    #[test]
    fn a_post_out_of_place_changes_nothing() {
        let truth = pose(1.0, 0.0, 0.0);
        let mut filter = localisation(&[at(1.0, 0.0, 0.0, 0.05)]);
        let near = LandmarkSighting { distance: 0.5, ..post(&truth, Goal::Opponent, GoalPost::Left) };
        filter.correct(&FIELD, &[near]);
        assert_eq!(filter.field_from_robot(), truth);
        filter.correct(&FIELD, &[post(&pose(1.2, 0.0, 0.0), Goal::Opponent, GoalPost::Left)]);
        assert!(filter.field_from_robot().translation.x > 1.0, "one that fits does");
    }

    #[test]
    fn it_is_less_confident_while_landmarks_do_not_match() {
        let truth = pose(1.0, 0.0, 0.0);
        let mut filter = localisation(&[at(1.0, 0.0, 0.0, 0.05)]);
        let seen = post(&truth, Goal::Opponent, GoalPost::Left);
        filter.correct(&FIELD, &[seen]);
        let before = filter.confidence();
        filter.correct(&FIELD, &[LandmarkSighting { distance: 0.5, ..seen }]);
        assert!(filter.confidence() < 0.9 * before, "{} {before}", filter.confidence());
        filter.correct(&FIELD, &[seen]);
        assert!(filter.confidence() > 0.97 * before, "{} {before}", filter.confidence());
    }

    #[test]
    fn a_robot_carried_away_finds_itself_with_the_second_image_of_a_goal() {
        let truth = pose(-0.8, 0.6, 0.5);
        let mut filter = localisation(&[at(1.0, -0.8, -0.4, 0.05)]);
        for _ in 0..3 {
            filter.correct(&FIELD, &goal(&truth, Goal::Opponent));
        }
        assert!(error(&filter, &truth) < 0.1, "{:?}", filter.field_from_robot());
    }

    #[test]
    fn a_goal_in_the_wrong_colour_does_not_turn_the_field_around() {
        let truth = pose(-0.8, 0.6, 0.5);
        let mut filter = localisation(&[at(-0.8, 0.6, 0.5, 0.05)]);
        for _ in 0..50 {
            let wrong = goal(&truth, Goal::Opponent).map(|seen| LandmarkSighting {
                landmark: match seen.landmark {
                    Landmark::Post(_, post) => Landmark::Post(Goal::Own, post),
                    other => other,
                },
                ..seen
            });
            filter.correct(&FIELD, &wrong);
            assert!(error(&filter, &truth) < 0.1, "{:?}", filter.field_from_robot());
            filter.correct(&FIELD, &goal(&truth, Goal::Opponent));
        }
    }

    #[test]
    fn landmarks_decide_between_the_places_at_which_it_may_have_been_put() {
        let truth = pose(0.0, -2.0, PI / 2.0);
        let starts = [at(0.0, 2.0, -PI / 2.0, 0.3), at(0.0, -2.0, PI / 2.0, 0.3)];
        let mut filter = localisation(&starts);
        assert!(filter.confidence() < 0.5, "{}", filter.confidence());
        let seen = post(&truth, Goal::Opponent, GoalPost::Right);
        for _ in 0..10 {
            filter.correct(&FIELD, &[seen]);
        }
        assert!(error(&filter, &truth) < 0.3, "{:?}", filter.field_from_robot());
        assert!(filter.confidence() > 0.6, "{}", filter.confidence());
    }

    proptest! {
        #[test]
        fn no_sighting_makes_it_lose_its_numbers(
            seen in prop::collection::vec((0.0..20.0f64, -3.2..3.2f64, 0..6u8, any::<bool>(), -0.3..0.3f64), 1..100)
        ) {
            let mut filter = localisation(&[at(0.0, 0.0, 0.0, 0.05)]);
            let mut before = None;
            for (distance, bearing, kind, own, step) in seen {
                let goal = if own { Goal::Own } else { Goal::Opponent };
                let landmark = match kind {
                    0 => Landmark::Post(goal, GoalPost::Left),
                    1 => Landmark::Post(goal, GoalPost::Right),
                    2 => Landmark::Post(goal, GoalPost::Either),
                    3 => Landmark::Corner,
                    4 => Landmark::Junction,
                    _ => Landmark::CentreCircle,
                };
                let sighting = LandmarkSighting { landmark, distance, bearing };
                filter.correct(&FIELD, &[sighting, before.unwrap_or(sighting)]);
                before = Some(sighting);
                filter.advance(&pose(step, -step, step));
                let pose = filter.field_from_robot();
                prop_assert!(pose.translation.vector.norm().is_finite() && heading(&pose).is_finite());
                prop_assert!((0.0..=1.0 + 1e-9).contains(&filter.confidence()));
            }
        }
    }
}
