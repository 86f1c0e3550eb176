//! The topics between a body and the agents of its host.

use crate::{Actuators, Announcement, Heard, Said, Sensors, Sightings};

narukom::topic! {
    /// Sensor readings of every cycle of the body; more than half a second at 100 Hz.
    pub SENSORS: narukom::Data<Sensors, 64> = "body/sensors";
    /// Sightings of every image.
    pub SIGHTINGS: narukom::State<Sightings> = "body/sightings";
    /// Announcements of the referee.
    pub ANNOUNCEMENT: narukom::State<Announcement> = "body/referee";
    /// Radio messages to the team.
    pub SAID: narukom::State<Said> = "body/said";
    /// Radio messages of team mates.
    pub HEARD: narukom::Data<Heard, 32> = "body/heard";
    /// Commands to the body.
    pub ACTUATORS: narukom::State<Actuators> = "body/actuators";
}
