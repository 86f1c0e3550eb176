//! Records everything published into MCAP files, with protobuf schemas

mod error;
mod playback;
mod recorder;
mod tape;

pub use error::{Error, ErrorKind};
pub use playback::{Channel, Message, Messages, Recording, read};
pub use tape::Tape;
