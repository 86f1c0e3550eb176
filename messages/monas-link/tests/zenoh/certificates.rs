//! A host without a certificate of the team is rejected, and one with a certificate publishes under
//! its own name only.

use std::path::{Path, PathBuf};

use monas_link::example::Command;
use monas_link::{AccessList, ErrorKind, LinkSettings, Tls, ZenohSettings};
use zenoh::Wait;
use zenoh::qos::CongestionControl;

use crate::{COMMAND, End, await_that, everything, pair, program};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/zenoh/tls").join(name)
}

fn tls(name: &str) -> Option<Tls> {
    let (certificate, key) = (file(&format!("{name}.pem")), file(&format!("{name}.key")));
    Some(Tls { authority: file("team.pem"), certificate, key })
}

/// Host `robot_1` of the team listens: `second` is received, and the other one is not.
fn only_the_team_is_heard(stranger: &str, settings: impl FnOnce(ZenohSettings) -> ZenohSettings) {
    let (listening, connecting) = pair("tls");
    let first = End::new("robot_1", &ZenohSettings { tls: tls("robot_1"), ..listening });
    first.say_ball(1.5);
    let stranger_end = End::new(stranger, &settings(connecting.clone()));
    stranger_end.say_ball(9.0);
    let second = End::new("robot_2", &ZenohSettings { tls: tls("robot_2"), ..connecting });
    second.say_ball(2.5);
    await_that("the ball", || second.ball_of("robot_1") == Some(1.5));
    await_that("the ball there", || first.ball_of("robot_2") == Some(2.5));
    assert_eq!(stranger_end.ball_of("robot_1"), None);
    assert_eq!(first.ball_of(stranger), None);
    assert!(!first.knows(stranger) && !stranger_end.knows("robot_1"));
}

#[test]
fn peers_with_certificates_of_other_authorities_are_rejected() {
    only_the_team_is_heard("stranger", |connecting| ZenohSettings { tls: tls("stranger"), ..connecting });
}

#[test]
fn peers_with_expired_certificates_are_rejected() {
    only_the_team_is_heard("robot_4", |connecting| ZenohSettings { tls: tls("expired"), ..connecting });
}

#[test]
fn peers_without_certificates_are_rejected() {
    only_the_team_is_heard("unknown", |connecting| {
        let mut config = connecting;
        config.connect[0] = config.connect[0].replace("tls/", "tcp/");
        config
    });
}

#[test]
fn listeners_with_invalid_certificates_are_rejected() {
    for wrong in ["stranger", "expired"] {
        let (listening, connecting) = pair("tls");
        let own = pair("tls").0;
        let impostor = End::new("robot_1", &ZenohSettings { tls: tls(wrong), ..listening });
        impostor.say_ball(9.0);
        let connect = [connecting.connect, own.listen.clone()].concat();
        let second =
            End::new("robot_2", &ZenohSettings { connect, tls: tls("robot_2"), ..ZenohSettings::default() });
        let third = End::new("robot_3", &ZenohSettings { tls: tls("robot_1"), ..own });
        third.say_ball(3.0);
        await_that("the ball of the true one", || second.ball_of("robot_3") == Some(3.0));
        assert_eq!(second.ball_of("robot_1"), None, "{wrong}");
        assert!(!second.knows("robot_1") && !impostor.knows("robot_2"), "{wrong}");
    }
}

#[test]
fn a_certificate_that_cannot_be_used_is_an_error_that_names_it() {
    let swapped =
        Tls { authority: file("team.pem"), certificate: file("robot_1.key"), key: file("robot_1.pem") };
    for (tls, named) in
        [(tls("robot_9"), "robot_9.pem"), (Some(swapped), "robot_1.key: holds no certificate")]
    {
        for settings in <[ZenohSettings; 2]>::from(pair("tls")) {
            let settings = ZenohSettings { tls: tls.clone(), ..settings };
            let error = End::with("robot_9", LinkSettings::default(), &settings).err().unwrap();
            assert_eq!(error.kind(), ErrorKind::File);
            assert!(error.to_string().contains(named), "{error}");
        }
    }
}

#[test]
fn peers_that_withhold_their_certificate_are_rejected() {
    let (listening, connecting) = pair("tls");
    let _first = End::new("robot_1", &ZenohSettings { tls: tls("robot_1"), ..listening });
    // Knows the authority, and has no key.
    let refused = program(&ZenohSettings { tls: tls("robot_9"), ..connecting.clone() });
    let taken = program(&ZenohSettings { tls: tls("laptop"), ..connecting });
    assert!(refused.is_err());
    assert!(taken.is_ok());
}

#[test]
fn a_host_publishes_under_its_own_name_only_and_what_it_may() {
    let (listening, connecting) = pair("tls");
    let (access, errors) =
        AccessList::parse("robot_1 publish **\nrobot_2 publish soccer/ball\nlaptop publish soccer/command");
    assert_eq!(errors, []);
    let settings = LinkSettings { access, accepts_unlinked: true, ..everything() };
    let first = End::with("robot_1", settings, &ZenohSettings { tls: tls("robot_1"), ..listening }).unwrap();
    let second = End::new("robot_2", &ZenohSettings { tls: tls("robot_2"), ..connecting.clone() });
    await_that("the introductions", || first.knows("robot_2") && second.knows("robot_1"));
    second.hub.publisher(COMMAND, "coach").unwrap().publish(Command::default(), second.now());
    second.say_ball(1.0);
    await_that("the ball", || first.ball_of("robot_2") == Some(1.0));

    // Has a certificate of the team, and claims the names of others.
    let laptop = program(&ZenohSettings { tls: tls("laptop"), ..connecting }).unwrap();
    let put = |key: &str| {
        laptop.put(key, Vec::<u8>::new()).congestion_control(CongestionControl::Block).wait().unwrap()
    };
    for key in ["robot_2/m/soccer/ball", "robot_3/m/soccer/ball", "laptop/m/soccer/ball", "robot_2/c"] {
        put(&format!("monas/{key}"));
    }
    put("monas/laptop/m/soccer/command");
    await_that("what it may say", || first.received("laptop", "soccer/command").delivered == 1);
    let report = first.stop();
    assert_eq!((report.counters.malformed, report.counters.foreign), (0, 0));
    let arrived: Vec<(&str, &str, u64)> = report
        .counters
        .received
        .iter()
        .map(|one| (&*one.0, &*one.1, one.2.arrived))
        .filter(|one| one.2 > 0)
        .collect();
    assert_eq!(arrived, [("laptop", "soccer/command", 1), ("robot_2", "soccer/ball", 1)]);
}
