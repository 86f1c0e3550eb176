//! `cargo xtask project`: what `monas new` makes builds, runs and passes its tests, and what is put into it is found.
//!
//! Nothing of the project is edited after it was made; files are only added: an activity by `monas new activity`, a message, a
//! functionality, a model and a configuration by hand.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// What a person drops into the folders.
const DROPPED: [(&str, &str); 5] = [
    (
        "messages/pins.proto",
        "syntax = \"proto3\";\n\npackage circus;\n\nmessage Pins {\n  uint32 count = 1;\n}\n",
    ),
    (
        "functionalities/doubling.rs",
        "//! Doubling.\n\n/// Twice as many.\npub fn double(count: u32) -> u32 {\n    count.saturating_mul(2)\n}\n",
    ),
    (
        "activities/throw.rs",
        "//! Throw: prints how many pins are in the air.\n\nuse functionalities::doubling::double;\nuse messages::Pins;\nuse monas::Blackboard;\n\n\
         fn throw(_: &mut Blackboard) {\n    println!(\"pins: {}\", double(Pins { count: 3 }.count));\n}\n\nmonas::activity!(fn throw as \"Throw\");\n",
    ),
    (
        "models/juggler.srm",
        "Role: juggler\nLiveness:\njuggler = (Juggle . Throw)~\nTransitions:\nJuggle -> Throw : [pause] / StartTimeout(pause, 100ms)\n",
    ),
    (
        "config/juggler.xml",
        "<agent><name>Juggler</name><statechart>models/juggler.srm</statechart></agent>\n",
    ),
];

/// Makes a project and goes through it.
pub(crate) fn run(root: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let folder = target.join("projects");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let team = folder.join("my-team");
    // The project's dependencies are those of this workspace, and need not be built again.
    let cargo = |folder: &Path, arguments: &[&str]| {
        let mut command = Command::new("cargo");
        command.args(arguments).current_dir(folder).env("CARGO_TARGET_DIR", &target);
        command
    };
    // as the tests have built it, so that nothing is built twice for another choice of features
    done(
        cargo(root, &["test", "--quiet", "--workspace", "--no-run"]).stderr(std::process::Stdio::inherit()),
    )?;
    let program = target.join("debug").join(format!("monas{}", std::env::consts::EXE_SUFFIX));
    let monas = |folder: &Path, arguments: &[&str]| {
        let mut command = Command::new(&program);
        command.args(arguments).current_dir(folder).env("CARGO_TARGET_DIR", &target);
        command
    };
    done(&mut monas(&folder, &["new", "my-team"]))?;
    done(&mut cargo(&team, &["test", "--offline", "--workspace"]))?;
    let said = done(&mut cargo(&team, &["run", "--offline", "--quiet", "--", "run", "--for", "2s"]))?;
    expect(&said, "hello for the 1. time")?;
    done(&mut monas(&team, &["new", "activity", "Juggle"]))?;
    for (file, text) in DROPPED {
        fs::write(team.join(file), text)?;
    }
    done(&mut cargo(&team, &["test", "--offline", "--workspace"]))?;
    let juggler = ["run", "--offline", "--quiet", "--", "run", "config/juggler.xml", "--for", "1s"];
    expect(&done(&mut cargo(&team, &juggler))?, "pins: 6")?;
    println!("project: made, built, tested, run; what was added is found");
    Ok(ExitCode::SUCCESS)
}

/// What a command prints; it has to end well.
fn done(command: &mut Command) -> Result<String, Box<dyn Error>> {
    let output = command.output()?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    match output.status.success() {
        true => Ok(text(&output.stdout)),
        false => Err(format!("{command:?}\n{}{}", text(&output.stdout), text(&output.stderr)).into()),
    }
}

fn expect(said: &str, expected: &str) -> Result<(), Box<dyn Error>> {
    match said.contains(expected) {
        true => Ok(()),
        false => Err(format!("`{expected}` is not in\n{said}").into()),
    }
}
