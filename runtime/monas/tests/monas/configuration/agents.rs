//! Agents from XML: the listings of the thesis are accepted, and all errors are reported at once
//! with their locations.
use std::fs;

use monas::{
    Activity, Agent, Blackboard, BoxError, ErrorKind, FailurePolicy, Parameters, Progress, Registry, Talws,
    config,
};
use yase::Source;

#[derive(Default)]
struct Walk;

impl Activity for Walk {
    fn configure(&mut self, parameters: &Parameters) {
        if parameters.number("speed").is_some_and(|speed| speed > 1.0) {
            parameters.refuse("speed", "is more than the legs can do");
        }
        parameters.flag("careful");
    }
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }
}

fn plain(_: &mut Blackboard) {}

pub(crate) fn registry() -> Registry {
    let names = ["Vision", "Behavior", "Sensors", "RobotController"];
    names.into_iter().fold(Registry::empty().with("Walk", Walk::default), |r, name| r.with(name, || plain))
}

/// Reads a text as a file in a folder with these models.
fn read(text: &str, models: &[(&str, &str)]) -> (Vec<Agent>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("models")).unwrap();
    for (name, model) in models {
        fs::write(folder.path().join("models").join(name), model).unwrap();
    }
    let path = folder.path().join("config/agents.xml");
    let (setup, diagnostics) = config::read(&Source::new("agents.xml", text), &path, &registry());
    let prefix = format!("{}/", folder.path().display());
    (setup.agents, diagnostics.iter().map(|diagnostic| diagnostic.to_string().replace(&prefix, "")).collect())
}

/// Diagnostics of a text, line by line.
fn check(text: &str, expected: &[&str]) {
    assert_eq!(read(text, &[]).1, expected);
}

/// Diagnostics of the attributes and children of an otherwise valid agent.
fn check_agent(attributes: &str, elements: &str, expected: &[&str]) {
    let text = format!("<agent thread_frequency='10' {attributes}>\n<name>a</name>\n{elements}\n</agent>");
    check(&text, expected);
}

/// Listing 4.17 of the thesis.
const LISTING: &str = include_str!("../../listings/4.17.xml");

#[test]
fn the_listing_of_the_thesis_is_read_as_it_stands() {
    let (agents, diagnostics) = read(LISTING, &[]);
    assert_eq!(diagnostics, [""; 0]);
    let [agent] = agents.as_slice() else { panic!("{agents:?}") };
    assert_eq!(agent.name(), "Motion");
    assert_eq!(agent.activity_names().collect::<Vec<_>>(), ["Vision", "Behavior"]);
    assert_eq!(agent.frequency().map(|frequency| frequency.hertz()), Some(10.0));
    assert_eq!(agent.scheduling(), (1, true));
    assert_eq!(agent.policy(), FailurePolicy::Restart);
}

#[test]
fn the_files_of_2012_are_read() {
    let text = r#"<?xml version="1.0"?>
        <!-- who runs where -->
        <agent IsRealTime="1" Priority="1" ThreadFrequency="50" StatsCycle="1000" Enable="1">
            <name>KMC</name>
            <activity Enable="0">Vision</activity>
            <activity>Behavior</activity>
        </agent>
        <provider IsRealTime="1" Priority="1" ThreadFrequency="10" StatsCycle="1000" Enable="1">Sensors</provider>
        <agent ThreadFrequency="1" Enable="0"><name>Rest</name><activity>Vision</activity></agent>"#;
    let (agents, diagnostics) = read(text, &[]);
    assert_eq!(diagnostics, [""; 0]);
    let names: Vec<_> =
        agents.iter().map(|agent| (agent.name(), agent.activity_names().collect::<Vec<_>>())).collect();
    assert_eq!(names, [("KMC", vec!["Behavior"]), ("Sensors", vec!["Sensors"])]);
}

#[test]
fn canonical_names_and_the_thesis_s_mean_the_same() {
    let text = "<agent is_real_time='true' priority='3' thread_frequency='2.5' stats_cycle='0' enable='1' \
                workers='4' on_failure='safe-state'><name>a</name><activity careful='1' speed='0.5'>Walk</activity></agent>";
    let (agents, diagnostics) = read(text, &[]);
    assert_eq!(diagnostics, [""; 0]);
    assert_eq!(agents[0].scheduling(), (3, true));
    assert_eq!(agents[0].frequency().map(|frequency| frequency.hertz()), Some(2.5));
    assert_eq!(agents[0].policy(), FailurePolicy::SafeState);
    assert_eq!(agents[0].worker_count().map(|count| count.get()), Some(4));
}

/// Diagnostics of statecharts of an agent, with two models.
fn check_charts(elements: &str, expected: &[&str]) {
    let files =
        [("walker.srm", "walker = Vision . Walk"), ("p.properties", "property \"p\": always not in Walk")];
    let (_, findings) = read(&format!("<agent><name>a</name>\n{elements}\n</agent>"), &files);
    assert_eq!(findings, expected);
}

#[test]
fn statecharts_have_what_agents_have_as_they_or_the_thesis_write_it() {
    check_charts(
        "<statechart ThreadFrequency='20' Priority='3' IsRealTime='1' StatsCycle='10' Threads='2' cores='0' OnFailure='skip'>\
         models/walker.srm<activity speed='0.5' on_failure='restart'>Walk</activity><monitor>models/p.properties</monitor>\
         </statechart><statechart>models/walker.srm</statechart>",
        &[],
    );
    let toml = "[[agent]]\nname = \"a\"\n[[agent.statechart]]\nmodel = \"models/walker.srm\"\nthread_frequency = 20\n\
                threads = 2\n[[agent.statechart.activity]]\nname = \"Walk\"\nspeed = 0.5\n";
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("models")).unwrap();
    fs::write(folder.path().join("models/walker.srm"), "walker = Vision . Walk").unwrap();
    let path = folder.path().join("agents.toml");
    let (_, findings) = config::read(&Source::new("agents.toml", toml), &path, &registry());
    assert!(findings.is_empty(), "{findings:?}");
}

#[test]
fn statechart_settings_are_checked() {
    let chart = |attributes: &str, within: &str| {
        format!("<statechart {attributes}>models/walker.srm{within}</statechart>")
    };
    for (elements, expected) in [
        (
            chart("threads='0'", ""),
            "agents.xml:2:22: error[E0306]: `threads` is `0`, expected a whole number from 1",
        ),
        (
            chart("priorty='1'", ""),
            "agents.xml:2:13: error[E0304]: unknown attribute `priorty` of `statechart` (did you mean `priority`?)",
        ),
        (
            chart("", "<activity>Wolk</activity>"),
            "agents.xml:2:41: error[E0338]: the chart `walker` has no activity `Wolk` (did you mean `Walk`?)",
        ),
        (
            chart("", "<activity sped='1'>Walk</activity>"),
            "agents.xml:2:41: error[E0314]: activity `Walk`: unknown parameter `sped` (did you mean `speed`?)",
        ),
        (
            chart("", "<activity>Walk</activity><activity>Walk</activity>"),
            "agents.xml:2:66: error[E0311]: the activity `Walk` of the chart `walker` is configured twice (use one `activity` element: it applies to every state that runs it)",
        ),
        (
            chart("", "") + &chart("", "") + "<monitor>models/p.properties</monitor>",
            "agents.xml:2:96: error[E0324]: agent `a` has 2 statecharts: the properties are ambiguous (put the `monitor` into one `statechart`)",
        ),
    ] {
        check_charts(&elements, &[expected]);
    }
}

#[test]
fn a_pool_has_at_least_one_thread() {
    check_agent(
        "workers='0'",
        "<activity>Vision</activity>",
        &["agents.xml:1:39: error[E0306]: `workers` is `0`, expected a whole number from 1"],
    );
}

#[test]
fn names_that_are_not_known_come_with_the_nearest_that_is() {
    check_agent(
        "",
        "<activty>Vision</activty>",
        &["agents.xml:3:2: error[E0303]: unknown element `activty` (did you mean `activity`?)"],
    );
    check_agent(
        "Prioritty='1'",
        "<activity>Vision</activity>",
        &[
            "agents.xml:1:30: error[E0304]: unknown attribute `Prioritty` of `agent` (did you mean `Priority`?)",
        ],
    );
    check_agent(
        "",
        "<activity>Vsion</activity>",
        &["agents.xml:3:11: error[E0312]: unknown activity `Vsion` (did you mean `Vision`?)"],
    );
    check("<agnet/>", &["agents.xml:1:2: error[E0303]: unknown element `agnet` (did you mean `agent`?)"]);
    check(
        "<robot/>",
        &[
            "agents.xml:1:2: error[E0303]: unknown element `robot` (expected `agent`, `provider`, `link`, `module`, `body` or `agents`)",
        ],
    );
}

#[test]
fn implausible_values_are_reported() {
    check_agent(
        "priority='high'",
        "<activity>Vision</activity>",
        &["agents.xml:1:40: error[E0306]: `priority` is `high`, expected a whole number"],
    );
    check_agent(
        "IsRealTime='maybe'",
        "<activity>Vision</activity>",
        &[
            "agents.xml:1:42: error[E0306]: `IsRealTime` is `maybe`, expected one of `1`, `0`, `true` or `false`",
        ],
    );
    check_agent(
        "on_failure='restrt'",
        "<activity>Vision</activity>",
        &[
            "agents.xml:1:42: error[E0306]: `on_failure` is `restrt`, expected one of `restart`, `skip`, `stop-agent` or \
         `safe-state` (did you mean `restart`?)",
        ],
    );
    for frequency in ["-5", "NaN", "inf", "quick"] {
        let text = format!(
            "<agent thread_frequency='{frequency}'><name>a</name><activity>Vision</activity></agent>"
        );
        let expected = format!(
            "agents.xml:1:26: error[E0306]: `thread_frequency` is `{frequency}`, expected a number from 0 to 1000000"
        );
        check(&text, &[&expected]);
    }
}

#[test]
fn missing_parts_of_an_agent_are_reported() {
    check(
        "<agent thread_frequency='1'><activity>Vision</activity></agent>",
        &["agents.xml:1:2: error[E0305]: `agent` has no `name` (give it a `name`)"],
    );
    check(
        "<agent thread_frequency='1'><name> </name><activity>Vision</activity></agent>",
        &["agents.xml:1:30: error[E0310]: `name` is empty (it is the name of the agent)"],
    );
    check(
        "<agent thread_frequency='1'><name>a</name></agent>",
        &[
            "agents.xml:1:2: error[E0319]: agent `a` has no activity and no statechart (give it an `activity`, or a `statechart` that names a model)",
        ],
    );
    check(
        "<agent><name>a</name><activity>Vision</activity></agent>",
        &[
            "agents.xml:1:2: error[E0305]: agent `a` has activities and no `thread_frequency` (add its cycles per second: `thread_frequency=\"10\"`)",
        ],
    );
}

#[test]
fn two_agents_of_one_name_are_reported() {
    let agent = "<agent thread_frequency='1'><name>a</name><activity>Vision</activity></agent>\n";
    check(
        &agent.repeat(2),
        &[
            "agents.xml:2:35: error[E0311]: another agent is named `a` (give each agent of a host a unique name)",
        ],
    );
    let provider = "<provider thread_frequency='1'>Vision</provider>";
    check(
        &provider.repeat(2),
        &[
            "agents.xml:1:80: error[E0311]: another agent is named `Vision` (give each agent of a host a unique name)",
        ],
    );
}

#[test]
fn parameters_are_checked_by_the_activity_that_has_them() {
    check_agent(
        "",
        "<activity sped='1'>Walk</activity>",
        &["agents.xml:3:11: error[E0314]: activity `Walk`: unknown parameter `sped` (did you mean `speed`?)"],
    );
    check_agent(
        "",
        "<activity speed='quick' careful='perhaps'>Walk</activity>",
        &[
            "agents.xml:3:18: error[E0315]: activity `Walk`: parameter `speed` is `quick`, expected a number",
            "agents.xml:3:34: error[E0315]: activity `Walk`: parameter `careful` is `perhaps`, expected `1`, `0`, \
         `true` or `false`",
        ],
    );
    check_agent(
        "",
        "<activity speed='2'>Walk</activity>",
        &["agents.xml:3:18: error[E0315]: activity `Walk`: parameter `speed` is more than the legs can do"],
    );
}

#[test]
fn ill_formed_xml_is_repaired_and_reported() {
    check_agent(
        "",
        "<activity>Vision",
        &["agents.xml:3:2: error[E0301]: `<activity>` is not closed (write `</activity>` behind it)"],
    );
    check_agent(
        "",
        "<activity>Vision</activty>",
        &["agents.xml:3:19: error[E0301]: `</activty>` closes nothing (did you mean `activity`?)"],
    );
    check_agent(
        "Enable",
        "<activity>Vision</activity>",
        &["agents.xml:1:30: error[E0301]: attribute `Enable` has no value (write `Enable=\"1\"`)"],
    );
    check_agent(
        "priority='1' priority='2'",
        "<activity>Vision</activity>",
        &["agents.xml:1:43: error[E0307]: attribute `priority` is repeated (remove one of them)"],
    );
    check(
        "hello <agents/>",
        &[
            "agents.xml:1:1: error[E0301]: text outside an element (text must be inside an element: `<name>text</name>`)",
        ],
    );
    // A file of another kind is one mistake.
    check(
        "# A role.\nkeep = Watch\n[a < b]\n[b < c]\n",
        &[
            "agents.xml:1:1: error[E0301]: this is not XML (XML begins with an element; the name of a configuration in TOML ends with `.toml`)",
        ],
    );
    check(
        "<agents>",
        &["agents.xml:1:2: error[E0301]: `<agents>` is not closed (write `</agents>` behind it)"],
    );
}

#[test]
fn two_mistakes_are_two_diagnostics() {
    check_agent(
        "prority='1'",
        "<activity>Vsion</activity>\n<activity>Behaviour</activity>",
        &[
            "agents.xml:1:30: error[E0304]: unknown attribute `prority` of `agent` (did you mean `priority`?)",
            "agents.xml:3:11: error[E0312]: unknown activity `Vsion` (did you mean `Vision`?)",
            "agents.xml:4:11: error[E0312]: unknown activity `Behaviour` (did you mean `Behavior`?)",
        ],
    );
}

#[test]
fn missing_files_are_reported_with_the_nearest_one() {
    let text = "<agent><name>a</name><statechart>models/golie.srm</statechart></agent>";
    let expected =
        "agents.xml:1:34: error[E0316]: no model file `models/golie.srm` (did you mean `models/goalie.srm`?)";
    assert_eq!(read(text, &[("goalie.srm", "goalie = Vision")]).1, [expected]);
    let text = "<agent><name>Goalie</name><statechart>models</statechart></agent>";
    let expected = "models:1:1: error[E0317]: `models` is a folder, not a file (name a file in it, for example `models/goalie.srm`)";
    assert_eq!(read(text, &[("goalie.srm", "goalie = Vision")]).1, [expected]);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("agents.xml"), "").unwrap();
    let (setup, diagnostics) = config::load(folder.path().join("agent.xml"), &registry());
    assert!(setup.agents.is_empty() && setup.links.is_empty());
    let findings = diagnostics[0].to_string().replace(&format!("{}/", folder.path().display()), "");
    assert_eq!(findings, "agent.xml:1:1: error[E0316]: no file `agent.xml` (did you mean `agents.xml`?)");
}

/// Diagnostics of a model named by an agent.
fn check_model(model: &str, expected: &[&str]) {
    let text = "<agent><name>a</name><statechart>models/m.srm</statechart></agent>";
    assert_eq!(read(text, &[("m.srm", model)]).1, expected);
}

#[test]
fn a_model_is_found_from_the_folders_above() {
    let (agents, diagnostics) = read(
        "<agent><name>a</name><statechart>models/m.srm</statechart></agent>",
        &[("m.srm", "m = Vision . Behavior")],
    );
    assert_eq!(diagnostics, [""; 0]);
    assert_eq!(agents[0].charts()[0].name, "m");
}

#[test]
fn errors_in_a_model_are_reported_with_positions_in_it() {
    check_model(
        "m = Vsion . Behavior",
        &[
            "models/m.srm:1:5: error[E0318]: no activity `Vsion` is registered for the state `m/Vsion` (did you mean `Vision`?)",
        ],
    );
}

#[test]
fn errors_in_formulas_and_expressions_have_positions_in_the_model() {
    check_model(
        "m = Vision . . Behavior",
        &[
            "models/m.srm:1:14: error[E0205]: there is nothing to the left of `.` (an operator connects two terms)",
        ],
    );
    check_model(
        "m = a\na = b . Vision\nb = a",
        &["models/m.srm:3:5: error[E0214]: `a` refines itself: a -> b -> a (repetition is written `x~`, \
           `x*` or `x+`)"],
    );
    check_model(
        &refined("Vision -> Behavior : [ball.x >]"),
        &[
            "models/m.srm:4:31: error[E0106]: an operand is expected, not `]` (an operand is a name, a number, a \"text\", \
           `true`, `false` or a call)",
        ],
    );
    check_model(&refined("Vision -> Behavior : [ball.fuond]"), &[UNKNOWN_FIELD]);
}

const UNKNOWN_FIELD: &str = "models/m.srm:4:28: error[E0134]: the message `Ball` has no field `fuond` (from `m/Vision` to \
                             `m/Behavior`) (did you mean `found`?)";

fn refined(entries: &str) -> String {
    format!("Liveness:\nm = Vision . Behavior\nTransitions:\n{entries}")
}

#[test]
fn a_wrong_entry_does_not_hide_what_is_wrong_elsewhere_in_the_model() {
    let entries = "Vision -> Behavior : [ball.fuond]\nVsion -> Behavior : [false]";
    let unknown_path = "models/m.srm:5:1: error[E0250]: `Vsion -> Behavior : [false]` names no transition of the chart (did \
                        you mean `Vision`?)";
    check_model(&refined(entries), &[UNKNOWN_FIELD, unknown_path]);
}

#[test]
fn a_configuration_runs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("agents.xml");
    fs::write(&path, LISTING).unwrap();
    let mut simulation = Talws::from_config(&path, registry()).unwrap().simulate(1).unwrap();
    simulation.run_until(monas::Timestamp::from_secs_f64(1.0)).unwrap();
    assert_eq!(simulation.statistics().calls(Talws::LOCAL, "Vision"), 10);
    fs::write(&path, LISTING.replace("Vision", "Vsion")).unwrap();
    let error = Talws::from_config(&path, registry()).unwrap_err();
    assert_eq!((error.kind(), error.diagnostics().len()), (ErrorKind::Invalid, 1));
    assert!(error.to_string().ends_with("unknown activity `Vsion` (did you mean `Vision`?)"), "{error}");
}

#[test]
fn properties_are_held_against_the_chart_before_the_run() {
    let agent = |monitor: &str| {
        format!("<agent><name>a</name><statechart>models/walker.srm</statechart>{monitor}</agent>")
    };
    let files = [
        ("walker.srm", "walker = Vision . Walk"),
        (
            "good.properties",
            "property \"p\": always (entering Walk implies eventually leaving Walk within 2 s)",
        ),
        (
            "bad.properties",
            "property \"p\":\n always not in Walc\nproperty \"q\": always not [Unknown.field]",
        ),
    ];
    let (agents, findings) =
        read(&agent("<monitor on_violation='policy'>models/good.properties</monitor>"), &files);
    assert_eq!((agents.len(), findings.len()), (1, 0), "{findings:?}");
    let (_, findings) = read(&agent("<monitor>models/bad.properties</monitor>"), &files);
    assert_eq!(findings.len(), 2, "{findings:?}");
    assert!(
        findings.iter().any(|it| it.ends_with(
            "bad.properties:2:16: error[E0845]: the chart `walker` has no state `Walc` (did you mean `Walk`?)"
        )),
        "{findings:?}"
    );
    assert!(findings.iter().any(|it| it.contains("E0132")), "{findings:?}");
    let (_, findings) = read(&agent("<monitor>models/god.properties</monitor>"), &files);
    assert!(findings[0].ends_with(
        "error[E0316]: no file of properties `models/god.properties` (did you mean `models/good.properties`?)"
    ), "{findings:?}");
    let list = "<agent thread_frequency='1'><name>a</name><activity>Vision</activity><monitor>models/good.properties</monitor></agent>";
    let (_, findings) = read(list, &files);
    assert!(findings[0].contains("error[E0324]: agent `a` has 0 statecharts"), "{findings:?}");
}
