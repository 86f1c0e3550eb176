//! A Python client with zenoh and the messages, without Monas.

use std::path::Path;
use std::process::{Command, Stdio};

use monas_link::LinkSettings;

use crate::{COMMAND, End, await_that, pair};

/// `python3`, or the interpreter named by the environment.
fn python() -> Command {
    Command::new(std::env::var_os("MONAS_PYTHON").unwrap_or_else(|| "python3".into()))
}

#[test]
fn a_client_in_python_reads_the_ball_and_commands_the_robot() {
    let packages = python().args(["-c", "import zenoh, google.protobuf"]).output();
    if !packages.is_ok_and(|output| output.status.success()) {
        println!("no python3 with eclipse-zenoh and protobuf: nothing is tested here");
        return;
    }
    let (listening, _) = pair("tcp");
    let settings = LinkSettings { accepts_unlinked: true, ..LinkSettings::default() };
    let settings = settings.sending("soccer/ball").receiving("soccer/command");
    let robot = End::with("robot_1", settings, &listening).unwrap();
    let client = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/client.py");
    let mut client =
        python().arg(client).args([&listening.listen[0], "3"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut reader = robot.hub.blackboard("reader");
    let (mut texts, mut number) = (Vec::new(), 0.0);
    await_that("the commands", || {
        number += 0.5;
        robot.say_ball(number);
        reader.process_messages(robot.now());
        if let Ok(laptop) = robot.hub.host_id("laptop") {
            texts.extend(reader.from(laptop).signals(COMMAND).map(|command| command.message.text.clone()));
        }
        texts.len() >= 3
    });
    assert_eq!(texts, ["kick 0 of laptop", "kick 1 of laptop", "kick 2 of laptop"]);
    assert!(client.wait().unwrap().success());
    let said = std::io::read_to_string(client.stdout.take().unwrap()).unwrap();
    assert!(said.matches("ball of robot_1: ").count() >= 3, "{said}");
    await_that("the report", || robot.received("laptop", "soccer/command").delivered == 3);
    robot.stop();
}
