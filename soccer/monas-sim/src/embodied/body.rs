//! Implements [`Robot`] for a robot of the simulated world.

use std::time::Duration;

use monas_robot::{
    Actuators, Anatomy, Announcement, Camera, Error, ErrorKind, FallDetector, IMAGE_WIDTHS, Limits,
    ObjectKind, ObjectSet, Percepts, Posture, Robot, Skill,
};
use narukom::Timestamp;

use super::image_camera::ImageCamera;
use super::picture_queue::PictureQueue;
use super::skill::SkillTrack;
use super::{SharedField, announce};
use crate::{BodyPhase, Command, LineFeature, Motion, Physics, STEP, Senses, Side, Sighting, Velocity};

/// Interval at which an unchanged announcement is repeated, as by a game controller.
const ANNOUNCE_EVERY: Duration = Duration::from_millis(500);

/// The body of one robot on a [`SharedField`].
pub struct FieldBody {
    pitch: SharedField,
    robot: usize,
    anatomy: Anatomy,
    senses: Senses,
    falls: FallDetector,
    skill: SkillTrack,
    command: Actuators,
    announced: Option<(Timestamp, Announcement)>,
    /// The body sits or is about to; commands are ignored.
    rests: bool,
    /// The cameras, if they deliver images in place of sightings.
    cameras: Option<ImageCamera>,
    /// The time from the exposure of a picture to its delivery.
    latency: Duration,
    pictures: PictureQueue<Picture>,
}

/// The output of the cameras for one exposure.
enum Picture {
    Sightings(monas_robot::Sightings),
    Images(monas_robot::Images),
}

impl FieldBody {
    pub(super) fn new(pitch: SharedField, robot: usize) -> FieldBody {
        let longest_message = pitch.lock().air.longest();
        let (anatomy, latency) = pitch.with_world(|world| {
            let physics = world.physics();
            (anatomy(physics, longest_message), Duration::from_secs_f64(physics.camera_latency))
        });
        let (senses, falls, skill, command) = Default::default();
        FieldBody {
            pitch,
            robot,
            anatomy,
            senses,
            falls,
            skill,
            command,
            announced: None,
            rests: false,
            cameras: None,
            latency,
            pictures: PictureQueue::new(),
        }
    }

    /// The announcement, if it has changed or is due for repetition.
    fn announcement(&mut self, now: Timestamp) -> Option<Announcement> {
        let announcement = announce::announcement(&self.pitch.lock(), self.robot)?;
        let said = self.announced.as_ref();
        let stale = |(at, before): &(Timestamp, Announcement)| {
            now.since(*at) >= ANNOUNCE_EVERY || announce::is_news(&announcement, before)
        };
        if !said.is_none_or(stale) {
            return None;
        }
        self.announced = Some((now, announcement));
        Some(announcement)
    }

    fn feel(&self, now: Timestamp, sensors: &mut monas_robot::Sensors) {
        let Senses { odometry, buttons, is_lifted, .. } = &self.senses;
        let (skill_done, skill_result) = self.skill.done();
        *sensors = monas_robot::Sensors {
            measured_at: now.as_nanos(),
            head_yaw: self.anatomy.head_yaw.clamp(self.senses.head_yaw),
            head_pitch: self.anatomy.head_pitch.clamp(self.senses.head_pitch),
            torso_roll: self.senses.torso_roll,
            torso_pitch: self.senses.torso_pitch,
            odometry_x: odometry.position.x,
            odometry_y: odometry.position.y,
            odometry_turn: odometry.heading,
            chest_button: buttons.chest,
            left_bumper: buttons.left_bumper,
            right_bumper: buttons.right_bumper,
            posture: posture(self.senses.phase, *is_lifted, self.falls) as i32,
            skill_done,
            skill_result: skill_result as i32,
            battery: 1.0,
            relaxed: self.rests && (self.senses.phase == BodyPhase::Sitting || self.falls.is_fallen()),
        };
    }

    /// Takes a picture, if one was exposed in this cycle.
    fn expose(&mut self, now: Timestamp) -> Result<(), Error> {
        if !self.senses.new_picture {
            return Ok(());
        }
        let (senses, robot) = (&self.senses, self.robot);
        let picture = self.pitch.with_world(|world| match &mut self.cameras {
            None => Ok(Picture::Sightings(sightings(senses, world.objects(), now))),
            Some(cameras) => cameras.take(world, robot, now).map(Picture::Images),
        })?;
        self.pictures.expose(now, picture);
        Ok(())
    }

    /// Sends the current command for legs and head to the world.
    fn drive(&self) -> Result<(), Error> {
        let Actuators { walk_x, walk_y, walk_turn, head_yaw, head_pitch, .. } = self.command;
        let limits = &self.anatomy;
        let walk = Velocity::new(
            limits.walk_x.clamp(walk_x),
            limits.walk_y.clamp(walk_y),
            limits.walk_turn.clamp(walk_turn),
        );
        let still = walk == Velocity::default();
        let legs = match still {
            true if self.rests => Motion::Sit,
            true => Motion::Stand,
            false => Motion::Walk(walk),
        };
        let command = Command {
            head_yaw: limits.head_yaw.clamp(head_yaw),
            head_pitch: limits.head_pitch.clamp(head_pitch),
            motion: self.skill.motion().unwrap_or(legs),
            ball_speed: self.skill.ball_speed(),
        };
        self.pitch.lock().world.command(self.robot, command).map_err(refused)
    }
}

impl Robot for FieldBody {
    fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        {
            let mut ground = self.pitch.lock();
            ground.world.sense(self.robot, &mut self.senses).map_err(refused)?;
            ground.air.receive(self.robot, now.as_nanos(), &mut percepts.heard);
        }
        let was_busy = self.skill.motion().is_some();
        self.skill.observe(self.senses.phase);
        if self.rests || (was_busy && self.skill.motion().is_none()) {
            self.drive()?;
        }
        self.falls.measure(self.senses.torso_roll, self.senses.torso_pitch);
        self.feel(now, &mut percepts.sensors);
        self.expose(now)?;
        percepts.sightings = None;
        match self.pictures.deliver(now, self.latency) {
            Some(Picture::Sightings(sightings)) => percepts.sightings = Some(sightings),
            Some(Picture::Images(images)) => percepts.images = Some(images),
            None => {}
        }
        percepts.announcement = self.announcement(now);
        Ok(())
    }

    fn act(&mut self, _now: Timestamp, actuators: &Actuators) -> Result<(), Error> {
        if self.rests {
            return Ok(());
        }
        self.command = *actuators;
        self.skill.command(actuators);
        self.drive()
    }

    fn deliver_images(&mut self, width: Option<u32>) -> Result<(), Error> {
        let is_known = |width: &u32| IMAGE_WIDTHS.iter().any(|(_, known)| known == width);
        if let Some(width) = width.filter(|width| !is_known(width)) {
            let widths = IMAGE_WIDTHS.map(|(name, _)| name).join(", ");
            let message = format!("images have a width of {widths} pixels, not {width}");
            return Err(Error::new(ErrorKind::Configuration, message));
        }
        self.cameras = Some(ImageCamera::with_width(width));
        Ok(())
    }

    /// The body sits down as soon as it stands; a lying body stays down.
    fn rest(&mut self, _now: Timestamp) -> Result<(), Error> {
        self.rests = true;
        self.command = Actuators::default();
        self.drive()
    }

    fn say(&mut self, now: Timestamp, words: &[u8]) -> Result<(), Error> {
        if words.len() > self.anatomy.radio {
            let message =
                format!("{} bytes are more than the {} of a message", words.len(), self.anatomy.radio);
            return Err(Error::new(ErrorKind::Protocol, message));
        }
        self.pitch.lock().air.broadcast(self.robot, now.as_nanos(), words);
        Ok(())
    }
}

fn refused(error: crate::Error) -> Error {
    Error::new(ErrorKind::Protocol, error.to_string())
}

fn anatomy(physics: &Physics, longest_message: usize) -> Anatomy {
    Anatomy {
        head_yaw: Limits::symmetric(physics.head_yaw_limit),
        head_pitch: Limits::new(physics.head_pitch_least, physics.head_pitch_most),
        walk_x: Limits::new(-physics.walk_backward, physics.walk_forward),
        walk_y: Limits::symmetric(physics.walk_sideways),
        walk_turn: Limits::symmetric(physics.walk_turn),
        cameras: vec![Camera {
            name: "head".to_owned(),
            link: None,
            horizontal: physics.camera_view_horizontal,
            vertical: physics.camera_view_vertical,
        }],
        skills: vec![
            Skill::KickLeft,
            Skill::KickRight,
            Skill::FallLeft,
            Skill::FallRight,
            Skill::DiveLeft,
            Skill::DiveRight,
            Skill::StandUp,
        ],
        radio: longest_message,
        ..Anatomy::new("field robot", cycle(physics))
    }
}

/// The cycle of a body: the number of steps of the world that is nearest to its rate.
fn cycle(physics: &Physics) -> Duration {
    let steps = (1.0 / (physics.body_rate * STEP)).round().max(1.0);
    Duration::from_millis((steps * STEP * 1e3).round() as u64)
}

/// The posture as the body can measure it: from its own motions, the contacts of its feet, and the
/// inclination of its torso, which shows that it has lost its balance or lies.
fn posture(phase: BodyPhase, is_lifted: bool, falls: FallDetector) -> Posture {
    match phase {
        _ if is_lifted => Posture::Lifted,
        BodyPhase::Kicking(_) | BodyPhase::SideFalling(_) | BodyPhase::Diving(_) => Posture::Busy,
        BodyPhase::StandingUp => Posture::StandingUp,
        BodyPhase::SittingDown | BodyPhase::Sitting => Posture::Sitting,
        _ if falls.is_fallen() => Posture::Fallen,
        _ if falls.is_inclined() => Posture::Busy,
        BodyPhase::Walking => Posture::Walking,
        BodyPhase::Standing | BodyPhase::Falling(_) | BodyPhase::Fallen(_) => Posture::Standing,
    }
}

fn sightings(senses: &Senses, objects: ObjectSet, now: Timestamp) -> monas_robot::Sightings {
    monas_robot::Sightings {
        taken_at: now.as_nanos(),
        head_yaw: senses.head_yaw,
        head_pitch: senses.head_pitch,
        objects: senses.sightings.iter().map(|seen| sighting(seen, objects)).collect(),
    }
}

fn sighting(seen: &Sighting, objects: ObjectSet) -> monas_robot::Sighting {
    let of_2010 = |colour| if objects == ObjectSet::Of2010 { colour } else { monas_robot::Colour::White };
    let (kind, colour, percept) = match seen {
        Sighting::Ball(percept) => (ObjectKind::Ball, of_2010(monas_robot::Colour::Orange), percept),
        Sighting::Post { goal, side, percept } => {
            (post(*side), of_2010(announce::goal_colour(*goal)), percept)
        }
        Sighting::Robot { colour, percept } => (ObjectKind::Robot, announce::team_colour(*colour), percept),
        Sighting::Line { feature, percept } => {
            let kind = match feature {
                LineFeature::Corner => ObjectKind::LineCorner,
                LineFeature::Junction => ObjectKind::LineJunction,
                LineFeature::CentreCircle => ObjectKind::CentreCircle,
            };
            (kind, monas_robot::Colour::White, percept)
        }
    };
    monas_robot::Sighting {
        kind: kind as i32,
        bearing: percept.bearing,
        distance: percept.distance,
        colour: colour as i32,
    }
}

fn post(side: Option<Side>) -> ObjectKind {
    match side {
        Some(Side::Left) => ObjectKind::LeftPost,
        Some(Side::Right) => ObjectKind::RightPost,
        None => ObjectKind::SomePost,
    }
}

#[cfg(test)]
mod tests {
    use monas_robot::SkillResult;

    use super::*;
    use crate::{FieldSide, RobotSetup, Setup, SimulatedWorld, TeamColour, TeamSetup};

    fn pitch() -> SharedField {
        pitch_with(Physics::default())
    }

    fn pitch_with(physics: Physics) -> SharedField {
        let team =
            |number, colour, plays| TeamSetup { number, name: format!("team {number}"), colour, plays };
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
        SharedField::new(SimulatedWorld::new(setup).unwrap())
    }

    #[test]
    fn a_fall_is_found_from_the_inclination_of_the_torso() {
        let pitch = pitch_with(Physics { fall_rate_walking: 10.0, ..Physics::default() });
        let mut body = pitch.body(0).unwrap();
        let walk = Actuators { walk_x: 0.2, ..Actuators::default() };
        let (mut percepts, mut postures) = (Percepts::default(), Vec::new());
        for cycle in 0..700 {
            let now = Timestamp::from_nanos(cycle * 20_000_000);
            (0..2).for_each(|_| pitch.lock().world.step());
            body.sense(now, &mut percepts).unwrap();
            body.act(now, &walk).unwrap();
            let monas_robot::Sensors { torso_roll, torso_pitch, .. } = percepts.sensors;
            let posture = percepts.sensors.posture();
            match torso_roll.abs().max(torso_pitch.abs()) {
                tilt if tilt < 0.35 => assert!(!matches!(posture, Posture::Busy | Posture::Fallen), "{tilt}"),
                tilt if tilt > 1.05 => assert_eq!(posture, Posture::Fallen, "{tilt}"),
                _ => {}
            }
            if postures.last() != Some(&posture) {
                postures.push(posture);
            }
        }
        assert!(postures.ends_with(&[Posture::Busy, Posture::Fallen]), "{postures:?}");
    }

    #[test]
    fn it_is_a_body_like_any_other() {
        let pitch = pitch();
        let mut body = pitch.body(0).unwrap();
        monas_robot::conformance::check(&mut body);
        assert!(pitch.body(1).is_none());
    }

    #[test]
    fn its_cycle_is_the_number_of_steps_that_is_nearest_to_its_rate() {
        let cycle = |body_rate| cycle(&Physics { body_rate, ..Physics::default() }).as_millis();
        assert_eq!([50.0, 100.0, 10.0, 83.0].map(cycle), [20, 10, 100, 10]);
    }

    /// The percepts of a body with the first images or sightings.
    fn first_percepts(body: &mut FieldBody, pitch: &SharedField) -> Percepts {
        let mut percepts = Percepts::default();
        for cycle in 0..50 {
            (0..2).for_each(|_| pitch.step());
            percepts.clear_news();
            body.sense(Timestamp::from_nanos(cycle * 20_000_000), &mut percepts).unwrap();
            let objects = percepts.sightings.as_ref().is_some_and(|seen| !seen.objects.is_empty());
            if percepts.images.is_some() || objects {
                return percepts;
            }
        }
        panic!("no images, and no sightings with objects, in a second");
    }

    #[test]
    fn images_have_the_width_of_the_configuration_and_the_objects_of_the_world() {
        for (objects, width) in [(ObjectSet::Of2010, None), (ObjectSet::OfToday, Some(640))] {
            let pitch = SharedField::new(
                SimulatedWorld::new(Setup { objects, ..Setup::three_against_three(1) }).unwrap(),
            );
            let mut body = pitch.body(0).unwrap();
            body.deliver_images(width).unwrap();
            let images = first_percepts(&mut body, &pitch).images.unwrap();
            let width = width.unwrap_or(320);
            assert_eq!((images.images.len(), images.objects()), (2, objects));
            for image in images.images {
                assert_eq!((image.width, image.height), (width, width * 3 / 4));
                assert_eq!(image.pixels.len() as u32, 2 * image.width * image.height);
            }
        }
    }

    #[test]
    fn a_width_that_images_cannot_have_is_refused() {
        let pitch = pitch();
        let mut body = pitch.body(0).unwrap();
        let error = body.deliver_images(Some(641)).unwrap_err().to_string();
        assert!(error.contains("160, 320, 640 pixels, not 641"), "{error}");
    }

    #[test]
    fn sightings_of_today_have_no_colours_of_goals() {
        let colours = |objects| {
            let setup = Setup { objects, ..Setup::three_against_three(1) };
            let pitch = SharedField::new(SimulatedWorld::new(setup).unwrap());
            let mut body = pitch.body(1).unwrap();
            let seen = first_percepts(&mut body, &pitch).sightings.unwrap().objects;
            let coloured = [ObjectKind::Ball, ObjectKind::LeftPost, ObjectKind::RightPost];
            let seen = seen.iter().filter(|seen| coloured.contains(&seen.kind()));
            let mut colours: Vec<i32> = seen.map(|seen| seen.colour).collect();
            colours.sort_unstable();
            colours.dedup();
            colours
        };
        use monas_robot::Colour;
        assert_eq!(colours(ObjectSet::OfToday), [Colour::White as i32]);
        assert!(!colours(ObjectSet::Of2010).contains(&(Colour::White as i32)));
    }

    #[test]
    fn an_unloaded_body_sits_relaxed_and_ignores_commands() {
        let pitch = pitch();
        let mut body = pitch.body(0).unwrap();
        let mut percepts = Percepts::default();
        let walk = Actuators { walk_x: 0.2, ..Actuators::default() };
        for cycle in 0..200 {
            let now = Timestamp::from_nanos(cycle * 20_000_000);
            (0..2).for_each(|_| pitch.lock().world.step());
            body.sense(now, &mut percepts).unwrap();
            if cycle == 20 {
                body.rest(now).unwrap();
            }
            body.act(now, &walk).unwrap();
        }
        assert_eq!((percepts.sensors.posture(), percepts.sensors.relaxed), (Posture::Sitting, true));
    }

    #[test]
    fn radio_messages_reach_each_teammate_once() {
        let pitch = SharedField::new(SimulatedWorld::new(Setup::three_against_three(7)).unwrap());
        let mut bodies: Vec<FieldBody> = (0..6).filter_map(|robot| pitch.body(robot)).collect();
        bodies[1].say(Timestamp::ZERO, b"mine").unwrap();
        for heard_then in [[1, 0, 1, 0, 0, 0], [0; 6]] {
            let now = Timestamp::from_nanos(20_000_000);
            let heard =
                bodies.iter_mut().map(|body| {
                    let mut percepts = Percepts::default();
                    body.sense(now, &mut percepts).unwrap();
                    assert!(percepts.heard.iter().all(|it| {
                        (it.number, it.heard_at, &it.words[..]) == (2, now.as_nanos(), b"mine")
                    }));
                    percepts.heard.len()
                });
            assert_eq!(heard.collect::<Vec<_>>(), heard_then);
        }
        assert!(bodies[1].say(Timestamp::ZERO, &[0; 513]).is_err());
    }

    #[test]
    fn a_kick_ends_and_reports_it() {
        let pitch = pitch();
        let mut body = pitch.body(0).unwrap();
        let kick = Actuators { skill: Skill::KickLeft as i32, skill_number: 5, ..Actuators::default() };
        let mut percepts = Percepts::default();
        let mut done_at = None;
        for cycle in 1..=600 {
            let now = Timestamp::from_nanos(cycle * 20_000_000);
            pitch.step();
            pitch.step();
            body.sense(now, &mut percepts).unwrap();
            // Only PLAYING lets a robot move; the match begins with six seconds of preparation.
            if cycle >= 400 {
                body.act(now, &kick).unwrap();
            }
            if percepts.sensors.skill_done == 5 && done_at.is_none() {
                done_at = Some(cycle - 400);
            }
        }
        let cycles = done_at.expect("the kick ends");
        assert!((70..100).contains(&cycles), "a kick takes 1.6 s, not {cycles} cycles");
        assert_eq!(percepts.sensors.skill_result(), SkillResult::Performed);
    }
}
