//! The records of the MCAP format that a tape uses.
//!
//! A file is a magic number, records, and the magic number again; a record is a kind (one byte), a
//! length (eight bytes) and a body. Numbers are little endian, strings and lists are prefixed with
//! their length. The specification is at <https://mcap.dev/spec>. Lengths are not trusted: a record
//! longer than its container is not read.

/// The magic number at both ends of a file.
pub(crate) const MAGIC: &[u8] = &[0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n'];

/// Kinds of record.
pub(crate) const SCHEMA: u8 = 0x03;
pub(crate) const CHANNEL: u8 = 0x04;
pub(crate) const MESSAGE: u8 = 0x05;
pub(crate) const CHUNK: u8 = 0x06;
pub(crate) const ATTACHMENT: u8 = 0x09;
pub(crate) const METADATA: u8 = 0x0c;
pub(crate) const DATA_END: u8 = 0x0f;

/// A cursor over bytes.
#[derive(Clone, Copy, Default)]
pub(crate) struct Bytes<'a>(pub(crate) &'a [u8]);

/// A record, possibly truncated.
pub(crate) struct Record<'a> {
    pub(crate) kind: u8,
    pub(crate) body: Bytes<'a>,
    pub(crate) is_whole: bool,
}

/// A message type.
pub(crate) struct SchemaRecord<'a> {
    pub(crate) id: u16,
    pub(crate) name: &'a str,
    pub(crate) encoding: &'a str,
    pub(crate) data: &'a [u8],
}

/// A stream of messages.
pub(crate) struct ChannelRecord<'a> {
    pub(crate) id: u16,
    pub(crate) schema: u16,
    pub(crate) topic: &'a str,
    pub(crate) encoding: &'a str,
    /// [Pairs](Bytes::pairs) of a name and a value.
    pub(crate) facts: Bytes<'a>,
}

/// An attachment.
pub(crate) struct AttachmentRecord<'a> {
    pub(crate) name: &'a str,
    pub(crate) media_type: &'a str,
    pub(crate) data: &'a [u8],
    /// The bytes that the checksum covers: all fields before it.
    pub(crate) checked: &'a [u8],
    /// CRC-32; 0 if there is none.
    pub(crate) crc: u32,
}

/// A message.
pub(crate) struct MessageRecord<'a> {
    pub(crate) channel: u16,
    pub(crate) sequence: u32,
    pub(crate) log_time: u64,
    pub(crate) publish_time: u64,
    pub(crate) data: &'a [u8],
}

/// A chunk: a group of records.
pub(crate) struct Chunk<'a> {
    /// CRC-32 of the records; 0 if there is none.
    pub(crate) crc: u32,
    pub(crate) compression: &'a str,
    /// The records as far as they are present, and whether they are complete.
    pub(crate) records: &'a [u8],
    pub(crate) is_whole: bool,
}

impl<'a> Bytes<'a> {
    /// The next `count` bytes, if there are that many.
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const SIZE: usize>(&mut self) -> Option<[u8; SIZE]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Length-prefixed bytes.
    fn block(&mut self) -> Option<&'a [u8]> {
        let length = self.u32()?;
        self.take(usize::try_from(length).ok()?)
    }

    fn text(&mut self) -> Option<&'a str> {
        str::from_utf8(self.block()?).ok()
    }

    /// The next `count` bytes as far as they are present, and whether they are complete.
    fn take_up_to(&mut self, count: u64) -> (&'a [u8], bool) {
        let present = self.0.len().min(usize::try_from(count).unwrap_or(usize::MAX));
        let (taken, rest) = self.0.split_at(present);
        self.0 = rest;
        (taken, present as u64 == count)
    }

    /// The next record; `None` at the end, or if kind and length are truncated.
    pub(crate) fn record(&mut self) -> Option<Record<'a>> {
        let [kind] = self.array()?;
        let length = self.u64()?;
        let (body, is_whole) = self.take_up_to(length);
        Some(Record { kind, body: Bytes(body), is_whole })
    }

    pub(crate) fn schema(mut self) -> Option<SchemaRecord<'a>> {
        let (id, name, encoding) = (self.u16()?, self.text()?, self.text()?);
        Some(SchemaRecord { id, name, encoding, data: self.block()? })
    }

    pub(crate) fn channel(mut self) -> Option<ChannelRecord<'a>> {
        let (id, schema, topic, encoding) = (self.u16()?, self.u16()?, self.text()?, self.text()?);
        Some(ChannelRecord { id, schema, topic, encoding, facts: Bytes(self.block()?) })
    }

    /// The name of a metadata entry, and its content as [`pairs`](Bytes::pairs).
    pub(crate) fn metadata(mut self) -> Option<(&'a str, Bytes<'a>)> {
        Some((self.text()?, Bytes(self.block()?)))
    }

    pub(crate) fn attachment(mut self) -> Option<AttachmentRecord<'a>> {
        let all = self.0;
        let (_logged, _created) = (self.u64()?, self.u64()?);
        let (name, media_type, length) = (self.text()?, self.text()?, self.u64()?);
        let data = self.take(usize::try_from(length).ok()?)?;
        let checked = all.get(..all.len() - self.0.len())?;
        Some(AttachmentRecord { name, media_type, data, checked, crc: self.u32()? })
    }

    /// Pairs of strings, as far as they are complete.
    pub(crate) fn pairs(mut self) -> impl Iterator<Item = (&'a str, &'a str)> {
        std::iter::from_fn(move || Some((self.text()?, self.text()?)))
    }

    pub(crate) fn message(mut self) -> Option<MessageRecord<'a>> {
        let (channel, sequence) = (self.u16()?, self.u32()?);
        let (log_time, publish_time) = (self.u64()?, self.u64()?);
        Some(MessageRecord { channel, sequence, log_time, publish_time, data: self.0 })
    }

    pub(crate) fn chunk(mut self) -> Option<Chunk<'a>> {
        let (_start, _end, _size) = (self.u64()?, self.u64()?, self.u64()?);
        let (crc, compression, length) = (self.u32()?, self.text()?, self.u64()?);
        let (records, is_whole) = self.take_up_to(length);
        Some(Chunk { crc, compression, records, is_whole })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_not_trusted() {
        assert!(Bytes(&[0xff, 0xff, 0xff, 0xff, b'a']).text().is_none());
        let mut record = vec![CHUNK];
        record.extend(u64::MAX.to_le_bytes());
        record.extend(b"abc");
        let record = Bytes(&record).record().unwrap();
        assert_eq!((record.kind, record.body.0, record.is_whole), (CHUNK, &b"abc"[..], false));
    }
}
