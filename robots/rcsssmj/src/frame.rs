//! Frames: each message is preceded by its length as four bytes, big endian.

use crate::error::Error;

/// The longest message that is accepted, bytes. The first one to a monitor has about 20 000.
pub const MAX_MESSAGE_SIZE: usize = 1 << 20;

/// Appends a message with its length.
pub fn write(message: &[u8], bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&(message.len() as u32).to_be_bytes());
    bytes.extend_from_slice(message);
}

/// Collects bytes as they arrive and divides them into messages.
#[derive(Clone, Debug, Default)]
pub struct FrameReader {
    bytes: Vec<u8>,
    /// The beginning of the first message that was not taken.
    start: usize,
}

impl FrameReader {
    /// Adds received bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.drain(..self.start);
        self.start = 0;
        self.bytes.extend_from_slice(bytes);
    }

    /// The next complete message; none until it has arrived as a whole.
    ///
    /// # Errors
    /// The message is longer than [`MAX_MESSAGE_SIZE`]. The connection is then unusable.
    pub fn next_message(&mut self) -> Result<Option<&[u8]>, Error> {
        let Some(length) = self.length()? else { return Ok(None) };
        let begin = self.start + 4;
        self.start = begin + length;
        Ok(Some(&self.bytes[begin..begin + length]))
    }

    /// Whether a complete message has arrived.
    ///
    /// # Errors
    /// As in [`next_message`](FrameReader::next_message).
    pub fn has_message(&self) -> Result<bool, Error> {
        Ok(self.length()?.is_some())
    }

    /// The length of the next message, if it is complete.
    fn length(&self) -> Result<Option<usize>, Error> {
        let Some((length, rest)) = self.bytes[self.start..].split_first_chunk::<4>() else {
            return Ok(None);
        };
        let length = u32::from_be_bytes(*length) as usize;
        if length > MAX_MESSAGE_SIZE {
            return Err(Error::protocol(format!(
                "a message of {length} bytes was announced, {MAX_MESSAGE_SIZE} are the most"
            )));
        }
        Ok((rest.len() >= length).then_some(length))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_length_has_four_bytes_the_highest_first() {
        let mut bytes = Vec::new();
        write(&[b'x'; 258], &mut bytes);
        assert_eq!((&bytes[..4], bytes.len()), (&[0, 0, 1, 2][..], 262));
    }

    #[test]
    fn a_length_without_measure_is_an_error() {
        let mut reader = FrameReader::default();
        reader.push(b"(syn)");
        let error = reader.next_message().unwrap_err();
        assert!(error.to_string().starts_with("a message of 678656366 bytes"), "{error}");
    }

    proptest! {
        #[test]
        fn messages_survive_any_division_into_packets(
            messages in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..40), 0..8),
            packet in 1..30usize,
        ) {
            let (mut bytes, mut reader, mut read) = (Vec::new(), FrameReader::default(), Vec::new());
            messages.iter().for_each(|message| write(message, &mut bytes));
            for part in bytes.chunks(packet) {
                reader.push(part);
                while let Some(message) = reader.next_message().unwrap() {
                    read.push(message.to_vec());
                }
            }
            prop_assert_eq!(read, messages);
        }
    }
}
