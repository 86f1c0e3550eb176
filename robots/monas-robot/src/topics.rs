//! The topics between a body and the agents of its host.

use crate::{
    Actuators, Announcement, Battery, Contacts, Heard, Images, Inertial, JointCommands, Joints, Leds, Said,
    Sensors, Sightings, Sonar,
};

narukom::topic! {
    /// Sensor readings of every cycle of the body; more than half a second at 100 Hz.
    pub SENSORS: narukom::Data<Sensors, 64> = "body/sensors";
    /// Sightings of every image.
    pub SIGHTINGS: narukom::State<Sightings> = "body/sightings";
    /// Images, of a body that delivers them in place of sightings.
    pub IMAGES: narukom::State<Images> = "body/images";
    /// Announcements of the referee.
    pub ANNOUNCEMENT: narukom::State<Announcement> = "body/referee";
    /// Radio messages to the team.
    pub SAID: narukom::State<Said> = "body/said";
    /// Radio messages of team mates.
    pub HEARD: narukom::Data<Heard, 32> = "body/heard";
    /// Commands to the body.
    pub ACTUATORS: narukom::State<Actuators> = "body/actuators";
    /// The joints, of every cycle of a body that has joints.
    pub JOINTS: narukom::Data<Joints, 64> = "body/joints";
    /// The inertial unit, of every cycle.
    pub INERTIAL: narukom::Data<Inertial, 64> = "body/inertial";
    /// Contacts of the body, each cycle.
    pub CONTACTS: narukom::State<Contacts> = "body/contacts";
    /// Distances by sound.
    pub SONAR: narukom::State<Sonar> = "body/sonar";
    /// The battery.
    pub BATTERY: narukom::State<Battery> = "body/power";
    /// Commands to single joints.
    pub JOINT_COMMANDS: narukom::State<JointCommands> = "body/joint_commands";
    /// Colours of the LEDs.
    pub LEDS: narukom::State<Leds> = "body/leds";
}
