//! The topics between a body and the agents of its host.

use crate::{Actuators, Announcement, Heard, Said, Sensors, Sightings};

narukom::topic! {
    /// What the body feels, every cycle of the body; half a second and more of it at 100 Hz.
    pub SENSORS: narukom::Data<Sensors, 64> = "body/sensors";
    /// What the body sees, whenever its camera has taken an image.
    pub SIGHTINGS: narukom::State<Sightings> = "body/sightings";
    /// What the referee says.
    pub ANNOUNCEMENT: narukom::State<Announcement> = "body/referee";
    /// What the robot says to its team.
    pub SAID: narukom::State<Said> = "body/said";
    /// What others of its team have said.
    pub HEARD: narukom::Data<Heard, 32> = "body/heard";
    /// What the body is to do.
    pub ACTUATORS: narukom::State<Actuators> = "body/actuators";
}
