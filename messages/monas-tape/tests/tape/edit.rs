//! Recovering, cutting and merging tapes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::ball::*;
use monas_tape::{Channel, ErrorKind, Recording, RecordingItem, Tape, TapeFilter, cut, merge, recover};

/// Host, publisher, topic, sequence number and milliseconds of each message.
fn lines(recording: &Recording) -> Vec<String> {
    let line = |message: monas_tape::RecordedSample<'_>| {
        let Channel { host, publisher, topic, .. } = &*message.channel;
        format!("{host} {publisher} {topic} {} {}", message.sequence, message.received.as_nanos() / 1_000_000)
    };
    recording.messages().unwrap().map(|message| line(message.unwrap())).collect()
}

/// All items but messages.
fn others(recording: &Recording) -> Vec<String> {
    let named = |content| match content {
        RecordingItem::Message(_) => None,
        RecordingItem::Facts(facts) => Some(format!("facts {} {:?}", facts.name, facts.entries)),
        RecordingItem::Attachment(file) => {
            Some(format!("file {} {} {}", file.name, file.media_type, file.bytes.len()))
        }
    };
    recording.contents().unwrap().filter_map(|content| named(content.unwrap())).collect()
}

/// A tape with metadata and an attachment, of `count` rounds on some hosts.
fn tape(path: &Path, hosts: &[&str], count: u64) -> Recording {
    let tape = Tape::create(path).unwrap();
    tape.describe("run", &BTreeMap::from([("seed".to_owned(), "7".to_owned())])).unwrap();
    tape.attach("match.xml", "text/xml", b"<match/>").unwrap();
    let hubs: Vec<_> = hosts.iter().map(|host| hub(host)).collect();
    hubs.iter().for_each(|hub| hub.observe(Box::new(tape.clone())));
    play(&hubs, count);
    tape.finish().unwrap();
    Recording::open(path).unwrap()
}

fn folder() -> (tempfile::TempDir, impl Fn(&str) -> PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_owned();
    (folder, move |name: &str| path.join(name))
}

#[test]
fn a_whole_tape_copied_is_equal() {
    let (_folder, path) = folder();
    tape(&path("a.mcap"), &["one", "two"], 30);
    let recovery = recover(path("a.mcap"), path("b.mcap")).unwrap();
    assert!(recovery.was_whole());
    assert_eq!(recovery.messages, 180);
    assert!(std::fs::read(path("a.mcap")).unwrap() == std::fs::read(path("b.mcap")).unwrap());
}

#[test]
fn records_after_damage_are_kept() {
    let (_folder, path) = folder();
    let whole = tape(&path("a.mcap"), &["one"], 60);
    let mut bytes = std::fs::read(path("a.mcap")).unwrap();
    let message = whole.messages().unwrap().nth(90).unwrap().unwrap();
    let index = bytes.windows(message.bytes.len()).position(|window| window == message.bytes).unwrap();
    bytes[index + 4] ^= 0xff;
    std::fs::write(path("a.mcap"), bytes).unwrap();
    let recovery = recover(path("a.mcap"), path("a.mcap")).unwrap();
    let expected =
        format!("{}: the tape is damaged: the checksum of a chunk is wrong", path("a.mcap").display());
    assert_eq!(recovery.damages, [expected]);
    let kept = lines(&Recording::open(path("a.mcap")).unwrap());
    let all = lines(&whole);
    assert!(kept.len() < all.len() && kept.first() == all.first() && kept.last() == all.last());
    assert!(kept.iter().all(|line| all.contains(line)));
}

#[test]
fn messages_behind_a_damaged_first_chunk_have_the_channels_of_the_summary() {
    let (_folder, path) = folder();
    let whole = tape(&path("a.mcap"), &["one"], 60);
    let mut bytes = std::fs::read(path("a.mcap")).unwrap();
    let message = whole.messages().unwrap().next().unwrap().unwrap();
    let index = bytes.windows(message.bytes.len()).position(|window| window == message.bytes).unwrap();
    bytes[index + 4] ^= 0xff;
    std::fs::write(path("a.mcap"), bytes).unwrap();
    let recovery = recover(path("a.mcap"), path("a.mcap")).unwrap();
    let expected =
        format!("{}: the tape is damaged: the checksum of a chunk is wrong", path("a.mcap").display());
    assert_eq!(recovery.damages, [expected]);
    let (kept, all) = (lines(&Recording::open(path("a.mcap")).unwrap()), lines(&whole));
    assert!(kept.len() < all.len() && kept[..] == all[all.len() - kept.len()..]);
}

#[test]
fn a_part_begins_with_the_states_that_hold() {
    let (_folder, path) = folder();
    let whole = tape(&path("a.mcap"), &["one"], 5);
    let part = TapeFilter { from: Some(at(300)), to: Some(at(400)), ..TapeFilter::default() };
    assert_eq!(cut(&whole, &part, path("b.mcap")).unwrap(), 4);
    let part = Recording::open(path("b.mcap")).unwrap();
    let expected = [
        // The state as it was last published before; the history is not a state.
        "one body soccer/ball 2 250",
        "one vision soccer/ball 3 300",
        "one vision soccer/sighting 3 300",
        "one body soccer/ball 3 350",
    ];
    assert_eq!(lines(&part), expected);
    assert_eq!(others(&part), others(&whole));
}

#[test]
fn channels_are_chosen_and_what_is_always_wanted_stays() {
    let (_folder, path) = folder();
    let whole = tape(&path("a.mcap"), &["one", "two"], 3);
    let host = |channel: &Channel| channel.host == "two";
    let history = |channel: &Channel| channel.kind == "data";
    let part = TapeFilter {
        from: Some(at(300)),
        channels: Some(&host),
        always: Some(&history),
        ..TapeFilter::default()
    };
    cut(&whole, &part, path("b.mcap")).unwrap();
    let expected = [
        "two vision soccer/sighting 1 100",
        "two vision soccer/sighting 2 200",
        "two body soccer/ball 2 250",
        "two vision soccer/ball 3 300",
        "two vision soccer/sighting 3 300",
        "two body soccer/ball 3 350",
    ];
    assert_eq!(lines(&Recording::open(path("b.mcap")).unwrap()), expected);
}

#[test]
fn tapes_are_merged_by_time_and_what_they_share_is_there_once() {
    let (_folder, path) = folder();
    let both = [tape(&path("a.mcap"), &["one"], 2), tape(&path("b.mcap"), &["two"], 2)];
    assert_eq!(merge(&both, path("c.mcap")).unwrap(), 12);
    let merged = Recording::open(path("c.mcap")).unwrap();
    let mut expected = Vec::new();
    for number in 1..=2 {
        for (publisher, topics, millis) in [("vision", &["ball", "sighting"][..], 0), ("body", &["ball"], 50)]
        {
            for host in ["one", "two"] {
                let time = 100 * number + millis;
                expected.extend(
                    topics.iter().map(|topic| format!("{host} {publisher} soccer/{topic} {number} {time}")),
                );
            }
        }
    }
    assert_eq!(lines(&merged), expected);
    assert_eq!(others(&merged), others(&both[0]));
}

#[test]
fn overlapping_parts_of_a_tape_merge_to_the_tape() {
    let (_folder, path) = folder();
    let whole = tape(&path("a.mcap"), &["one", "two"], 6);
    let part = |from, to, name: &str| {
        cut(&whole, &TapeFilter { from, to, ..TapeFilter::default() }, path(name)).unwrap();
        Recording::open(path(name)).unwrap()
    };
    // The second one also begins with the states that held before it.
    let parts = [part(None, Some(at(420)), "first.mcap"), part(Some(at(250)), None, "rest.mcap")];
    assert_eq!(merge(&parts, path("b.mcap")).unwrap(), 36);
    let sorted = |recording: &Recording| {
        let mut lines = lines(recording);
        lines.sort();
        lines
    };
    assert_eq!(sorted(&Recording::open(path("b.mcap")).unwrap()), sorted(&whole));
    // Another run with the same names has other messages.
    let other = tape(&path("other.mcap"), &["one"], 7);
    let later = TapeFilter { from: Some(at(700)), ..TapeFilter::default() };
    cut(&other, &later, path("later.mcap")).unwrap();
    let later = Recording::open(path("later.mcap")).unwrap();
    assert_eq!(merge(&[whole, later], path("c.mcap")).unwrap(), 36 + 3);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_named_with_the_file() {
    let (_folder, path) = folder();
    let whole = tape(&path("a.mcap"), &["one"], 200);
    let error = cut(&whole, &TapeFilter::default(), "/dev/full").unwrap_err();
    let expected = "the tape /dev/full cannot be written: No space left on device";
    assert!(error.to_string().starts_with(expected), "{error}");
}

#[test]
fn a_failed_write_keeps_the_old_file() {
    let (_folder, path) = folder();
    tape(&path("a.mcap"), &["one"], 2);
    let error = recover(path("a.mcap"), path("nowhere/b.mcap")).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::File);
    std::fs::write(path("text"), "no tape").unwrap();
    assert_eq!(recover(path("text"), path("text")).unwrap_err().kind(), ErrorKind::Damaged);
    assert_eq!(std::fs::read(path("text")).unwrap(), b"no tape");
    let names: Vec<_> =
        std::fs::read_dir(path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
}
