//! The messages from the server to an agent, one each cycle.

use std::f64::consts::PI;

use crate::error::Error;
use crate::expression::Items;
use crate::humanoid::{Humanoid, JointValues};

/// The percepts of a cycle, in SI units. It is reused: what a message does not hold keeps its
/// value, except for the objects of vision.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Percept {
    /// The time of the server, s.
    pub time: f64,
    /// The state of the game.
    pub game: Game,
    /// The orientation of the torso in the field, as the server knows it: w, x, y, z.
    pub true_orientation: [f64; 4],
    /// The position of the torso in the field, as the server knows it, m.
    pub true_position: [f64; 3],
    /// Angular velocities of the torso about its axes, rad/s.
    pub gyro: [f64; 3],
    /// Accelerations of the torso along its axes, m/s2: z is 9.81 for a robot that stands.
    pub acceleration: [f64; 3],
    /// Angles of the joints, rad.
    pub positions: JointValues,
    /// Angular velocities of the joints, rad/s.
    pub velocities: JointValues,
    /// Whether the message holds what the camera sees, as every second one does.
    pub has_vision: bool,
    /// The objects that the camera sees.
    pub objects: Vec<CameraObject>,
}

/// The state of the game as all players know it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Game {
    /// The time that has been played, s.
    pub play_time: f64,
    /// The play mode of the game.
    pub play_mode: PlayMode,
    /// The name of the team on the left; empty while there is none.
    pub left_team: String,
    /// The name of the team on the right; empty while there is none.
    pub right_team: String,
    /// The goals of the team on the left.
    pub left_score: u32,
    /// The goals of the team on the right.
    pub right_score: u32,
}

/// A side of the field, and the team that defends it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Side {
    /// At -x.
    Left,
    /// At +x.
    Right,
}

/// A play mode, with the team that it concerns.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum PlayMode {
    /// The game has not begun.
    #[default]
    BeforeKickOff,
    /// A team has the kick-off.
    KickOff(Side),
    /// The ball is free.
    PlayOn,
    /// A team has a throw-in.
    KickIn(Side),
    /// A team has a corner kick.
    CornerKick(Side),
    /// A team has a goal kick.
    GoalKick(Side),
    /// A team was offside.
    Offside(Side),
    /// The time is over.
    GameOver,
    /// A team has scored.
    Goal(Side),
    /// A team has an indirect free kick.
    FreeKick(Side),
    /// A team has a direct free kick.
    DirectFreeKick(Side),
    /// A team has a penalty kick.
    PenaltyKick(Side),
    /// A team has a kick of a penalty shoot-out.
    PenaltyShoot(Side),
}

/// All play modes, in the order in which messages to monitors number them.
const PLAY_MODES: [(&str, PlayMode); 23] = {
    use PlayMode::*;
    use Side::*;
    [
        ("BeforeKickOff", BeforeKickOff),
        ("KickOff_Left", KickOff(Left)),
        ("KickOff_Right", KickOff(Right)),
        ("PlayOn", PlayOn),
        ("KickIn_Left", KickIn(Left)),
        ("KickIn_Right", KickIn(Right)),
        ("corner_kick_left", CornerKick(Left)),
        ("corner_kick_right", CornerKick(Right)),
        ("goal_kick_left", GoalKick(Left)),
        ("goal_kick_right", GoalKick(Right)),
        ("offside_left", Offside(Left)),
        ("offside_right", Offside(Right)),
        ("GameOver", GameOver),
        ("Goal_Left", Goal(Left)),
        ("Goal_Right", Goal(Right)),
        ("free_kick_left", FreeKick(Left)),
        ("free_kick_right", FreeKick(Right)),
        ("direct_free_kick_left", DirectFreeKick(Left)),
        ("direct_free_kick_right", DirectFreeKick(Right)),
        ("penalty_kick_left", PenaltyKick(Left)),
        ("penalty_kick_right", PenaltyKick(Right)),
        ("penalty_shoot_left", PenaltyShoot(Left)),
        ("penalty_shoot_right", PenaltyShoot(Right)),
    ]
};

impl PlayMode {
    /// The mode with the name that agents receive.
    pub fn named(name: &[u8]) -> Option<PlayMode> {
        PLAY_MODES.iter().find(|(known, _)| known.as_bytes() == name).map(|(_, mode)| *mode)
    }

    /// The mode with the number that monitors receive.
    pub fn numbered(number: usize) -> Option<PlayMode> {
        PLAY_MODES.get(number).map(|(_, mode)| *mode)
    }
}

/// A direction from the camera: x along its axis, y to the left, z up.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Polar {
    /// Distance, m.
    pub distance: f64,
    /// Angle to the left, rad.
    pub azimuth: f64,
    /// Angle upwards, rad.
    pub elevation: f64,
}

/// An object that the camera sees.
#[derive(Clone, PartialEq, Debug)]
pub enum CameraObject {
    /// The ball: its middle.
    Ball(Polar),
    /// The top of a goal post.
    Post {
        /// The side of the field with this goal.
        goal: Side,
        /// Whether it stands at +y.
        is_upper: bool,
        /// The position of its top.
        at: Polar,
    },
    /// A mark of the field's lines, by its name.
    Mark {
        /// The name: `l_luf` is the corner of the field on the left at +y.
        name: String,
        /// The position of the mark.
        at: Polar,
    },
    /// A robot, perhaps a part of the own body.
    Robot {
        /// The name of its team.
        team: String,
        /// Its number.
        number: u32,
        /// The lowest of its marked parts in view.
        at: Polar,
    },
}

impl Percept {
    /// Reads a message to a robot. Unknown percepts are skipped: robots differ in their percepts.
    ///
    /// # Errors
    /// The parentheses are not balanced, or a percept does not have the form of its kind. Percepts
    /// read before it remain.
    pub fn decode(&mut self, message: &[u8], robot: &Humanoid) -> Result<(), Error> {
        self.has_vision = false;
        self.objects.clear();
        let mut percepts = Items::of(message)?;
        while let Some((kind, content)) = percepts.next_named() {
            self.decode_percept(kind, content, robot).ok_or_else(|| {
                let kind = String::from_utf8_lossy(kind).into_owned();
                Error::protocol(format!("a percept `{kind}` is not understood"))
            })?;
        }
        Ok(())
    }

    fn decode_percept(&mut self, kind: &[u8], mut content: Items<'_>, robot: &Humanoid) -> Option<()> {
        let degrees = |[x, y, z]: [f64; 3]| [radians(x), radians(y), radians(z)];
        match kind {
            b"time" => self.time = content.find_named(b"now")?.number()?,
            b"GS" => self.game.decode(content)?,
            b"quat" => self.true_orientation = content.find_named(b"q")?.numbers()?,
            b"pos" => self.true_position = content.find_named(b"p")?.numbers()?,
            b"GYR" => self.gyro = degrees(content.find_named(b"rt")?.numbers()?),
            b"ACC" => self.acceleration = content.find_named(b"a")?.numbers()?,
            b"HJ" => {
                let joint = robot.of_perceptor(content.find_named(b"n")?.word()?);
                let position = radians(content.find_named(b"ax")?.number()?);
                let velocity = radians(content.find_named(b"vx")?.number()?);
                if let Some(joint) = joint {
                    (self.positions[joint], self.velocities[joint]) = (position, velocity);
                }
            }
            b"See" => {
                self.has_vision = true;
                while let Some((name, object)) = content.next_named() {
                    self.objects.push(camera_object(name, object)?);
                }
            }
            _ => {}
        }
        Some(())
    }
}

impl Game {
    fn decode(&mut self, mut content: Items<'_>) -> Option<()> {
        while let Some((key, mut value)) = content.next_named() {
            match key {
                b"t" => self.play_time = value.number()?,
                b"pm" => self.play_mode = PlayMode::named(value.word()?)?,
                b"tl" => replace(&mut self.left_team, text(value.word()?)?),
                b"tr" => replace(&mut self.right_team, text(value.word()?)?),
                b"sl" => self.left_score = whole(&mut value)?,
                b"sr" => self.right_score = whole(&mut value)?,
                _ => {}
            }
        }
        Some(())
    }
}

fn camera_object(name: &[u8], object: Items<'_>) -> Option<CameraObject> {
    if name == b"P" {
        return robot(object);
    }
    let at = polar(object)?;
    Some(match name {
        b"B" => CameraObject::Ball(at),
        b"g_lup" => CameraObject::Post { goal: Side::Left, is_upper: true, at },
        b"g_llp" => CameraObject::Post { goal: Side::Left, is_upper: false, at },
        b"g_rup" => CameraObject::Post { goal: Side::Right, is_upper: true, at },
        b"g_rlp" => CameraObject::Post { goal: Side::Right, is_upper: false, at },
        _ => CameraObject::Mark { name: text(name)?.to_owned(), at },
    })
}

fn robot(mut object: Items<'_>) -> Option<CameraObject> {
    let team = text(object.find_named(b"team")?.word()?)?.to_owned();
    let number = whole(&mut object.find_named(b"id")?)?;
    let mut lowest: Option<Polar> = None;
    while let Some((part, content)) = object.next_named() {
        if part == b"team" || part == b"id" {
            continue;
        }
        let at = polar(content)?;
        if lowest.is_none_or(|lowest| at.elevation < lowest.elevation) {
            lowest = Some(at);
        }
    }
    Some(CameraObject::Robot { team, number, at: lowest? })
}

fn polar(object: Items<'_>) -> Option<Polar> {
    let [distance, azimuth, elevation] = object.find_named(b"pol")?.numbers()?;
    Some(Polar { distance, azimuth: radians(azimuth), elevation: radians(elevation) })
}

fn whole(items: &mut Items<'_>) -> Option<u32> {
    text(items.word()?)?.parse().ok()
}

fn text(word: &[u8]) -> Option<&str> {
    std::str::from_utf8(word).ok()
}

/// Replaces a text in its memory.
fn replace(text: &mut String, by: &str) {
    if text != by {
        text.clear();
        text.push_str(by);
    }
}

fn radians(degrees: f64) -> f64 {
    degrees * (PI / 180.0)
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use proptest::prelude::*;

    use super::*;
    use crate::{JOINTS, K1, T1};

    const TEXT: &str = "(time (now 4.17))(GS (t 1.5)(pm KickIn_Right)(tl Monas)(sl 2)(sr 1))\
        (quat (n torso_quat) (q 0.707 0.0 0.0 -0.707))(pos (n torso_pos) (p -3.0 2.0 0.673))\
        (GYR (n torso_gyro) (rt 0.0 180.0 -90))(ACC (n torso_acc) (a 0.1 -0.0 9.81))\
        (HJ (n q_hj1)(ax 90)(vx -18.0))(HJ (n q_rlj6)(ax -9)(vx 0.0))(HJ (n q_other)(ax 1)(vx 1))\
        (See (B (pol 4.98 90.0 -45.0))(g_rlp (pol 32.4 -3.2 1.3))(t_cuf (pol 4.3 46.0 -14.7))\
        (P (team Red)(id 3)(head (pol 5.0 1.0 2.0))(lfoot (pol 5.1 1.0 -12.0))))\
        (MIC hear (30 YQ==)(-180 Yg==))";

    fn read(text: &str) -> Result<Percept, Error> {
        let mut percept = Percept::default();
        percept.decode(text.as_bytes(), &T1).map(|()| percept)
    }

    #[test]
    fn a_message_is_read_in_si_units() {
        let percept = read(TEXT).unwrap();
        assert_eq!((percept.time, percept.true_position), (4.17, [-3.0, 2.0, 0.673]));
        assert_eq!(percept.true_orientation, [0.707, 0.0, 0.0, -0.707]);
        assert_eq!(percept.gyro, [0.0, PI, -PI / 2.0]);
        assert_eq!(percept.acceleration, [0.1, 0.0, 9.81]);
        assert_eq!((percept.positions[0], percept.positions[22]), (PI / 2.0, -PI / 20.0));
        assert_eq!(percept.velocities[0], -PI / 10.0);
        let game = percept.game;
        assert_eq!((game.play_time, game.play_mode), (1.5, PlayMode::KickIn(Side::Right)));
        assert_eq!((game.left_team.as_str(), game.right_team.as_str()), ("Monas", ""));
        assert_eq!((game.left_score, game.right_score), (2, 1));
        let at = |distance, azimuth, elevation| Polar {
            distance,
            azimuth: radians(azimuth),
            elevation: radians(elevation),
        };
        let expected = [
            CameraObject::Ball(at(4.98, 90.0, -45.0)),
            CameraObject::Post { goal: Side::Right, is_upper: false, at: at(32.4, -3.2, 1.3) },
            CameraObject::Mark { name: "t_cuf".into(), at: at(4.3, 46.0, -14.7) },
            CameraObject::Robot { team: "Red".into(), number: 3, at: at(5.1, 1.0, -12.0) },
        ];
        assert_eq!((percept.has_vision, &percept.objects[..]), (true, &expected[..]));
    }

    #[test]
    fn data_missing_in_a_message_stay_except_objects_of_vision() {
        let mut percept = read(TEXT).unwrap();
        percept.decode(b"(time (now 4.19))", &T1).unwrap();
        assert_eq!((percept.time, percept.game.left_score), (4.19, 2));
        assert!(!percept.has_vision && percept.objects.is_empty());
        percept.decode(b"(See )", &T1).unwrap();
        assert!(percept.has_vision, "a camera that sees nothing has looked");
    }

    #[test]
    fn what_does_not_have_its_form_is_an_error_that_names_it() {
        for (kind, text) in [
            ("time", "(time (now soon))"),
            ("GS", "(GS (pm Half))"),
            ("quat", "(quat (n q) (q 1 0 0))"),
            ("HJ", "(HJ (n q_hj1)(ax 1))"),
            ("See", "(See (B (pol 1 2)))"),
            ("See", "(See (P (team A)(id 2)))"),
        ] {
            assert_eq!(read(text).unwrap_err().to_string(), format!("a percept `{kind}` is not understood"));
        }
    }

    #[test]
    fn every_play_mode_has_a_name_and_a_number() {
        assert_eq!(PlayMode::numbered(3), Some(PlayMode::PlayOn));
        assert_eq!(PlayMode::numbered(23), None);
        for (number, (name, mode)) in PLAY_MODES.iter().enumerate() {
            assert_eq!(PlayMode::named(name.as_bytes()), Some(*mode));
            assert_eq!(PlayMode::numbered(number), Some(*mode));
        }
    }

    /// Messages of the server itself, if a folder `shared` above the workspace has them, or the one
    /// that the environment variable names.
    #[test]
    fn recorded_messages_are_read() {
        let named = std::env::var_os("MONAS_SHARED").map(PathBuf::from);
        let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().map(|folder| folder.join("shared"));
        let files = |folder: PathBuf| std::fs::read_dir(folder.join("robots/rcsssmj")).ok();
        let Some(files) = named.into_iter().chain(above).find_map(files) else { return };
        let mut objects = [0, 0];
        for file in files.map(|file| file.unwrap().path()) {
            let name = file.file_name().unwrap().to_string_lossy().into_owned();
            let is_of = |robot: &&Humanoid| name.starts_with(&format!("percept_{}_", robot.name()));
            let Some(robot) = Humanoid::ALL.into_iter().find(is_of) else { continue };
            let mut percept = Percept::default();
            let marked = JointValues::from([1e9; JOINTS]);
            (percept.positions, percept.velocities) = (marked, marked);
            percept.decode(&std::fs::read(&file).unwrap(), robot).unwrap();
            assert!(percept.time > 3.0 && percept.true_position[2] > 0.6, "{name}");
            assert_eq!(percept.game.left_team, "Monas");
            let sent = percept.positions.iter().filter(|angle| angle.abs() < 4.0).count();
            assert_eq!(sent, robot.joint_count(), "{name}");
            assert_eq!(percept.positions[..sent].iter().filter(|angle| **angle == 1e9).count(), 0, "{name}");
            objects[usize::from(*robot == K1)] += percept.objects.len();
        }
        assert!(objects.iter().all(|count| *count > 20), "{objects:?}");
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = Percept::default().decode(&bytes, &T1);
        }

        #[test]
        fn a_message_cut_off_or_changed_is_read_or_refused(
            length in 0..TEXT.len(), index in 0..TEXT.len(), byte in any::<u8>(),
        ) {
            let mut bytes = TEXT.as_bytes().to_vec();
            bytes[index] = byte;
            let _ = Percept::default().decode(&bytes, &T1);
            bytes.truncate(length);
            let _ = Percept::default().decode(&bytes, &T1);
        }
    }
}
