//! The Nao V6 as a body.
//!
//! [`Nao`] implements [`monas_robot::Robot`] on LoLA, the interface to the robot's hardware: a Unix
//! socket with a packet of [sensors](lola::SensorPacket) every 12 ms, answered by a packet of
//! [actuators](lola::ActuatorPacket). [`LolaServer`] is the other side, for simulations: it gives
//! joints to a body that moves in the plane, such as a robot of the embedded field.
//! [`SimulatedNao`] is both in lockstep, in simulated time, and [`ServedNao`] is the server for
//! agents in another process. A configuration names the body: `<body kind="nao"/>`.
//!
//! The commands in the plane, which all bodies have, become joint targets here: a [`WalkEngine`]
//! turns velocities into steps, skills are motions of the joints through the poses of a file, see
//! [`poses`](monas_config::poses), and odometry follows from the foot on the ground by the
//! [`kinematics`] of the legs. The [`anatomy`](anatomy()) is read from the file `nao.urdf`.
//!
//! # Limits
//!
//! LoLA has no images, no referee and no radio. Images come from the cameras through Video4Linux.
//! If a simulation stands in for the robot, it offers all three on sockets of their own, beside
//! LoLA's; the camera's delivers objects, or images if the configuration asks for them. On a robot
//! referee and radio are missing. The walk engine and the motions have no feedback of balance: they
//! are made for the embedded field. None of this has been tested on a robot.
//!
//! ```
//! use monas_nao::lola::{Decoded, SENSOR_BYTES, SensorPacket};
//!
//! let mut bytes = Vec::new();
//! SensorPacket::default().encode(&mut bytes);
//! let decoded = SensorPacket::default().decode(&bytes)?;
//! assert_eq!(decoded, Decoded::Packet { bytes: SENSOR_BYTES });
//! # Ok::<(), monas_nao::Error>(())
//! ```

mod anatomy;
mod camera_thread;
mod cameras;
mod control;
mod error;
#[cfg_attr(not(target_os = "linux"), allow(dead_code, reason = "no camera delivers images there"))]
mod frame;
pub mod kinematics;
mod leds;
pub mod lola;
mod motions;
mod nao;
mod options;
mod served_nao;
mod server;
mod side_channels;
mod simulated_nao;
mod socket;
#[cfg_attr(not(all(target_os = "linux", target_pointer_width = "64")), path = "no_video_device.rs")]
mod video_device;
mod walk;

use std::path::Path;

use monas_robot::topics::{ANNOUNCEMENT, HEARD, IMAGES, SAID, SIGHTINGS};
use monas_robot::{
    BodyEnvironment, BodyFault, BodyKind, BodyLimit, BodySettings, BodySite, CameraOutput, Robot,
};

pub use anatomy::{NaoJoint, anatomy, links};
pub use cameras::CameraConfig;
pub use error::{Error, ErrorKind};
pub use nao::Nao;
pub use served_nao::ServedNao;
pub use server::LolaServer;
pub use simulated_nao::SimulatedNao;
pub use walk::{SteppingWalk, WalkEngine, WalkVelocity};

monas_robot::body_kind!(BodyKind {
    name: "nao",
    summary: "a Nao V6 through LoLA; in simulated time through a LoLA server over the field's body",
    options: options::OPTIONS,
    has_own_time: |_| false,
    limits,
    faults,
    open,
    serve: Some(serve),
    probe,
});

/// Missing cameras, and the data that LoLA lacks and simulations offer on sockets of their own.
fn limits(settings: &BodySettings, surroundings: BodyEnvironment) -> Vec<BodyLimit> {
    if !has_cameras(settings, surroundings) {
        return Vec::new();
    }
    let mut limits: Vec<BodyLimit> = match settings.vision {
        CameraOutput::Sightings => vec![BodyLimit::topic(
            SIGHTINGS.path(),
            "the robot sees nothing: its cameras deliver images, with `vision=\"images\"`",
        )],
        CameraOutput::Images => CameraConfig::of(&settings.options)
            .missing()
            .into_iter()
            .map(|effect| BodyLimit::found(IMAGES.path(), effect))
            .collect(),
    };
    limits.extend([
        BodyLimit::topic(ANNOUNCEMENT.path(), "the robot hears no referee: LoLA has none"),
        BodyLimit::topic(HEARD.path(), "the robot hears no team mates: LoLA has no radio"),
        BodyLimit::topic(SAID.path(), "the robot cannot speak to team mates: LoLA has no radio"),
    ]);
    limits
}

/// Images that the cameras of a robot do not have; those of a simulation have other widths.
fn faults(settings: &BodySettings, surroundings: BodyEnvironment) -> Vec<BodyFault> {
    match (settings.vision, has_cameras(settings, surroundings)) {
        (CameraOutput::Images, true) => {
            cameras::check_width(settings.image_width).err().into_iter().collect()
        }
        _ => Vec::new(),
    }
}

/// Whether it sees with cameras of its own, and not what a simulation shows it.
fn has_cameras(settings: &BodySettings, surroundings: BodyEnvironment) -> bool {
    let lola = settings.address.as_deref().unwrap_or(lola::SOCKET);
    surroundings == BodyEnvironment::Own && !side_channels::are_offered(Path::new(lola))
}

/// Opens a Nao: on the body of a simulated world if there is one, otherwise at a socket.
fn open(site: BodySite) -> Result<Box<dyn Robot>, monas_robot::Error> {
    let control = control::NaoControl::of(&site.options)?;
    match site {
        BodySite { simulated: Some(body), address: None, .. } => {
            Ok(Box::new(SimulatedNao::with_control(body, control)?))
        }
        BodySite { address, options, .. } => {
            let path = Path::new(address.as_deref().unwrap_or(lola::SOCKET));
            Ok(Box::new(Nao::connect(path, control)?.with_cameras(CameraConfig::of(&options))))
        }
    }
}

/// Offers a simulated body at a LoLA socket.
fn serve(site: BodySite) -> Result<Box<dyn Robot>, monas_robot::Error> {
    let (Some(body), Some(address)) = (site.simulated, site.address) else {
        let message = "a LoLA server needs a simulated body and the path of a socket";
        return Err(monas_robot::Error::new(monas_robot::ErrorKind::Configuration, message));
    };
    Ok(Box::new(ServedNao::listen(Path::new(&address), body)?))
}

/// Whether LoLA answers at a socket.
fn probe(address: Option<&str>) -> Result<String, monas_robot::Error> {
    let path = Path::new(address.unwrap_or(lola::SOCKET));
    socket::Socket::connect(path)?;
    Ok(format!("LoLA answers at {}", path.display()))
}
