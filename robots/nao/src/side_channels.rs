//! Channels beside LoLA that a simulation offers: camera, referee and radio.

use std::path::{Path, PathBuf};

use monas_robot::{Announcement, Heard, Images, Percepts, Said, Sightings};
use narukom::Timestamp;

use crate::error::Error;
use crate::socket::{MessageSocket, Socket};

/// An empty message, for the unused direction.
type Nothing = ();

/// The output of the simulated cameras: objects in place of images, or images.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct SimulatedView {
    #[prost(message, optional, tag = "1")]
    pub(crate) sightings: Option<Sightings>,
    #[prost(message, optional, tag = "2")]
    pub(crate) images: Option<Images>,
    /// When this is sent, in the time of the simulation as `taken_at`, nanoseconds.
    #[prost(uint64, tag = "3")]
    pub(crate) sent_at: u64,
}

impl SimulatedView {
    /// The same in the time of the robot, which receives it now: a simulation has its own clock.
    pub(crate) fn received(mut self, now: Timestamp) -> SimulatedView {
        let sightings = self.sightings.as_mut().map(|it| &mut it.taken_at);
        let images = self.images.as_mut().map(|it| &mut it.taken_at);
        for taken_at in [sightings, images].into_iter().flatten() {
            let age = self.sent_at.saturating_sub(*taken_at);
            *taken_at = now.as_nanos().saturating_sub(age);
        }
        self
    }
}

/// The simulation's ends of the sockets.
///
/// LoLA carries neither images, nor announcements of the referee, nor the radio of the team. A
/// simulation offers three more sockets: on the first it sends what the cameras would see; on the
/// second the announcements of the referee; on the third the radio messages of the team in both
/// directions.
pub(crate) struct SimulatedChannels {
    pub(crate) camera: MessageSocket<SimulatedView, Nothing>,
    pub(crate) referee: MessageSocket<Announcement, Nothing>,
    pub(crate) radio: MessageSocket<Heard, Said>,
}

/// The robot's ends of the sockets.
pub(crate) struct RobotChannels {
    camera: MessageSocket<Nothing, SimulatedView>,
    referee: MessageSocket<Nothing, Announcement>,
    radio: MessageSocket<Said, Heard>,
}

/// The endings of the paths of the three sockets, after the path of LoLA's.
const SOCKET_SUFFIXES: [&str; 3] = ["simulated_camera", "simulated_referee", "simulated_radio"];

/// The path of one of the three sockets.
fn path(lola: &Path, ending: &str) -> PathBuf {
    let mut path = lola.as_os_str().to_owned();
    path.push(format!(".{ending}"));
    path.into()
}

/// Whether a simulation offers the sockets beside the one of LoLA.
pub(crate) fn are_offered(lola: &Path) -> bool {
    SOCKET_SUFFIXES.iter().all(|ending| path(lola, ending).exists())
}

impl SimulatedChannels {
    /// Listens beside the socket of LoLA.
    pub(crate) fn listen(lola: &Path) -> Result<SimulatedChannels, Error> {
        let [camera, referee, radio] = SOCKET_SUFFIXES.map(|ending| Socket::listen(&path(lola, ending)));
        Ok(SimulatedChannels {
            camera: MessageSocket::new(camera?),
            referee: MessageSocket::new(referee?),
            radio: MessageSocket::new(radio?),
        })
    }
}

impl RobotChannels {
    /// Connects beside the socket of LoLA. On a robot these sockets do not exist, or are left over
    /// from a simulation that was killed; then there are no channels.
    pub(crate) fn connect(lola: &Path) -> Result<Option<RobotChannels>, Error> {
        if !are_offered(lola) {
            return Ok(None);
        }
        let [camera, referee, radio] =
            SOCKET_SUFFIXES.map(|ending| Socket::connect_if_served(&path(lola, ending)));
        let (Some(camera), Some(referee), Some(radio)) = (camera?, referee?, radio?) else {
            return Ok(None);
        };
        Ok(Some(RobotChannels {
            camera: MessageSocket::new(camera),
            referee: MessageSocket::new(referee),
            radio: MessageSocket::new(radio),
        }))
    }

    /// Takes what has arrived until now: the newest sightings or images and announcement, and all
    /// radio messages.
    pub(crate) fn receive(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
        self.camera.receive(|view: SimulatedView| {
            let SimulatedView { sightings, images, .. } = view.received(now);
            percepts.sightings = sightings.or(percepts.sightings.take());
            percepts.images = images.or(percepts.images.take());
        })?;
        self.referee.receive(|announcement| percepts.announcement = Some(announcement))?;
        self.radio.receive(|heard| percepts.heard.push(heard))
    }

    /// Sends a message to the team.
    pub(crate) fn say(&mut self, words: &[u8]) -> Result<(), Error> {
        self.radio.send(&Said { words: words.to_vec() })
    }
}

/// Both ends of three connections.
pub(crate) fn pair() -> Result<(SimulatedChannels, RobotChannels), Error> {
    let (camera, cameras) = Socket::pair()?;
    let (referee, referees) = Socket::pair()?;
    let (radio, radios) = Socket::pair()?;
    let simulated = SimulatedChannels {
        camera: MessageSocket::new(camera),
        referee: MessageSocket::new(referee),
        radio: MessageSocket::new(radio),
    };
    let robot = RobotChannels {
        camera: MessageSocket::new(cameras),
        referee: MessageSocket::new(referees),
        radio: MessageSocket::new(radios),
    };
    Ok((simulated, robot))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_keeps_its_age_in_the_time_of_the_robot() {
        let sightings = Some(Sightings { taken_at: 940, ..Sightings::default() });
        let images = Some(Images { taken_at: 900, ..Images::default() });
        let view = SimulatedView { sightings, images, sent_at: 1000 };
        let received = |now| {
            let SimulatedView { sightings, images, .. } = view.clone().received(Timestamp::from_nanos(now));
            [sightings.unwrap().taken_at, images.unwrap().taken_at]
        };
        assert_eq!(received(7000), [6940, 6900]);
        assert_eq!(received(1000), [940, 900], "the same clock");
    }

    #[test]
    fn files_that_nobody_serves_are_no_channels() {
        let folder = tempfile::tempdir().unwrap();
        let lola = folder.path().join("lola");
        for ending in SOCKET_SUFFIXES {
            drop(std::os::unix::net::UnixListener::bind(path(&lola, ending)).unwrap());
        }
        assert!(are_offered(&lola) && RobotChannels::connect(&lola).unwrap().is_none());
    }

    #[test]
    fn the_files_of_channels_end_with_them_unless_others_have_replaced_them() {
        let folder = tempfile::tempdir().unwrap();
        let lola = folder.path().join("lola");
        let first = SimulatedChannels::listen(&lola).unwrap();
        let second = SimulatedChannels::listen(&lola).unwrap();
        drop(first);
        assert!(are_offered(&lola) && RobotChannels::connect(&lola).unwrap().is_some());
        drop(second);
        assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
    }
}
