//! Roles in the XMI form of the method's Eclipse tools.

use aseme::SrmFile;
use yase::Source;

const MODEL: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<SRM:SRMmodel xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" xmlns:SRM="http://www.amcl.tuc.gr/aseme/metamodels/SRM">
  <activities name="Wait"/>
  <activities name="Go"/>
  <roles role_activities="//@activities.0 //@activities.1" liveness="walker=Wait.move&#xA;move=Go&#126;
     &#10;" name="walker"/>
</SRM:SRMmodel>
"#;

#[test]
fn name_and_formulas_of_the_role_are_read() {
    let (file, findings) = SrmFile::parse(MODEL);
    assert_eq!(findings, []);
    assert_eq!(file.srm().role, "walker");
    assert_eq!(file.srm().liveness.to_string(), "walker = Wait . move\nmove = Go~\n");
}

#[test]
fn findings_stand_where_the_attribute_has_them() {
    let text = MODEL.replace("move=Go", "move=Goo..Wait");
    let (_, findings) = aseme::statechart_of_role(&Source::new("walker.srm", text.as_str()));
    let found: Vec<(&str, &str)> =
        findings.iter().map(|it| (it.code, &text[it.span.start..it.span.end])).collect();
    assert_eq!(found, [("E0249", "Goo"), ("E0205", ".")]);
    assert_eq!(findings[0].position(), Some((5, 96)));
}

#[test]
fn an_invalid_role_is_rejected() {
    for (text, code) in [
        ("<statechart:Model xmlns:statechart='http://statechart/1.0'/>", "E0230"),
        ("<SRMmodel/>", "E0247"),
        ("<SRMmodel><roles name='a' liveness='a=b'/><roles name='c'/></SRMmodel>", "E0248"),
        ("<SRMmodel><roles name='a'/></SRMmodel>", "E0233"),
        ("<SRMmodel>\n<roles", "E0246"),
    ] {
        let (_, findings) = SrmFile::parse(text);
        assert_eq!(findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), [code], "{text}");
    }
}

#[test]
fn deep_and_broken_xml_is_read_without_panic() {
    let texts = [
        "<a>".repeat(100_000),
        format!("<SRMmodel>{}", "<roles>".repeat(1000)),
        "<".into(),
        "<é".into(),
        "\u{feff}<SRMmodel".into(),
    ];
    for text in texts {
        let (_, findings) = SrmFile::parse(text.as_str());
        assert!(findings.iter().any(|finding| finding.is_error()));
        assert!(findings.iter().all(|finding| text.get(finding.span.start..finding.span.end).is_some()));
    }
}
