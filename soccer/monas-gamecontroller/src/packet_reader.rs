//! Reads little-endian numbers from a packet.

use crate::{Error, ErrorKind};

/// A position in a packet.
pub(crate) struct PacketReader<'a> {
    /// The name of the packet, for errors.
    packet: &'static str,
    rest: &'a [u8],
}

impl<'a> PacketReader<'a> {
    /// Begins to read the bytes of a packet.
    pub(crate) fn new(packet: &'static str, bytes: &'a [u8]) -> PacketReader<'a> {
        PacketReader { packet, rest: bytes }
    }

    /// The next bytes.
    pub(crate) fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let Some((bytes, rest)) = self.rest.split_first_chunk() else {
            let message = format!("{} ends before its last field", self.packet);
            return Err(Error::new(ErrorKind::Length, message));
        };
        self.rest = rest;
        Ok(*bytes)
    }

    /// Reads the letters at the beginning and the version after them.
    pub(crate) fn header(&mut self, known: &[[u8; 4]]) -> Result<[u8; 4], Error> {
        let header = self.bytes()?;
        if known.contains(&header) {
            return Ok(header);
        }
        let letters = |header: &[u8]| header.escape_ascii().to_string();
        let known = known.iter().map(|header| format!("`{}`", letters(header))).collect::<Vec<_>>();
        let message =
            format!("{} begins with {}, not `{}`", self.packet, known.join(" or "), letters(&header));
        Err(Error::new(ErrorKind::Header, message))
    }

    pub(crate) fn u8(&mut self) -> Result<u8, Error> {
        self.bytes().map(|[byte]| byte)
    }

    pub(crate) fn u16(&mut self) -> Result<u16, Error> {
        self.bytes().map(u16::from_le_bytes)
    }

    pub(crate) fn i16(&mut self) -> Result<i16, Error> {
        self.bytes().map(i16::from_le_bytes)
    }

    /// A number that is 0 or 1.
    pub(crate) fn bool(&mut self, field: &str) -> Result<bool, Error> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(Error::new(ErrorKind::Value, format!("{field} is 0 or 1, not {other}"))),
        }
    }

    /// A floating-point number; NaN is an error.
    pub(crate) fn f32(&mut self, field: &str) -> Result<f32, Error> {
        let number = f32::from_le_bytes(self.bytes()?);
        match number.is_nan() {
            false => Ok(number),
            true => Err(Error::new(ErrorKind::Value, format!("{field} is not a number"))),
        }
    }
}
