//! The attributes of `body` that a kind of body declares.

use std::path::Path;

use monas_config::read;
use monas_core::registry::Registry;
use monas_robot::{
    BodyEnvironment, BodyFault, BodyKind, BodyOption, BodySettings, Error, ErrorKind, OptionKind, body_kind,
};
use yase::Source;

const OPTIONS: &[BodyOption] = &[
    BodyOption { name: "shade", kind: OptionKind::Word(&["linen", "paper"]), doc: "its shade" },
    BodyOption { name: "bulbs", kind: OptionKind::Whole(1, 9), doc: "the number of its bulbs" },
    BodyOption { name: "height", kind: OptionKind::Number(0.2, 2.0), doc: "m; by default 1.5" },
    BodyOption { name: "dims", kind: OptionKind::Flag, doc: "whether it can be dimmed" },
    BodyOption { name: "room", kind: OptionKind::Name, doc: "where it is" },
];

body_kind!(BodyKind {
    name: "lamp",
    summary: "a lamp",
    options: OPTIONS,
    has_own_time: |_| false,
    limits: |_, _| Vec::new(),
    faults,
    open: |_| Err(Error::new(ErrorKind::Configuration, "a lamp is for tests only")),
    serve: None,
    probe: |_| Ok("it is on".to_owned()),
});

/// A paper shade is too near to more than three bulbs, and a lamp of its own is in a room.
fn faults(settings: &BodySettings, surroundings: BodyEnvironment) -> Vec<BodyFault> {
    let option = |name: &str| settings.options.get(name).map(String::as_str);
    let burns = option("shade") == Some("paper") && option("bulbs") > Some("3");
    let is_lost = surroundings == BodyEnvironment::Own && option("room").is_none();
    [burns.then(|| BodyFault::new("bulbs", "paper burns")), is_lost.then(|| BodyFault::new("room", "where?"))]
        .into_iter()
        .flatten()
        .collect()
}

/// The diagnostics of a file with these attributes of a lamp.
fn found(attributes: &str) -> Vec<String> {
    let text = format!("<agents>\n  <body kind=\"lamp\" {attributes}/>\n</agents>");
    let (_, diagnostics) = read(&Source::new("a.xml", text), Path::new("a.xml"), &Registry::linked());
    diagnostics.iter().map(ToString::to_string).collect()
}

#[test]
fn values_of_the_declared_kinds_are_accepted() {
    assert_eq!(found("shade='paper' bulbs='3' height='0.2' dims='true' room='hall_1'"), [""; 0]);
}

#[test]
fn each_wrong_value_is_reported_at_its_place_with_what_is_allowed() {
    let expected = [
        "a.xml:2:28: error[E0306]: `shade` is `papr`, expected `linen` or `paper` (did you mean `paper`?)",
        "a.xml:2:41: error[E0306]: `bulbs` is `0`, expected a whole number from 1 to 9 (the number of its bulbs)",
        "a.xml:2:52: error[E0306]: `height` is `9`, expected a number from 0.2 to 2 (m; by default 1.5)",
        "a.xml:2:61: error[E0306]: `dims` is `yes`, expected `0` or `1` (whether it can be dimmed)",
        "a.xml:2:72: error[E0306]: `room` is `a b`, expected a name of letters, digits, `-` and `_` (where it is)",
    ];
    assert_eq!(found("shade='papr' bulbs='0' height='9' dims='yes' room='a b'"), expected);
}

#[test]
fn values_that_do_not_go_together_are_reported_at_the_attribute_of_the_fault() {
    let wrong = found("shade='paper' bulbs='4' room='hall'");
    assert_eq!(wrong, ["a.xml:2:42: error[E0306]: paper burns"]);
    // An attribute that is not written has no place of its own.
    assert_eq!(found("bulbs='4'"), ["a.xml:2:4: error[E0306]: where?"]);
    // Consequences of a refused value are not reported.
    assert_eq!(found("shade='papers' bulbs='x'").len(), 2);
}

#[test]
fn unknown_options_and_kinds_are_reported_with_near_ones() {
    let near = "a.xml:2:21: error[E0304]: a body of kind `lamp` has no option `bulb` (did you mean `bulbs`?)";
    assert_eq!(found("bulb='1'"), [near]);
    let text = "<body kind=\"lump\"/>";
    let (_, diagnostics) = read(&Source::new("a.xml", text), Path::new("a.xml"), &Registry::linked());
    let found: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!(
        found,
        [
            "a.xml:1:13: error[E0328]: there is no body of kind `lump`; linked are `lamp` (did you mean `lamp`?)"
        ]
    );
}
