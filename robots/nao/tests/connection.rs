//! A Nao in real time, at a LoLA server in another thread.
#![allow(clippy::disallowed_methods, clippy::panic, clippy::unwrap_used)] // tests start threads

use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

use monas_nao::lola::ActuatorPacket;
use monas_nao::{LolaServer, Nao};
use monas_robot::{Actuators, Anatomy, Error, Percepts, Posture, Robot, Sensors, Sighting, Sightings};
use narukom::Timestamp;

/// A body in the plane that stands where it is.
struct StandingBody {
    anatomy: Anatomy,
    commands: mpsc::Sender<Actuators>,
}

impl Robot for StandingBody {
    fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }
    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        let posture = Posture::Standing as i32;
        percepts.sensors =
            Sensors { measured_at: now.as_nanos(), posture, battery: 0.5, ..Sensors::default() };
        let objects = vec![Sighting { distance: 2.0, ..Sighting::default() }];
        percepts.sightings = Some(Sightings { taken_at: now.as_nanos(), objects, ..Sightings::default() });
        Ok(())
    }
    fn act(&mut self, _: Timestamp, actuators: &Actuators) -> Result<(), Error> {
        // The test may have ended.
        let _ = self.commands.send(*actuators);
        Ok(())
    }
}

/// A server at a path, which ends after `cycles` with a client, or when the client has gone.
fn serve(path: &Path, cycles: u64, commands: mpsc::Sender<Actuators>) -> (u64, ActuatorPacket) {
    let anatomy = Anatomy::new("standing body", Duration::from_millis(20));
    let mut server = LolaServer::listen(path, Box::new(StandingBody { anatomy, commands })).unwrap();
    let (_sender, pause) = mpsc::channel::<()>();
    let mut cycle = 0;
    for _ in 0..5000 {
        cycle += u64::from(server.is_connected());
        server.step(Timestamp::from_nanos(cycle * 12_000_000)).unwrap();
        if cycle == cycles || (cycle > 0 && !server.is_connected()) {
            break;
        }
        // A cycle of real time, shortened: the client follows the packets, not the clock.
        let _ = pause.recv_timeout(Duration::from_millis(2));
    }
    (cycle, server.actuators().clone())
}

fn path(folder: &tempfile::TempDir) -> PathBuf {
    folder.path().join("lola")
}

/// Senses until `found` holds; the time counts the calls, from `start`.
fn sense_until(nao: &mut Nao, start: u64, found: impl Fn(&Percepts) -> bool) -> Percepts {
    let mut percepts = Percepts::default();
    let (_sender, pause) = mpsc::channel::<()>();
    for cycle in start..start + 20_000 {
        percepts.clear_news();
        nao.sense(Timestamp::from_nanos(cycle), &mut percepts).unwrap();
        if found(&percepts) {
            return percepts;
        }
        let _ = pause.recv_timeout(Duration::from_millis(1));
    }
    panic!("it has not been found: {percepts:?}");
}

#[test]
fn it_stands_sees_walks_and_sits_down_when_it_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let (commands, commanded) = mpsc::channel();
    let at = path(&folder);
    let server = std::thread::spawn(move || serve(&at, u64::MAX, commands));
    while !path(&folder).exists() {
        std::thread::yield_now();
    }
    let mut nao = Nao::open(&path(&folder)).unwrap();
    let percepts = sense_until(&mut nao, 1, |percepts| percepts.sensors.posture() == Posture::Standing);
    assert_eq!(percepts.sensors.battery, 0.5);
    sense_until(&mut nao, 1, |percepts| percepts.sightings.is_some());
    nao.act(Timestamp::ZERO, &Actuators { walk_x: 0.2, chest: 0x00ff00, ..Actuators::default() }).unwrap();
    sense_until(&mut nao, 1, |percepts| percepts.sensors.odometry_x > 0.001);
    assert!(commanded.try_iter().any(|command| command.walk_x > 0.0), "the feet move the body");
    drop(nao);
    let (_, last) = server.join().unwrap();
    assert_eq!((last.stiffness[2..].iter().copied().fold(0.0, f32::max), last.chest), (0.0, [0.0; 3]));
}

#[test]
fn without_calls_it_sits_down_and_relaxes() {
    let folder = tempfile::tempdir().unwrap();
    let at = path(&folder);
    let server = std::thread::spawn(move || serve(&at, 500, mpsc::channel().0));
    while !path(&folder).exists() {
        std::thread::yield_now();
    }
    let mut nao = Nao::open(&path(&folder)).unwrap();
    sense_until(&mut nao, 1, |percepts| percepts.sensors.posture() == Posture::Standing);
    // From here on the runtime is silent: 84 cycles, 1.5 s to sit down, 0.5 s to relax.
    let (cycles, last) = server.join().unwrap();
    assert_eq!((cycles, last.stiffness[10]), (500, 0.0));
    assert!(last.position[10] > 2.0, "the left knee is not folded: {}", last.position[10]);
}

#[test]
fn it_stands_until_the_run_begins_however_long_that_takes() {
    let folder = tempfile::tempdir().unwrap();
    let at = path(&folder);
    let (commands, commanded) = mpsc::channel();
    let server = std::thread::spawn(move || serve(&at, u64::MAX, commands));
    while !path(&folder).exists() {
        std::thread::yield_now();
    }
    let mut nao = Nao::open(&path(&folder)).unwrap();
    // A command for each cycle: twice as many as after which a run that has begun counts as lost.
    assert_eq!(commanded.iter().take(200).count(), 200);
    let percepts = sense_until(&mut nao, 1, |_| true);
    assert_eq!(percepts.sensors.posture(), Posture::Standing);
    drop(nao);
    server.join().unwrap();
}

#[test]
fn it_connects_again_when_the_server_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let at = path(&folder);
    let first = std::thread::spawn(move || serve(&at, 40, mpsc::channel().0));
    while !path(&folder).exists() {
        std::thread::yield_now();
    }
    let mut nao = Nao::open(&path(&folder)).unwrap();
    assert_eq!(first.join().unwrap().0, 40);
    let last = sense_until(&mut nao, 1, |percepts| percepts.sensors.measured_at > 0);
    let at = path(&folder);
    let second = std::thread::spawn(move || serve(&at, 40, mpsc::channel().0));
    sense_until(&mut nao, 100, |percepts| percepts.sensors.measured_at > last.sensors.measured_at);
    assert_eq!(second.join().unwrap().0, 40);
}

#[test]
fn where_nothing_answers_opening_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let error = Nao::open(&path(&folder)).map(drop).unwrap_err();
    assert!(error.to_string().contains("no LoLA answers at"), "{error}");
}
