//! Links from XML, and activities executed by another process.
use std::fs;
use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, LinkTransport, Progress, Topics, config};
use monas_link::{PublishAs, Reliability, SendBudget};
use yase::Source;

use crate::configuration::agents::registry;
use crate::kit;

/// The links of a text read beside these files, and its diagnostics.
fn links(text: &str, files: &[(&str, &str)]) -> (Vec<monas::LinkConfig>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let path = folder.path().join("agents.xml");
    let (setup, diagnostics) = config::read(&Source::new("agents.xml", text), &path, &registry());
    let prefix = format!("{}/", folder.path().display());
    (setup.links, diagnostics.iter().map(|diagnostic| diagnostic.to_string().replace(&prefix, "")).collect())
}

#[test]
fn a_link_is_read() {
    let text = "<agents><link name='robot_2' folder='sockets' beat='50ms' guests='1' access='access.txt'>\
                <send topics='test/ball' reliability='best_effort' priority='2'/><send topics='test/*'/>\
                <receive topics='monas/host'/><receive topics='monas/cycle' as='own'/>\
                <budget profile='spl' robots='5'/></link></agents>";
    let (links, diagnostics) = links(text, &[("access.txt", "robot_1 publish test/**  # all\n")]);
    assert_eq!(diagnostics, [""; 0]);
    let [link] = links.as_slice() else { panic!("{links:?}") };
    assert_eq!(link.transport, LinkTransport::Local { folder: Some("sockets".into()) });
    let settings = &link.settings;
    assert_eq!(
        (settings.name.as_str(), settings.accepts_unlinked, settings.beat),
        ("robot_2", true, Duration::from_millis(50))
    );
    let sent: Vec<_> =
        settings.send.iter().map(|rule| (rule.topics.as_str(), rule.reliability, rule.priority)).collect();
    assert_eq!(sent, [("test/ball", Reliability::BestEffort, 2), ("test/*", Reliability::Reliable, 4)]);
    let received: Vec<_> =
        settings.receive.iter().map(|rule| (rule.topics.as_str(), rule.publish_as)).collect();
    assert_eq!(received, [("monas/host", PublishAs::Other), ("monas/cycle", PublishAs::Own)]);
    let budget = SendBudget { packets: 12, window: Duration::from_secs(60), payload: 128 };
    assert_eq!(settings.budget, Some(budget));
    assert!(
        settings.access.may_publish("robot_1", "test/ball")
            && !settings.access.may_publish("robot_3", "test/ball")
    );
}

#[test]
fn durations_have_the_units_of_the_command_line() {
    let budget = |window: &str| {
        let budget = format!("<budget packets='12' window='{window}' payload='128'/>");
        links(&format!("<link name='a'><send topics='test/ball'/>{budget}</link>"), &[])
    };
    let (links, diagnostics) = budget("1.5h");
    assert_eq!(diagnostics, [""; 0]);
    let windows: Vec<_> = links.iter().map(|link| link.settings.budget.map(|budget| budget.window)).collect();
    assert_eq!(windows, [Some(monas::duration::parse("90min").unwrap())]);
    let wrong = "error[E0306]: `window` is `1.5d`, expected a time such as `300s` or `100ms`";
    let (_, diagnostics) = budget("1.5d");
    assert!(diagnostics.iter().any(|found| found.contains(wrong)), "{diagnostics:?}");
}

#[test]
fn a_link_that_is_not_enabled_is_left_out() {
    let (links, diagnostics) = links("<link enable='0'><send topics='test/*'/></link>", &[]);
    assert_eq!((links.len(), diagnostics), (0, vec![]));
}

/// Diagnostics of a link with these attributes and children; the link is at 1:2.
fn check_link(attributes: &str, elements: &str, expected: &[&str]) {
    let files = [("access.txt", "robot_1 publish test/**\nrobot_2 fly\n"), ("team.pem", "")];
    let (links, diagnostics) = links(&format!("<link {attributes}>\n{elements}\n</link>"), &files);
    assert_eq!(diagnostics, expected);
    assert!(links.is_empty());
}

#[test]
fn link_errors_have_positions_and_hints() {
    let send = "<send topics='test/ball'/>";
    check_link(
        "",
        "",
        &[
            "agents.xml:1:2: error[E0330]: the link neither sends nor receives anything (add topics: `<send topics=\"soccer/*\"/>`, `<receive topics=\"soccer/ball\"/>`)",
        ],
    );
    check_link(
        "nmae='a'",
        send,
        &["agents.xml:1:7: error[E0304]: unknown attribute `nmae` of `link` (did you mean `name`?)"],
    );
    check_link(
        "",
        "<sned topics='test/ball'/>\n<send topics='test/ball'/>",
        &["agents.xml:2:2: error[E0303]: unknown element `sned` (did you mean `send`?)"],
    );
    check_link(
        "",
        "<receive topics='test/bal'/>",
        &["agents.xml:2:18: error[E0331]: the topic `test/bal` is not declared; did you mean `test/ball`?"],
    );
    check_link(
        "",
        "<send topics='test/bal'/><send topics='test/*'/>",
        &["agents.xml:2:15: error[E0331]: the topic `test/bal` is not declared; did you mean `test/ball`?"],
    );
    check_link(
        "",
        "<send topics='test/ball' priority='9' reliability='relaible'/>",
        &[
            "agents.xml:2:36: error[E0306]: `priority` is `9`, expected a whole number from 1 to 7",
            "agents.xml:2:52: error[E0306]: `reliability` is `relaible`, expected one of `reliable` or `best_effort` (did you mean `reliable`?)",
        ],
    );
    check_link(
        "",
        "<send topics='test/ball'/><receive topics='test/ball' as='own'/>",
        &[
            "agents.xml:1:2: error[E0336]: `test/ball` is received as this host's own, so it cannot be sent too",
        ],
    );
    check_link(
        "",
        "<send topics='test/ball'/><budget packets='3'/>",
        &["agents.xml:2:28: error[E0332]: a budget is a profile, or `packets`, `window` and `payload` \
           (`<budget profile=\"spl\" robots=\"5\"/>`, or `<budget packets=\"240\" window=\"20min\" payload=\"128\"/>`)"],
    );
    check_link(
        "access='acces.txt'",
        send,
        &["agents.xml:1:15: error[E0316]: no file `acces.txt` (did you mean `access.txt`?)"],
    );
    check_link(
        "access='access.txt'",
        send,
        &[
            "access.txt:2:1: error[E0334]: access: `fly` is not a right: there are `publish TOPIC` and `manage`",
        ],
    );
    check_link(
        "scouting='1'",
        &format!("{send}<listen>7447</listen>"),
        &[
            "agents.xml:1:7: error[E0335]: `scouting` has no effect with the transport `local` \
         (use `transport=\"zenoh\"` to reach other computers)",
            "agents.xml:2:28: error[E0335]: `<listen>` has no effect with the transport `local` \
         (use `transport=\"zenoh\"` to reach other computers)",
        ],
    );
}

#[cfg(not(feature = "zenoh"))]
#[test]
fn zenoh_in_a_program_without_it_is_reported_with_other_errors() {
    check_link(
        "transport='zenoh'",
        "<send topics='test/ball'/><listen>7447</listen><connect>10.0.0.2</connect>",
        &[
            "agents.xml:1:18: error[E0337]: this program was built without the transport `zenoh` (build it with `--features zenoh`, or use `transport=\"local\"` on one computer)",
            "agents.xml:2:57: error[E0333]: `10.0.0.2` is not an endpoint (`tcp/192.168.1.20:7447` or `tls/robot_2:7447`)",
        ],
    );
    check_link(
        "transport='zenoh'",
        "<send topics='test/ball'/><connect>tls/10.0.0.2:7447</connect>\n\
        <certificates authority='team.pem' certificate='team.pem' key='team.key'/>",
        &[
            "agents.xml:1:2: error[E0333]: an endpoint starts with `tls/`, but the link has no certificates \
         (`<certificates authority=\"team.pem\" certificate=\"robot_1.pem\" key=\"robot_1.key\"/>`)",
            "agents.xml:1:18: error[E0337]: this program was built without the transport `zenoh` (build it with `--features zenoh`, or use `transport=\"local\"` on one computer)",
            "agents.xml:3:64: error[E0316]: no file `team.key` (did you mean `team.pem`?)",
        ],
    );
}

#[cfg(feature = "zenoh")]
#[test]
fn zenoh_in_a_program_with_it_is_checked_as_far_as_it_can_be_before_it_is_opened() {
    let send = "<send topics='test/ball'/>";
    let text = format!(
        "<link transport='zenoh' realm='cup' shared_memory='0'>{send}<listen>7447</listen><connect>tcp/10.0.0.2:7447</connect></link>"
    );
    let (read, diagnostics) = links(&text, &[]);
    assert_eq!(diagnostics, [""; 0]);
    let LinkTransport::Zenoh(endpoints) = &read[0].transport else { panic!("{read:?}") };
    assert_eq!(endpoints.listen, ["tcp/127.0.0.1:7447"], "a port alone is of this computer");
    assert_eq!(endpoints.connect, ["tcp/10.0.0.2:7447"]);
    assert_eq!(endpoints.realm.as_deref(), Some("cup"));
    assert!(!endpoints.scouting && !endpoints.shared_memory && endpoints.certificates.is_none());
    check_link(
        "transport='zenoh'",
        send,
        &["agents.xml:1:2: error[E0333]: the link neither listens nor connects, and discovery is off \
           (add `<listen>7447</listen>`, `<connect>tcp/192.168.1.20:7447</connect>` or `scouting=\"1\"`)"],
    );
    check_link(
        "transport='zenoh'",
        &format!("{send}<listen>udp/0.0.0.0:7447</listen>"),
        &[
            "agents.xml:1:2: error[E0333]: the link neither listens nor connects, and discovery is off \
           (add `<listen>7447</listen>`, `<connect>tcp/192.168.1.20:7447</connect>` or `scouting=\"1\"`)",
            "agents.xml:2:35: error[E0333]: `udp/0.0.0.0:7447` is not an endpoint (`tcp/127.0.0.1:7447` or `tls/0.0.0.0:7447`; a port alone, such as `7447`, is local to this computer)",
        ],
    );
    let certificates = "<certificates authority='team.pem' certificate='team.pem' key='team.pem'/>";
    check_link(
        "transport='zenoh'",
        &format!("{send}<listen>7447</listen>{certificates}"),
        &[
            "agents.xml:1:2: error[E0333]: the link has certificates, but its endpoint `tcp/127.0.0.1:7447` does not use them \
           (endpoints with certificates start with `tls/`)",
        ],
    );
    let (_, diagnostics) = links(
        &format!("<link transport='zenoh'>{send}<listen>tls/0.0.0.0:7447</listen>{certificates}</link>"),
        &[("team.pem", "")],
    );
    assert!(
        diagnostics[0].contains("E0336") && diagnostics[0].contains("holds no certificate in PEM"),
        "{diagnostics:?}"
    );
}

/// Publishes the ball and declares it.
#[derive(Default)]
struct See;

impl Activity for See {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }
    fn topics(&self) -> Topics {
        Topics::declared().publishes(kit::BALL)
    }
}

#[test]
fn remote_activities_belong_to_a_chart_and_need_a_link() {
    let elsewhere = |names: &str, link: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("m.srm"), "m = See . Vision").unwrap();
        let text = format!(
            "<agents><agent><name>a</name>\n<statechart elsewhere='{names}'>m.srm</statechart></agent>\n{link}</agents>"
        );
        let registry = registry().with("See", See::default);
        let (_, found) =
            config::read(&Source::new("agents.xml", text), &folder.path().join("agents.xml"), &registry);
        found.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(elsewhere("See", "<link><receive topics='test/*' as='own'/></link>"), [""; 0]);
    let unbrought = [
        "agents.xml:2:24: error[E0339]: `See` runs in another process, but no link receives its `test/ball` \
                      (add to a `<link>`: `<receive topics=\"test/ball\" as=\"own\"/>`)",
    ];
    assert_eq!(elsewhere("See", ""), unbrought);
    assert_eq!(elsewhere("See", "<link><receive topics='test/ball'/></link>"), unbrought);
    assert_eq!(
        elsewhere("Vison", ""),
        ["agents.xml:2:24: error[E0338]: the chart `m` has no activity `Vison` (did you mean `Vision`?)"]
    );
}
