//! Packets of the GameController: each is read, or is an error that says what is wrong. A packet
//! that is read is written again as the same bytes.

use monas_gamecontroller::{GameControlData, MonitorRequest, ReturnData};

/// Checks the documented guarantees for one input.
pub fn gamecontroller(data: &[u8]) {
    match GameControlData::decode(data) {
        Ok(control) => {
            assert_eq!(control.encode().as_deref(), Ok(data));
            for team in &control.teams {
                for player in 0..=u8::MAX {
                    let is_player = team.player(player).is_some();
                    assert_eq!(control.announcement(team.number, player).is_some(), is_player);
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    if let Ok(report) = ReturnData::decode(data) {
        let written = report.encode().expect("what was read can be written");
        assert_eq!(ReturnData::decode(&written), Ok(report));
    }
    if let Ok(request) = MonitorRequest::decode(data) {
        assert_eq!(&request.encode()[..], data);
    }
}
