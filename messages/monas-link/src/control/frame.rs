//! Length-prefixed messages on a stream.

use std::io::{self, Read, Write};

use prost::Message;

/// Appends a message with its length.
pub(crate) fn append(message: &impl Message, bytes: &mut Vec<u8>) {
    // A message of 4 GiB cannot occur: replies are bounded, and requests are limited.
    let length = u32::try_from(message.encoded_len()).unwrap_or(u32::MAX);
    bytes.extend(length.to_le_bytes());
    message.encode_raw(bytes);
}

/// Writes a message.
pub(super) fn write(message: &impl Message, to: &mut impl Write) -> io::Result<()> {
    let mut bytes = Vec::new();
    append(message, &mut bytes);
    to.write_all(&bytes)
}

/// Reads a message of at most `limit` bytes. Memory is allocated as bytes arrive, not as announced.
pub(crate) fn read<M: Message + Default>(from: &mut impl Read, limit: usize) -> io::Result<M> {
    let mut length = [0; 4];
    from.read_exact(&mut length)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > limit {
        let text = format!("a message of {length} bytes is announced, and at most {limit} are taken");
        return Err(io::Error::new(io::ErrorKind::InvalidData, text));
    }
    let mut bytes = Vec::new();
    from.take(length as u64).read_to_end(&mut bytes)?;
    if bytes.len() < length {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    M::decode(bytes.as_slice()).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

#[cfg(test)]
mod tests {
    use super::super::messages::{Publish, Request};
    use super::*;

    fn request() -> Request {
        let publish = Publish { host: "a".into(), path: "b/c".into(), payload: vec![1; 300] };
        Request { publish: Some(publish), ..Request::default() }
    }

    #[test]
    fn written_files_are_read_back() {
        let mut bytes = Vec::new();
        write(&request(), &mut bytes).unwrap();
        append(&request(), &mut bytes);
        let mut stream = bytes.as_slice();
        for _ in 0..2 {
            assert_eq!(read::<Request>(&mut stream, 1000).unwrap(), request());
        }
        assert_eq!(read::<Request>(&mut stream, 1000).unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
    }

    #[test]
    fn long_truncated_and_malformed_packets_are_rejected() {
        let mut bytes = Vec::new();
        append(&request(), &mut bytes);
        let kind = |bytes: &[u8], limit| read::<Request>(&mut &*bytes, limit).unwrap_err().kind();
        assert_eq!(kind(&bytes, 100), io::ErrorKind::InvalidData);
        assert_eq!(kind(&u32::MAX.to_le_bytes(), 1 << 20), io::ErrorKind::InvalidData);
        assert_eq!(kind(&bytes[..bytes.len() - 1], 1000), io::ErrorKind::UnexpectedEof);
        assert_eq!(kind(&[2, 0, 0, 0, 0xff, 0xff], 1000), io::ErrorKind::InvalidData);
    }
}
