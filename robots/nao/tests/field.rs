//! A Nao over a robot of the embedded field.
#![allow(clippy::panic, clippy::unwrap_used)] // tests

use std::collections::BTreeMap;

use monas_nao::SimulatedNao;
use monas_robot::{Actuators, BodySettings, JointCommands, Percepts, Posture, Robot, Skill, SkillResult};
use monas_sim::{
    BodyPhase, FieldSide, GameState, Physics, Pose, RobotSetup, Setup, SharedField, SimulatedWorld,
    TeamColour, TeamSetup,
};
use narukom::Timestamp;

/// A field with one robot that plays from the beginning.
fn field() -> SharedField {
    field_with(Physics::default())
}

fn field_with(physics: Physics) -> SharedField {
    let team = |number, colour, plays| TeamSetup { number, name: format!("team {number}"), colour, plays };
    let setup = Setup {
        field: Default::default(),
        physics,
        rules: Default::default(),
        radio: Default::default(),
        objects: Default::default(),
        teams: [team(1, TeamColour::Blue, FieldSide::Left), team(2, TeamColour::Red, FieldSide::Right)],
        robots: vec![RobotSetup { team: 1, number: 2 }],
        seed: 7,
    };
    let mut world = SimulatedWorld::new(setup).unwrap();
    while world.referee().state() != GameState::Playing {
        world.step();
    }
    SharedField::new(world)
}

/// A Nao on a field, and the time.
struct Trial {
    field: SharedField,
    nao: Box<dyn Robot>,
    percepts: Percepts,
    cycle: u64,
}

impl Trial {
    fn new() -> Trial {
        Trial::on(field())
    }

    fn on(field: SharedField) -> Trial {
        Trial::with(field, &BTreeMap::new())
    }

    /// A trial of the body that a configuration with these options opens.
    fn with(field: SharedField, options: &BTreeMap<String, String>) -> Trial {
        let settings =
            BodySettings { kind: "nao".to_owned(), options: options.clone(), ..BodySettings::default() };
        let nao = settings.open(Some(Box::new(field.body(0).unwrap())), 7).unwrap();
        let mut trial = Trial { field, nao, percepts: Percepts::default(), cycle: 0 };
        trial.run(1.5, Actuators::default());
        trial
    }

    /// Runs for a time with a command; returns the odometry: x, y and heading.
    fn run(&mut self, seconds: f64, command: Actuators) -> Pose {
        let mut moved = Pose::default();
        for _ in 0..(seconds / 0.012).round() as usize {
            self.cycle += 1;
            let now = Timestamp::from_nanos(self.cycle * 12_000_000);
            while self.field.with_world(|world| world.time()) + 0.005 < now.as_nanos() as f64 / 1e9 + START {
                self.field.step();
            }
            self.percepts.clear_news();
            self.nao.sense(now, &mut self.percepts).unwrap();
            self.nao.act(now, &command).unwrap();
            let felt = &self.percepts.sensors;
            moved = moved.compose(&Pose::new(felt.odometry_x, felt.odometry_y, felt.odometry_turn));
        }
        moved
    }

    fn pose(&self) -> Pose {
        self.field.with_world(|world| world.robots()[0].pose)
    }

    fn phase(&self) -> BodyPhase {
        self.field.with_world(|world| world.robots()[0].phase)
    }

    /// Performs a skill until `ends`; returns the time, s, and the odometry.
    fn perform(&mut self, skill: Skill, ends: impl Fn(BodyPhase) -> bool) -> (f64, Pose) {
        let skill_number = self.percepts.sensors.skill_done + 1;
        let command = Actuators { skill: skill as i32, skill_number, ..Actuators::default() };
        let (mut moved, mut cycles) = (Pose::default(), 0);
        while !ends(self.phase()) {
            moved = moved.compose(&self.run(0.012, command));
            cycles += 1;
            assert!(cycles < 1000, "{skill:?} does not end: {:?}", self.phase());
        }
        (f64::from(cycles) * 0.012, moved)
    }

    fn posture(&self) -> Posture {
        self.percepts.sensors.posture()
    }
}

/// The time of the field at which a robot plays, s.
const START: f64 = 6.0;

#[test]
fn it_is_a_body_like_any_other() {
    let field = field();
    let mut nao = SimulatedNao::new(Box::new(field.body(0).unwrap())).unwrap();
    monas_robot::conformance::check(&mut nao);
}

#[test]
fn legs_carry_the_robot_of_the_field() {
    for (x, y, turn) in [(0.2, 0.0, 0.0), (0.0, 0.1, 0.0), (0.1, 0.0, 0.4)] {
        let mut trial = Trial::new();
        assert_eq!(trial.posture(), Posture::Standing);
        let before = trial.pose();
        let command = Actuators { walk_x: x, walk_y: y, walk_turn: turn, ..Actuators::default() };
        let felt = trial.run(4.0, command);
        assert_eq!(trial.posture(), Posture::Walking);
        let after = trial.pose();
        let seen = before.to_own(after.position);
        let turned = monas_sim::normalize_angle(after.heading - before.heading);
        // The steps of the field slip by 8 percent.
        assert!((seen - felt.position).norm() < 0.25, "{seen} {}", felt.position);
        assert!((turned - felt.heading).abs() < 0.4, "{turned} {}", felt.heading);
        // Four seconds less the time to reach the speed.
        let min = if turn == 0.0 { 3.7 * x.max(y) } else { 0.3 };
        assert!(felt.position.norm() > min && felt.heading >= 3.7 * turn, "{felt:?}");
        trial.run(4.0, Actuators::default());
        assert_eq!(trial.posture(), Posture::Standing);
    }
}

#[test]
fn a_dive_and_standing_up_are_motions_of_joints() {
    let mut trial = Trial::new();
    let skill =
        |skill: Skill, skill_number| Actuators { skill: skill as i32, skill_number, ..Actuators::default() };
    trial.run(0.3, skill(Skill::DiveLeft, 1));
    assert_eq!(trial.posture(), Posture::Busy);
    trial.run(1.0, skill(Skill::DiveLeft, 1));
    assert_eq!((trial.posture(), trial.percepts.sensors.skill_done), (Posture::Fallen, 1));
    assert!(trial.percepts.sensors.torso_roll < -1.2, "{:?}", trial.percepts.sensors);
    trial.run(2.0, skill(Skill::StandUp, 2));
    assert_eq!(trial.posture(), Posture::StandingUp);
    trial.run(4.0, skill(Skill::StandUp, 2));
    assert_eq!((trial.posture(), trial.percepts.sensors.skill_done), (Posture::Standing, 2));
}

#[test]
fn resting_sits_down_and_relaxes_the_joints() {
    let mut trial = Trial::new();
    trial.run(1.0, Actuators { walk_x: 0.2, ..Actuators::default() });
    trial.nao.rest(Timestamp::ZERO).unwrap();
    trial.run(5.0, Actuators { walk_x: 0.2, ..Actuators::default() });
    let felt = &trial.percepts.sensors;
    assert_eq!((felt.posture(), felt.relaxed), (Posture::Sitting, true));
    let phase = trial.field.with_world(|world| world.robots()[0].phase);
    assert_eq!(phase, BodyPhase::Sitting);
    let joints = trial.percepts.joints.as_ref().unwrap();
    assert!(joints.stiffnesses.iter().all(|&stiffness| stiffness == 0.0));
    let knee = trial.nao.anatomy().joint("LKneePitch").unwrap();
    assert!(joints.positions[knee] > 2.0, "{:?}", joints.positions);
}

#[test]
fn commands_to_joints_move_them_and_are_released() {
    let mut trial = Trial::new();
    let anatomy = trial.nao.anatomy();
    let (elbow, head) = (anatomy.joint("RElbowRoll").unwrap(), anatomy.joint("HeadYaw").unwrap());
    let joints = vec![elbow as u32, head as u32];
    let commands = JointCommands { joints, targets: vec![1.0, 0.5], stiffnesses: vec![1.0, 0.6] };
    trial.nao.command_joints(Timestamp::ZERO, &commands).unwrap();
    trial.run(1.0, Actuators { head_yaw: -0.5, ..Actuators::default() });
    let joints = trial.percepts.joints.clone().unwrap();
    assert!((joints.positions[elbow] - 1.0).abs() < 1e-3 && (joints.positions[head] - 0.5).abs() < 1e-3);
    assert!((joints.stiffnesses[head] - 0.6).abs() < 1e-6);
    trial.nao.command_joints(Timestamp::ZERO, &JointCommands::default()).unwrap();
    trial.run(1.0, Actuators { head_yaw: -0.5, ..Actuators::default() });
    assert!((trial.percepts.sensors.head_yaw + 0.5).abs() < 1e-3, "{:?}", trial.percepts.sensors);
}

#[test]
fn a_fallen_or_lifted_robot_has_no_weight_on_its_soles() {
    let mut trial = Trial::new();
    let weight = |trial: &Trial| trial.percepts.contacts.as_ref().unwrap().foot_pressures.iter().sum::<f64>();
    assert!((weight(&trial) - 5.3).abs() < 0.01);
    let inertial = trial.percepts.inertial.unwrap();
    assert!((inertial.acceleration_z - 9.81).abs() < 0.1, "{inertial:?}");
    trial.run(2.0, Actuators { skill: Skill::FallRight as i32, skill_number: 1, ..Actuators::default() });
    assert_eq!((trial.posture(), weight(&trial)), (Posture::Fallen, 0.0));
}

#[test]
fn skills_take_little_longer_than_those_of_the_field_and_are_no_steps() {
    for (skill, begins) in [(Skill::DiveRight, 0.1), (Skill::FallLeft, 0.16)] {
        let mut trial = Trial::new();
        let (time, moved) = trial.perform(skill, |phase| !phase.is_upright());
        // The legs have to lean first.
        assert!(time < begins, "{skill:?} begins after {time} s");
        let fallen =
            trial.run(1.0, Actuators { skill: skill as i32, skill_number: 1, ..Actuators::default() });
        let before = trial.pose();
        let (time, risen) = trial.perform(Skill::StandUp, BodyPhase::is_upright);
        // The field takes 3.5 s from the moment that the legs are folded.
        assert!((3.5..3.75).contains(&time), "it stands after {time} s");
        let settled = trial.run(1.0, Actuators::default());
        assert_eq!(trial.posture(), Posture::Standing);
        for felt in [moved, fallen, risen, settled] {
            assert!(felt.position.norm() < 1e-3 && felt.heading.abs() < 1e-3, "{skill:?}: {felt:?}");
        }
        assert!((trial.pose().position - before.position).norm() < 0.01, "the legs carry it away");
    }
}

#[test]
fn standing_up_is_tried_again_when_it_fails() {
    let mut trial = Trial::on(field_with(Physics { stand_up_success: 0.1, ..Physics::default() }));
    // By chance one of the falls may need a single attempt.
    let attempts = (0..4).map(|_| attempts_to_stand(&mut trial)).sum::<u32>();
    assert!(attempts > 4, "each first attempt has succeeded");
}

/// Falls, and gets up by a skill that is commanded again under a new number whenever it has ended.
/// Returns how often the body began to stand up.
fn attempts_to_stand(trial: &mut Trial) -> u32 {
    trial.perform(Skill::DiveLeft, BodyPhase::is_fallen);
    let mut skill_number = trial.percepts.sensors.skill_done + 1;
    let (mut attempts, mut before) = (0, trial.phase());
    for _ in 0..20_000 {
        skill_number += u64::from(trial.percepts.sensors.skill_done == skill_number);
        let command = Actuators { skill: Skill::StandUp as i32, skill_number, ..Actuators::default() };
        trial.run(0.012, command);
        let phase = trial.phase();
        attempts += u32::from(phase == BodyPhase::StandingUp && before != phase);
        if phase.is_upright() {
            trial.run(1.0, command);
            return attempts;
        }
        before = phase;
    }
    panic!("it does not stand after {attempts} attempts");
}

/// A greeting with an arm and the head, in place of the kick.
const GREETING: &str = r#"<poses>
  <pose duration="0.5" RShoulderPitch="-0.5" HeadYaw="0.6"/>
  <pose duration="0.5" RElbowRoll="1.2"/>
  <pose duration="0.5" stiffness="0.5" RShoulderPitch="1.5" RElbowRoll="0.4"/>
</poses>"#;

#[test]
fn joints_pass_through_the_poses_of_a_file_and_the_skill_has_a_result() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("greeting.xml");
    std::fs::write(&file, GREETING).unwrap();
    let options = BTreeMap::from([("kick".to_owned(), file.display().to_string())]);
    for (skill, side, sign) in [(Skill::KickLeft, "R", 1.0), (Skill::KickRight, "L", -1.0)] {
        let mut trial = Trial::with(field(), &options);
        let anatomy = trial.nao.anatomy();
        let joints =
            ["ShoulderPitch", "ElbowRoll"].map(|name| anatomy.joint(&format!("{side}{name}")).unwrap());
        let command =
            Actuators { skill: skill as i32, skill_number: 1, head_yaw: -0.3, ..Actuators::default() };
        let before = trial.pose();
        for (seconds, shoulder, elbow, stiffness) in
            [(0.25, 0.5, 0.4, 0.8), (0.5, -0.5, 0.8, 0.8), (0.5, 0.5, 0.8, 0.5)]
        {
            trial.run(seconds, command);
            let felt = trial.percepts.joints.as_ref().unwrap();
            let [pitch, roll] = joints.map(|joint| felt.positions[joint]);
            // Targets arrive two cycles later.
            assert!((pitch - shoulder).abs() < 0.15 && (roll - sign * elbow).abs() < 0.1, "{pitch} {roll}");
            assert!((felt.stiffnesses[joints[0]] - stiffness).abs() < 1e-6, "{skill:?}");
            assert_eq!((trial.posture(), trial.percepts.sensors.skill_done), (Posture::Busy, 0));
        }
        assert!((trial.percepts.sensors.head_yaw - sign * 0.6).abs() < 0.05, "{:?}", trial.percepts.sensors);
        trial.run(0.5, command);
        let felt = &trial.percepts.sensors;
        assert_eq!((felt.skill_done, felt.skill_result()), (1, SkillResult::Performed));
        assert_eq!(trial.posture(), Posture::Standing);
        // The legs had no part in it, and the head follows its commands again.
        assert!((trial.pose().position - before.position).norm() < 1e-6);
        trial.run(0.5, command);
        assert!((trial.percepts.sensors.head_yaw + 0.3).abs() < 1e-3, "{:?}", trial.percepts.sensors);
    }
}

#[test]
fn a_file_of_poses_with_errors_opens_no_body() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("dive.xml");
    std::fs::write(&file, "<pose LKneePitch=90/>").unwrap();
    let options = BTreeMap::from([("dive".to_owned(), file.display().to_string())]);
    let settings = BodySettings { kind: "nao".to_owned(), options, ..BodySettings::default() };
    let error = settings.open(Some(Box::new(field().body(0).unwrap())), 7).map(drop).unwrap_err();
    let expected =
        "dive.xml:1:18: error[E0306]: `LKneePitch` is `90`, expected a number from -0.0923 to 2.1125";
    assert!(error.to_string().contains(expected), "{error}");
}

#[test]
fn a_robot_of_its_own_keeps_its_limits() {
    let folder = tempfile::tempdir().unwrap();
    let built_in = include_str!("../nao.urdf");
    let write = |name: &str, changes: &[(&str, &str)]| {
        let text = changes.iter().fold(built_in.to_owned(), |text, (from, to)| {
            assert_eq!(text.matches(from).count(), 1, "{from}");
            text.replace(from, to)
        });
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        BTreeMap::from([("anatomy".to_owned(), path.display().to_string())])
    };
    let slow = write(
        "slow.urdf",
        &[("walk x=\"-0.15 0.3\"", "walk x=\"-0.1 0.1\""), ("upper=\"0.5149\"", "upper=\"0.2\"")],
    );
    let command = Actuators { walk_x: 0.3, head_pitch: 0.5, ..Actuators::default() };
    let walk = |options| {
        let mut trial = Trial::with(field(), options);
        let moved = trial.run(3.0, command);
        (moved.position.x, trial.percepts.sensors.head_pitch)
    };
    let (ahead, pitch) = walk(&slow);
    assert!((0.2..0.32).contains(&ahead) && (pitch - 0.2).abs() < 0.01, "{ahead} {pitch}");
    let (ahead, pitch) = walk(&BTreeMap::new());
    assert!((0.6..0.95).contains(&ahead) && (pitch - 0.5).abs() < 0.01, "{ahead} {pitch}");

    let options = write(
        "tall.urdf",
        &[(
            "<parent link=\"LThigh\"/><child link=\"LTibia\"/>\n    \
        <origin xyz=\"0 0 -0.1\"/>",
            "<parent link=\"LThigh\"/><child link=\"LTibia\"/>\n    \
        <origin xyz=\"0 0 -0.11\"/>",
        )],
    );
    let settings = BodySettings { kind: "nao".to_owned(), options, ..BodySettings::default() };
    let Err(refused) = settings.open(Some(Box::new(field().body(0).unwrap())), 7) else {
        panic!("a robot with a longer thigh was opened");
    };
    let expected = "error[E0373]: `LTibia` is at xyz 0 0 -0.11";
    assert!(refused.to_string().contains(expected), "{refused}");
}
