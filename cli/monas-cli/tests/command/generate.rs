//! `monas generate`: the files it writes and those it leaves alone; matches do not change.

use std::fs;
use std::path::Path;

use crate::copying::copy;
use crate::kit::{changed, monas, root};

/// A copy of the parts of the project that a generated crate is linked into.
pub(crate) fn project() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for part in ["models", "statecharts"] {
        copy(&root().join(part), &folder.path().join(part));
    }
    fs::create_dir_all(folder.path().join("cli/monas-cli/src")).expect("the folder takes folders");
    let files =
        ["Cargo.toml", "rustfmt.toml", "cli/monas-cli/Cargo.toml", "cli/monas-cli/src/main.rs", LINKS];
    for file in files {
        fs::copy(root().join(file), folder.path().join(file)).expect("the folder takes files");
    }
    folder
}

const LINKS: &str = "cli/monas-cli/src/statecharts.rs";

fn read(folder: &Path, file: &str) -> String {
    fs::read_to_string(folder.join(file)).expect("the file is there")
}

fn generate(folder: &Path, model: &str) -> (Option<i32>, String, String) {
    let answer = monas(&["generate", &folder.join(model).display().to_string()]);
    (answer.code, answer.out, answer.err)
}

#[test]
fn a_match_with_generated_charts_has_the_hash_of_one_with_interpreted_ones() {
    let hash = |file| {
        let answer = monas(&["run", file, "--seed", "7", "--for", "15s"]);
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        let line = answer.out.lines().find(|line| line.starts_with("hash: ")).map(str::to_owned);
        line.expect("there is a hash")
    };
    assert_eq!(hash("config/match_generated.xml"), hash("config/match_attack.xml"));
}

/// A goalie that violates a property stops, and the match continues without it.
#[test]
fn properties_of_generated_charts_are_followed_in_a_match_as_those_of_interpreted_ones() {
    let monitor = "<monitor on_violation=\"policy\">models/strict.properties</monitor>";
    let (folder, _) = changed("config/roles/goalie.xml", "<agent ", "<agent on_failure=\"stop-agent\" ");
    for role in ["goalie.xml", "goalie_generated.xml"] {
        let path = folder.path().join("config/roles").join(role);
        let text = fs::read_to_string(&path).expect("it is there");
        let text = text.replace("<agent is_real_time", "<agent on_failure=\"stop-agent\" is_real_time");
        let monitored = text.replace("</statechart>", &format!("</statechart>\n    {monitor}"));
        assert!(monitored.contains("stop-agent") && monitored != text, "{monitored}");
        fs::write(&path, monitored).expect("the folder takes files");
    }
    let hash = |game: &str, property: &str, code: i32| {
        let text = format!("property \"p\": {property}\n");
        fs::write(folder.path().join("models/strict.properties"), text).expect("the folder takes files");
        let game = folder.path().join("config").join(game).display().to_string();
        let answer = monas(&["run", &game, "--seed", "7", "--for", "40s"]);
        assert_eq!(answer.code, Some(code), "{}", answer.err);
        assert_eq!(answer.out.contains("Goalie on blue-1 has stopped: "), code == 1, "{}", answer.out);
        answer
            .out
            .lines()
            .find(|line| line.starts_with("hash: "))
            .map(str::to_owned)
            .expect("there is a hash")
    };
    let (strict, mild) = ("always not entering TrackBall", "always not (in TrackBall and in SearchBall)");
    let violated = hash("match_attack.xml", strict, 1);
    assert_eq!(hash("match_generated.xml", strict, 1), violated);
    assert_ne!(hash("match_generated.xml", mild, 0), violated, "the goalie stops when it tracks the ball");
}

#[test]
fn committed_charts_equal_the_generated_ones() {
    let project = project();
    for model in ["models/goalie.srm", "models/attacker.srm", "models/extended_attacker.srm"] {
        assert_eq!(generate(project.path(), model), (Some(0), "nothing has changed\n".into(), String::new()));
    }
}

#[test]
fn a_new_role_is_linked_and_its_skeletons_are_left_alone() {
    let project = project();
    let folder = project.path();
    fs::write(folder.join("models/scout.srm"), "scout = (Vision . lookAround)~").expect("it takes files");
    let (code, out, err) = generate(folder, "models/scout.srm");
    assert_eq!(code, Some(0), "{err}");
    let skeleton = "statecharts/scout/src/activities/look_around.rs";
    for file in ["statecharts/scout/Cargo.toml", skeleton, "Cargo.toml", "cli/monas-cli/Cargo.toml", LINKS] {
        assert!(out.lines().any(|line| line == file), "{file} is not in\n{out}");
    }
    assert!(read(folder, LINKS).contains("use goalie as _;\nuse scout as _;\n"));
    assert!(read(folder, "Cargo.toml").contains("scout = { path = \"statecharts/scout\" }\n"));
    assert!(read(folder, "cli/monas-cli/Cargo.toml").contains("scout.workspace = true\n"));
    assert!(read(folder, skeleton).contains("monas::activity!(LookAround as \"lookAround\");"));
    let activities = read(folder, "statecharts/scout/src/activities.rs");
    assert!(activities.contains("Instance::of::<LookAround>(State::lookAround)"), "{activities}");
    assert!(activities.contains("use ::monas_soccer::activities::Vision;"), "{activities}");

    fs::write(folder.join(skeleton), "// filled in\n").expect("it takes files");
    assert_eq!(generate(folder, "models/scout.srm").1, "nothing has changed\n");
    assert_eq!(read(folder, skeleton), "// filled in\n");
}

/// Roles that share an activity which is still to be written have one skeleton of it.
#[test]
fn a_skeleton_is_shared() {
    let project = project();
    let folder = project.path();
    fs::write(folder.join("models/scout.srm"), "scout = (Vision . lookAround)~").expect("it takes files");
    fs::write(folder.join("models/guard.srm"), "guard = (lookAround . wait)~").expect("it takes files");
    for model in ["models/scout.srm", "models/guard.srm"] {
        let (code, _, err) = generate(folder, model);
        assert_eq!(code, Some(0), "{err}");
    }
    assert!(!folder.join("statecharts/guard/src/activities/look_around.rs").exists());
    assert!(read(folder, "statecharts/scout/src/lib.rs").contains("pub mod activities;"));
    assert!(read(folder, "statecharts/scout/src/activities.rs").contains("pub use look_around::LookAround;"));
    let activities = read(folder, "statecharts/guard/src/activities.rs");
    assert!(activities.contains("use ::scout::activities::LookAround;"), "{activities}");
    assert!(read(folder, "statecharts/guard/Cargo.toml").contains("scout.workspace = true\n"));
    assert_eq!(generate(folder, "models/guard.srm").1, "nothing has changed\n");

    fs::write(folder.join("models/scout.srm"), "scout = (wait . lookAround)~").expect("it takes files");
    let (code, _, err) = generate(folder, "models/scout.srm");
    assert!(code == Some(3) && err.contains("E0924") && err.contains("which uses one of `scout`"), "{err}");
}

#[test]
fn a_failed_generation_writes_nothing() {
    let project = project();
    let folder = project.path();
    let scout = "Liveness:\nscout = Vision . Stand\nTransitions:\nVision -> Stand : [Ball.fund]\n";
    fs::write(folder.join("models/scout.srm"), scout).expect("it takes files");
    let (code, _, err) = generate(folder, "models/scout.srm");
    assert_eq!(code, Some(3));
    assert!(err.contains("the message `Ball` has no field `fund`") && err.contains("E0134"), "{err}");
    assert!(!folder.join("statecharts/scout").exists());

    fs::write(folder.join("models/my-scout.srm"), "scout = Vision").expect("it takes files");
    let (code, _, err) = generate(folder, "models/my-scout.srm");
    assert!(code == Some(3) && err.contains("`my-scout` cannot be the name of a crate"), "{err}");

    let manifest = read(folder, "Cargo.toml").replace("team =", "teem =");
    fs::write(folder.join("Cargo.toml"), manifest).expect("it takes files");
    let (code, _, err) = generate(folder, "models/goalie.srm");
    assert!(code == Some(3) && err.contains("does not name the package that links statecharts"), "{err}");
}

#[test]
fn a_program_that_lacks_a_crate_of_its_project_runs_nothing() {
    let project = project();
    let folder = project.path();
    copy(&root().join("config"), &folder.join("config"));
    let config = folder.join("config/match_generated.xml").display().to_string();
    let run = ["run", config.as_str(), "--for", "1s", "--no-control"];
    let answer = monas(&run);
    assert_eq!(answer.code, Some(0), "the folder is what the program was built with");
    assert!(!answer.err.contains("E0928"), "{}", answer.err);
    let goalie = read(folder, "models/goalie.srm");
    fs::write(folder.join("models/goalie.srm"), goalie.replace("act_within = ", "act_within = 1"))
        .expect("it takes files");
    for command in [run.as_slice(), &["config", "check", config.as_str()]] {
        let answer = monas(command);
        let said = "`models/goalie.srm` differs from the model of the statechart `goalie` in this program: ~ constant `act_within`";
        assert!(answer.code == Some(0) && answer.err.contains(said), "{}", answer.err);
    }
    fs::write(folder.join("models/goalie.srm"), goalie).expect("it takes files");
    fs::write(folder.join("models/scout.srm"), "scout = (Vision . Stand)~").expect("it takes files");
    assert_eq!(generate(folder, "models/scout.srm").0, Some(0));
    for command in [run.as_slice(), &["config", "check", config.as_str()]] {
        let answer = monas(command);
        assert_eq!(answer.code, Some(3), "{}", answer.err);
        assert!(answer.err.contains("`statecharts/scout` is not in this program"), "{}", answer.err);
        assert!(answer.err.contains("build the program again"), "{}", answer.err);
    }
    for gone in ["scout", "goalie"] {
        fs::remove_dir_all(folder.join("statecharts").join(gone)).expect("it was there");
    }
    let answer = monas(&run);
    assert!(answer.code == Some(3) && answer.err.contains("`statecharts/goalie` is gone"), "{}", answer.err);
}
