//! The packets of LoLA, the interface to the hardware of a Nao V6.
//!
//! Each packet is one MessagePack map of the format's first version: raw strings, 32 bit floats.
//! The server sends a [`SensorPacket`] of 896 bytes every 12 ms, a client answers with an
//! [`ActuatorPacket`] of 786 bytes.

mod reader;

use rmp::encode::{self, ByteBuf};

use crate::error::Error;

pub use reader::Decoded;
use reader::Reader;

/// The number of joints.
pub const JOINTS: usize = 25;

/// The length of a sensor packet, bytes.
pub const SENSOR_BYTES: usize = 896;

/// The length of an actuator packet with all keys, bytes.
pub const ACTUATOR_BYTES: usize = 786;

/// The path of the socket on which the robot listens.
pub const SOCKET: &str = "/tmp/robocup";

/// The time between two packets.
pub const CYCLE: std::time::Duration = std::time::Duration::from_millis(12);

/// [`CYCLE`] in seconds.
pub const CYCLE_SECONDS: f64 = 0.012;

/// The measurements of the robot.
#[derive(Clone, PartialEq, Debug)]
pub struct SensorPacket {
    /// Stiffness of each joint, 0 to 1.
    pub stiffness: [f32; JOINTS],
    /// Angle of each joint, rad.
    pub position: [f32; JOINTS],
    /// Temperature of each motor, degrees Celsius.
    pub temperature: [f32; JOINTS],
    /// Current of each motor, A.
    pub current: [f32; JOINTS],
    /// Charge (0 to 1), status bits, current (A), temperature (degrees Celsius).
    pub battery: [f32; 4],
    /// Acceleration about x, y, z, m/s2; z is -9.8 at rest.
    pub accelerometer: [f32; 3],
    /// Angular velocity about x, y, z, rad/s.
    pub gyroscope: [f32; 3],
    /// Roll and pitch of the torso, rad.
    pub angles: [f32; 2],
    /// Distances, left and right, m.
    pub sonar: [f32; 2],
    /// Weights on the soles, kg: left front left, front right, rear left, rear right; right
    /// likewise.
    pub fsr: [f32; 8],
    /// Status of each joint: 0 normal to 3 critical.
    pub status: [i32; JOINTS],
    /// Buttons and touch sensors, at least 0.5 while pressed: see [`Touch`].
    pub touch: [f32; 14],
    /// Serial number and version of the body, then of the head.
    pub robot_config: [String; 4],
}

/// Indices in [`SensorPacket::touch`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Touch {
    /// The button on the chest.
    Chest = 0,
    /// The front of the head.
    HeadFront = 1,
    /// The middle of the head.
    HeadMiddle = 2,
    /// The rear of the head.
    HeadRear = 3,
    /// The left bumper of the left foot.
    LeftFootLeft = 4,
    /// The right bumper of the left foot.
    LeftFootRight = 5,
    /// The back of the left hand.
    LeftHandBack = 6,
    /// The left side of the left hand.
    LeftHandLeft = 7,
    /// The right side of the left hand.
    LeftHandRight = 8,
    /// The left bumper of the right foot.
    RightFootLeft = 9,
    /// The right bumper of the right foot.
    RightFootRight = 10,
    /// The back of the right hand.
    RightHandBack = 11,
    /// The left side of the right hand.
    RightHandLeft = 12,
    /// The right side of the right hand.
    RightHandRight = 13,
}

impl Default for SensorPacket {
    fn default() -> SensorPacket {
        SensorPacket {
            stiffness: [0.0; JOINTS],
            position: [0.0; JOINTS],
            temperature: [38.0; JOINTS],
            current: [0.0; JOINTS],
            battery: [1.0, 0.0, 0.0, 30.0],
            accelerometer: [0.0, 0.0, -9.81],
            gyroscope: [0.0; 3],
            angles: [0.0; 2],
            sonar: [0.0; 2],
            fsr: [0.0; 8],
            status: [0; JOINTS],
            touch: [0.0; 14],
            robot_config: ["P0000000000000000000", "6.0.0", "P0000000000000000000", "6.0.0"]
                .map(str::to_owned),
        }
    }
}

impl SensorPacket {
    /// Whether a touch sensor or button is pressed.
    pub fn is_touched(&self, touch: Touch) -> bool {
        self.touch[touch as usize] >= 0.5
    }

    /// Replaces `bytes` by the encoded packet.
    pub fn encode(&self, bytes: &mut Vec<u8>) {
        let mut writer = Writer::start(bytes, 13);
        writer.floats("Stiffness", &self.stiffness);
        writer.floats("Position", &self.position);
        writer.floats("Temperature", &self.temperature);
        writer.floats("Current", &self.current);
        writer.floats("Battery", &self.battery);
        writer.floats("Accelerometer", &self.accelerometer);
        writer.floats("Gyroscope", &self.gyroscope);
        writer.floats("Angles", &self.angles);
        writer.floats("Sonar", &self.sonar);
        writer.floats("FSR", &self.fsr);
        writer.integers("Status", &self.status);
        writer.floats("Touch", &self.touch);
        writer.strings("RobotConfig", &self.robot_config);
        writer.finish(bytes);
    }

    /// Reads a packet from the start of `bytes` into this one.
    ///
    /// # Errors
    /// The bytes are not a sensor packet.
    pub fn decode(&mut self, bytes: &[u8]) -> Result<Decoded, Error> {
        const KEYS: [&str; 13] = [
            "Stiffness",
            "Position",
            "Temperature",
            "Current",
            "Battery",
            "Accelerometer",
            "Gyroscope",
            "Angles",
            "Sonar",
            "FSR",
            "Status",
            "Touch",
            "RobotConfig",
        ];
        let mut seen = [false; KEYS.len()];
        let decoded = reader::map(bytes, |key, values| {
            if let Some(index) = KEYS.iter().position(|known| *known == key) {
                seen[index] = true;
            }
            self.read(key, values)
        })?;
        match seen.iter().position(|seen| !seen) {
            Some(missing) if matches!(decoded, Decoded::Packet { .. }) => {
                Err(Error::protocol(format!("a sensor packet without `{}`", KEYS[missing])))
            }
            _ => Ok(decoded),
        }
    }

    fn read(&mut self, key: &str, values: &mut Reader<'_>) -> Result<(), reader::ReadError> {
        match key {
            "Stiffness" => values.floats(&mut self.stiffness),
            "Position" => values.floats(&mut self.position),
            "Temperature" => values.floats(&mut self.temperature),
            "Current" => values.floats(&mut self.current),
            "Battery" => values.floats(&mut self.battery),
            "Accelerometer" => values.floats(&mut self.accelerometer),
            "Gyroscope" => values.floats(&mut self.gyroscope),
            "Angles" => values.floats(&mut self.angles),
            "Sonar" => values.floats(&mut self.sonar),
            "FSR" => values.floats(&mut self.fsr),
            "Status" => values.integers(&mut self.status),
            "Touch" => values.floats(&mut self.touch),
            "RobotConfig" => values.strings(&mut self.robot_config),
            unknown => Err(reader::ReadError::Wrong(format!("a sensor packet has no key `{unknown}`"))),
        }
    }
}

/// The commands to the robot.
#[derive(Clone, PartialEq, Debug)]
pub struct ActuatorPacket {
    /// Target of each joint, rad.
    pub position: [f32; JOINTS],
    /// Stiffness of each joint, 0 to 1.
    pub stiffness: [f32; JOINTS],
    /// Red, green and blue of the chest, 0 to 1.
    pub chest: [f32; 3],
    /// Brightness of the left ear at 0 to 324 degrees.
    pub left_ear: [f32; 10],
    /// Eight values of red, of green, and of blue, at 45, 0, 315 to 90 degrees.
    pub left_eye: [f32; 24],
    /// Red, green and blue of the left foot.
    pub left_foot: [f32; 3],
    /// Brightness of the right ear at 324 to 0 degrees.
    pub right_ear: [f32; 10],
    /// Eight values of red, of green, and of blue, at 0, 45 to 315 degrees.
    pub right_eye: [f32; 24],
    /// Red, green and blue of the right foot.
    pub right_foot: [f32; 3],
    /// Brightness of the head.
    pub skull: [f32; 12],
    /// Whether the left and the right sonar measure.
    pub sonar: [bool; 2],
}

impl Default for ActuatorPacket {
    fn default() -> ActuatorPacket {
        ActuatorPacket {
            position: [0.0; JOINTS],
            stiffness: [0.0; JOINTS],
            chest: [0.0; 3],
            left_ear: [0.0; 10],
            left_eye: [0.0; 24],
            left_foot: [0.0; 3],
            right_ear: [0.0; 10],
            right_eye: [0.0; 24],
            right_foot: [0.0; 3],
            skull: [0.0; 12],
            sonar: [true; 2],
        }
    }
}

impl ActuatorPacket {
    /// Replaces `bytes` by the encoded packet.
    pub fn encode(&self, bytes: &mut Vec<u8>) {
        let mut writer = Writer::start(bytes, 11);
        writer.floats("Position", &self.position);
        writer.floats("Stiffness", &self.stiffness);
        writer.floats("Chest", &self.chest);
        writer.floats("LEar", &self.left_ear);
        writer.floats("LEye", &self.left_eye);
        writer.floats("LFoot", &self.left_foot);
        writer.floats("REar", &self.right_ear);
        writer.floats("REye", &self.right_eye);
        writer.floats("RFoot", &self.right_foot);
        writer.floats("Skull", &self.skull);
        writer.flags("Sonar", &self.sonar);
        writer.finish(bytes);
    }

    /// Reads a packet from the start of `bytes` into this one. Keys that are missing keep their
    /// values, as on the robot.
    ///
    /// # Errors
    /// The bytes are not an actuator packet.
    pub fn decode(&mut self, bytes: &[u8]) -> Result<Decoded, Error> {
        reader::map(bytes, |key, values| match key {
            "Position" => values.floats(&mut self.position),
            "Stiffness" => values.floats(&mut self.stiffness),
            "Chest" => values.floats(&mut self.chest),
            "LEar" => values.floats(&mut self.left_ear),
            "LEye" => values.floats(&mut self.left_eye),
            "LFoot" => values.floats(&mut self.left_foot),
            "REar" => values.floats(&mut self.right_ear),
            "REye" => values.floats(&mut self.right_eye),
            "RFoot" => values.floats(&mut self.right_foot),
            "Skull" => values.floats(&mut self.skull),
            "Sonar" => values.flags(&mut self.sonar),
            unknown => Err(reader::ReadError::Wrong(format!("an actuator packet has no key `{unknown}`"))),
        })
    }
}

/// Writes a map of lists. Writing to memory does not fail.
struct Writer {
    bytes: ByteBuf,
}

impl Writer {
    fn start(bytes: &mut Vec<u8>, keys: u32) -> Writer {
        let mut memory = std::mem::take(bytes);
        memory.clear();
        let mut writer = Writer { bytes: ByteBuf::from_vec(memory) };
        let Ok(_) = encode::write_map_len(&mut writer.bytes, keys);
        writer
    }

    fn finish(self, bytes: &mut Vec<u8>) {
        *bytes = self.bytes.into_vec();
    }

    fn list(&mut self, key: &str, length: usize) {
        let Ok(()) = encode::write_str(&mut self.bytes, key);
        let Ok(_) = encode::write_array_len(&mut self.bytes, length as u32);
    }

    fn floats(&mut self, key: &str, values: &[f32]) {
        self.list(key, values.len());
        for &value in values {
            let Ok(()) = encode::write_f32(&mut self.bytes, value);
        }
    }

    fn integers(&mut self, key: &str, values: &[i32]) {
        self.list(key, values.len());
        for &value in values {
            let Ok(_) = encode::write_sint(&mut self.bytes, value.into());
        }
    }

    fn flags(&mut self, key: &str, values: &[bool]) {
        self.list(key, values.len());
        for &value in values {
            let Ok(()) = encode::write_bool(&mut self.bytes, value);
        }
    }

    fn strings(&mut self, key: &str, values: &[String]) {
        self.list(key, values.len());
        for value in values {
            let Ok(()) = encode::write_str(&mut self.bytes, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Names a folder with captured packets, where there is one.
    const SAMPLES: &str = "MONAS_LOLA_SAMPLES";

    #[test]
    fn packets_have_the_documented_sizes_and_read_back() {
        let mut bytes = Vec::new();
        let sent = SensorPacket { fsr: [0.5; 8], status: [3; JOINTS], ..SensorPacket::default() };
        sent.encode(&mut bytes);
        assert_eq!((bytes.len(), &bytes[..11]), (SENSOR_BYTES, &b"\x8d\xa9Stiffness"[..]));
        let mut received = SensorPacket::default();
        assert_eq!(received.decode(&bytes).unwrap(), Decoded::Packet { bytes: SENSOR_BYTES });
        assert_eq!(received, sent);

        let sent =
            ActuatorPacket { position: [0.25; JOINTS], sonar: [true, false], ..ActuatorPacket::default() };
        sent.encode(&mut bytes);
        assert_eq!((bytes.len(), &bytes[..10]), (ACTUATOR_BYTES, &b"\x8b\xa8Position"[..]));
        let mut received = ActuatorPacket::default();
        assert_eq!(received.decode(&bytes).unwrap(), Decoded::Packet { bytes: ACTUATOR_BYTES });
        assert_eq!(received, sent);
    }

    #[test]
    fn captured_packets_are_written_again_byte_by_byte() {
        let Some(folder) = std::env::var_os(SAMPLES) else { return };
        let captured = |name: &str| std::fs::read(Path::new(&folder).join(name)).unwrap();
        let (sensors, actuators) = (captured("sensor_896.bin"), captured("actuator.bin"));
        let mut bytes = Vec::new();
        let mut packet = SensorPacket::default();
        packet.decode(&sensors).unwrap();
        packet.encode(&mut bytes);
        assert_eq!(bytes, sensors);
        let mut packet = ActuatorPacket::default();
        packet.decode(&actuators).unwrap();
        packet.encode(&mut bytes);
        assert_eq!(bytes, actuators);
    }

    #[test]
    fn a_part_of_a_packet_is_incomplete_and_other_bytes_are_refused() {
        let mut bytes = Vec::new();
        SensorPacket::default().encode(&mut bytes);
        let mut packet = SensorPacket::default();
        for length in 0..bytes.len() {
            assert_eq!(packet.decode(&bytes[..length]).unwrap(), Decoded::Incomplete, "{length}");
        }
        let without = [&[0x8c][..], &bytes[1..bytes.len() - 58]].concat();
        for bad in [&b"\x93abc"[..], b"\x8d\xa1a\x90", b"\x8d\xa9Stiffness\x91\xca\0\0\0\0", &without] {
            assert!(packet.decode(bad).is_err(), "{bad:x?}");
        }
        let mut not_finite = Vec::new();
        let nan = ActuatorPacket { chest: [f32::NAN; 3], ..ActuatorPacket::default() };
        nan.encode(&mut not_finite);
        assert!(ActuatorPacket::default().decode(&not_finite).is_err());
    }

    #[test]
    fn an_actuator_packet_may_leave_out_keys() {
        let mut packet = ActuatorPacket { chest: [1.0; 3], ..ActuatorPacket::default() };
        let bytes = b"\x81\xa5Sonar\x92\xc2\xc3";
        assert_eq!(packet.decode(bytes).unwrap(), Decoded::Packet { bytes: bytes.len() });
        assert_eq!((packet.sonar, packet.chest), ([false, true], [1.0; 3]));
    }
}
