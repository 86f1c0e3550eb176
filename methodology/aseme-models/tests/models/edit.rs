//! Edits of models are edits of their text: what is not concerned keeps its bytes.

use aseme_models::edit::{ModelEdit, ModelOutline, TextEdit, applied, edits, outline};
use aseme_models::statechart_of;
use proptest::prelude::*;
use yase::{NodeKind, Source, Statechart};

const ATTACKER: &str = include_str!("../../../../models/attacker.srm");
const EXTENDED: &str = include_str!("../../../../models/extended_attacker.srm");
const GOALIE: &str = include_str!("../../../../models/goalie.srm");
const CHART: &str = include_str!("../../../../models/extended_attacker.iac");
const PROTOCOL: &str = include_str!("../../../../models/attack.aip");
const GOALS: &str = include_str!("../golden/goals/in.sag");
const CASES: &str = include_str!("../golden/roles/in.suc");
const ROLES: &str = include_str!("../golden/table/in.srm");

fn chart(text: &str) -> Statechart {
    statechart_of(&Source::new("model", text)).0
}

/// The text after an edit; all lines but `changed` removed and `added` new ones are as before.
fn edited(text: &str, edit: &ModelEdit) -> String {
    applied(
        text,
        &edits(text, edit).unwrap_or_else(|refused| panic!("{edit:?}: {refused} {:?}", refused.hint)),
    )
}

fn refused(text: &str, edit: &ModelEdit) -> String {
    edits(text, edit).expect_err("it is not possible").message
}

/// The lines that differ: those of the first text, and those of the second.
fn difference<'a>(before: &'a str, after: &'a str) -> (Vec<&'a str>, Vec<&'a str>) {
    let (old, new): (Vec<&str>, Vec<&str>) = (before.split('\n').collect(), after.split('\n').collect());
    let same = old.iter().zip(&new).take_while(|(old, new)| old == new).count();
    let max = old.len().min(new.len()) - same;
    let end = old.iter().rev().zip(new.iter().rev()).take(max).take_while(|(old, new)| old == new).count();
    (old[same..old.len() - end].to_vec(), new[same..new.len() - end].to_vec())
}

/// The number of the first transition to a state whose expression contains a text.
fn transition(text: &str, target: &str, expression: &str) -> u32 {
    let chart = chart(text);
    let is_meant = |it: &yase::Transition| {
        let node = chart.node(it.target);
        let is_target = if target == "END" { node.kind == NodeKind::End } else { node.name == target };
        is_target && it.expression.to_string().contains(expression)
    };
    chart
        .transitions()
        .find(|(_, it)| is_meant(it))
        .unwrap_or_else(|| panic!("no transition to {target}"))
        .0
        .0
}

/// The number of the first state of a name.
fn first(chart: &Statechart, name: &str) -> Option<u32> {
    chart.nodes().find(|(_, node)| node.name == name).map(|(id, _)| id.0)
}

fn state(text: &str, name: &str) -> u32 {
    first(&chart(text), name).unwrap_or_else(|| panic!("no state {name}"))
}

fn set(transition: u32, expression: &str) -> ModelEdit {
    ModelEdit::SetTransition { transition, expression: Some(expression.into()), modifiers: None }
}

#[test]
fn a_guard_changes_its_own_text_only() {
    let edit = set(transition(ATTACKER, "LeftKick", "Ball.y"), "[Ball.y > 0.01]");
    let after = edited(ATTACKER, &edit);
    let lines =
        (vec!["CONDITION -> LeftKick : [Ball.y >= 0]"], vec!["CONDITION -> LeftKick : [Ball.y > 0.01]"]);
    assert_eq!(difference(ATTACKER, &after), lines);
    // an entry of several lines becomes one
    let after =
        edited(ATTACKER, &set(transition(ATTACKER, "kickBall", "kick_x"), "[Ball.distance\n  < near]"));
    assert_eq!(difference(ATTACKER, &after).1, ["CONDITION -> kickBall : [Ball.distance < near]"]);
    // without an expression
    let after = edited(ATTACKER, &set(transition(ATTACKER, "LeftKick", "Ball.y"), " "));
    assert_eq!(difference(ATTACKER, &after).1, ["CONDITION -> LeftKick"]);
}

#[test]
fn comments_within_an_entry_stay() {
    let text = "Liveness:\na = b | c\nTransitions:\nCONDITION -> b : [x # first\n   && y] # last\nCONDITION -> c : [z]\n";
    let after = edited(text, &set(transition(text, "b", "x"), "[w]"));
    assert_eq!(
        after,
        "Liveness:\na = b | c\nTransitions:\n# first\nCONDITION -> b : [w] # last\nCONDITION -> c : [z]\n"
    );
    let after = edited(text, &ModelEdit::RemoveTransition { transition: transition(text, "b", "x") });
    assert_eq!(after, "Liveness:\na = b | c\nTransitions:\n# first\n# last\nCONDITION -> c : [z]\n");
}

#[test]
fn a_transition_without_an_entry_gets_one() {
    let edit = set(transition(ATTACKER, "AlignWithBall", ""), "[true]");
    assert!(edited(ATTACKER, &edit).contains("CONDITION -> AlignWithBall : [true]"));
    // by a wildcard: one of its own, at the end of the section
    let closed = transition(GOALIE, "END", "false");
    let after = edited(GOALIE, &set(closed, "[true]"));
    let (gone, new) = difference(GOALIE, &after);
    assert_eq!((gone.len(), new.len()), (0, 1), "{new:?}");
    assert!(new[0].ends_with("-> END : [true]") || new[0].ends_with("/END : [true]"), "{new:?}");
    let text = &chart(&after).transition(yase::TransitionId(closed)).expression.to_string();
    assert_eq!(text, "[true]");
    // without sections
    let bare = "# what it does\nlamp = Off . On\n";
    let after = edited(bare, &set(1, "switch"));
    assert_eq!(after, "# what it does\nLiveness:\nlamp = Off . On\n\nTransitions:\nOff -> On : switch\n");
    assert_eq!(chart(&after).transition(yase::TransitionId(1)).expression.to_string(), "switch");
}

#[test]
fn blanks_in_texts_stay_when_an_entry_becomes_one_line() {
    let text = "Liveness:\na = b . c | d . c\n\nTransitions:\n* -> c\n  : [Say.text   == \"go  left\"]\n";
    let added = |edit: &ModelEdit| {
        let after = edited(text, edit);
        after.lines().find(|line| line.starts_with("b -> ")).map(String::from).unwrap_or(after)
    };
    let edge = transition(text, "c", "Say");
    assert_eq!(added(&set(edge, "[Say.text\n == \"a  b\"]")), "b -> c : [Say.text == \"a  b\"]");
    let modifiers = Some("!3".to_owned());
    let edit = ModelEdit::SetTransition { transition: edge, expression: None, modifiers };
    assert_eq!(added(&edit), "b -> c !3 : [Say.text == \"go  left\"]");
    let ModelOutline::Role { transitions, .. } = outline(text) else { panic!("a role") };
    assert!(transitions.iter().any(|it| it.expression == "[Say.text == \"go  left\"]"));
}

#[test]
fn modifiers_and_parallel_transitions() {
    let kick = transition(EXTENDED, "center", "center_for_is_farthest");
    let modifiers = Some("!3 interrupts".to_owned());
    let edit = ModelEdit::SetTransition { transition: kick, expression: None, modifiers };
    let after = edited(EXTENDED, &edit);
    assert!(
        difference(EXTENDED, &after).1[0].starts_with("CONDITION -> center !3 interrupts : [Attack.ball")
    );
    let (source, target) = {
        let chart = chart(ATTACKER);
        let it = chart.transition(yase::TransitionId(transition(ATTACKER, "LeftKick", "Ball.y"))).clone();
        (it.source.0, it.target.0)
    };
    let edit = ModelEdit::AddTransition { source, target, expression: "[Ball.speed > 1]".into() };
    let after = edited(ATTACKER, &edit);
    let added = transition(&after, "LeftKick", "speed");
    assert_eq!(
        difference(ATTACKER, &after).1,
        ["kickBall/CONDITION -> LeftKick also : [Ball.speed > 1]"].map(|line| {
            if difference(ATTACKER, &after).1[0].starts_with("CONDITION") { &line[9..] } else { line }
        })
    );
    let removed = edited(&after, &ModelEdit::RemoveTransition { transition: added });
    assert_eq!(removed, ATTACKER);
    let far = ModelEdit::AddTransition {
        source: state(ATTACKER, "Stand"),
        target: state(ATTACKER, "RightKick"),
        expression: String::new(),
    };
    assert!(refused(ATTACKER, &far).contains("the formulas have no transition from `Stand` to `RightKick`"));
    assert!(
        refused(
            ATTACKER,
            &ModelEdit::RemoveTransition { transition: transition(ATTACKER, "SendCalibration", "") }
        )
        .contains("made by the formulas")
    );
}

#[test]
fn a_state_is_renamed_wherever_it_is_named() {
    let edit = ModelEdit::RenameState { state: state(EXTENDED, "AssessAttack"), name: "Judge".into() };
    let after = edited(EXTENDED, &edit);
    assert!(after.contains("search = SearchBall . Judge . [ roam ]"));
    assert!(after.contains("CONDITION -> WalkTowardsBall . Judge . [kickBall] : [Attack.ball_is_passed]"));
    assert!(after.contains("WalkTowardsBall.Judge.[kickBall]/WalkTowardsBall : activity = BringBallToShoot"));
    let (chart, findings) = statechart_of(&Source::new("model", after.as_str()));
    assert!(first(&chart, "AssessAttack").is_none() && first(&chart, "Judge").is_some());
    assert_eq!(findings, []);
    let text = "Liveness:\na = b . c\nTransitions:\nb -> c : [In(a/b) && c.b]\n";
    let after = edited(text, &ModelEdit::RenameState { state: state(text, "b"), name: "d".into() });
    assert_eq!(after, "Liveness:\na = d . c\nTransitions:\nd -> c : [In(a/d) && c.b]\n");
    for (name, why) in [("kickBall", "already"), ("a b", "not a name"), ("END", "not a name")] {
        let edit = ModelEdit::RenameState { state: state(EXTENDED, "AssessAttack"), name: name.into() };
        assert!(refused(EXTENDED, &edit).contains(why), "{name}");
    }
}

#[test]
fn settings_of_states_are_added_changed_and_removed() {
    let set = |text: &str, key: &str, value: Option<&str>| {
        let edit =
            ModelEdit::SetState { state: state(text, "b"), key: key.into(), value: value.map(String::from) };
        edited(text, &edit)
    };
    let text = "Liveness:\na = b . c\n# the end\n";
    let one = set(text, "duration", Some("2s"));
    assert_eq!(one, "Liveness:\na = b . c\n# the end\n\nStates:\nb : duration = 2s\n");
    let two = set(&one, "priority", Some("5"));
    assert!(two.ends_with("b : duration = 2s, priority = 5\n"));
    assert!(set(&two, "duration", Some("10ms")).ends_with("b : duration = 10ms, priority = 5\n"));
    assert!(set(&two, "duration", None).ends_with("b : priority = 5\n"));
    assert_eq!(set(&two, "priority", None), one);
    assert_eq!(set(&one, "duration", None), "Liveness:\na = b . c\n# the end\n\nStates:\n");
}

#[test]
fn nodes_of_all_kinds_are_added_to_a_chart_and_removed() {
    let parent = state(CHART, "kickBall");
    for kind in [
        "BASIC",
        "OR",
        "AND",
        "END",
        "CONDITION",
        "JUNCTION",
        "CHOICE",
        "FORK",
        "JOIN",
        "SHALLOW_HISTORY",
        "HISTORY",
        "TERMINATE",
        "ENTRY",
        "EXIT",
    ] {
        let edit = ModelEdit::AddState { parent, kind: kind.into(), name: "extra".into() };
        let after = edited(CHART, &edit);
        assert_eq!(difference(CHART, &after).0, [""; 0], "{kind}");
        assert_eq!(difference(CHART, &after).1.len(), 1, "{kind}");
        let ModelOutline::Chart { states, .. } = outline(&after) else { panic!("a chart") };
        let number =
            states.iter().position(|it| after[it.span.start..it.span.end] == format!("extra {kind}"));
        let number = number.unwrap_or_else(|| panic!("{kind} is there"));
        let connected = edited(
            &after,
            &ModelEdit::AddTransition {
                source: number as u32,
                target: number as u32,
                expression: "[x # y]".into(),
            },
        );
        assert_eq!(difference(&after, &connected).1, ["  extra -> extra : \"[x # y]\""]);
        let removed = edited(&connected, &ModelEdit::RemoveState { state: number as u32 });
        assert_eq!(removed, CHART, "{kind}");
    }
    let edit = ModelEdit::AddState { parent, kind: "STATE".into(), name: "x".into() };
    assert!(refused(CHART, &edit).contains("not a kind of node"));
}

#[test]
fn paths_of_transitions_follow_a_renamed_state() {
    let before = chart(CHART);
    let after =
        edited(CHART, &ModelEdit::RenameState { state: state(CHART, "kickBall"), name: "shoot".into() });
    let after_chart = chart(&after);
    assert_eq!(before.transitions().count(), after_chart.transitions().count());
    for ((_, old), (_, new)) in before.transitions().zip(after_chart.transitions()) {
        assert_eq!(
            (old.source, old.target, &old.expression.to_string()),
            (new.source, new.target, &new.expression.to_string())
        );
    }
    assert!(first(&after_chart, "shoot").is_some());
    // a second state of a name makes the paths of the first ambiguous
    let twin = ModelEdit::AddState {
        parent: state(CHART, "initialize"),
        kind: "BASIC".into(),
        name: "LeftKick".into(),
    };
    let twin = chart(&edited(CHART, &twin));
    assert_eq!(before.transitions().count(), twin.transitions().count());
}

#[test]
fn items_of_forms_are_edited() {
    let ModelOutline::Form { items, .. } = outline(GOALS) else { panic!("a form") };
    let goal = items.iter().find(|item| item.word == "Goal").expect("a goal");
    let set = |text: &str, key: &str, value: &str| {
        let value = Some(value).filter(|value| !value.is_empty()).map(String::from);
        edited(text, &ModelEdit::SetField { item: goal.item, key: key.into(), value })
    };
    let after = set(GOALS, "requirements", "keep \"it\" # simple");
    assert!(
        after.contains("requirements = \"keep \\\"it\\\" # simple\"")
            || after.contains("requirements = keep \"it\"")
    );
    let ModelOutline::Form { items: again, .. } = outline(&after) else { panic!("a form") };
    let field = |items: &[aseme_models::edit::ItemOutline], key: &str| -> Vec<String> {
        let item = items.iter().find(|item| item.item == goal.item).expect("the goal");
        item.fields.iter().find(|(known, _)| *known == key).expect("the field").1.clone()
    };
    assert_eq!(field(&again, "requirements"), ["keep \"it\" # simple"]);
    assert_eq!(field(&again, "depender"), field(&items, "depender"));
    assert!(
        refused(GOALS, &ModelEdit::SetField { item: goal.item, key: "colour".into(), value: None })
            .contains("no `colour`")
    );

    // a renamed actor is renamed where goals refer to it
    let actor = items.iter().find(|item| item.word == "Actor").expect("an actor");
    let edit = ModelEdit::SetField { item: actor.item, key: String::new(), value: Some("Some, one".into()) };
    let after = edited(GOALS, &edit);
    let (_, _, findings) = crate::kit::read(&after);
    assert_eq!(findings, []);
    assert!(after.contains("\"Some, one\""), "{after}");

    let added = edited(GOALS, &ModelEdit::AddItem { word: "Goal".into(), name: "Rest".into() });
    assert_eq!(difference(GOALS, &added).0, [""; 0]);
    let ModelOutline::Form { items, .. } = outline(&added) else { panic!("a form") };
    let new = items.iter().find(|item| item.name == "Rest").expect("the new goal");
    assert_eq!(edited(&added, &ModelEdit::RemoveItem { item: new.item }), GOALS);
}

#[test]
fn formulas_of_a_form_change_by_line() {
    let ModelOutline::Form { items, .. } = outline(PROTOCOL) else { panic!("a form") };
    let part = items.iter().find(|item| item.name == "center").expect("the part");
    let set = |value: &str| {
        edited(
            PROTOCOL,
            &ModelEdit::SetField { item: part.item, key: "liveness".into(), value: Some(value.into()) },
        )
    };
    let after = set("WalkTowardsBall . AssessAttack . [passBall]\nx = y");
    assert_eq!(difference(PROTOCOL, &after), (vec![], vec!["    x = y"]));
    let after = set("Walk");
    assert_eq!(difference(PROTOCOL, &after).1, ["    Walk"]);
}

#[test]
fn functionalities_of_activities_are_fields() {
    let ModelOutline::Form { items, .. } = outline(ROLES) else { panic!("a form") };
    let functionality = items.iter().find(|item| item.word == "Functionality").expect("one");
    // quoted or not, a reference is written as its item has it
    let activities = items.iter().filter(|item| item.word == "Activity");
    let linked = activities.flat_map(|item| item.fields.iter().flat_map(|(_, links)| links));
    for link in linked {
        assert!(items.iter().any(|item| item.word == "Functionality" && item.reference == *link), "{link}");
    }
    let edit = ModelEdit::SetField {
        item: functionality.item,
        key: "technology".into(),
        value: Some("Rust".into()),
    };
    let after = edited(ROLES, &edit);
    let (aseme_models::convert::Model::Srm(srm), _, _) = crate::kit::read(&after) else { panic!("roles") };
    assert!(srm.functionalities.iter().any(|it| it.technology == "Rust"));
    assert!(difference(ROLES, &after).1.iter().any(|line| line.trim() == "technology = Rust"));
}

#[test]
fn xmi_is_not_edited() {
    let edit = ModelEdit::RemoveTransition { transition: 0 };
    assert!(refused("<?xml version=\"1.0\"?><SAGmodel/>", &edit).contains("XMI"));
    assert_eq!(outline("<SAGmodel/>"), ModelOutline::Text);
}

fn any_edit() -> impl Strategy<Value = ModelEdit> {
    let number = 0_u32..120;
    let words = prop::sample::select(vec![
        "",
        "x",
        "[Ball.y > 1]",
        "a, b",
        "e [g] / f()",
        "START",
        "ω",
        "\"",
        "#",
        "a\nb",
    ]);
    let keys = prop::sample::select(vec![
        "",
        "activity",
        "duration",
        "liveness",
        "requirements",
        "functionality",
        "kind",
        "name",
        "at",
    ]);
    let kinds = prop::sample::select(vec![
        "BASIC",
        "OR",
        "JUNCTION",
        "Goal",
        "Role",
        "Constants",
        "States",
        "Activity",
    ]);
    (0_usize..12, number.clone(), number, words, keys, kinds).prop_map(|(which, a, b, word, key, kind)| {
        let (text, index) = (word.to_owned(), a as usize % 30);
        match which {
            0 => ModelEdit::SetTransition { transition: a, expression: Some(text), modifiers: None },
            1 => ModelEdit::SetTransition { transition: a, expression: None, modifiers: Some(text) },
            2 => ModelEdit::AddTransition { source: a, target: b, expression: text },
            3 => ModelEdit::RemoveTransition { transition: a },
            4 => ModelEdit::RenameState { state: a, name: text },
            5 => ModelEdit::SetState { state: a, key: key.into(), value: Some(text) },
            6 => ModelEdit::AddState { parent: a, kind: kind.into(), name: text },
            7 => ModelEdit::RemoveState { state: a },
            8 => ModelEdit::SetField { item: index, key: key.into(), value: Some(text) },
            9 => ModelEdit::AddItem { word: kind.into(), name: text },
            10 => ModelEdit::RemoveItem { item: index },
            _ => ModelEdit::AddEntry { section: kind.into(), text },
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    /// Edits are in order and apart, and every line that no edit touches keeps its bytes.
    #[test]
    fn untouched_lines_keep_their_bytes(edit in any_edit(), which in 0_usize..8, cut in 0.5_f64..1.0) {
        let whole = [ATTACKER, EXTENDED, GOALIE, CHART, PROTOCOL, GOALS, CASES, ROLES][which];
        let mut end = (whole.len() as f64 * cut) as usize;
        while !whole.is_char_boundary(end) {
            end -= 1;
        }
        for text in [whole, &whole[..end]] {
            let Ok(edits) = edits(text, &edit) else { continue };
            prop_assert!(edits.windows(2).all(|pair| pair[0].span.end <= pair[1].span.start), "{edits:?}");
            let after = applied(text, &edits);
            let mut start = 0;
            let mut kept: Vec<&str> = Vec::new();
            for line in text.split_inclusive('\n') {
                let (begin, end) = (start, start + line.len());
                start = end;
                let touches = |span: yase::Span| span.start < end && span.end >= begin;
                // A text inserted at the end of a text without a last line break may continue that
                // line.
                let follows = |edit: &TextEdit| {
                    edit.span.start == end && (line.ends_with('\n') || !edit.text.starts_with('\n'))
                };
                if !edits.iter().any(|edit| touches(edit.span) || follows(edit)) {
                    kept.push(line);
                }
            }
            let mut rest = after.split('\n');
            for line in kept {
                let is_there = rest.any(|other| other == line.trim_end_matches('\n'));
                prop_assert!(is_there, "{line:?} is gone from\n{after}");
            }
            // every comment of the untouched rest is still there
            let comments = |text: &str| aseme::text::comments(text).len();
            if !matches!(edit, ModelEdit::RemoveItem { .. } | ModelEdit::RemoveState { .. } | ModelEdit::SetField { .. }) {
                prop_assert!(comments(&after) >= comments(text), "{edit:?} {edits:?}");
            }
        }
    }
}
