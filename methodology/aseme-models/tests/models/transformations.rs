//! Inputs and outputs of the transformations in `tests/golden`. `MONAS_BLESS=1` rewrites the
//! outputs.

use std::path::{Path, PathBuf};

use aseme_models::convert::Model;
use aseme_models::iac::{ChartKind, Iac};
use aseme_models::{Aip, SystemRoles, transformations};
use yase::Diagnostic;

use crate::kit::{clean, read};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name)
}

fn input(name: &str) -> Model {
    clean(&std::fs::read_to_string(path(name)).expect("an input"))
}

#[track_caller]
fn check(name: &str, actual: &str) {
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(path(name), actual).expect("writable");
    }
    let expected = std::fs::read_to_string(path(name)).expect("a golden file");
    assert!(actual == expected, "{name} differs from its golden file; MONAS_BLESS=1 accepts it:\n{actual}");
}

/// Asserts that an output has no findings but open operators, and survives a round trip.
#[track_caller]
fn check_model(name: &str, model: &Model) {
    let text = model.to_text();
    let (again, _, findings) = read(&text);
    assert!(findings.iter().all(|it| it.code == "E0219"), "{findings:?}");
    assert_eq!(again, *model, "{name}");
    check(name, &text);
}

fn codes(findings: &[Diagnostic]) -> Vec<&str> {
    findings.iter().map(|finding| finding.code).collect()
}

fn protocols(name: &str) -> Aip {
    let Model::Aip(aip) = input(name) else { panic!("protocols") };
    aip
}

fn roles(name: &str) -> SystemRoles {
    let Model::Srm(srm) = input(name) else { panic!("roles") };
    srm
}

fn chart(text: &str) -> Iac {
    let (Model::Chart(chart), ..) = read(text) else { panic!("a chart") };
    chart
}

#[test]
fn goals_become_use_cases() {
    let Model::Sag(sag) = input("goals/in.sag") else { panic!("goals") };
    let (suc, findings) = transformations::sag_to_suc(&sag);
    assert_eq!(findings, []);
    check_model("goals/out.suc", &Model::Suc(suc));
}

#[test]
fn a_goal_without_an_actor_is_rejected() {
    let text = "SAG:\nGoal: Win\nActor: a\n";
    let Model::Sag(sag) = clean(text) else { panic!("goals") };
    let (_, findings) = transformations::sag_to_suc(&sag);
    assert_eq!(codes(&findings), ["E0830"]);
    assert_eq!(&text[findings[0].span.start..findings[0].span.end], "Goal: Win");
}

#[test]
fn use_cases_of_several_roles_become_protocols() {
    let Model::Suc(suc) = input("protocols/in.suc") else { panic!("use cases") };
    let (aip, findings) = transformations::suc_to_aip(&suc);
    assert_eq!(findings, []);
    check_model("protocols/out.aip", &Model::Aip(aip));
    let (aip, findings) = transformations::suc_to_aip(&aseme_models::Suc::default());
    assert_eq!((aip, codes(&findings)), (Aip::default(), vec!["E0831"]));
}

#[test]
fn use_cases_become_roles() {
    let Model::Suc(suc) = input("roles/in.suc") else { panic!("use cases") };
    let (srm, findings) = transformations::suc_to_srm(&suc, None);
    assert_eq!(findings, []);
    assert_eq!(
        srm.roles[1].liveness,
        "goalie=AttackProtocol_goalie ?OP? DefendGoal ?OP? Listen\nAttackProtocol_goalie=Clear\nDefendGoal=Dive ?OP? TrackBall\n"
    );
    check_model("roles/out.srm", &Model::Srm(srm));
    let (srm, findings) = transformations::suc_to_srm(&suc, Some(&protocols("roles/in.aip")));
    assert_eq!(findings, []);
    check_model("roles/out_with_protocols.srm", &Model::Srm(srm));
}

#[test]
fn a_capability_in_which_a_role_begins_nothing_is_reported() {
    let text = "SUC:\nRole: a\n  type = System\nRole: b\n  type = System\nUseCase: u\n  participants = a, b\n  includes = v\nUseCase: v\n  participants = a, b\n";
    let Model::Suc(suc) = clean(text) else { panic!("use cases") };
    assert_eq!(codes(&transformations::suc_to_srm(&suc, None).1), ["E0832"]);
}

#[test]
fn a_participant_is_of_the_role_that_its_name_ends_in() {
    let text = "SUC:\nRole: player\n  type = System\nRole: player2\n  type = System\nRole: Play_player\n  type = System\n\
        UseCase: Walk\n  participants = player, player2, Play_player\n";
    let Model::Suc(suc) = clean(text) else { panic!("use cases") };
    let Model::Aip(aip) = clean(
        "AIP:\nParticipant: Play_player2\n  liveness = Second\nParticipant: Play_player\n  liveness = Whole\n\
         Participant: Win_player\n  liveness = First\nParticipant: Win_player2_often\n  liveness = Often\n",
    ) else {
        panic!("protocols")
    };
    let (srm, findings) = transformations::suc_to_srm(&suc, Some(&aip));
    assert_eq!(findings, []);
    let formulas: Vec<&str> = srm.roles.iter().map(|role| role.liveness.as_str()).collect();
    assert_eq!(
        formulas,
        [
            "player=Walk\nWin_player=First\n",
            "player2=Walk\nPlay_player2=Second\nWin_player2_often=Often\n",
            "Play_player=Whole\n"
        ]
    );
}

/// Names that differ only in case are one activity, also with another one between them.
#[test]
fn an_activity_of_several_use_cases_is_listed_once() {
    let text = "SUC:\nRole: a\n  type = System\nUseCase: Walk\n  participants = a\n\
        UseCase: Look\n  participants = a\nUseCase: walk\n  participants = a\n";
    let Model::Suc(suc) = clean(text) else { panic!("use cases") };
    let (srm, _) = transformations::suc_to_srm(&suc, None);
    assert_eq!(srm.roles[0].activities, [0, 1]);
}

#[test]
fn a_protocol_becomes_a_chart() {
    let (charts, findings) = transformations::aip_to_eac(&protocols("protocol_chart/in.aip"));
    assert_eq!(findings, []);
    let [eac] = charts.as_slice() else { panic!("{} charts", charts.len()) };
    check_model("protocol_chart/out.eac", &Model::Chart(eac.clone()));
    let (meant, findings) = eac.to_statechart();
    assert_eq!(findings, []);
    meant.compile(&yase::TypeEnvironment::default()).expect("a chart that runs");
}

#[test]
fn participants_without_formulas_are_activities() {
    let Model::Aip(aip) = clean(
        "AIP:\nParticipant: a\nParticipant: b c\n  liveness = \"x.y\"\nProtocol: p\n  participants = a, b c\n",
    ) else {
        panic!()
    };
    let (charts, findings) = transformations::aip_to_eac(&aip);
    assert_eq!(findings, []);
    let kinds: Vec<(&str, &str)> =
        charts[0].nodes.iter().map(|node| (node.name.as_str(), node.kind.as_str())).collect();
    assert!(kinds.contains(&("a", "BASIC")) && kinds.contains(&("b_c", "OR")), "{kinds:?}");
}

#[test]
fn faults_in_a_participants_formulas_are_placed_there() {
    let text = "AIP:\nParticipant: a\n  liveness = x.\nParticipant: b\nProtocol: p\n  participants = a, b\n";
    let (Model::Aip(aip), _, findings) = read(text) else { panic!() };
    assert!(findings.iter().any(Diagnostic::is_error));
    let (_, findings) = transformations::aip_to_eac(&aip);
    assert_eq!(&text[findings[0].span.start..findings[0].span.end], "x.");
}

#[test]
fn roles_become_charts_with_functionalities() {
    let (charts, findings) = transformations::roles_to_iac(&roles("role_charts/in.srm"));
    assert_eq!(findings, []);
    for chart in charts {
        check_model(&format!("role_charts/{}.iac", chart.name), &Model::Chart(chart));
    }
}

fn extended_attacker() -> Iac {
    let Model::Role(role) = input("merged/in.srm") else { panic!("a role") };
    let (chart, findings) = aseme::role_to_statechart(role.srm());
    assert_eq!(findings, []);
    Iac::from_statechart(&chart, ChartKind::Intra)
}

fn protocol() -> String {
    std::fs::read_to_string(path("merged/in.eac")).expect("an input")
}

#[test]
fn a_protocols_chart_goes_into_that_of_a_role() {
    let mut iac = extended_attacker();
    let (merged, findings) = transformations::merge_eac(&mut iac, &chart(&protocol()));
    assert_eq!(findings, []);
    assert_eq!(merged.len(), 2);
    check_model("merged/out.iac", &Model::Chart(iac));
}

#[test]
fn the_protocols_chart_is_that_of_its_formulas() {
    let (charts, _) = transformations::aip_to_eac(&protocols("protocol_chart/in.aip"));
    let names = |chart: &Iac| -> Vec<String> {
        chart.nodes.iter().map(|node| format!("{} {} {}", node.label, node.name, node.kind)).collect()
    };
    assert_eq!(names(&chart(&protocol())), names(&charts[0]));
}

#[test]
fn broken_protocols_are_refused() {
    let swapped = protocol().replace("WalkTowardsGoal", "StandStill");
    let mut iac = extended_attacker();
    let before = iac.clone();
    let (merged, findings) = transformations::merge_eac(&mut iac, &chart(&swapped));
    assert_eq!((merged.len(), codes(&findings)), (1, vec!["E0835"]));
    assert!(
        findings[0].message.contains("WalkTowardsGoal BASIC instead of StandStill BASIC"),
        "{}",
        findings[0]
    );
    let unlike = |node: &&aseme_models::iac::IacNode| before.nodes.contains(node);
    assert!(iac.nodes.iter().filter(unlike).count() > 0);

    let renamed = protocol().replace("center", "middle");
    let (merged, findings) = transformations::merge_eac(&mut extended_attacker(), &chart(&renamed));
    assert_eq!((merged.len(), codes(&findings)), (0, vec!["E0837"]));
}

#[test]
fn the_protocol_takes_precedence_over_the_role() {
    let mut iac = extended_attacker();
    let inside = iac
        .transitions
        .iter()
        .position(|it| it.name == "WalkTowardsBallTO_open_option_passBall_close_option_")
        .expect("there");
    iac.transitions[inside].te = "[Ball.near]".into();
    iac.constants.push(yase::statechart::Constant {
        name: "reach".into(),
        value: yase::statechart::ConstantValue::Number(9.0),
    });
    let (_, findings) = transformations::merge_eac(&mut iac, &chart(&protocol()));
    assert_eq!(codes(&findings), ["E0836", "E0836"]);
    assert_eq!(iac.transitions[inside].te, "[Ball.distance < reach]");
}

#[test]
fn the_functionality_table_is_there_in_every_form() {
    let table = transformations::functionality_table(&roles("table/in.srm"));
    check_model("table/out.ft", &Model::Ft(table.clone()));
    check("table/out.txt", &table.to_table());
    check("table/out.html", &table.to_html());
    check("table/out.csv", &table.to_csv().replace("\r\n", "\n"));
    roxmltree::Document::parse(&table.to_html()).expect("well-formed");
    assert_eq!(table.to_csv().matches("\r\n").count(), table.rows.len() + 1);
}

#[test]
fn a_program_completes_only_what_the_model_leaves_open() {
    let mut table = transformations::functionality_table(&roles("table/in.srm"));
    let whole = table.clone();
    table.complete(|_| Some(("other".into(), "other".into())));
    assert_eq!(table, whole, "each row has a functionality");
    (table.rows[0].functionality, table.rows[0].technology) = (String::new(), String::new());
    table.complete(|name| (name == "RobotController").then(|| ("Narukom".into(), "game::controller".into())));
    assert_eq!(
        (table.rows[0].functionality.as_str(), table.rows[0].technology.as_str()),
        ("Narukom", "game::controller")
    );
}
