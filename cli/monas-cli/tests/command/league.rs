//! `monas run` with the league's GameController, and as one.

use std::net::UdpSocket;
use std::process::{Child, Stdio};

use crate::kit::{Answer, command, given, monas};

#[test]
fn what_cannot_be_combined_is_a_clear_error() {
    let agents = ["run", "config/roles/goalie.xml", "--realtime"];
    let of_match = ["run", "config/match.xml"];
    let cases: [(&[&str], &[&str], &str); 6] = [
        (&of_match, &["--gamecontroller", "127.0.0.1"], "--realtime"),
        (&of_match, &["--referee", "127.0.0.1"], "--realtime"),
        (
            &of_match,
            &["--realtime", "--gamecontroller", "127.0.0.1", "--referee", "127.0.0.1"],
            "cannot be used with",
        ),
        (&of_match, &["--realtime", "--gamecontroller", "field"], "expected an IP address"),
        (&of_match, &["--realtime", "--rules", "hsl"], "--referee"),
        (&agents, &["--referee", "127.0.0.1"], "these agents have no field"),
    ];
    for (run, options, expected) in cases {
        let answer = monas(&[run, options].concat());
        assert_eq!(answer.code, Some(2), "{options:?}: {}", answer.err);
        assert!(answer.err.contains(expected), "{options:?}: {}", answer.err);
    }
}

#[test]
fn an_address_that_is_taken_is_an_error() {
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("its address").to_string();
    let answer = monas(&["run", "config/match.xml", "--realtime", "--gamecontroller", &address]);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    assert!(answer.err.contains(&format!("cannot listen at {address}")), "{}", answer.err);
}

/// The referee of one process decides the match of another, whose robots report.
#[test]
fn the_referee_of_one_process_decides_the_match_of_another() {
    // Ports that were free a moment ago.
    let ports: Vec<UdpSocket> =
        (0..2).map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port")).collect();
    let [control, reports] =
        [0, 1].map(|index: usize| ports[index].local_addr().expect("its address").port().to_string());
    drop(ports);
    let to = format!("127.0.0.1:{control}");
    let arguments = |option: &'static str| {
        let fixed = ["run", "config/match.xml", "--realtime", "--no-control", "--format", "json", option];
        [
            fixed.map(str::to_owned).to_vec(),
            [to.as_str(), "--return-port", &reports].map(str::to_owned).to_vec(),
        ]
        .concat()
    };
    let referee =
        [arguments("--referee"), ["--for", "6s", "--rules", "hsl"].map(str::to_owned).to_vec()].concat();
    let players = [arguments("--gamecontroller"), ["--for", "4s"].map(str::to_owned).to_vec()].concat();
    let run = |arguments: Vec<String>| {
        let mut command = command(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
    };
    let (referee, players) = (run(referee), run(players));
    let answer = |child: Child| Answer::from(child.wait_with_output().expect("it ends"));
    let count = |answer: Answer, key: &str| {
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        let mut objects =
            answer.out.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
        let found = objects.find(|object| object["kind"] == "gamecontroller").expect("the counts of packets");
        assert_eq!(found["refused"], 0, "{found}");
        found[key].as_u64().expect("a number")
    };
    let heard = count(answer(players), "announcements");
    let reported = count(answer(referee), "reports");
    assert!(heard >= 1 && reported >= 6, "{heard} announcements were heard, {reported} reports came");
}

/// A person's decisions, read line by line, decide a match in another process.
#[test]
fn the_decisions_of_a_person_decide_a_match() {
    let ports: Vec<UdpSocket> =
        (0..2).map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port")).collect();
    let [control, reports] =
        [0, 1].map(|index: usize| ports[index].local_addr().expect("its address").port().to_string());
    drop(ports);
    let to = format!("127.0.0.1:{control}");
    let players = ["run", "config/match.xml", "--realtime", "--no-control", "--format", "json"];
    let ports = ["--gamecontroller", &to, "--return-port", &reports, "--for", "9s"];
    let mut players = command(&[&players[..], &ports].concat());
    let players = players.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let referee = ["referee", &to, "--return-port", &reports, "--teams", "1,2", "--players", "3"];
    let script = "ready 1\nwait 1\ngoal 1\nset\nwait 1\nplay\npenalize 2 3 pushing\nwait 3\ngoal 2\nwait 2\n";
    let referee = given(&referee, script);
    assert_eq!(referee.code, Some(1), "a decision was refused: {referee:?}");
    assert_eq!(referee.err.matches("error: ").count(), 1, "{referee:?}");
    assert!(referee.err.contains("error: a goal is scored in PLAYING; the state is READY"), "{referee:?}");
    assert!(
        referee.out.contains("PLAYING, 1 0 : 0 2") && referee.out.contains("3 of 2: pushing"),
        "{referee:?}"
    );
    assert!(referee.out.contains("player 1 of team 1 is online"), "{referee:?}");
    let played = Answer::from(players.wait_with_output().expect("it ends"));
    assert_eq!(played.code, Some(0), "{played:?}");
    let all = crate::running::objects(&played.out);
    let goals: Vec<_> =
        all.iter().filter(|object| object["kind"] == "team").map(|team| &team["goals"]).collect();
    assert_eq!(goals, [0, 1], "{played:?}");
    let said = |text: &str| all.iter().any(|object| object["text"] == text);
    assert!(said("kick-off for Blue") && said("penalty for Red 3: decided by a person"), "{played:?}");
}

/// A game is in the process of its referee alone, which therefore goes on without a network.
#[test]
fn a_referee_whose_packets_cannot_be_sent_goes_on_with_the_game() {
    // No packet can be sent to port 0.
    let referee = ["referee", "127.0.0.1:0", "--return-port", "0", "--teams", "1,2"];
    let answer = given(&referee, "ready 1\nset\nplay\nwait 1\ngoal 1\n");
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert_eq!(answer.err.matches("the decisions cannot be sent").count(), 1, "{answer:?}");
    assert!(answer.out.contains("READY, 1 1 : 0 2"), "{answer:?}");
}

#[test]
fn a_stopped_game_is_shown_as_such() {
    let referee = ["referee", "127.0.0.1:0", "--return-port", "0", "--teams", "1,2", "--rules", "hsl"];
    let answer = given(&referee, "ready 1\nset\nplay\nstop\n");
    assert!(answer.out.contains("PLAYING, stopped, 1 0 : 0 2"), "{answer:?}");
}

#[test]
fn the_number_that_stands_for_no_team_is_refused() {
    let answer = given(&["referee", "127.0.0.1:0", "--return-port", "0", "--teams", "1,255"], "ready 255\n");
    assert_eq!(answer.code, Some(2), "{answer:?}");
    assert!(answer.err.contains("two different numbers from 0 to 254"), "{answer:?}");
}
