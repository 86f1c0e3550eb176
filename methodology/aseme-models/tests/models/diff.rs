//! Differences between two charts.

use aseme_models::diff::{diff, picture};
use aseme_models::statechart_of;
use yase::{Source, Statechart};
use yase_export::{to_dot_marked, to_svg_marked};

const ROLE: &str = "\
Role: player
Liveness:
player = Stand . ( Search | act )
act = Track . Kick
Constants:
near = 0.25
Transitions:
CONDITION -> Search : [!Ball.found]
CONDITION -> act : [Ball.found]
Track -> Kick : [Ball.distance < near]
States:
Kick : priority = 5
";

fn chart(text: &str) -> Statechart {
    let (chart, findings) = statechart_of(&Source::new("player.srm", text));
    assert_eq!(findings, []);
    chart
}

/// The differences after replacements in the role's text.
fn said(replacements: &[(&str, &str)]) -> Vec<String> {
    let edited = replacements.iter().fold(ROLE.to_owned(), |role, (text, other)| {
        assert!(role.contains(text), "{text}");
        role.replace(text, other)
    });
    diff(&chart(ROLE), &chart(&edited)).changes.iter().map(ToString::to_string).collect()
}

#[test]
fn a_chart_does_not_differ_from_itself_nor_from_its_role_written_otherwise() {
    assert_eq!(said(&[]), [""; 0]);
    assert_eq!(
        said(&[("near = 0.25", "near = 25 cm"), ("Ball.distance < near", "near>Ball.distance")]).len(),
        1
    );
    assert_eq!(
        said(&[("( Search | act )", "(Search|act)"), ("near = 0.25", "near = 25cm  # close")]),
        [""; 0]
    );
}

#[test]
fn expressions_states_and_constants_are_compared() {
    assert_eq!(
        said(&[
            ("[Ball.found]", "[Ball.found && up]"),
            ("priority = 5", "priority = 4, exit = raise(done)"),
            ("0.25", "0.3")
        ]),
        [
            "~ state `Kick`: nothing, now `exit = raise(done)`",
            "~ state `Kick`: `priority = 5`, now `priority = 4`",
            "~ transition `CONDITION -> act`: `[Ball.found]`, now `[Ball.found && up]`",
            "~ constant `near`: `0.25`, now `0.3`",
        ]
    );
    assert_eq!(
        said(&[("CONDITION -> act :", "CONDITION -> act !2 interrupts :")]),
        ["~ transition `CONDITION -> act`: `[Ball.found]`, now `!2 interrupts [Ball.found]`"]
    );
}

#[test]
fn a_composite_whose_formula_was_edited_is_the_same_composite() {
    assert_eq!(
        said(&[("Search | act )", "Search | act | Wait )")]),
        [
            "> state `(Search|act|Wait)`, was `(Search|act)`",
            "+ state `Wait` (BASIC)",
            "+ transition `CONDITION -> Wait`",
            "+ transition `Wait -> END`",
        ]
    );
}

#[test]
fn a_state_that_went_elsewhere_has_moved_and_is_not_another_one() {
    let said = said(&[
        ("player = Stand .", "player = Stand . Kick ."),
        ("act = Track . Kick", "act = Track"),
        ("Track -> Kick", "Track -> END"),
    ]);
    assert_eq!(
        said,
        [
            "> state `player/Kick`, was `player/(Search|act)/act/Kick`",
            "> transition `Stand -> Kick`, was `Stand -> (Search|act)`",
            "> transition `Kick -> (Search|act)`, was `Kick -> END`",
            "> transition `Track -> END`, was `Track -> Kick`",
        ]
    );
}

#[test]
fn the_order_in_which_ways_out_are_tried_is_compared() {
    let said = said(&[("( Search | act )", "( act | Search )")]);
    assert_eq!(
        said,
        [
            "> state `(act|Search)`, was `(Search|act)`",
            "~ order `CONDITION`: `Search, act`, now `act, Search`"
        ]
    );
}

#[test]
fn regions_are_distinguished_by_their_content() {
    let before = chart("r = a~ || b~");
    let said = |text: &str| -> Vec<String> {
        diff(&before, &chart(text)).changes.iter().map(ToString::to_string).collect()
    };
    assert_eq!(
        said("r = b~ || a~"),
        ["> state `b~||a~`, was `a~||b~`", "~ order `b~||a~`: `a~, b~`, now `b~, a~`"]
    );
    let with_third = said("r = c~ || a~ || b~");
    assert!(
        with_third.iter().all(|line| line.starts_with('+') || line.starts_with("> state `c~||a~||b~`")),
        "{with_third:?}"
    );
}

#[test]
fn both_charts_are_in_the_picture_in_colours() {
    let (before, after) = (
        chart(ROLE),
        chart(
            &ROLE
                .replace("Track . Kick", "Look . Kick")
                .replace("Track -> Kick", "Look -> Kick")
                .replace("priority = 5", "priority = 6"),
        ),
    );
    let picture = picture(&before, &after, &diff(&before, &after));
    let svg = to_svg_marked(&picture.chart, &picture.marks);
    for (class, name) in [("added", "Look"), ("removed", "Track"), ("changed", "Kick")] {
        let opening = format!("<g class=\"{class}\">");
        let groups = svg.split(&opening).skip(1);
        let found = groups
            .map(|group| group.split("</g>").next().unwrap_or_default())
            .any(|group| group.contains(&format!(">{name}</text>")));
        assert!(found, "{name} is not {class} in {svg}");
    }
    assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
    let dot = to_dot_marked(&picture.chart, &picture.marks).text;
    let line = dot.lines().find(|line| line.contains("label=\"Track\"")).unwrap_or_default();
    assert!(line.contains("color=\"#c0261d\""), "{dot}");
    let plain = yase_export::to_svg(&after);
    assert!(!plain.contains("<g ") && !plain.contains("removed"), "nothing is set apart");
}
