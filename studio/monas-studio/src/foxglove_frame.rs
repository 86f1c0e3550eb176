//! Frames of Foxglove's protocol.

/// The first byte of a frame with a message.
const MESSAGE_DATA: u8 = 1;

/// The frame of a message: its kind, the subscription, the time of publication in nanoseconds, the
/// encoding.
pub(crate) fn frame(subscription: u32, time: u64, payload: &[u8]) -> Vec<u8> {
    let mut frame = Vec::with_capacity(13 + payload.len());
    frame.push(MESSAGE_DATA);
    frame.extend(subscription.to_le_bytes());
    frame.extend(time.to_le_bytes());
    frame.extend(payload);
    frame
}
