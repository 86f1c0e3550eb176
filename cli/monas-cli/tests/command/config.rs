//! `monas config`: values with their origin, layers of `run`, and the equivalence of TOML and XML.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::kit::{Answer, changed, command, monas, root};

fn show(arguments: &[&str]) -> Answer {
    monas(&[&["config", "show"], arguments].concat())
}

/// The lines of a configuration as objects.
fn objects(arguments: &[&str]) -> Vec<Value> {
    let answer = show(&[arguments, &["--format", "json"]].concat());
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    answer.out.lines().map(|line| serde_json::from_str(line).expect("a line is an object")).collect()
}

fn find<'a>(objects: &'a [Value], path: &str) -> &'a Value {
    objects.iter().find(|object| object["path"] == path).unwrap_or_else(|| panic!("{path} in {objects:#?}"))
}

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("the folder takes folders");
        fs::write(path, text).expect("the folder takes files");
    }
    folder
}

fn at(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

const AGENTS: &str = "<agent thread_frequency=10 priority=1>\n  <name>Motion</name>\n  <activity gait=quick>Unregistered</activity>\n</agent>\n";

#[test]
fn every_value_is_shown_with_its_origin() {
    let robot = "[[agent]]\nname = \"Motion\"\npriority = 4\n";
    let folder = folder(&[("config/agents.xml", AGENTS), ("config/robots/one.toml", robot)]);
    let file = at(folder.path(), "config/agents.xml");
    let answer = show(&[&file, "--robot", "one", "--set", "agent.Motion.frequency=50"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "names of activities are not looked up");
    let lines: Vec<String> =
        answer.out.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    for expected in [
        "agent.Motion.thread_frequency = 50 --set agent.Motion.frequency=50".to_owned(),
        format!("agent.Motion.priority = 4 {}:3:12 (robot)", at(folder.path(), "config/robots/one.toml")),
        "agent.Motion.enable = 1 default".to_owned(),
        format!("agent.Motion.activity.Unregistered.gait = quick {file}:3:18"),
    ] {
        assert!(lines.contains(&expected), "{expected} is not in\n{}", answer.out);
    }
    let check = monas(&["config", "check", &file]);
    assert_eq!(check.code, Some(3));
    assert!(check.err.contains("unknown activity `Unregistered`"), "{}", check.err);
}

#[test]
fn a_match_is_the_same_from_every_folder() {
    let hash_from = |folder: &str, file: &str| {
        let mut run = command(&["run", file, "--for", "2s", "--seed", "3"]);
        let run: Answer = run.current_dir(root().join(folder)).output().expect("the command starts").into();
        assert_eq!(run.code, Some(0), "from `{folder}`: {}", run.err);
        run.out.lines().find(|line| line.starts_with("hash")).expect("a hash").to_owned()
    };
    let hash = hash_from("", "config/match.xml");
    assert_eq!(hash_from("config", "match.xml"), hash);
    assert_eq!(hash_from("config/roles", "../match.xml"), hash);
}

#[test]
fn as_json_each_value_has_its_layer_and_place() {
    let folder = folder(&[("agents.xml", AGENTS)]);
    let file = at(folder.path(), "agents.xml");
    let all = objects(&[&file, "--set", "agent.Motion.priority=7"]);
    let priority = find(&all, "agent.Motion.priority");
    assert_eq!((&priority["value"], &priority["layer"]), (&Value::from("7"), &Value::from("command line")));
    let frequency = find(&all, "agent.Motion.thread_frequency");
    assert_eq!((&frequency["layer"], &frequency["file"]), (&Value::from("file"), &Value::from(file)));
    assert_eq!((frequency["line"].as_u64(), frequency["column"].as_u64()), (Some(1), Some(25)));
    assert_eq!(find(&all, "agent.Motion.on_failure")["layer"], "default");
}

#[test]
fn a_match_is_shown_with_its_robots_field_and_simulator() {
    let all = objects(&["config/match.xml", "--set", "agent.Goalie.priority=5", "--set", "field.length=9"]);
    let goalie = find(&all, "match.team.2.robot.1.agent.Goalie.priority");
    assert_eq!((&goalie["value"], &goalie["layer"]), (&Value::from("5"), &Value::from("command line")));
    assert_eq!(find(&all, "match.team.1.robot.2.agent.Attacker.priority")["value"], "1");
    assert_eq!(find(&all, "match.half")["file"], "config/match.xml");
    assert_eq!(find(&all, "field.length")["layer"], "command line");
    assert_eq!(find(&all, "field.width")["file"], "config/fields/thesis.xml");
    assert_eq!(find(&all, "simulator.physics.ball_radius")["value"], "0.0325");
}

#[test]
fn robot_settings_override_role_settings() {
    let robot = "<robot number=\"2\" role=\"config/roles/attacker.xml\"/>";
    let own = "<robot number=\"2\" role=\"config/roles/attacker.xml\"><agent priority='9'><name>Attacker</name></agent></robot>";
    let (folder, line) = changed("config/match.xml", robot, own);
    let file = at(folder.path(), "config/match.xml");
    let all = objects(&[&file]);
    let priority =
        |robot: &str| find(&all, &format!("match.team.1.robot.{robot}.agent.Attacker.priority")).clone();
    assert_eq!(
        (&priority("2")["value"], &priority("2")["layer"]),
        (&Value::from("9"), &Value::from("robot"))
    );
    assert_eq!(priority("2")["line"].as_u64(), Some(line as u64));
    assert_eq!(priority("3")["value"], "1");
    assert_eq!(monas(&["config", "check", &file]).code, Some(0));
}

#[test]
fn mistakes_end_with_3_and_say_what_would_be_right() {
    for (arguments, expected) in [
        (&["config/match.xml", "--set", "agent.Golie.priority=5"][..], "did you mean `Goalie`?"),
        (
            &["config/match.xml", "--set", "match.team.1.robot.9.agent.Goalie.priority=5"],
            "there is no `robot` `9`",
        ),
        (&["config/match.xml", "--set", "match.haf=3s"], "did you mean `half`?"),
        (&["config/match.xml", "--set", "agent"], "a path, `=` and a value"),
        (&["config/roles/goalie.xml", "--robot", "unknown"], "robots/unknown.toml"),
        (&["config/mach.xml"], "did you mean `config/match.xml`?"),
    ] {
        for command in ["show", "check"] {
            let answer = monas(&[&["config", command], arguments].concat());
            assert_eq!(answer.code, Some(3), "{command} {arguments:?}\n{}", answer.out);
            assert!(answer.err.contains(expected), "{command} {arguments:?}\n{}", answer.err);
        }
    }
    let run = monas(&["run", "config/match.xml", "--robot", "one"]);
    assert_eq!(run.code, Some(2), "{}", run.err);
}

fn hash(answer: &Answer) -> String {
    let line = answer.out.lines().find(|line| line.starts_with("hash: "));
    line.unwrap_or_else(|| panic!("no hash in {answer:?}")).to_owned()
}

#[test]
fn a_run_goes_by_its_settings_and_its_tape_knows_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = at(folder.path(), "t.mcap");
    let run = |more: &[&str]| {
        let all = [&["run", "config/match.xml", "--for", "4s", "--no-control"], more].concat();
        let answer = monas(&all);
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        hash(&answer)
    };
    let slow = ["--set", "simulator.rules.ready_duration=1"];
    let plain = run(&[]);
    assert_ne!(run(&[&slow[..], &["--record", &tape]].concat()), plain);
    assert_eq!(run(&["--set", "simulator.rules.ready_duration=3"]), plain, "the value that holds anyway");
    let replay = monas(&["tape", "replay", &tape, "--verify"]);
    assert_eq!(replay.code, Some(0), "{}{}", replay.out, replay.err);
    let info = monas(&["tape", "info", &tape]);
    assert!(info.out.contains("simulator.rules.ready_duration=1"), "{}", info.out);
}

/// config/match.xml and the files that it names.
const MATCH: [(&str, &str); 4] = [
    (
        "config/match.toml",
        "[match]\nfield = \"config/fields/thesis.toml\"\nsimulator = \"config/simulator.toml\"\nhalf = \"300s\"\n\n\
         [[match.team]]\nnumber = 1\nname = \"Blue\"\ncolour = \"blue\"\nside = \"left\"\nrobot = [\n\
         { number = 1, role = \"config/roles/goalie.toml\" },\n{ number = 2, role = \"config/roles/attacker.xml\" },\n\
         { number = 3, role = \"config/roles/attacker.xml\" },\n]\n\n\
         [[match.team]]\nnumber = 2\nname = \"Red\"\ncolour = \"red\"\nside = \"right\"\n\n\
         [[match.team.robot]]\nnumber = 1\nrole = \"config/roles/goalie.toml\"\n[[match.team.robot]]\nnumber = 2\nrole = \"config/roles/attacker.xml\"\n\
         [[match.team.robot]]\nnumber = 3\nrole = \"config/roles/attacker.xml\"\n",
    ),
    (
        "config/fields/thesis.toml",
        "[field]\nlength = 6.0\nwidth = 4.0\nborder = 0.7\ngoal_width = 1.4\ngoal_height = 0.8\npost_radius = 0.05\n\
         goal_area_depth = 0.6\ngoal_area_width = 2.2\ncentre_circle_radius = 0.6\nmark_distance = 1.2\n",
    ),
    (
        "config/simulator.toml",
        "[simulator.physics]\nrobot_radius = 0.13\n[simulator.rules]\nhalf_duration = 300\n",
    ),
    (
        "config/roles/goalie.toml",
        "[[agent]]\nis_real_time = false\npriority = 1\nname = \"Goalie\"\nstatechart = \"models/goalie.srm\"\n",
    ),
];

#[test]
fn a_match_in_toml_is_the_match_in_xml() {
    let (folder, _) = changed("config/match.xml", "Blue", "Blue");
    for (name, text) in MATCH {
        fs::write(folder.path().join(name), text).expect("the folder takes files");
    }
    let play = |name: &str| {
        let answer = monas(&["run", &at(folder.path(), name), "--for", "3s", "--no-control", "--seed", "7"]);
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        hash(&answer)
    };
    assert_eq!(play("config/match.toml"), play("config/match.xml"));
    let values = |name: &str| {
        let mut values: Vec<(String, String)> = objects(&[&at(folder.path(), name)])
            .into_iter()
            .map(|object| {
                (
                    object["path"].to_string(),
                    object["value"].to_string().replace("false", "0").replace(".0\"", "\""),
                )
            })
            .filter(|(path, value)| {
                let is_of_file =
                    ["role", "match.field", "match.simulator"].iter().any(|it| path.contains(it));
                !is_of_file && value != "null"
            })
            .collect();
        values.sort();
        values
    };
    assert_eq!(values("config/match.toml"), values("config/match.xml"));
}

#[test]
fn shipped_configurations_are_valid() {
    for name in [
        "config/match.xml",
        "config/match_generated.xml",
        "config/elsewhere/match.xml",
        "config/elsewhere/vision.xml",
        "config/simulator.xml",
    ] {
        let answer = show(&[name]);
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "{name}");
        assert!(answer.out.lines().count() > 5, "{name}: {}", answer.out);
    }
    assert!(root().join("config/simulator.xml").is_file());
}

#[test]
fn without_vision_nothing_publishes_the_ball_and_both_checks_say_so() {
    let model = fs::read_to_string(root().join("models/goalie.srm")).expect("the role");
    let lines =
        model.lines().filter(|line| !line.starts_with("START -> Vision") && !line.starts_with("Vision ->"));
    let model = lines.collect::<Vec<_>>().join("\n").replace("Sensorsω || Visionω || ", "Sensorsω || ");
    assert!(!model.contains("Vision"), "{model}");
    let role = fs::read_to_string(root().join("config/roles/goalie.xml")).expect("the agents of the role");
    let folder = folder(&[("goalie.xml", &role), ("models/goalie.srm", &model)]);
    let agents = at(folder.path(), "goalie.xml");

    let check = monas(&["config", "check", &agents]);
    assert_eq!(check.code, Some(0), "{}", check.err);
    let expected = "warning[E0369]: `models/goalie.srm` reads `soccer/ball`, but no agent here publishes it";
    assert!(check.err.contains(expected), "{}", check.err);
    assert!(check.err.contains("let an agent run one of `Vision`"), "{}", check.err);
    // Without exploring the states, of which this is not a finding.
    let names = |model: &str| monas(&["model", "check", model, "--all", "--states", "0"]);
    let check = names(&at(folder.path(), "models/goalie.srm"));
    let expected = "information[M17]: `soccer/ball` is read here, but no activity of this chart publishes it";
    assert!(check.err.contains(expected), "{}", check.err);

    let whole = monas(&["config", "check", &root().join("config/roles/goalie.xml").display().to_string()]);
    assert!(!whole.err.contains("E0369"), "{}", whole.err);
    let whole = names("models/goalie.srm");
    assert!(!whole.err.contains("M17"), "{}", whole.err);

    // Another agent of the robot may run it.
    let other =
        "<agent thread_frequency=\"5\"><name>Eyes</name><activity>Vision</activity></agent>\n</agents>";
    fs::write(&agents, role.replace("</agents>", other)).expect("a file");
    let check = monas(&["config", "check", &agents]);
    assert!(!check.err.contains("E0369"), "{}", check.err);
}

#[test]
fn what_a_body_cannot_do_is_said_with_the_activities_that_rely_on_it() {
    for attacker in ["config/rcsssmj.xml", "config/rcsssmj_k1.xml"] {
        let check = monas(&["config", "check", attacker]);
        assert_eq!(check.code, Some(0), "{}", check.err);
        assert!(!check.err.contains("Kick"), "{}", check.err);
        // No activity of the role dives, and none reads the sonar.
        assert!(!check.err.contains("without a motion") && !check.err.contains("sonar"), "{}", check.err);
    }

    let check = monas(&["config", "check", "config/rcsssmj_goalie.xml"]);
    assert_eq!(check.code, Some(0), "{}", check.err);
    let dive =
        "information[E0370]: body `rcsssmj`: the skill is over at once, without a motion; this concerns ";
    assert!(check.err.contains(dive) && check.err.contains("Dive"), "{}", check.err);

    // In a match the world stands in for what the Nao's interface lacks.
    let naos = monas(&["config", "check", "config/nao_sim.xml"]);
    assert_eq!((naos.code, naos.err.as_str()), (Some(0), ""));
    let role = fs::read_to_string(root().join("config/roles/goalie.xml")).expect("the agents of the role");
    let with_body =
        |body: &str| role.replace("<agents>", &format!("<agents>\n  <body kind=\"nao\" {body}/>"));
    let cameras = "vision=\"images\" camera_top=\"/dev/null\" camera_bottom=\"/nowhere/camera\"";
    let (role, seeing) = (with_body(""), with_body(cameras));
    let model = fs::read_to_string(root().join("models/goalie.srm")).expect("the role");
    let folder = folder(&[("goalie.xml", &role), ("seeing.xml", &seeing), ("models/goalie.srm", &model)]);
    let alone = monas(&["config", "check", &at(folder.path(), "goalie.xml")]);
    let blind = "body `nao`: the robot sees nothing: its cameras deliver images, with `vision=\"images\"`; this concerns `Vision` of Goalie";
    assert!(alone.err.contains(blind), "{}", alone.err);
    // Cameras that are missing on this computer are not errors of the configuration.
    let seeing = monas(&["config", "check", &at(folder.path(), "seeing.xml")]);
    assert_eq!(seeing.code, Some(0), "{}", seeing.err);
    for missing in [
        "upper camera, see the option `camera_top`: `/dev/null`: it is not a camera of Video4Linux; this",
        "lower camera, see the option `camera_bottom`: there is no `/nowhere/camera`; this concerns `Vision`",
    ] {
        assert!(seeing.err.contains(missing), "{}", seeing.err);
    }
}

#[test]
fn files_of_poses_are_checked_before_a_run() {
    let body =
        "<agents>\n  <body kind=\"nao\" kick=\"kick.xml\" dive=\"dive.toml\" fall=\"kik.xml\"/>\n</agents>\n";
    let kick = "<poses>\n  <pose LKneePich=\"1\"/>\n</poses>\n";
    let dive = "[[pose]]\nLHipRoll = 0.1\n[[pose]]\nduration = 0.1\nLHipRoll = 0.6\n";
    let folder = folder(&[("agents.xml", body), ("kick.xml", kick), ("dive.toml", dive)]);
    let check = monas(&["config", "check", &at(folder.path(), "agents.xml")]);
    assert_eq!(check.code, Some(3), "{}", check.err);
    for expected in [
        "error[E0304]: unknown attribute `LKneePich` of `pose`",
        "kick.xml:2:9",
        "did you mean `LKneePitch`?",
        "warning[E0371]: `LHipRoll` turns by 0.50 rad in 0.1 s, its motor by 4.16 rad/s at most",
        "dive.toml:5:12",
        "error[E0316]: no file `kik.xml`",
    ] {
        assert!(check.err.contains(expected), "{expected} is not in\n{}", check.err);
    }
}

#[test]
fn the_kick_of_a_file_moves_the_joints_and_behaviours_learn_its_result() {
    let poses = "<poses>\n  <pose duration=\"0.4\" RShoulderPitch=\"-0.5\"/>\n  <pose duration=\"0.4\" RShoulderPitch=\"1.5\"/>\n</poses>\n";
    let folder = folder(&[("greeting.xml", poses)]);
    let (kick, tape) = (at(folder.path(), "greeting.xml"), at(folder.path(), "kick.mcap"));
    let mut run = vec!["run", "config/nao_sim.xml", "--seed", "9", "--for", "15s", "--record", &tape];
    let body = format!("match.team.1.robot.2.body.kick={kick}");
    let phases = ["initial", "ready", "set"].map(|phase| format!("simulator.rules.{phase}_duration=0"));
    run.extend(phases.iter().chain([&body]).flat_map(|setting| ["--set", setting]));
    let run = monas(&run);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let exported = |topic: &str| -> Vec<Value> {
        let answer = monas(&["tape", "export", &tape, "--topic", topic, "--host", "blue-2"]);
        answer.out.lines().map(|line| serde_json::from_str(line).expect("a line is an object")).collect()
    };
    let result = exported("soccer/motion_state").into_iter().find(|it| it["message"]["done"] == 1);
    let result = result.expect("a kick has ended");
    assert_eq!(result["message"]["result"], "PERFORMED");
    // Shoulder pitch of the left and the right arm; a walk keeps both at 1.5.
    let is_up =
        |joints: &Value| [2, 18].iter().any(|&it| joints["message"]["positions"][it].as_f64() < Some(-0.4));
    let waved = exported("body/joints").into_iter().find(is_up).expect("an arm has been up");
    let between = result["seconds"].as_f64().zip(waved["seconds"].as_f64()).map(|(end, up)| end - up);
    assert!(between.is_some_and(|seconds| (0.2..1.0).contains(&seconds)), "{between:?}");
}

#[test]
fn physics_that_contradict_themselves_are_found_in_their_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let physics = "<simulator>\n<physics><kick_strike>5</kick_strike></physics></simulator>\n";
    fs::write(folder.path().join("simulator.xml"), physics).expect("a file");
    let game = folder.path().join("match.xml");
    fs::write(&game, "<match simulator=\"simulator.xml\"/>\n").expect("a file");
    let answer = monas(&["config", "check", &game.to_string_lossy()]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(answer.err.contains("error[E0405]: a kick strikes after it has ended"), "{answer:?}");
    assert!(answer.err.contains("simulator.xml:2:2"), "{answer:?}");
}

#[test]
fn two_files_of_overrides_for_one_robot_are_refused() {
    let files = [("agents.xml", AGENTS), ("robots/one.xml", ""), ("robots/one.toml", "")];
    let folder = folder(&files);
    let config = at(folder.path(), "agents.xml");
    for command in [&["config", "check"][..], &["run"]] {
        let answer = monas(&[command, &[&config, "--robot", "one"]].concat());
        assert_eq!(answer.code, Some(3), "{answer:?}");
        for file in ["robots/one.xml", "robots/one.toml"] {
            assert!(answer.err.contains(&format!("`{}`", at(folder.path(), file))), "{answer:?}");
        }
    }
}

#[test]
fn a_tape_is_replayed_with_the_overrides_of_its_robot() {
    let agent = |name: &str| {
        format!("<agent frequency=\"20\"><name>{name}</name><activity>LedHandler</activity></agent>\n")
    };
    let own = agent("More");
    let folder = folder(&[("config/agents.xml", &agent("Lights")), ("robots/one.xml", &own)]);
    let (config, tape) = (at(folder.path(), "config/agents.xml"), at(folder.path(), "run.mcap"));
    let run = ["run", &config, "--robot", "one", "--for", "300ms", "--no-control", "--record", &tape];
    let recorded = monas(&run);
    assert_eq!(recorded.code, Some(0), "{recorded:?}");
    fs::remove_dir_all(folder.path().join("robots")).expect("the overrides are on the tape, too");
    let verified = monas(&["tape", "verify", &tape]);
    assert_eq!(verified.code, Some(0), "{verified:?}");
    assert!(verified.out.contains(" of 2 agents replayed"), "{verified:?}");
}
