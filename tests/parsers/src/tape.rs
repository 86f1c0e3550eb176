//! Tapes: arbitrary bytes, and a valid tape with changed bytes or a missing end.

use std::io::{self, Write};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use monas_robot::{Announcement, Sensors, topics};
use monas_tape::{Decoder, Recording, RecordingItem, Tape};
use narukom::{Hub, Timestamp};

static WHOLE: LazyLock<Vec<u8>> = LazyLock::new(|| recorded().expect("a tape is recorded in memory"));

/// Checks the documented guarantees for one input.
pub fn tape(data: &[u8]) {
    read(data.to_vec());
    let messages = read(damaged(data));
    assert!(!data.is_empty() || messages == 2 * MESSAGES_PER_TOPIC, "{messages} messages of the whole tape");
}

/// Reads all records, decodes messages where possible, and returns the number of messages before
/// the first error.
fn read(bytes: Vec<u8>) -> usize {
    let recording = Recording::from_bytes(bytes);
    let Ok(overview) = recording.overview() else { return 0 };
    assert!(overview.bytes == recording.size());
    let mut decoder = Decoder::new();
    for content in recording.contents().into_iter().flatten() {
        if let Ok(RecordingItem::Message(message)) = content
            && let Ok(value) = decoder.decode(&message.channel, message.bytes)
        {
            assert!(value.differences(&value).is_empty());
        }
    }
    recording.messages().map_or(0, |messages| messages.map_while(Result::ok).count())
}

/// The tape after some edits: two bytes are the position, the third is the new value. Two remaining
/// bytes are the length.
fn damaged(edits: &[u8]) -> Vec<u8> {
    let mut bytes = WHOLE.clone();
    let length = bytes.len();
    let place = |low: u8, high: u8| usize::from(u16::from_le_bytes([low, high])) % length;
    let chunks = edits.chunks_exact(3);
    let rest = chunks.remainder();
    for edit in chunks {
        bytes[place(edit[0], edit[1])] = edit[2];
    }
    if let [low, high] = rest {
        bytes.truncate(place(*low, *high));
    }
    bytes
}

/// Number of messages on each topic.
const MESSAGES_PER_TOPIC: usize = 8;

/// A tape of messages on two topics.
fn recorded() -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let memory = Memory::default();
    let tape = Tape::to_writer(memory.clone())?;
    let hub = Hub::with_linked_topics("robot")?;
    hub.observe(Box::new(tape.clone()));
    let mut referee = hub.publisher(topics::ANNOUNCEMENT, "referee")?;
    let mut body = hub.publisher(topics::SENSORS, "body")?;
    for number in 0..MESSAGES_PER_TOPIC as u64 {
        let now = Timestamp::from_nanos(400_000_000 * number);
        referee.publish(Announcement { team: 3, seconds_left: 600.0, ..Announcement::default() }, now);
        body.publish(Sensors { head_yaw: 0.5, ..Sensors::default() }, now);
    }
    tape.finish()?;
    Ok(memory.bytes())
}

/// A file in memory.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl Memory {
    fn bytes(&self) -> Vec<u8> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
