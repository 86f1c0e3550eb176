//! Packets of LoLA: a packet that was read is equal after writing and reading it again, and lies
//! within the bytes.

use monas_nao::lola::{ActuatorPacket, Decoded, SensorPacket};

macro_rules! check {
    ($packet:ty, $data:expr) => {
        let mut packet = <$packet>::default();
        match packet.decode($data) {
            Ok(Decoded::Packet { bytes }) => {
                assert!(bytes <= $data.len());
                let (mut written, mut again) = (Vec::new(), <$packet>::default());
                packet.encode(&mut written);
                assert!(matches!(again.decode(&written), Ok(Decoded::Packet { .. })), "{packet:?}");
                let mut rewritten = Vec::new();
                again.encode(&mut rewritten);
                assert_eq!(written, rewritten);
            }
            Ok(_) => {}
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    };
}

/// Checks the documented guarantees for one input.
pub fn lola(data: &[u8]) {
    check!(SensorPacket, data);
    check!(ActuatorPacket, data);
}
