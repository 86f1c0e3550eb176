//! Packets: what is written is read again, what is malformed is an error that says why.
#![allow(clippy::unwrap_used)] // tests may panic

use monas_gamecontroller::{
    Audience, Competition, CompetitionPhase, CompetitionType, ErrorKind, GameControlData, JerseyColour,
    LeaguePhase, LeagueState, MonitorRequest, Penalty, PlayerData, ReturnData, RobotSize, RuleBook, SetPlay,
    TeamData,
};
use proptest::prelude::*;
use proptest::sample::select;

/// The values of a rule book.
fn of<T: Copy + std::fmt::Debug + 'static>(
    rules: RuleBook,
    all: impl Iterator<Item = T>,
    number: fn(T, RuleBook) -> Result<u8, monas_gamecontroller::Error>,
) -> impl Strategy<Value = T> {
    select(all.filter(|value| number(*value, rules).is_ok()).collect::<Vec<_>>())
}

fn player(rules: RuleBook) -> impl Strategy<Value = PlayerData> {
    let penalty = proptest::option::of(of(rules, Penalty::all(), Penalty::number));
    let max = if rules == RuleBook::HumanoidSoccer { u8::MAX } else { 0 };
    (penalty, any::<u8>(), 0..=max, 0..=max).prop_map(|(penalty, seconds_left, warnings, cautions)| {
        PlayerData { penalty, seconds_left, warnings, cautions }
    })
}

fn team(rules: RuleBook) -> impl Strategy<Value = TeamData> {
    let colour = || of(rules, JerseyColour::all(), JerseyColour::number);
    let numbers = (any::<u8>(), 1_u8..=20, any::<u8>(), any::<u8>(), any::<u16>(), any::<u16>());
    let players = proptest::collection::vec(player(rules), 20);
    (numbers, colour(), colour(), players).prop_map(|(numbers, field, keeper, players)| TeamData {
        number: numbers.0,
        field_player_colour: field,
        goalkeeper_colour: keeper,
        goalkeeper: numbers.1,
        score: numbers.2,
        penalty_shot: numbers.3,
        single_shots: numbers.4,
        message_budget: numbers.5,
        players: players.try_into().unwrap(),
    })
}

fn competition(rules: RuleBook) -> BoxedStrategy<Competition> {
    match rules {
        RuleBook::StandardPlatform => {
            let phase = of(rules, CompetitionPhase::all(), CompetitionPhase::number);
            let kind = of(rules, CompetitionType::all(), CompetitionType::number);
            (phase, kind).prop_map(|(phase, kind)| Competition::StandardPlatform { phase, kind }).boxed()
        }
        RuleBook::HumanoidSoccer => (of(rules, RobotSize::all(), RobotSize::number), any::<bool>())
            .prop_map(|(size, is_stopped)| Competition::HumanoidSoccer { size, is_stopped })
            .boxed(),
    }
}

fn control(rules: RuleBook) -> impl Strategy<Value = GameControlData> {
    let phase = of(rules, LeaguePhase::all(), LeaguePhase::number);
    let state = of(rules, LeagueState::all(), LeagueState::number);
    let set_play = proptest::option::of(of(rules, SetPlay::all(), SetPlay::number));
    let numbers = (any::<u8>(), any::<u8>(), any::<i16>(), any::<i16>());
    let choices = (any::<bool>(), any::<bool>(), proptest::option::of(0_u8..255));
    (competition(rules), phase, state, set_play, numbers, choices, team(rules), team(rules)).prop_map(
        |(competition, phase, state, set_play, numbers, choices, left, right)| GameControlData {
            audience: if choices.0 { Audience::Players } else { Audience::Monitors },
            packet_number: numbers.0,
            players_per_team: numbers.1,
            competition,
            phase,
            state,
            set_play,
            is_first_half: choices.1,
            kicking_team: choices.2,
            seconds_left: numbers.2,
            secondary_seconds: numbers.3,
            teams: [left, right],
        },
    )
}

fn report() -> impl Strategy<Value = ReturnData> {
    let length = || -1e6_f32..1e6;
    let ball_age = proptest::option::of(0_f32..1e6);
    let pose = (length(), length(), length());
    (1_u8..=20, any::<u8>(), any::<bool>(), pose, ball_age, (length(), length())).prop_map(
        |(player, team, is_fallen, (x, y, heading), ball_age, (ball_x, ball_y))| ReturnData {
            player,
            team,
            is_fallen,
            pose: [x, y, heading],
            ball_age,
            ball: [ball_x, ball_y],
        },
    )
}

/// Reads a packet as all kinds; one that is accepted is written again, byte by byte the same.
fn read(packet: &[u8]) {
    if let Ok(control) = GameControlData::decode(packet) {
        assert_eq!(control.encode().unwrap(), packet);
    }
    if let Ok(report) = ReturnData::decode(packet) {
        assert_eq!(ReturnData::decode(&report.encode().unwrap()), Ok(report));
    }
    if let Ok(request) = MonitorRequest::decode(packet) {
        assert_eq!(request.encode(), packet);
    }
}

proptest! {
    #[test]
    fn control_data_is_read_as_it_was_written(
        control in select(RuleBook::ALL.to_vec()).prop_flat_map(control)
    ) {
        let packet = control.encode().unwrap();
        prop_assert_eq!(packet.len(), control.competition.rules().packet_length());
        prop_assert_eq!(GameControlData::decode(&packet).unwrap(), control);
    }

    #[test]
    fn return_data_is_read_as_it_was_written(report in report()) {
        let packet = report.encode().unwrap();
        prop_assert_eq!(packet.len(), 32);
        prop_assert_eq!(ReturnData::decode(&packet).unwrap(), report);
    }

    #[test]
    fn random_bytes_do_no_harm(bytes in proptest::collection::vec(any::<u8>(), 0..256)) {
        read(&bytes);
    }

    #[test]
    fn truncated_and_changed_packets_do_no_harm(
        control in select(RuleBook::ALL.to_vec()).prop_flat_map(control),
        length in 0_usize..200,
        at in 0_usize..198,
        byte in any::<u8>(),
    ) {
        let packet = control.encode().unwrap();
        let short = &packet[..length.min(packet.len() - 1)];
        prop_assert_eq!(GameControlData::decode(short).unwrap_err().kind(), ErrorKind::Length);
        let mut changed = packet;
        if let Some(position) = changed.get_mut(at) {
            *position = byte;
        }
        read(&changed);
    }
}

/// A packet of version 18 as the league lays it out: READY, 600 s, team 5 kicks off, and a penalty
/// of player 2 of team 24.
fn version_18() -> Vec<u8> {
    let mut packet = b"RGme\x12\x07\x05\x01\x00\x00\x01\x00\x01\x05\x58\x02\x2d\x00".to_vec();
    let team = |number, colour, penalty| {
        let mut team = vec![number, colour, 7, 1, 3, 0, 0, 0, 0xb0, 0x04];
        team.extend([0, 0, penalty, 45]);
        team.resize(50, 0);
        team
    };
    packet.extend(team(5, 3, 0));
    packet.extend(team(24, 9, 2));
    packet
}

/// A packet of version 19: PLAYING, a throw-in, stopped, and a caution of player 1 of team 7.
fn version_19() -> Vec<u8> {
    let mut packet = b"RGme\x13\xff\x04\x02\x01\x02\x03\x04\x00\xff\xf6\xff\x0a\x00".to_vec();
    let team = |number, penalty| {
        let mut team = vec![number, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        team.extend([penalty, 30, 2, 1]);
        team.resize(90, 0);
        team
    };
    packet.extend(team(7, 8));
    packet.extend(team(8, 0));
    packet
}

#[test]
fn both_layouts_are_those_of_the_league() {
    let control = GameControlData::decode(&version_18()).unwrap();
    let expected =
        Competition::StandardPlatform { phase: CompetitionPhase::PlayOff, kind: CompetitionType::Normal };
    assert_eq!((control.competition, control.packet_number, control.players_per_team), (expected, 7, 5));
    assert_eq!(
        (control.state, control.kicking_team, control.is_first_half),
        (LeagueState::Ready, Some(5), true)
    );
    assert_eq!((control.seconds_left, control.secondary_seconds), (600, 45));
    let team = &control.teams[1];
    assert_eq!((team.number, team.field_player_colour, team.score), (24, JerseyColour::Gray, 3));
    assert_eq!((team.goalkeeper_colour, team.message_budget), (JerseyColour::Purple, 1200));
    let player = team.player(2).unwrap();
    assert_eq!((player.penalty, player.seconds_left), (Some(Penalty::Pushing), 45));

    let control = GameControlData::decode(&version_19()).unwrap();
    assert_eq!(control.competition, Competition::HumanoidSoccer { size: RobotSize::Large, is_stopped: true });
    assert_eq!((control.phase, control.state), (LeaguePhase::ExtraTime, LeagueState::Playing));
    assert_eq!((control.set_play, control.kicking_team), (Some(SetPlay::ThrowIn), None));
    assert_eq!((control.seconds_left, control.is_first_half), (-10, false));
    let player = control.teams[0].players[0];
    let expected = (Some(Penalty::ArmsOrHands), 30, 2, 1);
    assert_eq!((player.penalty, player.seconds_left, player.warnings, player.cautions), expected);
    assert_eq!(control.teams[1].number, 8);
}

#[test]
fn malformed_packets_are_errors_that_say_what_is_wrong() {
    let with = |at: usize, byte: u8| {
        let mut packet = version_18();
        packet[at] = byte;
        packet
    };
    let cases: [(Vec<u8>, ErrorKind, &str); 8] = [
        (with(3, b'X'), ErrorKind::Header, "control data begins with `RGme` or `RGTD`, not `RGmX`"),
        (with(4, 17), ErrorKind::Version, "control data of version 17 is not supported, only 18 and 19"),
        (with(4, 19), ErrorKind::Length, "control data of version 19 has 198 bytes, not 118"),
        (with(10, 9), ErrorKind::Value, "state 9 is not defined in version 18"),
        (with(11, 6), ErrorKind::Value, "set play 6 is not defined in version 18"),
        (with(12, 2), ErrorKind::Value, "the first half is 0 or 1, not 2"),
        (with(21, 0), ErrorKind::Value, "the goalkeeper's number in version 18 is 1 to 20, not 0"),
        (with(28, 13), ErrorKind::Value, "penalty 13 is not defined in version 18"),
    ];
    for (packet, kind, message) in cases {
        let error = GameControlData::decode(&packet).unwrap_err();
        assert_eq!((error.kind(), error.to_string().as_str()), (kind, message));
    }
    let report =
        ReturnData { player: 3, team: 5, is_fallen: false, pose: [0.0; 3], ball_age: None, ball: [0.0; 2] };
    let packet = report.encode().unwrap();
    let cases: [(usize, u8, &str); 4] = [
        (4, 3, "return data of version 3 is not supported, only 4"),
        (5, 21, "a player has a number from 1 to 20, not 21"),
        (7, 2, "fallen is 0 or 1, not 2"),
        (11, 0x7f, "x of the pose is not a number"),
    ];
    for (at, byte, message) in cases {
        let mut packet = packet.clone();
        packet[10] = 0xc0;
        packet[at] = byte;
        assert_eq!(ReturnData::decode(&packet).unwrap_err().to_string(), message);
    }
    assert!(MonitorRequest::decode(b"RGTr\x00").is_ok());
    assert_eq!(MonitorRequest::decode(b"RGTr").unwrap_err().kind(), ErrorKind::Length);
    assert_eq!(MonitorRequest::decode(b"RGTr\x01").unwrap_err().kind(), ErrorKind::Version);
}

#[test]
fn what_a_rule_book_lacks_cannot_be_written() {
    let mut control = GameControlData::new(Competition::of(RuleBook::HumanoidSoccer), [1, 2]);
    control.set_play = Some(SetPlay::KickIn);
    assert_eq!(control.encode().unwrap_err().to_string(), "version 19 has no set play `kick-in`");
    let mut control = GameControlData::new(Competition::default(), [1, 2]);
    control.teams[0].players[0].warnings = 1;
    assert_eq!(control.encode().unwrap_err().kind(), ErrorKind::Value);
}

#[test]
fn a_packet_says_to_each_robot_what_concerns_it() {
    let control = GameControlData::decode(&version_18()).unwrap();
    let own = control.announcement(5, 2).unwrap();
    assert_eq!((own.phase(), own.kick_off, own.penalized), (monas_robot::GamePhase::Ready, true, false));
    assert_eq!(
        (own.goal_to_attack(), own.team_colour()),
        (monas_robot::Colour::Yellow, monas_robot::Colour::Black)
    );
    let other = control.announcement(24, 2).unwrap();
    assert_eq!((other.penalized, other.penalty_left, other.kick_off), (true, 45.0, false));
    assert_eq!(other.goal_to_attack(), monas_robot::Colour::Blue);
    assert_eq!(
        control.announcement(24, 1).unwrap().team_colour(),
        monas_robot::Colour::Purple,
        "the goalkeeper"
    );
    assert_eq!(
        (control.announcement(6, 1), control.announcement(5, 21), control.announcement(5, 0)),
        (None, None, None)
    );
    let stopped = GameControlData::decode(&version_19()).unwrap().announcement(7, 1).unwrap();
    assert_eq!((stopped.halted, stopped.set_play()), (true, monas_robot::SetPlay::ThrowIn));
}

/// Packets captured from the league's program, if a folder `shared` above the workspace has them.
#[test]
fn captured_packets_are_read() {
    let file = |folder: &std::path::Path| folder.join("shared/robots/gamecontroller/packets_v18.json");
    let mut folders = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let Some(text) = folders.find_map(|folder| std::fs::read_to_string(file(folder)).ok()) else { return };
    let packets: Vec<serde_json::Value> = serde_json::from_str(&text).unwrap();
    assert!(packets.len() > 20, "{}", packets.len());
    for packet in packets {
        let hex = packet["hex"].as_str().unwrap();
        let byte = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
        let bytes: Vec<u8> = (0..hex.len()).step_by(2).map(byte).collect();
        match bytes.len() {
            118 => {
                let control = GameControlData::decode(&bytes).unwrap();
                assert_eq!(control.encode().unwrap(), bytes, "{}", packet["name"]);
                let decoded = &packet["decoded"];
                let upper = control.state.to_string().to_uppercase();
                assert_eq!(decoded["state"].as_str(), Some(upper.as_str()), "{}", packet["name"]);
                assert_eq!(decoded["secsRemaining"].as_i64(), Some(control.seconds_left.into()));
                assert_eq!(decoded["teams"][0]["teamNumber"].as_u64(), Some(control.teams[0].number.into()));
                assert_eq!(decoded["teams"][1]["score"].as_u64(), Some(control.teams[1].score.into()));
            }
            // With the address of the robot in front, as monitors get it.
            36 => assert!(ReturnData::decode(&bytes[4..]).is_ok()),
            _ => assert_eq!(ReturnData::decode(&bytes).unwrap().encode().unwrap(), bytes),
        }
    }
}
