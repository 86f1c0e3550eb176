//! Variants of XMI: orders of attributes, kinds of references, older metamodels.

use aseme_models::convert::{Format, Model};
use aseme_models::iac::Dialect;
use aseme_models::suc::RoleKind;

use crate::kit::{clean, read};

#[test]
fn attributes_come_in_any_order_and_references_in_any_form() {
    let plain = r#"<statechart:Model xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" xmlns:statechart="http://statechart/1.0" name="m">
  <nodes name="r" label="0" type="OR"><Children name="0.1" label="0.1" type="START"/><Children name="a" label="0.2" type="BASIC"/></nodes>
  <transitions TE="[x &amp;&amp; y &lt; 2]" name="0.1TOa" source="//@nodes.0/@Children.0" target="//@nodes.0/@Children.1"/>
</statechart:Model>"#;
    let varied = r##"<?xml version="1.0"?>
<!-- a comment --><x:Model xmlns:x="http://statechart/1.0" xmlns:xmi="http://www.omg.org/XMI" name="m" xmi:version="2.0">
  <transitions target="#b" source="#//@nodes/@Children.0" name="0.1TOa"
    TE="[x &#38;&#x26; y &#60; 2]"/>
  <nodes type="OR" label="0" name="r"><Children type="START" label="0.1" name="0.1" activity="null"/><Children xmi:id="b" type="BASIC" label="0.2" name="a" activity=""/></nodes>
</x:Model>"##;
    assert_eq!(clean(varied), clean(plain));
}

/// Entities that consist of entities ask for any amount of memory.
#[test]
fn a_document_type_is_refused() {
    let text = "<!DOCTYPE m [<!ENTITY a \"xx\"><!ENTITY b \"&a;&a;\">]>\n<Model name=\"&b;\"/>";
    let found = aseme_models::convert::read(&yase::Source::new("m.stct", text)).1;
    let codes: Vec<&str> = found.iter().map(|found| found.code).collect();
    assert_eq!(codes, ["E0246"], "{found:?}");
    assert!(found[0].hint.as_deref().is_some_and(|hint| hint.contains("`<!DOCTYPE`")), "{found:?}");
}

#[test]
fn a_file_of_2010_nests_by_labels_in_any_order() {
    let file = r##"<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" xmlns:IAC="http://mi.parisdescartes.fr/ASEME/metamodels/IAC">
  <IAC:Node name="a" type="BASIC" label="0.10" activity="null"/>
  <IAC:Transition TE="null" source="#/3" target="#/2" name="0.1TO0.2"/>
  <IAC:Node name="b" type="BASIC" label="0.2" activity="Printer(&quot;x&quot;)"/>
  <IAC:Node name="0.1" type="START" label="0.1" activity="null"/>
  <IAC:Node name="r" type="OR" label="0" activity="null"/>
  <IAC:Model nodes="#/0 #/2 #/3 #/4" transitions="#/1" name="m"/>
</xmi:XMI>"##;
    let (model, format, findings) = read(file);
    assert_eq!(format, Format::Statechart(Dialect::MultiRoot));
    assert_eq!(
        findings.iter().map(|it| it.code).collect::<Vec<_>>(),
        ["E0813"],
        "0.10 stands where 0.3 would be"
    );
    let Model::Chart(chart) = model else { panic!("a chart") };
    let names: Vec<&str> = chart.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["r", "0.1", "b", "a"]);
    assert_eq!((chart.transitions[0].te.as_str(), chart.transitions[0].target), ("", 2));
    assert_eq!(chart.nodes[2].functionality, "Printer(\"x\")");
}

#[test]
fn older_metamodels_are_understood() {
    let suc = r#"<SUC:SUCmodel xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:SUC="http://www.amcl.tuc.gr/aseme/metamodels/SUC">
  <roles xsi:type="SUC:HumanRole" name="fan" participates_in="//@usecases.0"/><roles xsi:type="SUC:SystemRole" name="player" participates_in="//@usecases.0"/>
  <usecases name="Cheer" participant="//@roles.0 //@roles.1"/></SUC:SUCmodel>"#;
    let Model::Suc(suc) = clean(suc) else { panic!("use cases") };
    assert_eq!([suc.roles[0].kind, suc.roles[1].kind], [RoleKind::Human, RoleKind::System]);

    let srm = r#"<SRM:SRMmodel xmlns:SRM="http://www.amcl.tuc.gr/aseme/metamodels/SRM">
  <activities name="Stand" functionality="motion control"/><activities name="Scan" functionality="motion control"/>
  <capabilities name="search" activities="//@activities.1"/>
  <roles activities="//@activities.0" liveness="p=Stand.Scan" name="p" capabilities="//@capabilities.0"/></SRM:SRMmodel>"#;
    let Model::Srm(srm) = clean(srm) else { panic!("roles") };
    assert_eq!(srm.functionalities.len(), 1);
    assert_eq!(srm.functionalities[0].description, "motion control");
    assert_eq!((srm.activities[1].functionality, &srm.roles[0].activities), (Some(0), &vec![0]));
}

#[test]
fn the_namespace_of_protocols_is_misspelt_as_the_tools_have_it() {
    let Model::Aip(aip) = clean("AIP:\nParticipant: a\nParticipant: b\nProtocol: p\n  participants = a, b\n")
    else {
        panic!()
    };
    let text = Model::Aip(aip).write(Format::Xmi, "<").unwrap().text;
    assert!(text.contains("http://www.acml.tuc.gr/aseme/metamodels/AIP"), "{text}");
    clean(&text.replace("acml", "amcl"));
}

/// Settings that only the text form represents.
const SAID: &str = "\
IAC: m

Constants:
  near = 0.5

States:
  r OR
    START
    a BASIC
      activity = Walk
      priority = 5
      entry = raise(on)
      exit = raise(off)
      defer = stop
      duration = 250ms
      at = 10 20
      size = 90 30
    END

Transitions:
  START -> a !2 %0.5 interrupts
  a -> a internal : stop
  a -> END
    via = 10 20
";

#[test]
fn losses_of_dialects_are_listed_individually() {
    let model = clean(SAID);
    for (_, format) in Format::WORDS {
        let Format::Statechart(dialect) = format else { continue };
        let lost = model.write(format, SAID).unwrap().lost;
        assert!(lost.iter().all(|it| it.code == "E0850" && !it.is_error()), "{lost:?}");
        let lost: Vec<String> = lost.iter().map(|it| it.message.clone()).collect();
        for what in [
            "the constant `near = 0.5`",
            "the activity of `a`, `Walk`",
            "the priority of `a`, `5`",
            "the entry action of `a`, `raise(on)`",
            "the exit action of `a`, `raise(off)`",
            "the deferred events of `a`, `stop`",
            "the duration of `a`, `250ms`",
            "the layout of `a`, `at = 10 20`",
            "the layout of `a`, `size = 90 30`",
            "the priority of `0.1 -> a`",
            "the weight of `0.1 -> a`",
            "the word `interrupts` of `0.1 -> a`",
            "the word `internal` of `a -> a`",
            "the layout of `a -> 0.3`",
        ] {
            let whole = format!("{what}: {} cannot represent it", dialect.name());
            assert!(lost.contains(&whole), "{whole}\nis not in\n{}", lost.join("\n"));
        }
        assert_eq!(lost.len(), 14, "{}", lost.join("\n"));
    }
    let lost = model.write(Format::Scxml, SAID).unwrap().lost;
    let lost: Vec<&str> = lost.iter().map(|it| it.message.as_str()).collect();
    for what in [
        "`near`",
        "`r/a` has an activity",
        "a priority",
        "deferred events",
        "interrupts",
        "duration",
        "the layout of",
        "a weight",
    ] {
        assert!(lost.iter().any(|it| it.contains(what)), "{what} is not in\n{}", lost.join("\n"));
    }
}

/// The notation of the editors places the nodes of a model file.
#[test]
fn nodes_are_where_a_diagram_has_them() {
    let model = r#"<statechart:Model xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" xmlns:statechart="http://statechart/1.0" name="m">
  <nodes name="r" label="0" type="OR"><Children name="0.1" label="0.1" type="START"/><Children name="a" label="0.2" type="BASIC"/></nodes>
  <transitions name="0.1TOa" source="//@nodes.0/@Children.0" target="//@nodes.0/@Children.1"/>
</statechart:Model>"#;
    let diagram = r#"<notation:Diagram xmlns:xmi="http://www.omg.org/XMI" xmlns:notation="http://www.eclipse.org/gmf/runtime/1.0.2/notation" type="Statechart">
  <children type="2001">
    <children type="7001">
      <children type="3001"><element href="m.stct#//@nodes.0/@Children.1"/><layoutConstraint x="40" y="25" width="90" height="-1"/></children>
      <children type="3002"><element href="m.stct#//@nodes.0/@Children.0"/><layoutConstraint y="10"/></children>
    </children>
    <element href="m.stct#//@nodes.0"/><layoutConstraint x="5" y="5" width="300" height="200"/>
  </children>
  <edges source="a" target="b"><bendpoints points="[0, 0, 1, 1]"/></edges>
</notation:Diagram>"#;
    let source = yase::Source::new("m.stct", model);
    let (chart, found) = aseme_models::drawable_chart_of(&source, Some(&yase::Source::new("m.kse", diagram)));
    assert_eq!(found, []);
    let chart = chart.expect("a chart");
    let frame = |name: &str| chart.layout.frames[&chart.find(name).expect("a node")];
    assert_eq!((frame("a").at, frame("a").size), (Some((40.0, 25.0)), None));
    assert_eq!(frame("START").at, Some((0.0, 10.0)));
    assert_eq!(chart.layout.frames[&yase::Statechart::ROOT].size, Some((300.0, 200.0)));
    let other = yase::Source::new("n.kse", diagram.replace("@nodes.0", "@nodes.7"));
    let found = aseme_models::drawable_chart_of(&source, Some(&other)).1;
    assert_eq!(found[0].code, "E0819");
}
