//! Behaviour of sessions that the suites do not cover.

use std::collections::BTreeMap;

use yase::{Semantics, Source, Timestamp};
use yase_scxml::{DataValue, Platform, ScxmlEvent, Session, SessionError, read};

/// A platform with files that records all calls.
#[derive(Debug, Default)]
struct RecordingPlatform {
    files: BTreeMap<String, String>,
    notes: Vec<String>,
}

impl Platform for RecordingPlatform {
    fn read(&mut self, uri: &str) -> Result<String, String> {
        self.files.get(uri).cloned().ok_or_else(|| "there is no such file".into())
    }

    fn log(&mut self, session: &str, label: &str, text: &str) {
        let label = if label.is_empty() { String::new() } else { format!("{label}=") };
        let inner = if session == "session.1" { "" } else { "  inner " };
        self.notes.push(format!("{inner}{label}{text}"));
    }

    fn send(&mut self, kind: &str, target: Option<&str>, event: &ScxmlEvent) -> bool {
        self.notes.push(format!("{kind} to {target:?}: {} {}", event.name, event.data));
        kind == "radio"
    }
}

fn document(inside: &str) -> String {
    format!("<scxml xmlns='http://www.w3.org/2005/07/scxml' version='1.0' name='test'>{inside}</scxml>")
}

fn session(inside: &str) -> Session<RecordingPlatform> {
    session_with(inside, RecordingPlatform::default())
}

fn session_with(inside: &str, platform: RecordingPlatform) -> Session<RecordingPlatform> {
    let (document, found) = read(&Source::new("test.scxml", document(inside)));
    assert!(!found.iter().any(yase::Diagnostic::is_error), "{found:?}");
    let mut session = Session::new(&document.unwrap(), platform).unwrap();
    let _ = session.start(Timestamp::ZERO);
    session
}

/// The log of a session after these events and one minute.
fn notes(inside: &str, events: &[&str]) -> Vec<String> {
    let mut session = session(inside);
    for event in events {
        session.send(ScxmlEvent::new(*event)).unwrap();
    }
    session.advance_to(Timestamp::from_millis(60_000)).unwrap();
    std::mem::take(&mut session.platform_mut().notes)
}

fn fails(inside: &str) -> SessionError {
    let mut session = session(inside);
    let error = session.advance_to(Timestamp::from_millis(60_000)).unwrap_err();
    assert!(!session.is_running() && !session.is_finished());
    assert_eq!(session.send(ScxmlEvent::new("e")), Err(error.clone()), "it stays so");
    error
}

#[test]
fn a_failed_content_ends_its_block_and_no_other() {
    let noted = notes(
        "<state id='a'>
           <onentry><log expr='1'/><assign location='nowhere' expr='1'/><log expr='2'/></onentry>
           <onentry><log expr='3'/></onentry>
           <transition event='error.execution'><log label='type' expr='_event.type'/><log expr='_event.data'/></transition>
         </state>",
        &[],
    );
    assert_eq!(noted, ["1", "3", "type=platform", "there is no variable `nowhere`"]);
}

#[test]
fn a_failed_condition_is_false_and_an_error() {
    let noted = notes(
        "<state id='a'><onentry><if cond='nothing'><log expr='1'/><else/><log expr='2'/></if><log expr='3'/></onentry>
           <transition event='error' target='b'/></state>
         <state id='b'><onentry><log expr='_event.name'/></onentry><transition cond='nothing.at.all' target='a'/>
           <transition event='error' target='c'/></state>
         <state id='c'><onentry><log expr=\"'c'\"/></onentry></state>",
        &[],
    );
    assert_eq!(noted, ["2", "3", "error.execution", "c"]);
}

#[test]
fn a_cancelled_event_is_not_sent() {
    let inside = "<state id='a'>
        <onentry><send event='one' id='x' delay='2s'/><send event='two' id='y' delay='1s'/><send event='three' delay='3s'/></onentry>
        <transition event='stop'><cancel sendid='x'/><cancel sendid='unknown'/></transition>
        <transition event='*'><log expr='_event.name'/><log expr='_event.sendid'/></transition></state>";
    assert_eq!(notes(inside, &[]), ["two", "y", "one", "x", "three", "undefined"]);
    assert_eq!(notes(inside, &["stop"]), ["two", "y", "three", "undefined"]);
}

#[test]
fn delayed_events_come_at_their_moment() {
    let mut session = session(
        "<state id='a'><onentry><send event='e' delay='1.5s'/></onentry><transition event='e' target='b'/></state><final id='b'/>",
    );
    assert_eq!(session.next_deadline(), Some(Timestamp::from_millis(1500)));
    session.advance_to(Timestamp::from_millis(1499)).unwrap();
    assert_eq!(session.configuration(), ["a"]);
    session.advance_to(Timestamp::from_millis(1500)).unwrap();
    assert_eq!((session.configuration(), session.is_finished()), (vec!["b"], true));
    assert_eq!(session.next_deadline(), None);
}

const FORWARDING: &str = "<state id='a'>
    <invoke id='child' autoforward='true'><content><scxml><state id='s'>
      <transition event='*'><log expr='_event.name'/><log label='data' expr='_event.data'/><log label='type' expr='_event.type'/></transition>
    </state></scxml></content></invoke>
    <invoke id='deaf'><content><scxml><state id='s'><transition event='*'><log expr=\"'never'\"/></transition></state></scxml></content></invoke>
    <transition event='leave' target='b'/><transition event='own'/></state>
    <state id='b'/>";

#[test]
fn autoforward_copies_every_event_from_outside() {
    let mut session = session(FORWARDING);
    session
        .send(ScxmlEvent::new("own").with_data(DataValue::Object(vec![("x".into(), DataValue::Number(1.0))])))
        .unwrap();
    session.send(ScxmlEvent::new("unknown")).unwrap();
    assert_eq!(session.inner_sessions(), 2);
    session.send(ScxmlEvent::new("leave")).unwrap();
    assert_eq!(session.inner_sessions(), 0, "both were cancelled");
    session.send(ScxmlEvent::new("own")).unwrap();
    let expected = [
        "  inner own",
        "  inner data={\"x\":1}",
        "  inner type=external",
        "  inner unknown",
        "  inner data=undefined",
        "  inner type=external",
    ];
    assert_eq!(
        session.platform().notes,
        expected,
        "the event that cancels it is not heard: it is gone by then"
    );
}

#[test]
fn finalize_has_its_say_first_and_only_for_its_own() {
    let child = |id: &str, finalize: &str| {
        format!(
            "<invoke id='{id}'><content><scxml><state id='s'><onentry>
               <send target='#_parent' event='hello'><param name='v' expr=\"'{id}'\"/></send></onentry></state></scxml></content>{finalize}</invoke>"
        )
    };
    let inside = format!(
        "<datamodel><data id='v' expr=\"'none'\"/></datamodel><state id='a'>{}{}
         <transition event='hello'><log expr='v'/><log expr='_event.invokeid'/></transition></state>",
        child("one", "<finalize><assign location='v' expr=\"'of ' + _event.data.v\"/></finalize>"),
        child("two", ""),
    );
    assert_eq!(notes(&inside, &[]), ["of one", "one", "of one", "two"]);
}

#[test]
fn an_empty_finalize_takes_over_what_is_named() {
    let noted = notes(
        "<datamodel><data id='a' expr='1'/><data id='b' expr='2'/></datamodel>
         <state id='s'><invoke namelist='a' id='i'><content><scxml><datamodel><data id='a'/></datamodel><state id='t'><onentry>
            <send target='#_parent' event='e'><param name='a' expr='a + 10'/><param name='b' expr='99'/></send></onentry></state></scxml></content>
            <finalize/></invoke>
         <transition event='e'><log expr='[a, b]'/></transition></state>",
        &[],
    );
    assert_eq!(noted, ["[11,2]"]);
}

#[test]
fn an_error_in_finalize_follows_the_event() {
    let noted = notes(
        "<state id='s'><invoke id='i'><content><scxml><state id='t'><onentry><send target='#_parent' event='e'/></onentry></state></scxml></content>
            <finalize><assign location='nowhere' expr='1'/></finalize></invoke>
         <transition event='*'><log expr='_event.name'/></transition></state>",
        &[],
    );
    assert_eq!(noted, ["e", "error.execution"]);
}

#[test]
fn done_invoke_brings_what_the_end_gives() {
    let noted = notes(
        "<state id='s'><invoke id='i'><content><scxml><final id='f'><onexit><log expr=\"'out'\"/></onexit>
            <donedata><param name='x' expr='6 * 7'/></donedata></final></scxml></content></invoke>
         <transition event='done.invoke.i' target='t'><log expr='_event.data'/><log expr='_event.invokeid'/></transition></state><final id='t'/>",
        &[],
    );
    assert_eq!(noted, ["  inner out", "{\"x\":42}", "i"]);
}

#[test]
fn events_of_a_cancelled_session_are_dropped() {
    let mut session = session(
        "<state id='s'><invoke id='i'><content><scxml><state id='t'>
            <onentry><send event='later' delay='1s'/><send target='#_parent' event='late' delay='1s'/></onentry>
            <onexit><log expr=\"'leaving'\"/><send target='#_parent' event='bye'/></onexit></state></scxml></content></invoke>
         <transition event='go' target='u'><send target='#_i' event='x'/></transition></state>
         <state id='u'><transition event='*'><log expr='_event.name'/></transition></state>",
    );
    session.send(ScxmlEvent::new("go")).unwrap();
    session.advance_to(Timestamp::from_millis(5000)).unwrap();
    assert_eq!(session.platform().notes, ["error.communication", "  inner leaving"]);
    assert_eq!(session.next_deadline(), None, "what it wanted to send later is forgotten");
}

#[test]
fn sessions_find_one_another() {
    let noted = notes(
        "<state id='s'><invoke id='i'><content><scxml><state id='t'/></scxml></content></invoke>
         <onentry><send target='#_i' event='ping'/></onentry><transition event='error'><log expr='_event.data'/></transition></state>",
        &[],
    );
    assert_eq!(
        noted,
        ["there is no session to send `ping` to"],
        "an invocation begins when the macrostep is over"
    );
    let noted = notes(
        "<state id='s'><invoke id='i'><content><scxml><state id='t'><onentry><send target='#_parent' event='up'/></onentry>
            <transition event='ping'><send targetexpr='_event.origin' typeexpr='_event.origintype' event='pong'/></transition>
         </state></scxml></content></invoke>
         <transition event='up'><send target='#_i' event='ping'/></transition>
         <transition event='pong'><log expr='_event.origin'/><log expr=\"_ioprocessors['scxml'].location\"/></transition></state>",
        &[],
    );
    assert_eq!(noted, ["#_scxml_session.2", "#_scxml_session.1"]);
}

#[test]
fn system_variables_cannot_be_changed_by_any_way() {
    let noted = notes(
        "<datamodel><data id='e'/></datamodel><state id='s'><onentry><raise event='x'/></onentry>
         <transition event='x' target='t'/></state>
         <state id='t'>
           <onentry><assign location='e' expr='_event'/><script>e.name = 'changed'</script></onentry>
           <onentry><script>_ioprocessors.scxml.location = 1</script></onentry>
           <onentry><foreach array='[1]' item='_sessionid'/></onentry>
           <onentry><log expr='e.name + _name + _sessionid'/></onentry>
           <transition event='error.execution'><log expr='_event.data'/></transition></state>",
        &[],
    );
    assert_eq!(
        noted,
        [
            "xtestsession.1",
            "a system variable cannot be changed",
            "`_ioprocessors` cannot be assigned",
            "`_sessionid` cannot be assigned",
        ]
    );
}

#[test]
fn late_variables_get_their_values_at_the_first_entry() {
    let inside = "<state id='a'><transition event='e' target='b'/></state>
         <state id='b'><datamodel><data id='x' expr='1'/></datamodel><onentry><log expr='x'/><assign location='x' expr='x + 1'/></onentry>
           <transition event='e' target='a'/></state>";
    let text = document(inside).replace("version", "binding='late' version");
    let (document, _) = read(&Source::new("d", text));
    let mut session = Session::new(&document.unwrap(), RecordingPlatform::default()).unwrap();
    session.start(Timestamp::ZERO).unwrap();
    assert_eq!(session.value("x"), Some(DataValue::Undefined));
    for _ in 0..3 {
        session.send(ScxmlEvent::new("e")).unwrap();
    }
    assert_eq!(session.platform().notes, ["1", "2"]);
    assert_eq!(session.value("x"), Some(DataValue::Number(3.0)));
}

#[test]
fn scripts_and_data_come_from_elsewhere() {
    let files = [
        ("lib.js", "function twice(x) { return 2 * x }"),
        ("data.json", "[1, 2]"),
        ("words.txt", " some \n words "),
    ];
    let files = files.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let platform = RecordingPlatform { files: files.into(), ..RecordingPlatform::default() };
    let session = session_with(
        "<datamodel><data id='a' src='data.json'/><data id='b' src='words.txt'/><data id='c' src='nowhere'/></datamodel><script src='lib.js'/>
         <state id='s'><onentry><log expr='twice(a[1])'/><log expr='b'/></onentry>
           <transition event='error.execution'><log expr='_event.data'/></transition></state>",
        platform,
    );
    assert_eq!(
        session.platform().notes,
        ["4", "some words", "`nowhere` cannot be had: there is no such file"]
    );
}

#[test]
fn a_script_that_cannot_be_had_is_refused() {
    let (document, _) = read(&Source::new("d", document("<script src='nowhere'/><state/>")));
    let refused = Session::new(&document.unwrap(), RecordingPlatform::default()).unwrap_err();
    assert_eq!(
        refused[0].to_string(),
        "error[E0621]: the script `nowhere` cannot be had: there is no such file"
    );
}

#[test]
fn other_kinds_of_targets_are_the_platforms() {
    let noted = notes(
        "<state id='s'><onentry><send type='radio' target='all' event='e'><content>[1]</content></send><log expr=\"'sent'\"/></onentry>
           <onentry><send type='smoke' id='x' event='e'/></onentry>
           <transition event='error.execution'><log expr='_event.sendid'/></transition></state>",
        &[],
    );
    assert_eq!(noted, ["radio to Some(\"all\"): e [1]", "sent", "smoke to None: e undefined", "x"]);
}

#[test]
fn a_livelock_is_stopped() {
    let eventless =
        fails("<state id='a'><transition target='b'/></state><state id='b'><transition target='a'/></state>");
    assert!(
        eventless.to_string().starts_with("session `session.1`: the chart does not come to rest"),
        "{eventless}"
    );
    let raising = fails(
        "<state id='a'><onentry><raise event='e'/></onentry><transition event='e' target='a'/></state>",
    );
    assert!(raising.to_string().contains("does not come to rest"), "{raising}");
    let sending =
        fails("<state id='a'><onentry><send event='e'/></onentry><transition event='e' target='a'/></state>");
    assert!(sending.to_string().contains("steps at one moment"), "{sending}");
    let working = fails("<datamodel><data id='a' expr='[1,2,3,4,5,6,7,8,9,10]'/></datamodel><state id='s'><onentry>
        <foreach array='a' item='b'><foreach array='a' item='c'><foreach array='a' item='d'><foreach array='a' item='e'><foreach array='a' item='f'>
        <foreach array='a' item='g'><assign location='b' expr='c + d + e + f + g'/></foreach></foreach></foreach></foreach></foreach></foreach></onentry></state>");
    assert!(working.to_string().contains("steps of evaluation"), "{working}");
    let flooding = fails("<datamodel><data id='a' expr='[1,2,3,4,5,6,7,8,9,10]'/></datamodel><state id='s'><onentry>
        <foreach array='a' item='b'><foreach array='a' item='c'><foreach array='a' item='d'><foreach array='a' item='e'><foreach array='a' item='f'>
        <send event='e' delay='1s'/></foreach></foreach></foreach></foreach></foreach></onentry></state>");
    assert!(flooding.to_string().contains("events are in transit"), "{flooding}");
}

#[test]
fn conversions_and_cancelled_events_are_work() {
    // Neither the sends nor the cancels take too many steps by themselves; each cancel looks at all
    // delayed events.
    let loops = |count: usize, inside: &str| {
        let open = |name| format!("<foreach array='a' item='{name}'>");
        let opened: String = ["b", "c", "d", "e"][..count].iter().map(open).collect();
        format!("{opened}{inside}{}", "</foreach>".repeat(count))
    };
    let document = |inside: &str| {
        format!(
            "<datamodel><data id='a' expr='[1,2,3,4,5,6,7,8,9,10]'/></datamodel>
             <script>function f(n) {{ if (n > 0) {{ f(n - 1); f(n - 1) }} }}</script>
             <state id='s'><onentry><script>f(16)</script>{inside}</onentry></state>"
        )
    };
    let send = loops(4, "<send event='e' delay='1s'/>");
    let cancel = loops(4, "<cancel sendid='x'/>");
    for fine in [&send, &cancel] {
        assert!(session(&document(fine)).is_running());
    }
    let both = fails(&document(&format!("{send}{cancel}")));
    assert!(both.to_string().contains("steps of evaluation"), "{both}");
    // A conversion takes more steps the longer the array is.
    let compare = loops(2, "<if cond=\"long == 'x'\"/>");
    let converting = |last: u32| document(&format!("<script>long = []; long[{last}] = 1</script>{compare}"));
    assert!(session(&converting(10)).is_running());
    let long = fails(&converting(262_143));
    assert!(long.to_string().contains("steps of evaluation"), "{long}");
}

#[test]
fn sessions_do_not_nest_for_ever() {
    let own = document(
        "<state id='s'><invoke src='self'/><transition event='error.communication'><log expr='_event.data'/></transition></state>",
    );
    let platform =
        RecordingPlatform { files: [("self".to_owned(), own)].into(), ..RecordingPlatform::default() };
    let session = session_with("<state id='s'><invoke src='self'/></state>", platform);
    assert_eq!(session.inner_sessions(), 15);
    assert_eq!(session.platform().notes, ["  inner sessions nest deeper than 16"]);
}

#[test]
fn a_document_that_cannot_be_invoked_is_an_error() {
    let noted = notes(
        "<state id='s'><invoke src='nowhere'/><invoke type='ftp' src='x'/><invoke id='i'><content expr=\"'no document'\"/></invoke>
           <transition event='error'><log expr='_event.name'/><log expr='_event.data'/></transition></state>",
        &[],
    );
    assert_eq!(noted.len(), 6, "{noted:?}");
    assert_eq!(
        noted[..4],
        [
            "error.execution",
            "`nowhere` cannot be had: there is no such file",
            "error.execution",
            "`ftp` cannot be invoked"
        ]
    );
    assert!(noted[5].contains("not XML"), "{noted:?}");
}

#[test]
fn two_runs_are_the_same() {
    let inside = "<datamodel><data id='n' expr='0'/></datamodel><state id='s'>
        <invoke id='a'><content><scxml><state id='t'><onentry><send event='x' delay='10ms'/></onentry><transition event='x' target='t'>
            <send target='#_parent' event='tick'><param name='who' expr=\"'a'\"/></send></transition></state></scxml></content></invoke>
        <invoke id='b'><content><scxml><state id='t'><onentry><send event='x' delay='15ms'/></onentry><transition event='x' target='t'>
            <send target='#_parent' event='tick'><param name='who' expr=\"'b'\"/></send></transition></state></scxml></content></invoke>
        <transition event='tick'><assign location='n' expr='n + 1'/><log expr='_event.data.who + n'/></transition>
        <transition event='never'/></state>";
    let run = || {
        let mut session = session(inside);
        session.advance_to(Timestamp::from_millis(300)).unwrap();
        std::mem::take(&mut session.platform_mut().notes)
    };
    let first = run();
    assert_eq!(first.len(), 50);
    assert_eq!(first[..5], ["a1", "b2", "a3", "b4", "a5"], "at 30 ms the older send comes first");
    assert_eq!(first, run());
}

#[test]
fn another_semantics_can_be_selected() {
    let text = document(
        "<state id='a'><transition event='e' target='b'/></state>
         <state id='b'><onentry><assign location='x' expr='x + 1'/></onentry><transition cond='x == 1' target='c'/></state><state id='c'/>
         <datamodel><data id='x' expr='0'/></datamodel>",
    );
    let (document, _) = read(&Source::new("d", text));
    for semantics in [Semantics::scxml(), Semantics::yase(), Semantics::uml()] {
        let mut session =
            Session::with_semantics(&document.clone().unwrap(), RecordingPlatform::default(), semantics)
                .unwrap();
        session.start(Timestamp::ZERO).unwrap();
        session.send(ScxmlEvent::new("e")).unwrap();
        assert_eq!(session.configuration(), ["c"]);
    }
}

#[test]
fn event_names_keep_their_tokens() {
    let noted = notes(
        "<state id='s'><onentry><raise event='a.b.c'/><raise event='ab'/><send event='x.y'/></onentry>
           <transition event='a'><log label='a' expr='_event.name'/></transition>
           <transition event='x.*'><log label='x' expr='_event.name'/></transition>
           <transition event='*'><log label='any' expr='_event.name'/></transition></state>",
        &[],
    );
    assert_eq!(noted, ["a=a.b.c", "any=ab", "x=x.y"]);
}
