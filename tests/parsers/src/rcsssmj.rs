//! Messages of the soccer simulation server: each is read, or is an error that says what is wrong.

use monas_rcsssmj::T1;
use monas_rcsssmj::expression::Items;
use monas_rcsssmj::frame::FrameReader;
use monas_rcsssmj::monitor::MonitoredGame;
use monas_rcsssmj::percept::Percept;

/// Checks the documented guarantees for one input.
pub fn rcsssmj(data: &[u8]) {
    let balanced = Items::of(data).is_ok();
    match Percept::default().decode(data, &T1) {
        Ok(()) => assert!(balanced),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    let _ = MonitoredGame::default().decode(data);
    let mut frames = FrameReader::default();
    for part in data.chunks(7) {
        frames.push(part);
        while let Ok(Some(message)) = frames.next_message() {
            assert!(message.len() <= data.len());
        }
    }
}
