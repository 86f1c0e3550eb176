//! A scripted team that knows the ground truth: a reference for the physics, far simpler than real
//! players.

use monas_sim::{BodyPhase, Command, GameState, Motion, RobotState, Side, SimulatedWorld, Vector};

/// The current command to a robot of a scripted team.
pub(crate) fn command(world: &SimulatedWorld, robot: usize) -> Command {
    let me = world.robots()[robot];
    if me.phase.is_fallen() {
        return Command::new(Motion::StandUp);
    }
    if world.referee().state() != GameState::Playing {
        // Goalies walk home; who else stands where it must not is placed by the referee.
        let is_away = me.is_goalie() && (home(world, &me) - me.pose.position).norm() > 0.25;
        return if is_away { keep_goal(world, &me) } else { Command::new(Motion::Stand) };
    }
    let goal = world.field().goal(world.referee().defends()[me.team].opposite());
    if me.is_goalie() {
        return keep_goal(world, &me);
    }
    if is_nearest_of_team(world, robot) { attack(world, &me, goal) } else { wait(world, &me, goal) }
}

fn keep_goal(world: &SimulatedWorld, me: &RobotState) -> Command {
    let ball = me.pose.to_own(world.ball().position);
    let velocity = turned(world.ball().velocity, -me.pose.heading);
    let time = -ball.x / velocity.x;
    if velocity.x < -0.3 && ball.x > 0.0 && time < 1.0 {
        let y = ball.y + velocity.y * time;
        return match y.abs() {
            y if y > 0.8 => Command::default(),
            reach if reach > 0.25 => Command::new(Motion::Dive(Side::of(y))),
            reach if reach > 0.1 => Command::new(Motion::Fall(Side::of(y))),
            _ => Command::default(),
        };
    }
    go(me, home(world, me), Vector::zeros())
}

/// The place of a goalie before its goal.
fn home(world: &SimulatedWorld, me: &RobotState) -> Vector {
    let side = world.referee().defends()[me.team];
    world.field().goal(side) - Vector::new(side.sign() * 0.2, 0.0)
}

fn attack(world: &SimulatedWorld, me: &RobotState, goal: Vector) -> Command {
    let ball = world.ball().position;
    let foot = Side::of(me.pose.to_own(ball).y);
    let ahead = (goal - ball).normalize();
    let left = Vector::new(-ahead.y, ahead.x);
    let position = ball - ahead * 0.16 - left * (0.05 * foot.sign());
    let aim = angle(libm::atan2(goal.y - ball.y, goal.x - ball.x) - me.pose.heading);
    let off = me.pose.to_own(position);
    if off.norm() < 0.03 && aim.abs() < 0.15 {
        return Command::new(Motion::Kick(foot));
    }
    let ready = me.pose.to_own(ball - ahead * 0.35);
    let (target, turn) = if off.norm() < 0.4 && aim.abs() < 0.4 { (off, aim) } else { (ready, aim) };
    if target.norm() > 0.5 {
        let bearing = libm::atan2(target.y, target.x);
        return Command::walk(if bearing.abs() < 0.8 { 0.3 } else { 0.0 }, 0.0, 2.0 * bearing);
    }
    Command::walk(target.x * 1.5, target.y * 1.5, turn * 1.5)
}

fn wait(world: &SimulatedWorld, me: &RobotState, goal: Vector) -> Command {
    let ball = world.ball().position;
    let position =
        (ball - goal * 0.4) * 0.6 + Vector::new(0.0, if me.number.is_multiple_of(2) { 0.8 } else { -0.8 });
    go(me, position, ball)
}

/// Walks to a position and faces a point once there.
fn go(me: &RobotState, position: Vector, face: Vector) -> Command {
    let off = me.pose.to_own(position);
    let look = me.pose.to_own(face);
    if off.norm() > 0.3 {
        let bearing = libm::atan2(off.y, off.x);
        return Command::walk(if bearing.abs() < 0.8 { 0.3 } else { 0.0 }, 0.0, 2.0 * bearing);
    }
    Command::walk(off.x, off.y, libm::atan2(look.y, look.x))
}

fn is_nearest_of_team(world: &SimulatedWorld, robot: usize) -> bool {
    let me = &world.robots()[robot];
    let ball = world.ball().position;
    let distance = |other: &RobotState| (other.pose.position - ball).norm();
    let mut mates = world.robots().iter().filter(|other| other.team == me.team && !other.is_goalie());
    let able = |other: &RobotState| other.on_field && !matches!(other.phase, BodyPhase::Fallen(_));
    mates.all(|other| !able(other) || distance(other) >= distance(me))
}

fn turned(vector: Vector, by: f64) -> Vector {
    let (sin, cos) = libm::sincos(by);
    Vector::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}

fn angle(angle: f64) -> f64 {
    monas_sim::normalize_angle(angle)
}

/// Lets both teams (or only the first) play by the script until the match is over.
pub(crate) fn play_match(world: &mut SimulatedWorld, teams: &[usize]) {
    while world.referee().state() != GameState::Finished {
        for robot in 0..world.robots().len() {
            if world.steps().is_multiple_of(2) && teams.contains(&world.robots()[robot].team) {
                let command = command(world, robot);
                world.command(robot, command).unwrap();
            }
        }
        world.step();
    }
}
