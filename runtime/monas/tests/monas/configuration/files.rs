//! `XmlConfig` and `Xml`: the listings of the thesis are accepted, and changes affect nothing else
//! in the file.

use std::collections::BTreeMap;
use std::fs;

use monas::config::{Xml, XmlConfig, XmlNode, xml};
use proptest::prelude::*;
use yase::Source;

const LOGGER: &str = include_str!("../../listings/4.5.xml");
const POSES: &str = include_str!("../../listings/4.10.xml");

fn map<V, const N: usize>(values: [(&str, V); N]) -> BTreeMap<String, V> {
    values.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

#[test]
fn the_logger_s_listing_is_read_as_it_is_printed() {
    let config = XmlConfig::from_text("logger.xml", LOGGER);
    assert!(config.is_loaded(), "{:?}", config.diagnostics());
    assert_eq!(config.element::<String>("MessageLogFile").unwrap().as_deref(), Some("MonasLog.txt"));
    assert_eq!(config.element::<u8>("MessageLogCerr").unwrap(), Some(1));
    assert_eq!(config.element::<String>("MessageLogFilter").unwrap().as_deref(), Some("all"));
    assert_eq!(config.element::<i32>("LogFileVerbosityLevel").unwrap(), Some(4));
    assert_eq!(config.element::<i32>("Gone").unwrap(), None);
}

#[test]
fn the_listing_of_poses_is_read_and_written_as_the_thesis_does() {
    let poses =
        [map([("HeadYaw", 0.876), ("HeadPitch", 1.324)]), map([("HeadYaw", 0.227), ("HeadPitch", 0.912)])];
    let printed = XmlConfig::from_text("test.xml", POSES);
    assert!(printed.is_loaded());
    assert_eq!(printed.all_attributes::<f64>("pose").unwrap(), poses);
    assert_eq!(printed.attributes::<f64>("pose").unwrap().as_ref(), Some(&poses[0]));

    // Listing 4.9, in a file that does not exist yet.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("test.xml");
    let mut config = XmlConfig::open(&path);
    assert!(!config.is_loaded() && config.diagnostics().is_empty());
    poses.iter().for_each(|pose| config.set_attributes("pose", pose, true).unwrap());
    config.save().unwrap();
    let written = fs::read_to_string(&path).unwrap();
    assert_eq!(
        written,
        "<?xml version=\"1.0\" ?>\n<pose HeadPitch=\"1.324\" HeadYaw=\"0.876\" />\n<pose HeadPitch=\"0.912\" HeadYaw=\"0.227\" />\n"
    );
    let again = XmlConfig::open(&path);
    assert!(again.is_loaded());
    assert_eq!(again.all_attributes::<f64>("pose").unwrap(), poses);
}

#[test]
fn without_iteration_an_element_is_changed_and_with_it_one_is_added() {
    let mut config = XmlConfig::from_text("a.xml", "<a>1</a>\n");
    config.set_element("a", 2, false).unwrap();
    config.set_element("a", 3, true).unwrap();
    config.set_element("b", "x < y", false).unwrap();
    assert_eq!(config.text(), "<a>2</a>\n<a>3</a>\n<b>x &lt; y</b>\n");
    assert_eq!(config.elements::<u8>("a").unwrap(), [2, 3]);
    assert_eq!(config.element::<String>("b").unwrap().as_deref(), Some("x < y"));
}

#[test]
fn elements_are_found_and_added_within_the_one_root_of_well_formed_xml() {
    let mut config = XmlConfig::from_text(
        "a.xml",
        "<?xml version='1.0'?>\n<all>\n  <speed>1</speed>\n  <!-- end -->\n</all>\n",
    );
    assert_eq!(config.element::<f64>("speed").unwrap(), Some(1.0));
    config.set_element("turn", 2.5, false).unwrap();
    let expected =
        "<?xml version='1.0'?>\n<all>\n  <speed>1</speed>\n  <turn>2.5</turn>\n  <!-- end -->\n</all>\n";
    assert_eq!(config.text(), expected);
}

#[test]
fn only_the_value_changes_in_any_context() {
    for (text, expected) in [
        ("<a x=1 y='2'/>", "<a x=\"5\" y='2'/>"),
        ("<a  x = '1'\n y=2 />", "<a  x = '5'\n y=2 />"),
        ("<a y=\"2\"></a>", "<a y=\"2\" x=\"5\"></a>"),
        ("<a/>", "<a x=\"5\"/>"),
        ("<!-- <a x=1/> -->\r\n<b><a x=\"1\">t</a></b>", "<!-- <a x=1/> -->\r\n<b><a x=\"5\">t</a></b>"),
    ] {
        let mut config = XmlConfig::from_text("a.xml", text);
        config.set_attributes("a", &map([("x", 5.0)]), false).unwrap();
        assert_eq!(config.text(), expected);
    }
    for (text, expected) in [
        ("<a x=1/>", "<a x=1>5</a>"),
        ("<a> 1 </a>", "<a> 5 </a>"),
        (
            "<a>\n  <!-- one --> 1 <!-- two --><b>2</b> more</a>",
            "<a>\n  <!-- one --> 5 <!-- two --><b>2</b> </a>",
        ),
        ("<a></a>", "<a>5</a>"),
        ("<a><![CDATA[1]]></a><?x y?>", "<a>5</a><?x y?>"),
    ] {
        let mut config = XmlConfig::from_text("a.xml", text);
        config.set_element("a", 5, false).unwrap();
        assert_eq!(config.text(), expected);
    }
}

#[test]
fn an_apostrophe_does_not_end_a_value_between_single_quotes() {
    let mut config = XmlConfig::from_text("a.xml", "<a x='1' y=\"2\"/>");
    config.set_attributes("a", &map(["x", "y"].map(|key| (key, String::from("it's")))), false).unwrap();
    assert_eq!(config.text(), "<a x='it&apos;s' y=\"it's\"/>");
}

#[test]
fn io_errors_are_reported_with_positions() {
    let config = XmlConfig::from_text("a.xml", "<a>quick</a>\n<b x=1 y=z/>");
    assert_eq!(
        config.element::<f64>("a").unwrap_err().to_string(),
        "a.xml:1:4: error[E0306]: `<a>` is `quick`, which is not of type f64"
    );
    let findings = config.attributes::<f64>("b").unwrap_err().to_string();
    assert_eq!(findings, "a.xml:2:10: error[E0306]: `y` is `z`, which is not of type f64");
    let mut broken = XmlConfig::from_text("a.xml", "<a>1");
    assert!(!broken.is_loaded());
    assert_eq!(broken.set_element("a", 2, false).unwrap_err().diagnostic().code, "E0301");
    assert_eq!(broken.text(), "<a>1");
    let mut fine = XmlConfig::from_text("a.xml", "");
    assert_eq!(fine.set_element("a b", 2, false).unwrap_err().diagnostic().code, "E0309");
    assert_eq!(fine.set_element("a", "\u{1}", false).unwrap_err().diagnostic().code, "E0309");
}

#[test]
fn a_file_that_could_not_be_read_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xml");
    fs::write(&path, b"<a>\xff</a>").unwrap();
    let mut config = XmlConfig::open(&path);
    assert!(!config.is_loaded());
    config.set_element("b", 1, false).unwrap();
    config.save().unwrap_err();
    assert_eq!(fs::read(&path).unwrap(), b"<a>\xff</a>");
}

#[test]
fn a_tree_is_queried_from_the_root_and_from_a_node() {
    let text = "<agent Priority=1><name>A</name><activity>Vision</activity></agent>\n\
                <agent Priority=2><name>B</name><activity>Behavior</activity><activity>Motion</activity></agent>";
    let tree = Xml::read(&Source::new("a.xml", text));
    let agents: Vec<XmlNode<String, u8>> = tree.query("agent").unwrap();
    assert_eq!(agents.iter().map(|agent| agent.attributes["Priority"]).collect::<Vec<_>>(), [1, 2]);
    let activities: Vec<XmlNode<String, f64>> = tree.query_within("activity", &agents[1]).unwrap();
    let names: Vec<_> = activities.iter().filter_map(|activity| activity.value.as_deref()).collect();
    assert_eq!((activities[0].name.as_str(), names), ("activity", vec!["Behavior", "Motion"]));
    assert!(tree.query::<String, String, String>("activity").unwrap().is_empty());
    assert!(tree.query::<String, char, String>("agent").is_ok());
    let error = tree.query_within::<f64, f64, String, _, _, _>("name", &agents[0]).unwrap_err();
    assert_eq!(error.to_string(), "a.xml:1:25: error[E0306]: `<name>` is `A`, which is not of type f64");
    assert_eq!(Xml::open("nowhere.xml").diagnostics()[0].code, "E0316");
}

/// Arbitrary files that contain an element `x` at some depth.
fn document() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        Just("<!-- a comment: <x>7</x> -->".to_owned()),
        Just("<?pi x=\"1\"?>".to_owned()),
        Just("\n  ".to_owned()),
        Just("\r\n".to_owned()),
        Just("<unknown a=1 b='two > one'><deeper/>text ü &amp; more</unknown>".to_owned()),
        Just("<empty></empty>".to_owned()),
        "[a-w]{1,3}".prop_map(|name| format!("<{name} v='&lt;'>1</{name}>")),
    ];
    let x = prop_oneof![
        Just("<x/>"),
        Just("<x a=1 />"),
        Just("<x>1</x>"),
        Just("<x a='2' b=\"3\"> one <!-- kept --> two <y>3</y> three </x>"),
        Just("<x><![CDATA[ <raw> ]]></x>"),
    ];
    (prop::collection::vec(piece.clone(), 0..6), x, prop::collection::vec(piece, 0..6))
        .prop_map(|(before, x, after)| format!("{}{x}{}", before.concat(), after.concat()))
}

/// The first element `x` of a text.
fn place_of_x(text: &str) -> (usize, usize) {
    let (elements, _) = xml::parse(&Source::new("a.xml", text));
    let x = elements.iter().find(|element| element.name() == "x").unwrap();
    (x.span().start, x.span().end)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_unchanged_file_is_saved_byte_by_byte(text in prop_oneof![document(), ".*"]) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        fs::write(&path, &text).unwrap();
        XmlConfig::open(&path).save().unwrap();
        prop_assert_eq!(fs::read(&path).unwrap(), text.into_bytes());
    }

    #[test]
    fn a_set_changes_its_element_and_nothing_else(text in document(), value in "[ -~ü\n\t]{0,12}", is_text: bool) {
        let mut config = XmlConfig::from_text("a.xml", text.clone());
        prop_assert!(config.diagnostics().is_empty(), "{:?}", config.diagnostics());
        match is_text {
            true => config.set_element("x", &value, false).unwrap(),
            false => config.set_attributes("x", &BTreeMap::from([("a".to_owned(), value.clone())]), false).unwrap(),
        }
        let (start, end) = place_of_x(&text);
        let new = config.text();
        prop_assert!(new.starts_with(&text[..start]) && new.ends_with(&text[end..]), "{new}");
        prop_assert_eq!(new.matches("<!-- kept -->").count(), text.matches("<!-- kept -->").count());
        prop_assert_eq!(new.matches("<y>3</y>").count(), text.matches("<y>3</y>").count());
        prop_assert!(config.diagnostics().is_empty(), "{:?}", config.diagnostics());
        match is_text {
            true => {
                let read = config.element::<String>("x").unwrap().unwrap();
                prop_assert_eq!(read, value.trim());
            }
            false => prop_assert_eq!(&config.attributes::<String>("x").unwrap().unwrap()["a"], value.trim()),
        }
    }
}
