//! `cargo xtask project`: a project created by `monas new` builds, runs and passes its tests, and
//! added files are found.
//!
//! The first test compiles neither the simulator nor the soccer team, and it includes the unit
//! tests of activities: one that fails is noticed. Files of the project are not edited, only added:
//! an activity by `monas new activity`; a message, a functionality, a model and a configuration by
//! hand. Then a crate is generated from the model, and items that it refers to are removed: an
//! activity, a field of a message, a state. Each time the compiler must report it. Finally an
//! activity becomes a module: it is built, loaded by the existing program, changed, and built
//! again.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Files that a user adds to the folders.
const ADDED_FILES: [(&str, &str); 5] = [
    (
        "messages/pins.proto",
        "syntax = \"proto3\";\n\npackage circus;\n\nmessage Pins {\n  uint32 count = 1;\n  uint32 held = 2;\n}\n",
    ),
    (
        "functionalities/doubling.rs",
        "//! Doubling.\n\n/// Twice as many.\npub fn double(count: u32) -> u32 {\n    count.saturating_mul(2)\n}\n",
    ),
    (
        "activities/throw.rs",
        "//! Throw: prints how many pins are in the air.\n\nuse functionalities::doubling::double;\nuse messages::Pins;\nuse monas::Blackboard;\nuse narukom::State;\n\n\
         narukom::topic! {\n    /// What is in the air.\n    pub PINS: State<Pins> = \"circus/pins\"\n}\n\n\
         /// Says how many.\npub fn throw(_: &mut Blackboard) {\n    println!(\"pins: {}\", double(Pins { count: 3, ..Pins::default() }.count));\n}\n\nmonas::activity!(fn throw as \"Throw\");\n",
    ),
    (
        "models/juggler.srm",
        "Role: juggler\nLiveness:\njuggler = (Juggle . Throw)~\nTransitions:\nJuggle -> Throw : [pause && (Pins == NULL || Pins.held > 0)] / StartTimeout(pause, 100ms)\n",
    ),
    (
        "config/juggler.xml",
        "<agent><name>Juggler</name><statechart>models/juggler.srm</statechart></agent>\n",
    ),
];

/// Roles with every kind of expression and the file that they need: these are generated and built,
/// but not checked. `Announce` and `Watch` are written nowhere.
const EXPRESSIONS: [(&str, &str); 4] = [
    (
        "messages/act.proto",
        "syntax = \"proto3\";\n\npackage circus;\n\nmessage Act {\n  enum Mood {\n    CALM = 0;\n    WILD = 1;\n  }\n  message Place {\n    double x = 1;\n    double y = 2;\n  }\n\
         string title = 1;\n  bool ready = 2;\n  double height = 3;\n  int32 type = 4;\n  uint64 count = 5;\n  Mood mood = 6;\n  Place place = 7;\n  optional float width = 8;\n}\n\nmessage Applause {\n  uint32 level = 1;\n}\n",
    ),
    (
        "activities/clap.rs",
        "//! Clap: applauds.\n\nuse messages::{Act, Applause};\nuse monas::Blackboard;\nuse narukom::{Signal, State};\n\n\
         narukom::topic! {\n    /// What is shown.\n    pub ACT: State<Act> = \"circus/act\"\n}\n\nnarukom::topic! {\n    /// Somebody claps.\n    pub APPLAUSE: Signal<Applause> = \"circus/applause\"\n}\n\n\
         /// Does nothing.\npub fn clap(_: &mut Blackboard) {}\n\nmonas::activity!(fn clap as \"Clap\");\n",
    ),
    (
        "roles/director.srm",
        "Role: director\nLiveness:\ndirector = (Juggle . Throw . Announce . Clap)~ || Watch~\n\
         Constants:\nhigh = 2.5\nword = \"bow\"\nloud = true\nTransitions:\n\
         Juggle -> Throw !2 interrupts : go | Message.Applause [Act.place.x > high + Act.type / 2 - 1 && Act.title != word || In(Watch)] / Act.type = Act.type + 1; Act.title = \"end\"; Act.mood = WILD; Act.place.x = -Act.height * 2; raise(go)\n\
         Throw -> Announce : not stop [abs(Act.height) >= 1 && !(Act.ready == loud) && Act.mood != CALM && Pins != NULL] / Act.ready = Act.type > 3; Act.count = 7; Act.width = high; Pins.held = Pins.count; publish.Act; publish_all\n\
         Announce -> Clap : * [pause && TimeoutCheck(rest) && Juggle.Act.ready] / StartTimeout(pause, 100ms), StartTimeout(rest, 1s); process_messages\n\
         Watch -> Watch : [other.act.State.Act.height <= high || Act == NULL]\n\
         States:\nClap : priority = 2, entry = Greeting.number = 7, exit = Greeting.text = word, defer = stop, duration = 10ms\n",
    ),
    ("roles/usher.srm", "usher = (Announce . Clap)~\n"),
];

/// The configuration that refers to the generated crate. It is added later, because the project's
/// test checks that everything named in configurations exists.
const GENERATED: (&str, &str) =
    ("config/generated.xml", "<agent><name>Juggler</name><statechart>juggler</statechart></agent>\n");

/// The file that refers to a state of the generated crate.
const NAMING: (&str, &str) = (
    "tests/states.rs",
    "//! States by name.\n\n#[test]\nfn it_throws() {\n    assert_ne!(juggler::State::Throw, juggler::State::Juggle);\n}\n",
);

/// Removed items that a generated crate refers to: the file, the original text, its replacement,
/// and the errors of the compiler.
const REMOVED_ITEMS: [(&str, &str, &str, &[&str]); 2] = [
    (
        "activities/throw.rs",
        "fn throw",
        "fn fling",
        &[
            "error[E0432]: unresolved import `activities::throw::throw`",
            "statecharts/juggler/src/activities.rs",
        ],
    ),
    (
        "messages/pins.proto",
        "held",
        "kept",
        &["error[E0609]: no field `held` on type", "statecharts/juggler/src/guards.rs"],
    ),
];

/// A unit test of an activity that is made to fail: the file, the original text, its replacement,
/// and the errors of the test.
const FAILING_TEST: (&str, &str, &str, &[&str]) =
    ("activities/greet.rs", "number, number)", "number, number + 1)", &["test failed", "-p activities"]);

/// Files that a project without matches does not need.
const LEFT_OUT: [&str; 6] =
    ["monas-eval", "monas-match", "monas-sim", "monas-soccer", "nalgebra", "rapier2d"];

/// The most crates that the first test of a project needs, its own included.
const MAX_CRATES: usize = 230;

/// A configuration with a module, whose file is filled in. It is separate from the project's
/// configuration, whose test needs no module.
const WITH_MODULE: &str =
    "<module>{file}</module>\n<agent frequency=\"10\"><name>Winker</name><activity>Wink</activity></agent>\n";

/// The body of the module's activity before the change.
const ACTIVITY_BODY: &str = "        Ok(Progress::Done)\n";

/// The model with a renamed state.
const RENAMED_MODEL: &str = "Role: juggler\nLiveness:\njuggler = (Juggle . Fling)~\nTransitions:\nJuggle -> Fling : [pause] / StartTimeout(pause, 100ms)\nStates:\nFling : activity = Throw\n";

/// Creates a project and checks all steps.
pub(crate) fn run(root: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let folder = target.join("projects");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let team = folder.join("my-team");
    // The target folder of the workspace: two thirds of the crates are compiled there already, with
    // the profile of projects.
    let cargo = |folder: &Path, arguments: &[&str]| {
        let mut command = Command::new("cargo");
        command.args(arguments).current_dir(folder).env("CARGO_TARGET_DIR", &target);
        command
    };
    // The program as the tests use it: a build alone has other features, and takes minutes again.
    let mut build = Command::new("cargo");
    build.args(["test", "--quiet", "--workspace", "--no-run", "--test", "command"]).current_dir(root);
    done(build.stderr(std::process::Stdio::inherit()))?;
    let program = target.join("debug").join(format!("monas{}", std::env::consts::EXE_SUFFIX));
    let monas = |folder: &Path, arguments: &[&str]| {
        let mut command = Command::new(&program);
        command.args(arguments).current_dir(folder).env("CARGO_TARGET_DIR", &target);
        command
    };
    done(&mut monas(&folder, &["new", "my-team"]))?;
    let crates = first_test(&mut cargo(&team, &["test", "--offline", "--verbose"]))?;
    expect_refusal_after_edit(&team, FAILING_TEST, &mut cargo(&team, &["test", "--offline"]))?;
    let said = done(&mut cargo(&team, &["run", "--offline", "--quiet", "--", "run", "--for", "2s"]))?;
    expect(&said, "hello for the 1. time")?;
    done(&mut monas(&team, &["new", "activity", "Juggle"]))?;
    for (file, text) in ADDED_FILES {
        fs::write(team.join(file), text)?;
    }
    done(&mut cargo(&team, &["test", "--offline"]))?;
    let juggler = ["run", "--offline", "--quiet", "--", "run", "config/juggler.xml", "--for", "1s"];
    expect(&done(&mut cargo(&team, &juggler))?, "pins: 6")?;
    let generate = ["run", "--offline", "--quiet", "--", "generate", "models/juggler.srm"];
    expect(&done(&mut cargo(&team, &generate))?, "statecharts/juggler/src/chart.rs")?;
    for (file, text) in [GENERATED, NAMING] {
        fs::write(team.join(file), text)?;
    }
    done(&mut cargo(&team, &["test", "--offline"]))?;
    let generated = ["run", "--offline", "--quiet", "--", "run", "config/generated.xml", "--for", "1s"];
    expect(&done(&mut cargo(&team, &generated))?, "pins: 6")?;
    let build = ["test", "--offline", "--no-run"];
    for taken in REMOVED_ITEMS {
        expect_refusal_after_edit(&team, taken, &mut cargo(&team, &build))?;
    }
    fs::write(team.join("models/juggler.srm"), RENAMED_MODEL)?;
    done(&mut cargo(&team, &generate))?;
    let error = refused(&mut cargo(&team, &build))?;
    ["error[E0599]: no variant", "`Throw`", NAMING.0].iter().try_for_each(|part| expect(&error, part))?;
    fs::remove_file(team.join(NAMING.0))?;
    expressions(&team, &cargo)?;
    module(&team, &monas, &cargo)?;
    println!(
        "project: made, built from {crates} crates, tested, run; what was added is found, what a generated chart lacks is not a program, a module is exchanged"
    );
    Ok(ExitCode::SUCCESS)
}

/// Generates roles with every kind of expression, which the compiler accepts, and one skeleton for
/// an activity that two of them have.
fn expressions(team: &Path, cargo: &dyn Fn(&Path, &[&str]) -> Command) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(team.join("roles"))?;
    for (file, text) in EXPRESSIONS {
        fs::write(team.join(file), text)?;
    }
    for role in ["roles/director.srm", "roles/usher.srm"] {
        done(&mut cargo(team, &["run", "--offline", "--quiet", "--", "generate", role]))?;
    }
    if team.join("statecharts/usher/src/activities/announce.rs").exists() {
        return Err("two roles have a skeleton of one activity".into());
    }
    done(&mut cargo(team, &["build", "--offline", "--workspace"]))?;
    done(&mut cargo(team, &["run", "--offline", "--quiet", "--", "model", "check", "roles/usher.srm"]))?;
    Ok(())
}

/// Runs the first test of a project, which has to succeed. Returns how many crates it needs,
/// whether compiled now or before.
fn first_test(test: &mut Command) -> Result<usize, Box<dyn Error>> {
    let output = test.output()?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        return Err(format!("{test:?}\n{}{said}", String::from_utf8_lossy(&output.stdout)).into());
    }
    let named = |line| ["Compiling ", "Fresh "].iter().find_map(|kind| str::strip_prefix(line, kind));
    let crates: Vec<&str> = said.lines().map(str::trim).filter_map(named).collect();
    let needless = |line: &&&str| line.split(' ').next().is_some_and(|name| LEFT_OUT.contains(&name));
    match crates.iter().find(needless) {
        Some(name) => Err(format!("a project without matches needs {name}").into()),
        None if crates.len() > MAX_CRATES => {
            Err(format!("a new project needs {} crates, more than {MAX_CRATES}", crates.len()).into())
        }
        None => Ok(crates.len()),
    }
}

/// Creates an activity as a module and changes it: the existing program loads the last build.
fn module(
    team: &Path,
    monas: &dyn Fn(&Path, &[&str]) -> Command,
    cargo: &dyn Fn(&Path, &[&str]) -> Command,
) -> Result<(), Box<dyn Error>> {
    done(&mut monas(team, &["new", "activity", "Wink", "--module"]))?;
    let library = team.join("modules/wink/lib.rs");
    let idle = fs::read_to_string(&library)?;
    for times in ["once", "twice"] {
        let wink = format!("        println!(\"wink {times}\");\n{ACTIVITY_BODY}");
        fs::write(&library, idle.replacen(ACTIVITY_BODY, &wink, 1))?;
        let own = ["run", "--offline", "--quiet", "--", "module", "build", "wink"];
        let file = done(&mut cargo(team, &own))?;
        fs::write(team.join("winker.xml"), WITH_MODULE.replace("{file}", file.trim()))?;
        let run = ["run", "--offline", "--quiet", "--", "run", "winker.xml", "--for", "1s"];
        expect(&done(&mut cargo(team, &run))?, &format!("wink {times}"))?;
    }
    Ok(())
}

/// Changes a file for one build, which has to fail with the expected errors.
fn expect_refusal_after_edit(
    team: &Path,
    (file, there, instead, said): (&str, &str, &str, &[&str]),
    build: &mut Command,
) -> Result<(), Box<dyn Error>> {
    let file = team.join(file);
    let text = fs::read_to_string(&file)?;
    if !text.contains(there) {
        return Err(format!("{} has no `{there}`", file.display()).into());
    }
    fs::write(&file, text.replace(there, instead))?;
    let error = refused(build);
    fs::write(&file, text)?;
    let error = error?;
    said.iter().try_for_each(|part| expect(&error, part))
}

/// The output of a build, which has to fail.
fn refused(build: &mut Command) -> Result<String, Box<dyn Error>> {
    let output = build.output()?;
    match output.status.success() {
        true => Err(format!("{build:?} went well").into()),
        false => Ok(String::from_utf8_lossy(&output.stderr).into_owned()),
    }
}

/// The output of a command, which has to succeed.
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
