//! The attack protocol of thesis 5.5: from its table to the player's chart, and conformance of
//! charts to it. `MONAS_BLESS=1` rewrites the player's chart in `models`.

use std::path::{Path, PathBuf};

use aseme::{role_to_statechart, to_text};
use aseme_models::convert::{self, Model};
use aseme_models::diff::diff;
use aseme_models::iac::ChartKind;
use aseme_models::{Aip, Iac, regenerate, statechart_of, transformations};
use aseme_verify::protocol::{Conformance, chart_conforms, player_conforms};
use yase::Source;

/// Parses a model that must have no findings.
fn clean(text: &str) -> Model {
    let (found, findings) = convert::read(&Source::new("model", text));
    assert_eq!(findings, [], "{text}");
    found.unwrap_or_else(|| panic!("no model:\n{text}")).0
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(path(name)).expect("a model")
}

fn aip() -> Aip {
    let Model::Aip(aip) = clean(&text("attack.aip")) else { panic!("protocols") };
    aip
}

fn chart(text: &str) -> Iac {
    let Model::Chart(chart) = clean(text) else { panic!("a chart") };
    chart
}

fn eac() -> Iac {
    chart(&text("attack.eac"))
}

fn player() -> Iac {
    role(&text("extended_attacker.srm"))
}

fn role(text: &str) -> Iac {
    let Model::Role(role) = clean(text) else { panic!("a role") };
    let (chart, found) = role_to_statechart(role.srm());
    assert_eq!(found, []);
    Iac::from_statechart(&chart, ChartKind::Intra)
}

/// The player with the protocol merged into it.
fn merged(eac: &Iac) -> Iac {
    let mut player = player();
    let (composites, found) = transformations::merge_eac(&mut player, eac);
    assert_eq!((composites.len(), found), (2, Vec::new()));
    player
}

fn said(conformance: &Conformance) -> Vec<String> {
    conformance.findings.iter().map(|found| format!("{}: {}", found.code, found.message)).collect()
}

#[test]
fn the_table_becomes_the_chart_of_the_protocol_and_keeps_its_guards() {
    let (mut charts, found) = transformations::aip_to_eac(&aip());
    assert_eq!((charts.len(), found), (1, Vec::new()));
    let mut made = charts.remove(0);
    let rule = "[Attack.ball_is_free && Attack.center_is_closest && Attack.center_for_is_farthest && Attack.part == CENTER]";
    assert!(made.transitions.iter().any(|it| it.te == rule), "the rule guards the way in");
    for outcome in ["[Attack.shot_at_goal]", "[Attack.opponent_has_ball]", "[Attack.ball_is_out]"] {
        assert_eq!(
            made.transitions.iter().filter(|it| it.te == outcome).count(),
            2,
            "{outcome} leads out of both"
        );
    }
    if std::env::var_os("MONAS_BLESS").is_some() && !path("attack.eac").exists() {
        std::fs::write(path("attack.eac"), Model::Chart(made.clone()).to_text()).expect("writable");
    }
    assert_eq!(regenerate::transfer_refinements(&eac(), &mut made), []);
    assert_eq!(made, eac(), "what is written in attack.eac besides is kept");
}

#[test]
fn the_protocol_goes_into_the_chart_of_the_player() {
    let made = Model::Chart(merged(&eac())).to_text();
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(path("extended_attacker.iac"), &made).expect("writable");
    }
    assert!(
        made == text("extended_attacker.iac"),
        "models/extended_attacker.iac is not up to date; MONAS_BLESS=1 writes it:\n{made}"
    );
}

#[test]
fn the_role_as_text_is_the_chart_of_the_player() {
    let found = |name: &str| statechart_of(&Source::new(name, text(name)));
    let ((role, of_role), (player, of_player)) =
        (found("extended_attacker.srm"), found("extended_attacker.iac"));
    assert_eq!((of_role, of_player), (Vec::new(), Vec::new()));
    assert_eq!(to_text(&role), to_text(&player));
    assert!(diff(&role, &player).is_empty());
}

#[test]
fn a_role_without_protocol_entries_gets_rules_guards_and_exits() {
    let text = text("extended_attacker.srm");
    let lines = text.lines().filter(|line| !line.contains(" also : "));
    // The rules of who goes to the ball, and of a ball that a mate sees, are the player's own.
    let is_own = |line: &str| line.contains("Attack.mate_lead") || line.contains("Attack.mate_sees_ball");
    let lines = lines.map(|line| match line.split_once(" : [Attack.") {
        Some((before, _)) if !is_own(line) => before,
        _ => line,
    });
    let bare: String = lines.map(|line| format!("{line}\n")).collect();
    let mut made = role(&bare);
    assert!(!made.transitions.iter().any(|it| it.te.contains("Attack.") && !is_own(&it.te)));
    let (_, found) = transformations::merge_eac(&mut made, &eac());
    assert_eq!(found, []);
    assert_eq!(made, merged(&eac()));
}

#[test]
fn the_chart_of_the_protocol_and_that_of_the_player_conform() {
    let protocol = chart_conforms(&eac(), &aip());
    assert_eq!(said(&protocol), [""; 0]);
    let player = player_conforms(&chart(&text("extended_attacker.iac")), &eac(), &aip());
    assert_eq!(said(&player), [""; 0]);
    let explored: Vec<(&str, usize, bool)> = protocol
        .explored
        .iter()
        .chain(&player.explored)
        .map(|(name, it)| (name.as_str(), it.states, it.is_finished))
        .collect();
    let expected = [
        ("Attack", 30, true),
        ("center", 4, true),
        ("center within player", 111, true),
        ("center_for", 5, true),
        ("center_for within player", 111, true),
    ];
    assert_eq!(explored, expected);
}

/// The part and its rule equal the protocol's; only the exploration of the whole player shows that
/// it is entered in the middle.
#[test]
fn a_way_into_the_middle_of_a_part_is_found_in_all_that_the_player_does() {
    let whole = text("extended_attacker.iac");
    let entry = whole.lines().find(|line| line.contains("/CONDITION -> center !1 : ")).unwrap();
    let middle = entry.replace("-> center !1", "-> [passBall] !2");
    let player = chart(&whole.replace(entry, &format!("{entry}\n{middle}")));
    let found = player_conforms(&player, &eac(), &aip());
    assert_eq!(
        said(&found),
        ["E0867: `player` executes `passBall` as `center` where the protocol does not allow it"]
    );
}

/// The findings for the protocol's chart after an edit.
fn broken(edit: impl Fn(&str) -> String) -> Vec<String> {
    let (before, after) = (text("attack.eac"), edit(&text("attack.eac")));
    assert_ne!(before, after);
    let found = chart_conforms(&chart(&after), &aip());
    assert!(!found.is_given());
    said(&found)
}

fn without(text: &str, part: &str) -> String {
    let lines: Vec<&str> = text.lines().filter(|line| !line.contains(part)).collect();
    lines.join("\n")
}

#[test]
fn a_protocol_that_lacks_an_outcome_is_refused() {
    let found = broken(|text| without(text, "[Attack.opponent_has_ball]"));
    assert_eq!(
        found,
        [
            "E0864: `center` has no exit for the outcome `Attack.opponent_has_ball`",
            "E0864: `center_for` has no exit for the outcome `Attack.opponent_has_ball`",
        ]
    );
}

#[test]
fn a_protocol_with_its_parts_swapped_is_refused() {
    let swapped = |text: &str| {
        let text = text.replace("CENTER_FOR", "@2").replace("CENTER", "@1");
        text.replace("@2", "CENTER").replace("@1", "CENTER_FOR")
    };
    let found = broken(swapped);
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|line| line.starts_with("E0863: `center")), "{found:?}");
    let aip = aip();
    let mut other = aip.clone();
    (other.participants[0].liveness, other.participants[1].liveness) =
        (aip.participants[1].liveness.clone(), aip.participants[0].liveness.clone());
    let found = said(&chart_conforms(&eac(), &other));
    assert!(found[0].starts_with("E0862: `center` differs from the protocol: WalkTowardsBall BASIC instead of WalkTowardsGoal BASIC"), "{found:?}");
}

#[test]
fn a_protocol_with_an_unguarded_pass_is_refused() {
    let found = broken(|text| text.replace(" : [Attack.pass_is_open]", ""));
    assert_eq!(found, ["E0866: `passBall` is always executed: its transition has no guard"]);
}

/// The name of a composite is the term of the formula, not a path of a file format.
#[test]
fn an_unguarded_composite_is_named_by_its_term() {
    let found = broken(|text| text.replace(" : [Attack.ball_is_passed]", ""));
    let name = "WalkTowardsBall.AssessAttack.[kickBall]";
    assert_eq!(found, [format!("E0866: `{name}` is always executed: its transition has no guard")]);
}

#[test]
fn a_protocol_that_is_engaged_in_at_any_time_is_refused() {
    let found = broken(|text| text.replace("Attack.ball_is_free && ", ""));
    assert_eq!(found.len(), 2);
    assert!(
        found[0].starts_with("E0863: `center` may be entered while `Attack.ball_is_free && "),
        "{found:?}"
    );
}

#[test]
fn a_protocol_that_is_left_for_another_reason_is_refused() {
    let found = broken(|text| text.replace("[Attack.ball_is_out]", "[Attack.ball_is_out || Attack.tired]"));
    assert_eq!(found.len(), 2);
    assert!(found[0].contains("which is not an outcome of the protocol"), "{found:?}");
}

#[test]
fn a_protocol_of_which_a_part_can_never_be_done_is_refused() {
    let found = broken(|text| text.replace("[Attack.pass_is_open]", "[false]"));
    assert_eq!(
        found,
        [
            "E0868: in `Attack`, after `WalkTowardsBall AssessAttack` the protocol allows `passBall`, but the chart never executes it"
        ]
    );
}

#[test]
fn a_player_that_does_otherwise_than_the_protocol_is_refused() {
    let judged = |edit: &dyn Fn(&mut Iac)| {
        let mut player = merged(&eac());
        edit(&mut player);
        said(&player_conforms(&player, &eac(), &aip()))
    };
    assert_eq!(judged(&|_| {}), [""; 0]);
    let always = |player: &mut Iac| {
        player
            .transitions
            .iter_mut()
            .filter(|it| it.te == "[Attack.pass_is_open]")
            .for_each(|it| it.te = String::new());
    };
    let found = judged(&always);
    assert!(found[0].starts_with("E0867: the protocol has `"), "{found:?}");
    let stays = |player: &mut Iac| player.transitions.retain(|it| it.te != "[Attack.ball_is_out]");
    assert_eq!(judged(&stays).len(), 2, "an outcome is missing from each part");
    let joins = |player: &mut Iac| {
        player
            .transitions
            .iter_mut()
            .filter(|it| it.te.contains("CENTER"))
            .for_each(|it| it.te = "[Ball.found]".into());
    };
    assert!(judged(&joins)[0].starts_with("E0863"), "it engages by another rule");
    let mut other = player();
    other.nodes.iter_mut().filter(|it| it.name.starts_with("center")).for_each(|it| it.name = "x".into());
    assert!(said(&player_conforms(&other, &eac(), &aip()))[0].starts_with("E0861"));
}

/// Characters of a participant's name that a formula cannot have are underscores in charts.
#[test]
fn a_participant_whose_name_is_no_formula_is_found_in_the_charts() {
    let renamed = |name: &str| text(name).replace("center", "the_center");
    let Model::Aip(mut aip) = clean(&renamed("attack.aip")) else { panic!("protocols") };
    aip.participants.iter_mut().for_each(|it| it.name = it.name.replace('_', " "));
    let eac = chart(&renamed("attack.eac"));
    assert_eq!(said(&chart_conforms(&eac, &aip)), [""; 0]);
    let player = player_conforms(&chart(&renamed("extended_attacker.iac")), &eac, &aip);
    assert_eq!(said(&player), [""; 0]);
    let compared: Vec<&str> = player.explored.iter().map(|(name, _)| name.as_str()).collect();
    let parts = ["the_center", "the_center within player", "the_center_for", "the_center_for within player"];
    assert_eq!(compared, parts);
}
