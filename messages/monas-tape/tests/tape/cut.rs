//! Truncated or damaged tapes.

use crate::ball::*;
use monas_tape::{ErrorKind, Recording, Tape};
use proptest::prelude::*;

/// The number of messages before the end or the first error.
fn readable(bytes: Vec<u8>) -> usize {
    let recording = Recording::from_bytes(bytes);
    recording.messages().map_or(0, |messages| messages.take_while(Result::is_ok).count())
}

#[test]
fn a_truncated_file_keeps_its_prefix() {
    let bytes = recorded(30);
    let whole = readable(bytes.clone());
    let mut before = 0;
    for length in (0..=bytes.len()).step_by(7) {
        let count = readable(bytes[..length].to_vec());
        assert!(count >= before && count <= whole, "{length} bytes: {count} after {before}");
        before = count;
    }
    assert_eq!(before, whole);
}

#[test]
fn damage_inside_a_chunk_is_noticed() {
    let bytes = recorded(3);
    let whole = readable(bytes.clone());
    // The string is in the schema at the beginning of the first chunk.
    let index = bytes.windows(9).position(|text| text == b"tape.test").unwrap();
    let mut damaged = bytes;
    damaged[index] ^= 1;
    let recording = Recording::from_bytes(damaged);
    let mut messages = recording.messages().unwrap();
    let error = messages.next().unwrap().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Damaged);
    assert!(error.to_string().contains("checksum"), "{error}");
    assert!(messages.next().is_none(), "after {whole} messages in the whole tape");
}

#[test]
fn damage_inside_an_attachment_is_noticed() {
    let output = Shared::default();
    let tape = Tape::to_writer(output.clone()).unwrap();
    tape.attach("match.xml", "text/xml", b"<match/>").unwrap();
    tape.finish().unwrap();
    let mut bytes = output.bytes();
    let index = bytes.windows(8).position(|text| text == b"<match/>").unwrap();
    bytes[index] ^= 1;
    let recording = Recording::from_bytes(bytes);
    let errors = recording.contents().unwrap().filter_map(Result::err).map(|error| error.to_string());
    let expected = "the tape is damaged: the checksum of the attachment `match.xml` is wrong";
    assert_eq!(errors.collect::<Vec<_>>(), [expected]);
}

#[test]
fn a_record_that_is_longer_than_a_finished_tape_is_damage() {
    let bytes = recorded(3);
    // The first record behind the magic number: its kind, then its length.
    let mut damaged = bytes;
    damaged[mcap::MAGIC.len() + 1 + 4] ^= 1;
    let recording = Recording::from_bytes(damaged);
    let error = recording.messages().unwrap().next().unwrap().unwrap_err();
    assert_eq!(error.to_string(), "the tape is damaged: a record is longer than the tape");
}

#[test]
fn files_that_are_no_tape_are_rejected() {
    for bytes in [&b""[..], b"<match/>", &mcap::MAGIC[..7]] {
        let error = Recording::from_bytes(bytes.to_vec()).messages().unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Damaged);
    }
}

#[test]
fn tapes_of_others_are_read_whether_in_chunks_or_not() {
    for chunks in [true, false] {
        let mut output = std::io::Cursor::new(Vec::new());
        let options = mcap::WriteOptions::new().compression(None).use_chunks(chunks);
        let mut writer = options.create(&mut output).unwrap();
        let schema = writer.add_schema("a.Ball", "protobuf", b"schema").unwrap();
        let channel = writer.add_channel(schema, "/ball", "protobuf", &Default::default()).unwrap();
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: 7, log_time: 9, publish_time: 8 };
        writer.write_to_known_channel(&header, b"ball").unwrap();
        writer.finish().unwrap();
        drop(writer);
        let recording = Recording::from_bytes(output.into_inner());
        let messages: Vec<_> = recording.messages().unwrap().map(|message| message.unwrap()).collect();
        let [message] = &messages[..] else { panic!("one message: {messages:?}") };
        let channel = &message.channel;
        assert_eq!(
            (&*channel.topic, channel.message_type(), &*channel.schema.data),
            ("/ball", "a.Ball", &b"schema"[..])
        );
        assert_eq!((message.sequence, message.bytes), (7, &b"ball"[..]));
        assert_eq!((message.published.as_nanos(), message.received.as_nanos()), (8, 9));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damage_is_met_without_a_panic(damages in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut bytes = recorded(3);
        for (position, value) in damages {
            let index = position.index(bytes.len());
            bytes[index] = value;
        }
        readable(bytes);
    }

    #[test]
    fn any_bytes_are_met_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let mut tape = mcap::MAGIC.to_vec();
        tape.extend(&bytes);
        readable(tape);
        readable(bytes);
    }
}
