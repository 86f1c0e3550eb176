//! Refinements that survive the edit of a formula.

use aseme::srm::Section;
use aseme::{SrmFile, role_to_statechart, to_text};
use aseme_models::Iac;
use aseme_models::convert::Model;
use aseme_models::iac::ChartKind;
use aseme_models::regenerate::{
    RegeneratedRole, apply_refinements, comment_out_refinements, entries_of_chart, entries_of_role,
    transfer_refinements,
};
use yase::{NodeKind, Source, Statechart};

const ROLE: &str = "\
Role: player
Liveness:
player = Stand . ( Search | act )   # what it does
act = Track . Kick
Constants:
near = 0.25
Transitions:
CONDITION -> Search !2 : [!Ball.found]
CONDITION -> act interrupts : [Ball.found]
# nearly there
Track -> Kick
        : [Ball.distance < near]   # then kick
States:
Kick : priority = 5, entry = raise(kick), exit = raise(kicked), duration = 2s
Search : defer = go stop
act : history = deep
";

fn file(text: &str) -> SrmFile {
    let (file, found) = SrmFile::parse(text);
    assert_eq!(found, []);
    file
}

fn chart(text: &str) -> Statechart {
    let (chart, found) = role_to_statechart(file(text).srm());
    assert_eq!(found, []);
    chart
}

#[test]
fn matching_entries_stay_unchanged() {
    let RegeneratedRole { text, kept, lost, .. } = comment_out_refinements(&file(ROLE)).unwrap();
    assert_eq!((text.as_str(), kept, lost.len()), (ROLE, 6, 0));
}

#[test]
fn unmatched_entries_become_comments_with_reasons() {
    let edited = ROLE
        .replace("act = Track . Kick", "act = Track . [Align] . Kick")
        .replace("Search | act", "Find | act");
    let made = comment_out_refinements(&file(&edited)).unwrap();
    assert_eq!((made.kept, made.lost.len()), (3, 3));
    for lost in [
        "# lost: this names no transition of the chart; did you mean one of `Track -> [Align]`, `[Align] -> Kick`?\n\
         # Track -> Kick\n#         : [Ball.distance < near]   # then kick\n",
        "# CONDITION -> Search !2 : [!Ball.found]\n",
        "# Search : defer = go stop\n",
    ] {
        assert!(made.text.contains(lost), "{lost}\nis not in\n{}", made.text);
    }
    assert!(made.text.contains("# nearly there\n"), "comments stay");
    let refined = chart(&made.text);
    assert!(to_text(&refined).contains("-> HISTORY interrupts : [Ball.found]"), "what is left is in force");
    let again = comment_out_refinements(&file(&made.text)).unwrap();
    assert_eq!((again.text, again.lost), (made.text, Vec::new()), "once is enough");
}

#[test]
fn the_line_ends_of_the_file_are_kept() {
    let crlf = |text: &str| text.replace('\n', "\r\n");
    let edited = crlf(&ROLE.replace("act = Track . Kick", "act = Track . [Align] . Kick"));
    let made = comment_out_refinements(&file(&edited)).unwrap();
    assert_eq!(made.lost.len(), 1);
    assert_eq!(made.text, crlf(&made.text.replace('\r', "")));

    let bare =
        crlf("Role: player\nLiveness:\nplayer = Stand . ( Search | act )\nact = Track . [Align] . Kick\n");
    let made = apply_refinements(&file(&bare), &entries_of_role(&file(ROLE))).unwrap();
    assert_eq!(made.lost.len(), 1);
    assert_eq!(made.text, crlf(&made.text.replace('\r', "")));
    let last = file(&made.text);
    let made = apply_refinements(&last, &[(Section::Transitions, "act -> END : [x]".into())]).unwrap();
    assert_eq!((made.kept, made.text.as_str()), (1, crlf(&made.text.replace('\r', "")).as_str()));
}

#[test]
fn another_way_beside_the_formulas_is_named_added_and_carried() {
    let role = "Role: r\nLiveness:\nr = a . b . c\nb = d . e\nTransitions:\nb -> c : [B.x]\nb -> c also !1 : stop\nb -> c also : [B.y]\n";
    let own = chart(role);
    let from = |name: &str| {
        let node = own.find(name).unwrap();
        own.transitions()
            .filter(move |(_, it)| it.source == node)
            .map(|(_, it)| (it.priority, it.expression.to_string()))
    };
    let said: Vec<_> = from("b").collect();
    assert_eq!(said, [(0, "[B.x]".into()), (1, "stop".into()), (0, "[B.y]".into())]);
    let entries: Vec<String> = entries_of_chart(&own).into_iter().map(|(_, line)| line).collect();
    assert_eq!(entries, ["b -> c : [B.x]", "b -> c also !1 : stop", "b -> c also : [B.y]"]);

    let bare = file("Role: r\nLiveness:\nr = a . b . c\nb = d . e\n");
    let made = apply_refinements(&bare, &entries_of_chart(&own)).unwrap();
    assert_eq!((made.kept, made.lost.len()), (3, 0));
    assert_eq!(to_text(&chart(&made.text)), to_text(&own));
    assert_eq!(
        apply_refinements(&file(&made.text), &entries_of_chart(&own)).unwrap().text,
        made.text,
        "once is enough"
    );

    let edited = comment_out_refinements(&file(&role.replace("a . b . c", "a . c . b"))).unwrap();
    assert_eq!(edited.lost.len(), 3);
    assert!(edited.text.contains("\n# b -> c also !1 : stop\n"), "{}", edited.text);
}

#[test]
fn a_composite_with_history_is_entered_where_it_was_left() {
    let (chart, act) = (chart(ROLE), |chart: &Statechart| chart.find("act").unwrap());
    let history = chart.children(act(&chart)).last().copied().unwrap();
    assert_eq!(chart.node(history).kind, NodeKind::DeepHistory);
    let into: Vec<_> = chart.transitions().filter(|(_, it)| it.target == history).collect();
    assert_eq!(into.len(), 1);
    assert_eq!(into[0].1.expression.to_string(), "[Ball.found]");
    assert!(chart.transitions().all(|(_, it)| it.target != act(&chart)));
    let (_, found) = role_to_statechart(file(&ROLE.replace("act : history", "Track : history")).srm());
    let found: Vec<&str> = found.iter().map(|found| found.message.as_str()).collect();
    assert_eq!(found, ["`Track` has no states inside"]);
    let (_, found) = SrmFile::parse(ROLE.replace("= deep", "= far"));
    assert_eq!(
        found[0].to_string(),
        "error[E0245]: `far` is not a value for `history` (`shallow` or `deep`)"
    );
}

/// Entries represent all refinements of a chart.
#[test]
fn refinements_of_a_chart_become_entries_of_a_role() {
    let formulas = &ROLE[..ROLE.find("Constants:").unwrap()];
    let entries = entries_of_chart(&chart(ROLE));
    let made = apply_refinements(&file(formulas), &entries).unwrap();
    assert_eq!((made.kept, made.lost.len()), (7, 0), "{}", made.text);
    assert_eq!(to_text(&chart(&made.text)), to_text(&chart(ROLE)), "{}", made.text);
    let again = apply_refinements(&file(&made.text), &entries).unwrap();
    assert!(again.lost.is_empty(), "{:?}", again.lost);
    assert_eq!(to_text(&chart(&again.text)), to_text(&chart(ROLE)));
    let bare = apply_refinements(
        &file("player = Stand . (Search|act)\nact = Track . Kick"),
        &entries_of_role(&file(ROLE)),
    )
    .unwrap();
    assert_eq!(to_text(&chart(&bare.text)), to_text(&chart(ROLE)), "{}", bare.text);
}

#[test]
fn entries_of_the_role_take_precedence_and_others_are_listed() {
    let own = "Role: player\nLiveness:\nplayer = Stand . (Search | act)\nact = Track . [Align] . Kick\nTransitions:\nCONDITION -> act : [up]\n";
    let made = apply_refinements(&file(own), &entries_of_role(&file(ROLE))).unwrap();
    let lost: Vec<&str> = made.lost.iter().map(|lost| lost.text.as_str()).collect();
    assert_eq!(
        lost,
        ["CONDITION -> act interrupts : [Ball.found]", "Track -> Kick : [Ball.distance < near]"]
    );
    assert!(
        made.text.contains("CONDITION -> act : [up]\nCONDITION -> Search !2 : [!Ball.found]\n"),
        "{}",
        made.text
    );
    for text in lost {
        assert!(made.text.contains(&format!("\n# {text}\n")), "{}", made.text);
    }
    chart(&made.text);
}

#[test]
fn a_chart_keeps_what_only_its_file_can_say() {
    let mut older =
        Iac::from_statechart(&chart("player = Stand . (Search|act)\nact = Track . Kick"), ChartKind::Intra);
    let place = |iac: &Iac, name: &str| iac.nodes.iter().position(|node| node.name == name).unwrap();
    for (name, functionality) in [("Kick", "motion"), ("Search", "vision")] {
        let index = place(&older, name);
        older.nodes[index].functionality = functionality.into();
        older.nodes[index].metadata = format!("at 10 20 of {name}");
    }
    let kick = place(&older, "Kick");
    let end = older.transitions.iter_mut().find(|it| it.source == kick).unwrap();
    end.te = "[far]".into();
    let search = place(&older, "Search");
    older.transitions.iter_mut().find(|it| it.target == search).unwrap().te = "[lost]".into();

    let mut newer = Iac::from_statechart(
        &chart("player = Stand . (Find|Wait|act)\nact = Track . [Align] . Kick"),
        ChartKind::Intra,
    );
    let lost = transfer_refinements(&older, &mut newer);
    let node = &newer.nodes[place(&newer, "Kick")];
    assert_eq!((node.functionality.as_str(), node.metadata.as_str()), ("motion", "at 10 20 of Kick"));
    let kick = place(&newer, "Kick");
    assert_eq!(newer.transitions.iter().find(|it| it.source == kick).unwrap().te, "[far]");
    let lost: Vec<&str> = lost.iter().map(|lost| lost.message.as_str()).collect();
    assert_eq!(
        lost,
        [
            "`player/(Search|act)/Search` was removed, with: functionality = vision, metadata = at 10 20 of Search",
            "the transition was removed: `player/(Search|act)/CONDITION -> player/(Search|act)/Search : [lost]`",
        ]
    );
}

/// Internal transitions are written as entries and restored from them.
#[test]
fn internal_transitions_become_entries_and_are_restored() {
    let role = "Role: r\nLiveness:\nr = a~ . b\nTransitions:\na -> a interrupts internal : more\na~ -> b also !2 %0.5 : stop\n";
    let own = chart(role);
    let (_, loop_of_a) = own.transitions().find(|(_, it)| it.internal).unwrap();
    assert_eq!((loop_of_a.source, loop_of_a.interrupts), (loop_of_a.target, true));
    let made = apply_refinements(&file("Role: r\nLiveness:\nr = a~ . b\n"), &entries_of_chart(&own)).unwrap();
    assert_eq!(made.lost, []);
    assert_eq!(chart(&made.text), own, "{}", made.text);
}

const DRAWN: &str = "\
Role: r
Liveness:
r = a . (b | c)
Transitions:
a -> (b|c) : [x]
a -> (b|c) also : stop
CONDITION -> b : [y]
States:
(b|c) : history = deep
Layout:
# beside each other
a : at = 10 20, size = 100 40
(b|c) : at = 200 0
(b|c)/START : at = 3 3
CONDITION -> b : via = 40 80,
        120 80
a -> (b|c) also : via = 1 2
*~ : size = 300 200
";

#[test]
fn a_layout_is_no_part_of_what_a_chart_means_and_is_kept_with_it() {
    let text = DRAWN.replace("*~ : size = 300 200\n", "");
    let drawn = chart(&text);
    assert_eq!(drawn, chart(&text[..text.find("Layout:").unwrap()]));
    assert_eq!((drawn.layout.frames.len(), drawn.layout.bends.len()), (3, 2));
    let entries = entries_of_chart(&drawn);
    let plain = file("Role: r\nLiveness:\nr = a . (b | c)\n");
    let made = apply_refinements(&plain, &entries).unwrap();
    assert_eq!(made.lost, []);
    let again = chart(&made.text);
    assert_eq!((&again, &again.layout), (&drawn, &drawn.layout), "{}", made.text);
    let twice = apply_refinements(&file(&made.text), &entries).unwrap();
    assert_eq!((twice.text, twice.lost), (made.text, Vec::new()), "it is said already");
    let from_role = apply_refinements(&plain, &entries_of_role(&file(&text))).unwrap();
    assert_eq!(chart(&from_role.text).layout, drawn.layout);
}

#[test]
fn places_of_what_is_gone_become_comments_and_those_that_differ_are_listed() {
    let made =
        comment_out_refinements(&file(&DRAWN.replace("(b | c)\n", "(b | d)\n").replace("(b|c)", "(b|d)")))
            .unwrap();
    let lost: Vec<&str> = made.lost.iter().map(|it| it.text.as_str()).collect();
    assert_eq!(lost, ["*~ : size = 300 200"], "nothing goes on forever");
    let made = comment_out_refinements(&file(&DRAWN.replace("(b | c)\n", "b\n"))).unwrap();
    for lost in ["# (b|c) : at = 200 0\n", "# CONDITION -> b : via = 40 80,\n#         120 80\n"] {
        assert!(made.text.contains(lost), "{lost}\nis not in\n{}", made.text);
    }
    assert!(made.text.contains("\na : at = 10 20, size = 100 40\n"), "{}", made.text);
    let own = file("Role: r\nLiveness:\nr = a\nLayout:\na : at = 1 1\n");
    let made = apply_refinements(&own, &entries_of_role(&file(&DRAWN[..DRAWN.find("(b|c) : at").unwrap()])))
        .unwrap();
    let codes: Vec<(&str, &str)> =
        made.lost.iter().map(|it| (it.text.as_str(), it.diagnostic.code)).collect();
    assert!(codes.contains(&("a : at = 10 20, size = 100 40", "E0255")), "{codes:?}");
}

#[test]
fn an_invalid_layout_is_reported() {
    for (line, code, what) in [
        ("a : at = 10", "E0245", "`10` is not a value for `at`"),
        ("a : size = 0 5", "E0245", "`0 5` is not a value for `size`"),
        ("a : at = -1 5", "E0245", "`-1 5` is not a value for `at`"),
        ("a -> END : via = 1 2 3", "E0245", "`1 2 3` is not a value for `via`"),
        ("a : via = 1 2", "E0244", "the layout of a state has no `via`"),
        ("a -> END : at = 1 2", "E0244", "the layout of a transition has no `at`"),
        ("a -> END !2 : via = 1 2", "E0242", "`!2` is not a modifier of a transition"),
        ("a", "E0243", "an entry has a path, `:` and settings"),
        ("b : at = 1 2", "E0250", "names no state of the chart"),
        ("a -> END also : via = 1 2", "E0250", "names no transition of the chart"),
        ("a : at = 1 2\na : at = 1 2", "E0252", "both refer to `a`"),
    ] {
        let (read, mut found) = SrmFile::parse(format!("Role: r\nLiveness:\nr = a\nLayout:\n{line}\n"));
        found.extend(role_to_statechart(read.srm()).1);
        assert_eq!(found.len(), 1, "{line}: {found:?}");
        assert_eq!(found[0].code, code, "{line}");
        assert!(found[0].message.contains(what) && found[0].is_error(), "{line}: {}", found[0].message);
    }
}

#[test]
fn a_newer_model_file_keeps_the_places_of_an_older_one() {
    let drawn = chart(&DRAWN.replace("*~ : size = 300 200\n", ""));
    let older = Iac::from_statechart(&drawn, ChartKind::Intra);
    let mut newer =
        Iac::from_statechart(&chart("Role: r\nLiveness:\nr = z . a . (b | c)\n"), ChartKind::Intra);
    transfer_refinements(&older, &mut newer);
    let (meant, _) = newer.to_statechart();
    let place = |chart: &Statechart, name: &str| chart.layout.frames[&chart.find(name).unwrap()];
    assert_eq!(place(&meant, "r/a"), place(&drawn, "r/a"));
    assert_eq!(meant.layout.frames.len(), 3);
    let mut other = newer.clone();
    let a = newer.nodes.iter().position(|node| node.name == "a").unwrap();
    other.nodes[a].frame.at = Some((7.0, 7.0));
    let lost = transfer_refinements(&newer, &mut other);
    assert_eq!(lost.len(), 1, "{lost:?}");
    assert!(lost[0].message.contains("from `at = 10 20, size = 100 40`"), "{}", lost[0].message);
}

#[test]
fn a_state_without_an_activity_is_carried() {
    let text = "IAC: r\n\nStates:\n  r OR\n    START\n    wait BASIC\n      activity = \"\"\n    END\n\nTransitions:\n  START -> wait\n  wait -> END\n";
    let (waiting, found) = aseme_models::statechart_of(&Source::new("r.iac", text));
    assert_eq!(found, []);
    let entries = entries_of_chart(&waiting);
    assert_eq!(entries.iter().map(|(_, line)| line.as_str()).collect::<Vec<_>>(), ["wait : activity = \"\""]);
    let made = apply_refinements(&file("Role: r\nLiveness:\nr = wait\n"), &entries).unwrap();
    assert_eq!((made.kept, made.lost.len()), (1, 0));
    let refined = chart(&made.text);
    assert_eq!(refined.node(refined.find("wait").unwrap()).activity, None);
}

#[test]
fn entries_follow_a_composite_whose_text_was_edited() {
    let role = "\
Role: r
Liveness:
r = A . ( B | C )ω . [D . F]
Transitions:
A -> ( B | C )ω : [Ball.found]   # go
(B|C) ω/(B|C): CONDITION -> C !2 : [!In((B|C))]
(B|C)~ -> [D.F] : [false]
States:
(B|C)~ : entry = raise(begun)
(B|C) : exit = raise(done)
";
    let edited = role.replace("= A . ( B | C )ω", "= A . ( B | C | E )ω");
    let made = comment_out_refinements(&file(&edited)).unwrap();
    assert_eq!((made.kept, made.lost.len(), made.renamed.len()), (5, 0, 5), "{}", made.text);
    for line in [
        "A -> (B|C|E)~ : [Ball.found]   # go",
        "(B|C|E)~/(B|C|E): CONDITION -> C !2 : [!In((B|C|E))]",
        "(B|C|E)~ -> [D.F] : [false]",
        "(B|C|E)~ : entry = raise(begun)",
        "(B|C|E) : exit = raise(done)",
    ] {
        assert!(made.text.lines().any(|it| it == line), "{line}\nis not in\n{}", made.text);
    }
    let said = "`(B|C)~ -> [D.F] : [false]` is now `(B|C|E)~ -> [D.F] : [false]`: the formula was edited";
    assert!(made.renamed.iter().any(|it| it.code == "E0256" && it.message == said), "{:?}", made.renamed);

    // what may be one of two, or is another operator, stays to the developer
    for edit in ["= A . (( B | C | E ) || (B | C | G))ω", "= A . ( B . C )ω", "= A . ( B | G | E | H )ω"] {
        let edited = role.replace("= A . ( B | C )ω", edit);
        let made = comment_out_refinements(&file(&edited)).unwrap();
        assert!(made.renamed.is_empty() && !made.lost.is_empty(), "{}", made.text);
    }
}

/// Blanks between the parts of an entry are single ones; those in texts are what a guard compares
/// with.
#[test]
fn blanks_in_texts_are_carried_as_they_are() {
    let role = "\
Role: r
Liveness:
r = A . B
Constants:
name =   \"a  b\"
Transitions:
A -> B
   : [Say.text   == \"go  left\"]
States:
B : entry =  Say.text = \"come   back\"
";
    let entries =
        |entries: Vec<(Section, String)>| entries.into_iter().map(|(_, line)| line).collect::<Vec<_>>();
    let texts = ["\"a  b\"", "\"go  left\"", "\"come   back\""];
    for lines in [entries(entries_of_role(&file(role))), entries(entries_of_chart(&chart(role)))] {
        assert_eq!(lines.len(), 3, "{lines:?}");
        assert!(lines.iter().zip(texts).all(|(line, text)| line.contains(text)), "{lines:?}");
    }
    assert_eq!(entries_of_role(&file(role))[1].1, "A -> B : [Say.text == \"go  left\"]");
}

/// 1001 ms are not a number of seconds that a floating-point number can represent.
#[test]
fn durations_are_carried_exactly() {
    for written in ["1001ms", "1.5ms", "0.000001ms", "86400000ms"] {
        let role = format!("Role: r\nLiveness:\nr = A . B\nStates:\nB : duration = {written}\n");
        let chart = chart(&role);
        let expected = format!("B : duration = {written}");
        assert_eq!(entries_of_chart(&chart), [(Section::States, expected.clone())]);
        assert_eq!(self::chart(&role), chart);
        let text = Model::Chart(Iac::from_statechart(&chart, ChartKind::Intra)).to_text();
        assert!(text.contains(&format!("duration = {written}\n")), "{text}");
        let (read, _) = aseme_models::statechart_of(&Source::new("r.iac", text));
        assert_eq!(to_text(&read), to_text(&chart));
    }
}
