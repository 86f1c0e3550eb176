//! The messages from an agent to the server.

use std::fmt::Write;

use crate::humanoid::Humanoid;

/// A command to a motor. The server applies `stiffness (angle - measured) + damping (velocity -
/// measured) + torque`, clamped to the motor's greatest torque, in each step of its physics until
/// the next command.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct MotorCommand {
    /// Target angle, rad.
    pub angle: f64,
    /// Target angular velocity, rad/s.
    pub velocity: f64,
    /// Torque per angle, Nm/rad.
    pub stiffness: f64,
    /// Torque per angular velocity, Nm s/rad.
    pub damping: f64,
    /// Torque that is added, Nm.
    pub torque: f64,
}

/// A message to the server, written into one buffer.
#[derive(Clone, Debug, Default)]
pub struct Effectors {
    text: String,
}

impl Effectors {
    /// Empties the message.
    pub fn clear(&mut self) {
        self.text.clear();
    }

    /// Joins the game: the first message of a connection.
    pub fn init(&mut self, robot: &Humanoid, team: &str, number: u32) {
        self.write(format_args!("(init {} {team} {number})", robot.name()));
    }

    /// Commands the motor of a joint of a robot, an index in its anatomy.
    ///
    /// # Panics
    /// The robot has no such joint.
    pub fn motor(&mut self, robot: &Humanoid, joint: usize, command: &MotorCommand) {
        let MotorCommand { angle, velocity, stiffness, damping, torque } = *command;
        let (angle, velocity) = (angle.to_degrees(), velocity.to_degrees());
        let name = robot.motor(joint);
        self.write(format_args!("({name} {angle:.3} {velocity:.3} {stiffness} {damping} {torque})"));
    }

    /// Places the robot in its own half before a kick-off: position in metres, heading in radians.
    pub fn beam(&mut self, x: f64, y: f64, heading: f64) {
        self.write(format_args!("(beam {x} {y} {})", heading.to_degrees()));
    }

    /// Does nothing; the server waits for a message of each agent in its synchronous mode.
    pub fn synchronize(&mut self) {
        self.text.push_str("(syn)");
    }

    /// The message.
    pub fn as_bytes(&self) -> &[u8] {
        self.text.as_bytes()
    }

    fn write(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing into a string does not fail.
        let _ = self.text.write_fmt(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::T1;

    #[test]
    fn effectors_are_written_in_degrees_one_after_the_other() {
        let mut message = Effectors::default();
        message.init(&T1, "Monas", 2);
        assert_eq!(message.as_bytes(), b"(init T1 Monas 2)");
        message.clear();
        let angle = std::f64::consts::PI;
        message.motor(
            &T1,
            1,
            &MotorCommand { angle, stiffness: 25.0, damping: 0.6, ..MotorCommand::default() },
        );
        message.motor(&T1, 22, &MotorCommand { velocity: -angle, torque: 1.5, ..MotorCommand::default() });
        message.beam(-2.0, 0.5, -angle);
        message.synchronize();
        let written = std::str::from_utf8(message.as_bytes()).unwrap();
        let expected = "(he2 180.000 0.000 25 0.6 0)(rle6 0.000 -180.000 0 0 1.5)\
            (beam -2 0.5 -180)(syn)";
        assert_eq!(written, expected);
    }
}
