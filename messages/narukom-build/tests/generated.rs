//! The generated code is unchanged, and works.
//!
//! `tests/generated` holds the code for `tests/proto`, so that changes of the generator show in
//! review and the code itself is compiled and tested here.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::fs;
use std::path::Path;

use messages::everything::Touch;
use messages::everything::touch::Part;
use messages::{Everything, Lists, Nothing, Position, Role};
use narukom::{AnyMessage, Enumeration, FieldError, FieldKind, FieldValue, Message, Reflect};
use narukom_build::Compiler;

/// Generated code compiles without warnings, whatever fields a message has.
#[deny(warnings)]
mod messages {
    include!("generated/narukom.testing.rs");
}

/// The generated file is equal to the one in `tests/generated`; if NARUKOM_BUILD_BLESS is set, the
/// latter is replaced.
#[test]
fn the_generated_code_is_the_one_under_review() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let target = tempfile::tempdir().unwrap();
    let proto = here.join("proto");
    let compiler = Compiler::new().out_dir(target.path());
    compiler.compile(&[proto.join("testing.proto")], &[proto]).unwrap();
    for name in ["narukom.testing.rs", "narukom.testing.descriptors"] {
        let (made, kept) = (target.path().join(name), here.join("generated").join(name));
        if std::env::var_os("NARUKOM_BUILD_BLESS").is_some() {
            fs::copy(&made, &kept).unwrap();
        }
        assert!(fs::read(made).unwrap() == fs::read(kept).unwrap(), "{name} differs: look, then bless");
    }
}

fn index(name: &str) -> usize {
    Everything::DESCRIPTOR.field_index(name).unwrap()
}

fn touched() -> Everything {
    let inner = Touch { part: Part::Head.into(), before: None };
    let touch = Touch { part: Part::Foot.into(), before: Some(Box::new(inner)) };
    Everything { touch: Some(touch), ..Everything::default() }
}

#[test]
fn descriptors_name_everything_in_the_order_of_the_file() {
    let message = Everything::DESCRIPTOR;
    assert_eq!((message.full_name, message.name), ("narukom.testing.Everything", "Everything"));
    assert_eq!(Touch::DESCRIPTOR.full_name, "narukom.testing.Everything.Touch");
    assert_eq!(Touch::DESCRIPTOR.name, "Everything.Touch");
    let fields: Vec<_> = message.fields.iter().map(|field| (field.name, field.tag)).collect();
    assert_eq!(fields[..3], [("flag", 1), ("small", 2), ("large", 3)]);
    assert_eq!(fields.len(), 24);
    let FieldKind::Message(touch) = message.fields[index("touch")].kind else { panic!("a message") };
    assert_eq!(touch(), Touch::DESCRIPTOR);
    let FieldKind::Enum(role) = message.fields[index("role")].kind else { panic!("an enumeration") };
    assert_eq!(role, Role::DESCRIPTOR);
}

#[test]
fn enumerations_know_their_names_and_numbers() {
    assert_eq!(Role::DESCRIPTOR.full_name, "narukom.testing.Role");
    assert_eq!(Role::DESCRIPTOR.number("ROLE_GOALIE"), Some(1));
    assert_eq!(Role::DESCRIPTOR.name_of(2), Some("ROLE_ATTACKER"));
    assert_eq!(Role::DESCRIPTOR.number("GOALIE"), None);
    assert_eq!(Part::DESCRIPTOR.full_name, "narukom.testing.Everything.Touch.Part");
    assert_eq!(Part::DESCRIPTOR.name, "Everything.Touch.Part");
}

#[test]
fn the_schema_comes_with_its_imports_and_without_positions() {
    use narukom::prost::Message as _;
    let set = prost_types::FileDescriptorSet::decode(Everything::DESCRIPTOR.file_descriptor_set).unwrap();
    let names: Vec<_> = set.file.iter().map(|file| file.name()).collect();
    assert_eq!(names, ["google/protobuf/timestamp.proto", "testing.proto"]);
    assert!(set.file.iter().all(|file| file.source_code_info.is_none()));
}

#[test]
fn every_scalar_field_is_read_by_index() {
    let message = Everything {
        flag: true,
        small: -1,
        large: i64::MIN,
        count: 7,
        total: u64::MAX,
        rough: 0.5,
        fine: 0.25,
        name: "n".into(),
        raw: vec![1, 2],
        role: Role::Goalie.into(),
        r#type: "t".into(),
        ..Everything::default()
    };
    assert!(matches!(message.field(index("flag")), FieldValue::Bool(true)));
    assert!(matches!(message.field(index("small")), FieldValue::Int(-1)));
    assert!(matches!(message.field(index("large")), FieldValue::Int(i64::MIN)));
    assert!(matches!(message.field(index("count")), FieldValue::Uint(7)));
    assert!(matches!(message.field(index("total")), FieldValue::Uint(u64::MAX)));
    assert!(matches!(message.field(index("rough")), FieldValue::Float(0.5)));
    assert!(matches!(message.field(index("fine")), FieldValue::Float(0.25)));
    assert!(matches!(message.field(index("name")), FieldValue::Text("n")));
    assert!(matches!(message.field(index("raw")), FieldValue::Bytes([1, 2])));
    assert!(matches!(message.field(index("role")), FieldValue::Enum(1)));
    assert!(matches!(message.field(index("type")), FieldValue::Text("t")));
}

#[test]
fn unset_fields_are_missing_and_unindexed_ones_unsupported() {
    let message = Everything::default();
    for name in ["position", "touch", "distance", "remark", "wish", "limit", "blob", "home"] {
        assert!(matches!(message.field(index(name)), FieldValue::Missing), "{name}");
    }
    for name in ["path", "landmarks", "left", "right", "stamp"] {
        assert!(matches!(message.field(index(name)), FieldValue::Unsupported), "{name}");
        assert!(matches!(Everything::DESCRIPTOR.fields[index(name)].kind, FieldKind::Unsupported), "{name}");
    }
    assert!(matches!(message.field(99), FieldValue::Missing));
}

#[test]
fn messages_inside_messages_are_reached_also_when_boxed() {
    let message = touched();
    let FieldValue::Message(touch) = message.field(index("touch")) else { panic!("a message") };
    let FieldValue::Message(before) = touch.field(1) else { panic!("a message") };
    assert!(matches!(before.field(0), FieldValue::Enum(1)));
    assert!(matches!(before.field(1), FieldValue::Missing));
}

#[test]
fn settings_are_read_back() {
    let mut message = Everything::default();
    let place = Position { x: 1.0, y: 2.0 };
    let values = [
        ("flag", FieldValue::Bool(true)),
        ("small", FieldValue::Int(-3)),
        ("count", FieldValue::Uint(3)),
        ("rough", FieldValue::Float(1.5)),
        ("name", FieldValue::Text("ball")),
        ("raw", FieldValue::Bytes(&[9])),
        ("role", FieldValue::Enum(2)),
        ("position", FieldValue::Message(&place)),
        ("distance", FieldValue::Float(2.5)),
        ("remark", FieldValue::Text("far")),
        ("wish", FieldValue::Enum(1)),
        ("limit", FieldValue::Uint(4)),
        ("blob", FieldValue::Bytes(&[])),
    ];
    for (name, value) in values {
        message.set_field(index(name), value).unwrap();
        let read = message.field(index(name));
        assert_eq!(format!("{read:?}"), format!("{value:?}"), "{name}");
    }
    assert_eq!(message.position, Some(place));
    assert_eq!(message.wish(), Role::Goalie);
}

#[test]
fn a_missing_value_resets_a_field() {
    let mut message = Everything { small: 3, distance: Some(1.0), ..touched() };
    for name in ["small", "distance", "touch"] {
        message.set_field(index(name), FieldValue::Missing).unwrap();
    }
    assert_eq!(message, Everything::default());
}

#[test]
fn numbers_fit_or_are_refused() {
    let mut message = Everything::default();
    message.set_field(index("fine"), FieldValue::Int(-2)).unwrap();
    message.set_field(index("small"), FieldValue::Float(4.0)).unwrap();
    message.set_field(index("total"), FieldValue::Int(5)).unwrap();
    assert_eq!((message.fine, message.small, message.total), (-2.0, 4, 5));
    let refused = [
        ("small", FieldValue::Int(1 << 40)),
        ("small", FieldValue::Float(0.5)),
        ("small", FieldValue::Float(f64::NAN)),
        ("small", FieldValue::Float(f64::INFINITY)),
        ("count", FieldValue::Int(-1)),
        ("total", FieldValue::Float(1e300)),
    ];
    for (name, value) in refused {
        let error = message.set_field(index(name), value).unwrap_err();
        assert!(matches!(error, FieldError::OutOfRange { field } if field == name), "{name}: {error}");
    }
    assert_eq!((message.small, message.count, message.total), (4, 0, 5));
}

#[test]
fn values_of_another_kind_are_refused() {
    let mut message = Everything::default();
    let other = Touch::default();
    let refused = [
        ("flag", FieldValue::Int(1)),
        ("name", FieldValue::Bool(true)),
        ("position", FieldValue::Message(&other)),
    ];
    for (name, value) in refused {
        let error = message.set_field(index(name), value).unwrap_err();
        assert_eq!(error, FieldError::WrongKind { field: name });
    }
    let error = message.set_field(index("left"), FieldValue::Float(1.0)).unwrap_err();
    assert_eq!(error, FieldError::Unsupported { field: "left" });
    assert_eq!(message.set_field(99, FieldValue::Missing).unwrap_err(), FieldError::NoSuchField);
    assert_eq!(message, Everything::default());
}

#[test]
fn a_path_of_fields_is_set_through_the_messages_on_it() {
    let mut message = Everything::default();
    let touch = message.message_mut(index("touch")).unwrap();
    let before = touch.message_mut(1).unwrap();
    before.set_field(0, FieldValue::Enum(1)).unwrap();
    assert_eq!(message.touch.unwrap().before.unwrap().part(), Part::Head);
    assert!(Position::default().message_mut(0).is_none());
}

#[test]
fn messages_travel_without_their_type() {
    let message = touched();
    let mut bytes = Vec::new();
    message.as_message().encode_to(&mut bytes);
    let mut copy: Box<dyn AnyMessage> = Everything::default().clone_box();
    copy.decode_from(&bytes).unwrap();
    assert_eq!(copy.as_any().downcast_ref::<Everything>(), Some(&message));
    assert!(!copy.copy_from(&Position::default()));
    assert!(copy.decode_from(&[0xff]).is_err());
}

#[test]
fn messages_without_a_field_that_is_reached_by_index_say_so() {
    let mut lists = Lists { path: vec![Position::default()], ..Lists::default() };
    assert!(matches!(lists.field(0), FieldValue::Unsupported));
    assert_eq!(
        lists.set_field(0, FieldValue::Missing).unwrap_err(),
        FieldError::Unsupported { field: "path" }
    );
    assert!(lists.message_mut(0).is_none());
    assert!(matches!(Nothing {}.field(0), FieldValue::Missing));
    assert_eq!(Nothing {}.set_field(0, FieldValue::Bool(true)).unwrap_err(), FieldError::NoSuchField);
}
