//! Reads maps of lists from bytes that may not be complete yet.

use std::io::ErrorKind;

use rmp::decode::bytes::BytesReadError;
use rmp::decode::{self, DecodeStringError, NumValueReadError, ValueReadError};

use crate::error::Error;

/// The result of reading a packet from bytes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Decoded {
    /// A packet, and its length.
    Packet {
        /// The length of the packet.
        bytes: usize,
    },
    /// The bytes are the beginning of a packet.
    Incomplete,
}

/// Why nothing could be read.
pub(super) enum ReadError {
    /// The bytes end before.
    Incomplete,
    /// The bytes are something else.
    Wrong(String),
}

/// The bytes that are not read yet.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

/// Reads a map; `read` reads the value of each key.
pub(super) fn map(
    bytes: &[u8],
    mut read: impl FnMut(&str, &mut Reader<'_>) -> Result<(), ReadError>,
) -> Result<Decoded, Error> {
    let mut reader = Reader { rest: bytes };
    let mut entries = || {
        for _ in 0..decode::read_map_len(&mut reader.rest)? {
            let key = reader.string()?;
            read(key, &mut reader)?;
        }
        Ok(reader.rest.len())
    };
    match entries() {
        Ok(rest) => Ok(Decoded::Packet { bytes: bytes.len() - rest }),
        Err(ReadError::Incomplete) => Ok(Decoded::Incomplete),
        Err(ReadError::Wrong(what)) => Err(Error::protocol(what)),
    }
}

impl<'a> Reader<'a> {
    fn string(&mut self) -> Result<&'a str, ReadError> {
        let (text, rest) = decode::read_str_from_slice(self.rest)?;
        self.rest = rest;
        Ok(text)
    }

    fn list(&mut self, length: usize) -> Result<(), ReadError> {
        match decode::read_array_len(&mut self.rest)? as usize {
            found if found == length => Ok(()),
            found => Err(ReadError::Wrong(format!("a list of {found} values instead of {length}"))),
        }
    }

    pub(super) fn floats(&mut self, values: &mut [f32]) -> Result<(), ReadError> {
        self.list(values.len())?;
        for value in values {
            *value = decode::read_f32(&mut self.rest)?;
            if !value.is_finite() {
                return Err(ReadError::Wrong("a number is not finite".into()));
            }
        }
        Ok(())
    }

    pub(super) fn integers(&mut self, values: &mut [i32]) -> Result<(), ReadError> {
        self.list(values.len())?;
        values.iter_mut().try_for_each(|value| {
            *value = decode::read_int(&mut self.rest)?;
            Ok(())
        })
    }

    pub(super) fn flags(&mut self, values: &mut [bool]) -> Result<(), ReadError> {
        self.list(values.len())?;
        values.iter_mut().try_for_each(|value| {
            *value = decode::read_bool(&mut self.rest)?;
            Ok(())
        })
    }

    pub(super) fn strings(&mut self, values: &mut [String]) -> Result<(), ReadError> {
        self.list(values.len())?;
        for value in values {
            let text = self.string()?;
            value.clear();
            value.push_str(text);
        }
        Ok(())
    }
}

impl From<ValueReadError> for ReadError {
    fn from(error: ValueReadError) -> ReadError {
        match error {
            ValueReadError::InvalidMarkerRead(io) | ValueReadError::InvalidDataRead(io)
                if io.kind() == ErrorKind::UnexpectedEof =>
            {
                ReadError::Incomplete
            }
            other => ReadError::Wrong(other.to_string()),
        }
    }
}

impl From<NumValueReadError> for ReadError {
    fn from(error: NumValueReadError) -> ReadError {
        match error {
            NumValueReadError::InvalidMarkerRead(io) | NumValueReadError::InvalidDataRead(io)
                if io.kind() == ErrorKind::UnexpectedEof =>
            {
                ReadError::Incomplete
            }
            other => ReadError::Wrong(other.to_string()),
        }
    }
}

impl From<DecodeStringError<'_, BytesReadError>> for ReadError {
    fn from(error: DecodeStringError<'_, BytesReadError>) -> ReadError {
        match error {
            DecodeStringError::InvalidMarkerRead(_)
            | DecodeStringError::InvalidDataRead(_)
            | DecodeStringError::BufferSizeTooSmall(_) => ReadError::Incomplete,
            other => ReadError::Wrong(other.to_string()),
        }
    }
}
