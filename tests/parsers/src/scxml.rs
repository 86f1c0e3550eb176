//! SCXML documents: findings are valid, written documents read back and are written identically,
//! and a session of any valid document ends or reports an error.

use std::time::Duration;

use yase::{Source, Timestamp};
use yase_scxml::{NoPlatform, ScxmlEvent, Session};

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn scxml(data: &[u8]) {
    let text = text_of(data);
    let (document, findings) = yase_scxml::read(&Source::new("document", text));
    assert_findings_fit(text, &findings);
    let Some(document) = document else { return assert!(!findings.is_empty()) };
    if let Ok(written) = document.write() {
        let (again, findings) = yase_scxml::read(&Source::new("again", written.as_str()));
        let again = again.unwrap_or_else(|| panic!("{findings:?}\n{written}"));
        assert_eq!(again.write().as_deref(), Ok(written.as_str()));
    }
    match Session::new(&document, NoPlatform) {
        Ok(session) => play(session, text),
        Err(findings) => assert!(!findings.is_empty()),
    }
}

/// Sends some events and advances time; a session that cannot continue reports an error.
fn play(mut session: Session<NoPlatform>, text: &str) {
    if session.start(Timestamp::ZERO).is_err() {
        return;
    }
    for (round, name) in (1..).zip(["e", "ball.near", "whistle", "stop", "error.execution"]) {
        let moment = Timestamp::ZERO + Duration::from_secs(round);
        let next = session.next_deadline().map_or(moment, |deadline| deadline.min(moment));
        if session.send(ScxmlEvent::new(name)).is_err() || session.advance_to(next).is_err() {
            return;
        }
        for state in session.configuration() {
            assert!(session.is_active(state), "{state} in {text}");
        }
    }
}
