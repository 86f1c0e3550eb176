//! A stream that may be closed by its reader.

use std::io::{self, ErrorKind, Write};

/// Drops what is written after the reader has closed the stream.
pub struct UnreadOutput<'a>(pub &'a mut dyn Write);

/// A closed pipe takes everything; other errors remain.
fn unread<T>(done: io::Result<T>, taken: T) -> io::Result<T> {
    match done {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(taken),
        done => done,
    }
}

impl Write for UnreadOutput<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        unread(self.0.write(bytes), bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        unread(self.0.flush(), ())
    }
}
