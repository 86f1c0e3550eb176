//! Structural faults of files are reported with their positions.

use crate::kit::{codes_and_texts, read};

const HEAD: &str = r#"<statechart:Model xmlns:xmi="http://www.omg.org/XMI" xmlns:statechart="http://statechart/1.0" name="m">"#;

fn nested(body: &str) -> String {
    format!("{HEAD}\n{body}\n</statechart:Model>")
}

fn flat(body: &str) -> String {
    format!("<IAC:Model xmlns:IAC=\"http://www.amcl.tuc.gr/aseme/metamodels/IAC\">\n{body}\n</IAC:Model>")
}

#[track_caller]
fn check(text: &str, expected: &[(&str, &str)]) {
    let (.., findings) = read(text);
    assert_eq!(codes_and_texts(text, &findings), expected, "{findings:#?}\n{text}");
}

const ROOT: &str =
    r#"<nodes name="r" label="0" type="OR"><Children name="0.1" label="0.1" type="START"/></nodes>"#;

#[test]
fn references_that_lead_nowhere() {
    let transition =
        r#"<transitions name="x" source="//@nodes.0/@Children.0" target="//@nodes.0/@Children.7"/>"#;
    check(&nested(&format!("{ROOT}{transition}")), &[("E0807", "//@nodes.0/@Children.7")]);
    check(
        &nested(&format!(r#"{ROOT}<transitions name="x" target="//@nodes.0"/>"#)),
        &[("E0809", "<transitions")],
    );
    check(
        r#"<SAGmodel><goals name="g" depender="//@goals.0"/><actors name="a"/></SAGmodel>"#,
        &[("E0809", "<goals"), ("E0807", "//@goals.0")],
    );
}

#[test]
fn charts_without_a_root_or_with_several() {
    check(&nested(""), &[("E0811", "<statechart:Model")]);
    let second =
        r#"<nodes name="0.2" label="1" type="OR"><Children name="1.1" label="1.1" type="START"/></nodes>"#;
    check(&nested(&format!("{ROOT}{second}")), &[("E0811", "<nodes")]);
}

#[test]
fn nodes_that_lie_in_themselves_or_after_their_children() {
    let circle = r#"<nodes name="a" label="0" type="OR" Father_of="//@nodes.1"/><nodes name="b" label="0.1" type="START" Father_of="//@nodes.0"/>"#;
    let (.., findings) = read(&flat(circle));
    assert!(findings.iter().any(|it| it.code == "E0812" && it.is_error()), "{findings:?}");
    let late = r#"<nodes name="0.1" label="0.1" type="START" Father_of="//@nodes.1"/><nodes name="r" label="0" type="OR"/>"#;
    check(&flat(late), &[("E0812", "//@nodes.1")]);
}

#[test]
fn labels_types_and_places() {
    check(&nested(&ROOT.replace("label=\"0.1\"", "label=\"0.2\"")), &[("E0813", "<Children")]);
    check(&nested(&ROOT.replace("\"START\"", "\"STRAT\"")), &[("E0816", "<nodes"), ("E0814", "<Children")]);
    check(
        &nested(
            r#"<nodes name="r" label="0" type="AND"><Children name="a" label="0.1" type="BASIC"/></nodes>"#,
        ),
        &[("E0814", "<nodes"), ("E0816", "<Children")],
    );
    let back = r#"<transitions name="x" source="//@nodes.0" target="//@nodes.0/@Children.0"/>"#;
    check(&nested(&format!("{ROOT}{back}")), &[("E0816", "<transitions")]);
    check(&nested(r#"<nodes name="r" label="0" type="OR"/>"#), &[("E0816", "<nodes")]);
}

#[test]
fn words_that_no_metamodel_has() {
    check(&nested(&ROOT.replace("label=\"0\"", "label=\"0\" colour=\"red\"")), &[("E0804", "colour")]);
    check(&nested(&format!("{ROOT}<states/>")), &[("E0803", "<states")]);
    check(
        r#"<SUCmodel><roles name="r" type="Systm"/><roles name="s"/><usecases name="u"/></SUCmodel>"#,
        &[("E0806", "Systm")],
    );
    check("<SUCmodel/>", &[("E0809", "<SUCmodel"), ("E0809", "<SUCmodel")]);
    let (found, findings) = aseme_models::convert::read(&yase::Source::new("x", "<html/>"));
    assert!(found.is_none());
    assert_eq!(findings[0].code, "E0801");
}

#[test]
fn ends_that_disagree() {
    check(
        r#"<SAGmodel><goals name="g" depender="//@actors.0"/><actors name="a"/><actors name="b" my_goal="//@goals.0"/></SAGmodel>"#,
        &[("E0808", "<actors"), ("E0808", "//@goals.0")],
    );
}

#[test]
fn nesting_has_a_limit_in_every_dialect() {
    let deep = 400;
    let children = r#"<Children name="a" label="0" type="OR">"#.repeat(deep);
    let text = nested(&format!(
        "<nodes name=\"r\" label=\"0\" type=\"OR\">{children}{}</nodes>",
        "</Children>".repeat(deep)
    ));
    let (.., findings) = read(&text);
    assert!(findings.iter().any(|it| it.code == "E0815"));
    let nodes: String = (0..deep)
        .map(|index: usize| {
            format!(
                "<nodes name=\"a\" label=\"0\" type=\"OR\" Father_of=\"//@nodes.{}\"/>",
                index.saturating_sub(1)
            )
        })
        .collect();
    let (model, _, findings) = read(&flat(&nodes.replacen(" Father_of=\"//@nodes.0\"", "", 1)));
    assert!(findings.iter().any(|it| it.code == "E0815"));
    assert!(model.to_text().len() < 1 << 20);
    let tree: String = (0..deep).map(|index| format!("{:1$}a OR\n", "", index + 2)).collect();
    let (.., findings) = read(&format!("IAC: x\nStates:\n{tree}"));
    assert!(findings.iter().any(|it| it.code == "E0815"));
}
