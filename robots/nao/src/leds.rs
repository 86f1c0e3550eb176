//! Colours of eyes, chest and feet in the order of LoLA.

use monas_robot::{Actuators, Leds};

use crate::lola::ActuatorPacket;

/// Segments of an eye.
const SEGMENTS: usize = 8;

/// Red, green and blue of 0xRRGGBB, 0 to 1.
fn components(colour: u32) -> [f32; 3] {
    [16, 8, 0].map(|shift| ((colour >> shift) & 0xff) as f32 / 255.0)
}

/// Sets the LEDs: what `leds` sets, else the colours of the commands.
pub(crate) fn set(packet: &mut ActuatorPacket, commands: &Actuators, leds: &Leds) {
    eye(&mut packet.left_eye, &leds.left_eye, commands.left_eye);
    eye(&mut packet.right_eye, &leds.right_eye, commands.right_eye);
    packet.chest = components(leds.chest.first().copied().unwrap_or(commands.chest));
    packet.left_foot = components(leds.left_foot.first().copied().unwrap_or(commands.left_foot));
    packet.right_foot = components(leds.right_foot.first().copied().unwrap_or(commands.right_foot));
    brightness(&mut packet.left_ear, &leds.left_ear);
    brightness(&mut packet.right_ear, &leds.right_ear);
    brightness(&mut packet.skull, &leds.skull);
}

/// Replaces what a message sets; what is empty in it stays.
pub(crate) fn merge(leds: &mut Leds, message: &Leds) {
    let Leds { left_eye, right_eye, chest, left_foot, right_foot, left_ear, right_ear, skull } = message;
    let colours = [
        (&mut leds.left_eye, left_eye),
        (&mut leds.right_eye, right_eye),
        (&mut leds.chest, chest),
        (&mut leds.left_foot, left_foot),
        (&mut leds.right_foot, right_foot),
    ];
    for (kept, new) in colours.into_iter().filter(|(_, new)| !new.is_empty()) {
        kept.clone_from(new);
    }
    let lights = [(&mut leds.left_ear, left_ear), (&mut leds.right_ear, right_ear), (&mut leds.skull, skull)];
    for (kept, new) in lights.into_iter().filter(|(_, new)| !new.is_empty()) {
        kept.clone_from(new);
    }
}

/// The values of an eye are all reds, then all greens, then all blues. A message with fewer
/// segments repeats its last one.
fn eye(values: &mut [f32; 3 * SEGMENTS], segments: &[u32], otherwise: u32) {
    for segment in 0..SEGMENTS {
        let colour = segments.get(segment).or(segments.last()).copied().unwrap_or(otherwise);
        for (component, value) in components(colour).into_iter().enumerate() {
            values[component * SEGMENTS + segment] = value;
        }
    }
}

fn brightness(values: &mut [f32], wanted: &[f64]) {
    for (index, value) in values.iter_mut().enumerate() {
        let wanted = wanted.get(index).or(wanted.last()).copied().unwrap_or_default();
        *value = if wanted.is_finite() { wanted.clamp(0.0, 1.0) as f32 } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_eye_is_all_reds_then_all_greens_then_all_blues() {
        let mut packet = ActuatorPacket::default();
        let commands = Actuators {
            left_eye: 0xff_80_00,
            chest: 0x00_00_ff,
            left_foot: 0xff0000,
            ..Actuators::default()
        };
        set(&mut packet, &commands, &Leds::default());
        assert_eq!(packet.left_eye[..8], [1.0; 8]);
        assert!(packet.left_eye[8..16].iter().all(|green| (green - 0.502).abs() < 1e-3));
        assert_eq!((&packet.left_eye[16..], packet.chest), (&[0.0; 8][..], [0.0, 0.0, 1.0]));
        assert_eq!((packet.left_foot, packet.right_foot), ([1.0, 0.0, 0.0], [0.0; 3]));
    }

    #[test]
    fn a_message_replaces_what_it_sets_and_nothing_else() {
        let mut leds = Leds::default();
        merge(&mut leds, &Leds { right_eye: vec![0xff0000], skull: vec![0.5, 2.0], ..Leds::default() });
        merge(&mut leds, &Leds { chest: vec![0x00ff00], ..Leds::default() });
        let mut packet = ActuatorPacket::default();
        set(&mut packet, &Actuators::default(), &leds);
        assert_eq!((packet.right_eye[0], packet.chest), (1.0, [0.0, 1.0, 0.0]));
        assert_eq!((packet.skull[0], packet.skull[1], packet.skull[11]), (0.5, 1.0, 1.0));
    }
}
