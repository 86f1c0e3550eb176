//! Every input yields findings and never a panic.

use aseme_models::convert::{self, Format};
use proptest::prelude::*;
use yase::Source;

/// Parses a text and writes the model in every format.
fn exercise(text: &str) {
    let (found, findings) = convert::read(&Source::new("any", text));
    for finding in &findings {
        assert!(text.get(finding.span.start..finding.span.end).is_some(), "{finding:?}");
    }
    let Some((model, _)) = found else { return assert!(!findings.is_empty()) };
    for (_, format) in Format::WORDS {
        match model.write(format, text) {
            // The text of a role is parsed as another kind of model, and Rust cannot be parsed.
            Ok(written)
                if written.lost.is_empty()
                    && !matches!(format, Format::Role | Format::Rust)
                    && !matches!(model, convert::Model::Role(_)) =>
            {
                let (again, _) = convert::read(&Source::new("again", written.text.as_str()));
                let (again, _) = again.expect("what is written is a model");
                assert_eq!(again, model, "{format:?}\n{}", written.text);
            }
            Ok(_) => {}
            Err(refused) => assert!(!refused.is_empty(), "{format:?}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_heap_of_words(kind in prop::sample::select(vec!["SAG:\n", "SUC:\n", "AIP:\n", "SRM:\n", "FT:\n", "IAC: m\n", ""]),
                         words in prop::collection::vec(prop::sample::select(WORDS.to_vec()), 0..60)) {
        exercise(&format!("{kind}{}", words.concat()));
    }

    #[test]
    fn any_heap_of_elements(root in prop::sample::select(vec!["SAGmodel", "SUCmodel", "AIPmodel", "SRMmodel", "Model", "XMI"]),
                            words in prop::collection::vec(prop::sample::select(ELEMENTS.to_vec()), 0..30)) {
        exercise(&format!("<{root}>{}</{root}>", words.concat()));
    }

    #[test]
    fn any_text(text in any::<String>()) {
        exercise(&text);
    }
}

const WORDS: [&str; 46] = [
    "Goal: g\n",
    "Actor: a\n",
    "Actor: \"a b\"\n",
    "Role: r\n",
    "UseCase: u\n",
    "Participant: p\n",
    "Protocol: q\n",
    "Activity: a\n",
    "Functionality: f\n",
    "Capability: c\n",
    "Variable: v\n",
    "Constants:\n",
    "States:\n",
    "Transitions:\n",
    "  r OR\n",
    "    START\n",
    "    a BASIC\n",
    "    b OR\n",
    "      START\n",
    "      a BASIC\n",
    "    END\n",
    "  START -> a\n",
    "  b/START -> b/a : [x]\n",
    "  a -> END !2\n",
    "    name = x\n",
    "  liveness:\n",
    "    r = a . b\n",
    "  depender = a\n",
    "  participants = r, r[2]\n",
    "  activities = a\n",
    "  functionality = f\n",
    "  type = System\n",
    "  type = a\n",
    "  label = 7\n",
    "  entry = raise(x)\n",
    "      at = 3 4\n",
    "    via = 3 4, 5 6\n",
    "# c\n",
    "  # d\n",
    "\"",
    "=",
    "\\",
    "\n",
    "  ",
    "[2]",
    "\u{feff}",
];

const ELEMENTS: [&str; 26] = [
    "<goals name='g' depender='//@actors.0'/>",
    "<actors name='a'/>",
    "<actors my_goal='//@goals.0'/>",
    "<roles name='r' participates_in='//@usecases.0'/>",
    "<usecases name='u' participant='//@roles.0 //@roles.1'/>",
    "<participants name='p' liveness='a.b'/>",
    "<protocols participants='//@participants.0'/>",
    "<activities name='a' functionality='//@functionalities.0'/>",
    "<activities functionality='text'/>",
    "<functionalities description='f'/>",
    "<roles liveness='r=a&#xA;' role_activities='//@activities.0'/>",
    "<capabilities capability_activities='//@activities.0 //@activities.1'/>",
    "<nodes name='r' label='0' type='OR'><Children name='0.1' type='START'/><Children name='a_or_b' type='OR'/></nodes>",
    "<nodes name='a' label='0.1' type='BASIC' Father_of='//@nodes.0'/>",
    "<nodes name='a' label='0.1' type='AND' Father_of='//@nodes.2'/>",
    "<transitions source='//@nodes.0' target='//@nodes.0/@Children.1' TE='[a &amp;&amp; b]' name='x'/>",
    "<transitions source='//@nodes.1' target='//@nodes.0'/>",
    "<variables name='v' type='t'/>",
    "<Node name='n' label='0' type='OR' activity='null'/>",
    "<Node name='n' label='0.1' type='START'/>",
    "<Transition source='#/0' target='#/1' TE='null'/>",
    "<Model nodes='#/0' name='m'/>",
    "<nodes name=' # ' label='0' type='?'/>",
    "text",
    "<x y='z'/>",
    "<goals name=' \"a\\&#xA;' requirements='#'/>",
];
