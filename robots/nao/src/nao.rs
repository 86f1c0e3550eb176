//! A Nao on its own hardware, or on a LoLA server in another process, in real time.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use monas_robot::{Actuators, Anatomy, Error, ErrorKind, JointCommands, Leds, Percepts, Robot};
use narukom::Timestamp;

use crate::cameras::{self, CameraConfig, Cameras};
use crate::control::NaoControl;
use crate::lola::SensorPacket;
use crate::side_channels::RobotChannels;
use crate::simulated_nao::say;
use crate::socket::Socket;
use crate::walk::WalkEngine;

/// The cycles without a call of `sense` after which the commands count as lost: about one second.
const LOST_AFTER: u32 = 84;
/// Maximum time that a body waits for its first sensors when it is opened.
const FIRST_PACKET: Duration = Duration::from_secs(5);
/// The pause between two attempts to connect.
const RETRY_INTERVAL: Duration = Duration::from_millis(100);
/// The most bytes that a radio message has; the league's limit.
const MAX_RADIO_MESSAGE: usize = 128;

/// A Nao at a LoLA socket.
///
/// A thread answers each sensor packet with an actuator packet, and connects again when the
/// connection has ended. If the runtime no longer calls [`sense`](Robot::sense), for a second or
/// because the body is dropped, the robot sits down and its joints lose their stiffness.
pub struct Nao {
    anatomy: Anatomy,
    shared: Arc<SharedControl>,
    channels: Option<RobotChannels>,
    camera_config: CameraConfig,
    /// The cameras, if they deliver images.
    cameras: Option<Cameras>,
    measured_at: Timestamp,
    thread: Option<JoinHandle<()>>,
}

/// State shared by the thread and its caller.
struct SharedControl {
    state: Mutex<ControlState>,
    changed: Condvar,
}

struct ControlState {
    control: NaoControl,
    is_connected: bool,
    /// Whether a packet has arrived since the last call of `sense`.
    is_new: bool,
    /// Cycles since the last call of `sense`; none before the first, which may come long after the
    /// body is opened: a run begins when all its links are connected.
    cycles_since_sense: Option<u32>,
    ends: bool,
    has_ended: bool,
}

impl Nao {
    /// Connects to the robot, and waits for its first sensors.
    ///
    /// # Errors
    /// Nothing answers at the path within five seconds.
    pub fn open(path: &Path) -> Result<Nao, Error> {
        Nao::with_walk(path, None)
    }

    /// As [`open`](Nao::open), with a walk engine.
    ///
    /// # Errors
    /// As in [`open`](Nao::open).
    pub fn with_walk(path: &Path, walk: Option<Box<dyn WalkEngine>>) -> Result<Nao, Error> {
        let mut control = NaoControl::of(&BTreeMap::new())?;
        if let Some(walk) = walk {
            control.set_walk(walk);
        }
        Nao::connect(path, control)
    }

    /// As [`open`](Nao::open), with this control.
    pub(crate) fn connect(path: &Path, control: NaoControl) -> Result<Nao, Error> {
        let state = ControlState {
            control,
            is_connected: false,
            is_new: false,
            cycles_since_sense: None,
            ends: false,
            has_ended: false,
        };
        let shared = Arc::new(SharedControl { state: Mutex::new(state), changed: Condvar::new() });
        let (of_thread, at) = (shared.clone(), path.to_owned());
        let thread = std::thread::Builder::new()
            .name("nao".into())
            .spawn(move || of_thread.run(&at))
            .map_err(|error| Error::new(ErrorKind::Configuration, error.to_string()))?;
        let waited = shared.changed.wait_timeout_while(shared.lock(), FIRST_PACKET, |state| !state.is_new);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let (answers, anatomy) = (state.is_new, state.control.anatomy().clone());
        drop(state);
        // From here on an error ends the thread, because it drops this value.
        let mut nao = Nao {
            anatomy,
            shared,
            channels: None,
            camera_config: CameraConfig::default(),
            cameras: None,
            measured_at: Timestamp::ZERO,
            thread: Some(thread),
        };
        if !answers {
            let message = format!("no LoLA answers at {}", path.display());
            return Err(Error::new(ErrorKind::Disconnected, message));
        }
        nao.channels = RobotChannels::connect(path)?;
        nao.anatomy.radio = if nao.channels.is_some() { MAX_RADIO_MESSAGE } else { 0 };
        Ok(nao)
    }

    /// The body with other camera devices than those of a Nao V6. They are opened by
    /// [`deliver_images`](Robot::deliver_images), unless a simulation delivers images.
    #[must_use]
    pub fn with_cameras(mut self, camera_config: CameraConfig) -> Nao {
        self.camera_config = camera_config;
        self
    }
}

impl SharedControl {
    fn lock(&self) -> MutexGuard<'_, ControlState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Connects and serves the connection, repeatedly, until the body is dropped.
    fn run(&self, path: &Path) {
        while !self.lock().has_ended {
            let served = Socket::connect_blocking(path).and_then(|socket| self.serve(socket));
            let Err(error) = served else { return };
            let mut state = self.lock();
            if std::mem::replace(&mut state.is_connected, false) {
                tracing::warn!("LoLA at {}: {error}", path.display());
            }
            if state.ends {
                return;
            }
            // Ended by `drop`.
            let _ = self.changed.wait_timeout_while(state, RETRY_INTERVAL, |state| !state.ends);
        }
    }

    /// Answers each sensor packet with actuators. Ends when the body is dropped and sits.
    fn serve(&self, mut socket: Socket) -> Result<(), crate::Error> {
        let (mut sensors, mut bytes) = (SensorPacket::default(), Vec::new());
        loop {
            if !socket.receive(|bytes| sensors.decode(bytes))? {
                continue;
            }
            let mut state = self.lock();
            state.control.receive(&sensors);
            state.is_connected = true;
            state.is_new = true;
            state.cycles_since_sense = state.cycles_since_sense.map(|cycles| cycles.saturating_add(1));
            if state.ends || state.cycles_since_sense.is_some_and(|cycles| cycles > LOST_AFTER) {
                state.control.rest();
            }
            state.control.actuators().encode(&mut bytes);
            state.has_ended = state.ends && state.control.is_relaxed();
            let has_ended = state.has_ended;
            drop(state);
            self.changed.notify_all();
            socket.send(&bytes)?;
            if has_ended {
                return Ok(());
            }
        }
    }
}

impl Robot for Nao {
    fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        let mut state = self.shared.lock();
        state.cycles_since_sense = Some(0);
        if std::mem::take(&mut state.is_new) {
            self.measured_at = now;
        }
        state.control.percepts(self.measured_at, percepts);
        let angles = *state.control.measured();
        drop(state);
        if let Some(cameras) = &mut self.cameras {
            percepts.images = cameras.take(now, &angles);
        }
        if let Some(channels) = &mut self.channels
            && let Err(error) = channels.receive(now, percepts)
        {
            tracing::warn!("the simulated camera, referee and radio are gone: {error}");
            self.channels = None;
        }
        Ok(())
    }

    /// Opens the cameras. A simulation in place of the robot delivers images if it was configured
    /// to.
    fn deliver_images(&mut self, width: Option<u32>) -> Result<(), Error> {
        if self.channels.is_none() {
            cameras::check_width(width)?;
            self.cameras = Some(Cameras::start(&self.camera_config)?);
        }
        Ok(())
    }

    fn act(&mut self, _now: Timestamp, actuators: &Actuators) -> Result<(), Error> {
        self.shared.lock().control.act(actuators);
        Ok(())
    }

    fn command_joints(&mut self, _now: Timestamp, commands: &JointCommands) -> Result<(), Error> {
        self.shared.lock().control.command_joints(commands)
    }

    fn light(&mut self, _now: Timestamp, leds: &Leds) -> Result<(), Error> {
        self.shared.lock().control.light(leds);
        Ok(())
    }

    fn rest(&mut self, _now: Timestamp) -> Result<(), Error> {
        self.shared.lock().control.rest();
        Ok(())
    }

    fn say(&mut self, _now: Timestamp, words: &[u8]) -> Result<(), Error> {
        match &mut self.channels {
            Some(channels) => say(channels, self.anatomy.radio, words),
            None => Err(Error::new(ErrorKind::Hardware, "the nao v6 has no radio to speak to its team")),
        }
    }
}

impl Drop for Nao {
    /// Waits until the robot sits and its joints are relaxed, or the connection has ended.
    fn drop(&mut self) {
        self.shared.lock().ends = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;
    use crate::lola::ActuatorPacket;

    /// Sends sensors until the client has disconnected. Returns whether it has.
    fn serve(mut lola: Socket) -> bool {
        let (mut bytes, mut actuators) = (Vec::new(), ActuatorPacket::default());
        let (_sender, pause) = mpsc::channel::<()>();
        SensorPacket::default().encode(&mut bytes);
        let mut was_connected = false;
        for _ in 0..2000 {
            // A connection that has ended is seen below.
            let _ = lola.send(&bytes).and_then(|()| lola.receive(|bytes| actuators.decode(bytes)));
            if was_connected && !lola.is_connected() {
                return true;
            }
            was_connected = lola.is_connected();
            let _ = pause.recv_timeout(Duration::from_millis(1));
        }
        false
    }

    #[test]
    fn a_robot_whose_channels_fail_is_left_without_a_connection() {
        let folder = tempfile::tempdir().unwrap();
        // The path is short enough for a socket, and too long with the endings of the channels.
        let length = 100_usize.saturating_sub(folder.path().as_os_str().len() + 1);
        let path = folder.path().join("l".repeat(length));
        for ending in ["simulated_camera", "simulated_referee", "simulated_radio"] {
            std::fs::write(format!("{}.{ending}", path.display()), "").unwrap();
        }
        let lola = Socket::listen(&path).unwrap();
        std::thread::scope(|threads| {
            let server = threads.spawn(|| serve(lola));
            let error = Nao::open(&path).map(drop).unwrap_err().to_string();
            assert!(error.contains("simulated_camera"), "{error}");
            assert!(server.join().unwrap(), "the connection stays");
        });
    }
}
