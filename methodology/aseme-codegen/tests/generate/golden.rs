//! Generated charts in `tests/golden/generated`. `MONAS_BLESS=1` rewrites the files.

use std::fs;
use std::path::{Path, PathBuf};

use aseme_codegen::generate::{CrateFiles, RustActivity, RustBindings, generate};
use yase::{Source, Statechart};

use crate::words::soccer;

fn root(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

fn chart(name: &str, text: &str) -> Statechart {
    let (chart, findings) = aseme_models::statechart_of(&Source::new(name, text));
    assert_eq!(findings, []);
    chart
}

fn check(folder: &str, files: &CrateFiles) {
    for (path, text) in files {
        let golden = root("tests/golden/generated").join(folder).join(path.replace("src/", ""));
        if std::env::var_os("MONAS_BLESS").is_some() {
            fs::create_dir_all(golden.parent().expect("it has one")).expect("writable");
            fs::write(&golden, text).expect("writable");
        }
        let expected = fs::read_to_string(&golden).expect("a golden file");
        assert!(*text == expected, "{path} differs from its golden file; MONAS_BLESS=1 accepts it:\n{text}");
    }
}

/// A chart with every element: names that are no Rust identifiers, timers, assignments, events,
/// entry and exit actions.
#[test]
fn a_patrol_as_rust() {
    let model = "
Role: patrol
Liveness:
patrol = (walk . type . [2nd])~ || watch+
Constants:
far = 2.5
word = \"red\"
Transitions:
walk -> type !3 interrupts : go | stop [Ball.place.near.x > far + Ball.type / 2 && Ball.colour != word || In(watch)]
CONDITION -> 2nd : [abs(Ball.place.x) <= far]
watch -> watch : [watch_timeout && Ball == NULL] / StartTimeout(watch_timeout, 100ms)
type -> [2nd] : [Vision.Ball.found] / Ball.place.x = -Ball.time_to_cross; Ball.colour = word; raise(go); publish.Ball
States:
walk : priority = 2, entry = GameState.player_state = PLAYING, exit = StartTimeout(t, 5ms), defer = stop, duration = 1500ms
";
    check("patrol", &generate(&chart("patrol.srm", model), &soccer()).expect("it can be written"));
}

#[test]
fn a_crate_of_monas_has_its_activities_and_skeletons_for_those_that_are_not_there() {
    let words = RustBindings { registers: true, runtime: "monas::generated".into(), ..soccer() };
    let activity = |path: &str, is_function| RustActivity { path: path.into(), is_function };
    let activities = [("look", activity("team::look", true)), ("kick", activity("team::Kick", false))];
    let activities = activities.map(|(name, activity)| (name.to_owned(), activity));
    let about =
        [("mate", "team.State.Mate"), ("ball", "ball.State.Ball"), ("game", "game_state.State.GameState")];
    let about = about.map(|(name, kind)| (name.to_owned(), kind.to_owned())).to_vec();
    let subjects = [("passBall".to_owned(), about)].into();
    let topics =
        [("soccer/ball", "soccer::topics::BALL"), ("soccer/game_state", "soccer::topics::GAME_STATE")];
    let topics = topics.map(|(path, constant)| (path.to_owned(), constant.to_owned())).into();
    let words =
        RustBindings { activities: activities.into(), subjects, topics, name: "player".into(), ..words };
    let chart = chart("player.srm", "player = look . kick . passBall");
    check("player", &generate(&chart, &words).expect("it can be written"));
}

#[test]
fn rustfmt_leaves_them_as_they_are() {
    let folder = root("tests/golden/generated");
    let roots = ["patrol", "player"].map(|name| folder.join(name).join("lib.rs"));
    let config = root("../../rustfmt.toml");
    let mut command = std::process::Command::new("rustfmt");
    let command = command.args(["--check", "--edition", "2024", "--config-path"]).arg(config).args(roots);
    match command.output() {
        Ok(output) => assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout)),
        Err(error) => println!("skipped: no rustfmt ({error})"),
    }
}

/// Rust looks for the module `r#move` in the file `move.rs`.
#[test]
fn skeletons_called_like_keywords_are_in_files_that_rust_finds() {
    let words = RustBindings { registers: true, runtime: "monas::generated".into(), ..soccer() };
    let files = generate(&chart("r.srm", "r = Move . Super . Union"), &words).expect("it can be written");
    let modules = &files["src/activities.rs"];
    for (module, file) in [("r#move", "move"), ("super_", "super_"), ("union", "union")] {
        assert!(modules.contains(&format!("mod {module};\n")), "{modules}");
        assert!(files.contains_key(&format!("src/activities/{file}.rs")), "{:?}", files.keys());
    }
}

/// A skeleton imports `Activity`, and its function returns a `Result`.
#[test]
fn activities_called_like_types_of_the_generated_code_have_other_names_in_rust() {
    let state = RustActivity { path: "activities::state::State".into(), is_function: false };
    let words = RustBindings {
        registers: true,
        runtime: "monas::generated".into(),
        activities: [("State".to_owned(), state)].into(),
        ..soccer()
    };
    let files =
        generate(&chart("r.srm", "r = Activity . Result . State"), &words).expect("it can be written");
    let skeleton = &files["src/activities/activity_.rs"];
    assert!(skeleton.contains("impl Activity for Activity_ {"), "{skeleton}");
    assert!(skeleton.contains("monas::activity!(Activity_ as \"Activity\");"), "{skeleton}");
    let modules = &files["src/activities.rs"];
    assert!(modules.contains("pub use result_::Result_;"), "{modules}");
    assert!(modules.contains("Instance::of::<::activities::state::State>(State::State)"), "{modules}");
}

/// A project's messages are in a crate that is called like a module of the generated crate.
#[test]
fn a_crate_of_messages_is_not_the_module_of_messages() {
    let types = ["Ball", "GameState"].map(|name| (name.to_owned(), format!("messages::{name}")));
    let words = RustBindings { messages: types.into(), ..soccer() };
    let model = "Role: r\nLiveness:\nr = a . b\nTransitions:\na -> b : / Ball.type = 7\n";
    let files = generate(&chart("r.srm", model), &words).expect("it can be written");
    let function = "fn set_ball_type(message: &mut ::messages::Ball, value: Value<'_>)";
    assert!(files["src/guards.rs"].contains(function), "{}", files["src/guards.rs"]);
    let source = "const BALL: Source<::messages::Ball> = Source::new(0);";
    assert!(files["src/words.rs"].contains(source), "{}", files["src/words.rs"]);
}
