//! Positions at which the referee puts robots and ball.

use crate::state::{GOALIE_NUMBER, WorldView};
use crate::{FieldGeometry, FieldSide, Physics, Pose, RobotState, Vector};

/// Distance from the ball of the robot that kicks off, m.
const KICK_OFF_DISTANCE: f64 = 0.3;

/// Least distance between a placed ball or robot and another robot, m.
const MIN_CLEARANCE: f64 = 0.08;

/// Positions of field players that do not kick off, as fractions of half the length and half the
/// width towards the own goal, in the order of their numbers.
const PLACES: [(f64, f64); 10] = [
    (-0.35, 0.45),
    (-0.35, -0.45),
    (-0.6, 0.0),
    (-0.55, 0.75),
    (-0.55, -0.75),
    (-0.75, 0.4),
    (-0.75, -0.4),
    (-0.3, 0.8),
    (-0.3, -0.8),
    (-0.5, 0.25),
];

/// The legal pose of a robot for a kick-off: in its own half, and outside the centre circle for the
/// opponents of the team that kicks off. `rank` counts the field players of its team before it.
pub(crate) fn kick_off_pose(
    field: &FieldGeometry,
    physics: &Physics,
    defends: FieldSide,
    kicks_off: bool,
    number: u8,
    rank: usize,
) -> Pose {
    let clear_of_circle = field.centre_circle_radius + physics.robot_radius + MIN_CLEARANCE;
    let own_half = match (number, rank) {
        (GOALIE_NUMBER, _) => Vector::new(-field.half_length() + physics.robot_radius, 0.0),
        (_, 0) if kicks_off => Vector::new(-KICK_OFF_DISTANCE, 0.0),
        (_, 0) => Vector::new(-clear_of_circle, 0.0),
        _ => spread(field, rank, clear_of_circle),
    };
    Pose::facing(own_half * -defends.sign(), Vector::zeros())
}

fn spread(field: &FieldGeometry, rank: usize, clear_of_circle: f64) -> Vector {
    let (x, y) = PLACES[(rank - 1) % PLACES.len()];
    let least_x = field.goal_area_depth + MIN_CLEARANCE - field.half_length();
    let position = Vector::new((x * field.half_length()).max(least_x), y * field.half_width());
    if position.norm() >= clear_of_circle { position } else { position * (clear_of_circle / position.norm()) }
}

/// The position for a ball that left the field at `position`: on the throw-in line, set back
/// against the team that touched it last, which defends `against`.
pub(crate) fn throw_in(
    field: &FieldGeometry,
    behind: f64,
    position: Vector,
    against: Option<FieldSide>,
) -> Vector {
    let max =
        Vector::new(field.half_length() - field.throw_in_inset, field.half_width() - field.throw_in_inset);
    let at = position.x.clamp(-field.half_length(), field.half_length());
    let back = against.map_or(0.0, |side| side.sign() * behind);
    Vector::new((at + back).clamp(-max.x, max.x), max.y.copysign(position.y))
}

/// The position at which a stuck ball is dropped: the centre, or a penalty mark if it is stuck at
/// the centre.
pub(crate) fn drop_position(field: &FieldGeometry, ball: Vector, mark: FieldSide) -> Vector {
    if ball.norm() > field.centre_circle_radius {
        return Vector::zeros();
    }
    Vector::new(mark.sign() * field.mark_distance, 0.0)
}

/// The free position for a ball nearest to `wanted`.
pub(crate) fn free_for_ball(scene: &WorldView<'_>, wanted: Vector) -> Vector {
    let physics = scene.physics;
    let reach = physics.robot_radius.max(physics.foot_front).max(physics.foot_side) + physics.ball_radius;
    let lying = physics.lying_reach.max(physics.dive_reach) + physics.ball_radius;
    let limit = Vector::new(
        scene.field.half_length() - physics.ball_radius,
        scene.field.half_width() - physics.ball_radius,
    );
    let is_free = |position: Vector| {
        scene.on_field().all(|(_, robot)| {
            let reach = if robot.phase.is_upright() { reach } else { lying };
            (robot.pose.position - position).norm() > reach + MIN_CLEARANCE
        })
    };
    nearest(wanted, limit, is_free)
}

/// The pose of a robot that returns after a penalty: at the end of the halfway line away from the
/// ball, facing it.
pub(crate) fn return_pose(scene: &WorldView<'_>, robot: usize) -> Pose {
    let side = -1f64.copysign(scene.ball.position.y);
    let wanted = Vector::new(0.0, side * scene.field.half_width());
    let limit = Vector::new(scene.field.half_length(), scene.field.half_width());
    let apart = 2.0 * scene.physics.robot_radius + MIN_CLEARANCE;
    let is_free = |position: Vector| {
        let mut others = scene.on_field().filter(|(index, _)| *index != robot);
        others.all(|(_, other)| (other.pose.position - position).norm() > apart)
            && (scene.ball.position - position).norm() > apart
    };
    Pose::facing(nearest(wanted, limit, is_free), Vector::zeros())
}

/// The free pose for a robot nearest to a wanted one.
pub(crate) fn free_for_robot(scene: &WorldView<'_>, robot: usize, wanted: Pose) -> Pose {
    let limit = Vector::new(scene.field.half_length(), scene.field.half_width());
    let apart = 2.0 * scene.physics.robot_radius;
    let is_free = |position: Vector| {
        let mut others = scene.on_field().filter(|(index, _)| *index != robot);
        others.all(|(_, other)| (other.pose.position - position).norm() > apart)
    };
    Pose { position: nearest(wanted.position, limit, is_free), ..wanted }
}

/// Whether a robot stands where it may stand at a kick-off: upright in its own half and on the
/// field, outside the centre circle unless its team kicks off, and outside its own goal area unless
/// it is the goalie.
pub(crate) fn is_legal_at_kick_off(
    scene: &WorldView<'_>,
    robot: usize,
    defends: FieldSide,
    kicks_off: bool,
) -> bool {
    let (field, state) = (scene.field, &scene.robots[robot]);
    let position = state.pose.position;
    let clear = position.norm() >= field.centre_circle_radius;
    state.phase.is_upright()
        && field.contains(position)
        && position.x * defends.sign() > 0.0
        && (clear || kicks_off)
        && (state.is_goalie() || !field.in_goal_area(defends, position))
}

/// The pose of a penalized robot: beside the field, in its own half.
pub(crate) fn waiting_pose(field: &FieldGeometry, defends: FieldSide, robot: &RobotState) -> Pose {
    let along = 0.4 + 0.35 * f64::from(robot.number);
    let x = defends.sign() * along.min(field.half_length() + field.border);
    let y = field.half_width() + field.border * 0.7;
    Pose::facing(Vector::new(x, y), Vector::zeros())
}

/// The first free position on rings of growing radius around `wanted`, inside a rectangle; `wanted`
/// itself if none is free.
fn nearest(wanted: Vector, limit: Vector, is_free: impl Fn(Vector) -> bool) -> Vector {
    const DIRECTIONS: usize = 12;
    let within = |position: Vector| {
        Vector::new(position.x.clamp(-limit.x, limit.x), position.y.clamp(-limit.y, limit.y))
    };
    let around = (0..20).flat_map(|ring| {
        (0..DIRECTIONS).map(move |turn| {
            let angle = std::f64::consts::TAU * turn as f64 / DIRECTIONS as f64;
            Vector::new(libm::cos(angle), libm::sin(angle)) * (0.1 * f64::from(ring))
        })
    });
    around.map(|offset| within(wanted + offset)).find(|position| is_free(*position)).unwrap_or(wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kick_off_places_are_legal_on_any_field() {
        for (length, width) in [(6.0, 4.0), (9.0, 6.0), (4.0, 3.0)] {
            let field = FieldGeometry { length, width, ..FieldGeometry::default() };
            let physics = Physics::default();
            for defends in [FieldSide::Left, FieldSide::Right] {
                for (number, rank) in (1..=11u8).map(|number| (number, usize::from(number.saturating_sub(2))))
                {
                    for kicks_off in [false, true] {
                        let pose = kick_off_pose(&field, &physics, defends, kicks_off, number, rank);
                        assert!(field.contains(pose.position), "{number} {pose:?}");
                        assert!(pose.position.x * defends.sign() > 0.0, "{number} {pose:?}");
                        assert!(
                            number == GOALIE_NUMBER || !field.in_goal_area(defends, pose.position),
                            "{number} {pose:?}"
                        );
                        let outside = pose.position.norm() > field.centre_circle_radius;
                        assert!(outside || (kicks_off && rank == 0), "{number} {pose:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn kick_off_places_are_apart() {
        let field = FieldGeometry::default();
        let physics = Physics::default();
        let position = |number: u8| {
            let rank = usize::from(number.saturating_sub(2));
            kick_off_pose(&field, &physics, FieldSide::Left, true, number, rank).position
        };
        for one in 1..=11 {
            for other in (1..=11).filter(|other| *other != one) {
                assert!((position(one) - position(other)).norm() > 0.26, "{one} {other}");
            }
        }
    }

    #[test]
    fn a_throw_in_is_set_back_against_the_last_toucher() {
        let field = FieldGeometry::default();
        let at = |x, y, against| throw_in(&field, 1.0, Vector::new(x, y), against);
        assert_eq!(at(0.5, 2.1, None), Vector::new(0.5, 1.6));
        assert_eq!(at(0.5, 2.1, Some(FieldSide::Left)), Vector::new(-0.5, 1.6));
        assert_eq!(at(0.5, -2.1, Some(FieldSide::Right)), Vector::new(1.5, -1.6));
        assert_eq!(
            at(3.1, 1.2, Some(FieldSide::Left)),
            Vector::new(2.0, 1.6),
            "an attacker over the goal line"
        );
        assert_eq!(at(3.1, -1.2, Some(FieldSide::Right)), Vector::new(2.6, -1.6), "a defender: a corner");
    }

    #[test]
    fn a_stuck_ball_goes_to_the_centre_or_from_there_to_a_mark() {
        let field = FieldGeometry::default();
        assert_eq!(drop_position(&field, Vector::new(2.0, 1.0), FieldSide::Left), Vector::zeros());
        assert_eq!(drop_position(&field, Vector::new(0.1, 0.1), FieldSide::Right), Vector::new(1.2, 0.0));
    }
}
