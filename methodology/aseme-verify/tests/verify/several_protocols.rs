//! Two protocols of three roles: merged into the roles in any order, with repetition and sequence,
//! every role does what the protocols ask for.

use aseme_models::convert::{self, Model};
use aseme_models::iac::ChartKind;
use aseme_models::{Aip, Iac, transformations};
use aseme_verify::protocol::{parts_taken, player_conforms};
use yase::Source;

const PROTOCOLS: &str = "AIP:
Participant: RequestMeeting_assistant
  engaging_rules = [Meeting.is_wished]
  outcomes = [Meeting.is_refused] or [Meeting.is_late]
  liveness = AskForMeeting . ReadReply
Participant: RequestMeeting_manager
  engaging_rules = [Meeting.is_requested]
  outcomes = [Meeting.is_refused] or [Meeting.is_late]
  liveness = ReadRequest . ReplyToRequest
Participant: ReserveRoom_manager
  engaging_rules = [Meeting.is_accepted]
  outcomes = [Room.is_full]
  liveness = AskForRoom . ReadOffer
Participant: ReserveRoom_room_keeper
  engaging_rules = [Room.is_requested]
  outcomes = [Room.is_full]
  liveness = FindRoom . OfferRoom
Protocol: RequestMeeting
  participants = RequestMeeting_assistant, RequestMeeting_manager
Protocol: ReserveRoom
  participants = ReserveRoom_manager, ReserveRoom_room_keeper
";

const ASSISTANT: &str = "assistant = WaitForUser . RequestMeeting_assistant
RequestMeeting_assistant = AskForMeeting . ReadReply";

const MANAGER: &str = "manager = (RequestMeeting_manager . ReserveRoom_manager)~
RequestMeeting_manager = ReadRequest . ReplyToRequest
ReserveRoom_manager = AskForRoom . ReadOffer";

const ROOM_KEEPER: &str = "room_keeper = ReserveRoom_room_keeper~
ReserveRoom_room_keeper = FindRoom . OfferRoom";

fn protocols() -> Aip {
    match convert::read(&Source::new("meeting.aip", PROTOCOLS)) {
        (Some((Model::Aip(aip), _)), found) if found.is_empty() => aip,
        (_, found) => panic!("{found:?}"),
    }
}

fn role(text: &str) -> Iac {
    let (chart, found) = aseme_models::statechart_of(&Source::new("role.srm", text));
    assert_eq!(found, []);
    Iac::from_statechart(&chart, ChartKind::Intra)
}

/// A role with the protocols merged into it in this order, those it takes no part in left out.
fn merged<'a>(role: &Iac, protocols: impl Iterator<Item = &'a Iac>) -> Iac {
    let mut role = role.clone();
    for eac in protocols {
        let takes_part = parts_taken(&role, eac).iter().any(|(_, is_taken)| *is_taken);
        let (composites, found) = transformations::merge_eac(&mut role, eac);
        let codes: Vec<&str> = found.iter().map(|found| found.code).collect();
        assert_eq!((composites.len(), codes), if takes_part { (1, vec![]) } else { (0, vec!["E0837"]) });
    }
    role
}

/// The transitions with an expression, with the names of their ends.
fn expressions(chart: &Iac) -> Vec<String> {
    let named = |node: usize| match chart.nodes[node].kind.as_str() {
        kind @ ("START" | "END") => kind.to_owned(),
        _ => chart.nodes[node].written(),
    };
    let said = chart.transitions.iter().filter(|it| !it.te.is_empty());
    said.map(|it| format!("{} -> {} : {}", named(it.source), named(it.target), it.te)).collect()
}

/// The messages are those of no program.
fn only_unknown_messages(found: Vec<yase::Diagnostic>) {
    let is_about_names = |found: &yase::Diagnostic| found.code.starts_with("E01");
    assert!(found.iter().all(is_about_names), "{found:?}");
}

#[test]
fn three_roles_conform_to_two_protocols_merged_in_any_order() {
    let aip = protocols();
    let (charts, found) = transformations::aip_to_eac(&aip);
    assert_eq!(found, []);
    for text in [ASSISTANT, MANAGER, ROOM_KEEPER] {
        let forwards = merged(&role(text), charts.iter());
        let backwards = merged(&role(text), charts.iter().rev());
        for player in [forwards, backwards] {
            let text = Model::Chart(player.clone()).to_text();
            let (_, found) = convert::read(&Source::new("player.iac", text));
            assert_eq!(found, [], "labels and names");
            assert!(!Model::Chart(player.clone()).to_text().contains("    name = "), "names of transitions");
            let (chart, found) = player.to_statechart();
            assert_eq!(found, []);
            chart.compile(&yase::TypeEnvironment::default()).map(drop).unwrap_or_else(only_unknown_messages);
            for eac in charts.iter().filter(|eac| parts_taken(&player, eac).iter().any(|(_, taken)| *taken)) {
                let found = player_conforms(&player, eac, &aip).findings;
                assert_eq!(found, [], "{} in {}:\n{:#?}", eac.name, player.name, expressions(&player));
            }
        }
    }
}

/// The outcomes end an engagement, and only the rule begins the next.
#[test]
fn a_part_that_is_repeated_is_enclosed() {
    let (charts, _) = transformations::aip_to_eac(&protocols());
    let player = merged(&role(ROOM_KEEPER), charts.iter());
    let expected = [
        "START -> ReserveRoom_room_keeper : [Room.is_requested]",
        "ReserveRoom_room_keeper -> END : [Room.is_full]",
    ];
    assert_eq!(expressions(&player), expected);
    let repeated = player.transitions.iter().find(|it| it.source == it.target).expect("it is repeated");
    assert_eq!(player.nodes[repeated.source].written(), "(ReserveRoom_room_keeper)");
    let again = merged(&player, charts.iter().skip(1));
    assert_eq!(again, player, "merged twice");
}

/// The end of one protocol is not replaced by the beginning of the next.
#[test]
fn outcomes_and_rules_stand_side_by_side() {
    let (charts, _) = transformations::aip_to_eac(&protocols());
    for player in [merged(&role(MANAGER), charts.iter()), merged(&role(MANAGER), charts.iter().rev())] {
        let mut expected = vec![
            "RequestMeeting_manager -> (ReserveRoom_manager) : [Meeting.is_late]",
            "RequestMeeting_manager -> (ReserveRoom_manager) : [Meeting.is_refused]",
            "ReserveRoom_manager -> END : [Room.is_full]",
            "START -> RequestMeeting_manager : [Meeting.is_requested]",
            "START -> ReserveRoom_manager : [Meeting.is_accepted]",
        ];
        let mut there = expressions(&player);
        expected.sort_unstable();
        there.sort_unstable();
        assert_eq!(there, expected);
    }
}

#[test]
fn a_guard_of_the_role_stays_beside_the_rule() {
    let (charts, _) = transformations::aip_to_eac(&protocols());
    let text = format!(
        "Role: a\nLiveness:\n{ASSISTANT}\nTransitions:\nWaitForUser -> RequestMeeting_assistant : [User.is_there || Meeting.is_urgent] / raise(asked)\n"
    );
    let player = merged(&role(&text), charts.iter());
    let expected = "WaitForUser -> RequestMeeting_assistant : [(User.is_there || Meeting.is_urgent) && Meeting.is_wished] / raise(asked)";
    assert!(expressions(&player).iter().any(|it| it == expected), "{:#?}", expressions(&player));
}

#[test]
fn a_part_that_is_entered_again_without_its_rule_does_not_conform() {
    let aip = protocols();
    let (charts, _) = transformations::aip_to_eac(&aip);
    let mut player = role(ROOM_KEEPER);
    let part = player.nodes.iter().position(|node| node.name == "ReserveRoom_room_keeper").expect("there");
    let first = player.transitions.iter_mut().find(|it| it.target == part && it.source != part);
    first.expect("there").te = "[Room.is_requested]".into();
    let found = player_conforms(&player, &charts[1], &aip).findings;
    let codes: Vec<&str> = found.iter().map(|found| found.code).collect();
    assert_eq!(codes, ["E0863", "E0864"], "{found:?}");
}

/// A role that is a participant itself has no place for the rule.
#[test]
fn a_role_that_is_a_part_as_a_whole_is_refused() {
    let (charts, _) = transformations::aip_to_eac(&protocols());
    let mut player = role("ReserveRoom_room_keeper = FindRoom . OfferRoom");
    let (_, found) = transformations::merge_eac(&mut player, &charts[1]);
    let codes: Vec<&str> = found.iter().map(|found| found.code).collect();
    assert_eq!(codes, ["E0839", "E0839"]);
}
