//! Files of poses: what is read, what is reported, and that no text makes the reader panic.
#![allow(clippy::unwrap_used)] // tests

use std::collections::BTreeMap;
use std::time::Duration;

use monas_config::XmlConfig;
use monas_config::poses::{self, JointPose};
use monas_robot::{Anatomy, Joint, Limits};
use proptest::prelude::*;
use yase::{Diagnostic, Source};

/// A knee and a head, with limits as those of a Nao.
fn anatomy() -> Anatomy {
    let joint = |name: &str, low, high, speed| Joint {
        name: name.to_owned(),
        limits: Limits::new(low, high),
        speed: Some(speed),
    };
    let joints = vec![joint("HeadPitch", -0.672, 0.5149, 7.0), joint("LKneePitch", -0.0923, 2.1125, 6.4)];
    Anatomy { joints, ..Anatomy::new("knee", Duration::from_millis(12)) }
}

fn read(name: &str, text: &str) -> (Option<Vec<JointPose>>, Vec<Diagnostic>) {
    poses::read(&Source::new(name, text), &anatomy())
}

const POSES: &str = "<poses>\n  <pose duration=\"0.5\" LKneePitch=\"1\" HeadPitch=\"-0.25\"/>\n  \
                     <pose stiffness=\"0.4\"/>\n  <pose duration=\"0.3\" LKneePitch=\"2\"/>\n</poses>\n";

#[test]
fn a_sequence_is_read_from_xml_and_from_toml() {
    let expected = vec![
        JointPose { seconds: 0.5, stiffness: None, angles: vec![(0, -0.25), (1, 1.0)] },
        JointPose { seconds: 1.0, stiffness: Some(0.4), angles: vec![] },
        JointPose { seconds: 0.3, stiffness: None, angles: vec![(1, 2.0)] },
    ];
    assert_eq!(read("kick.xml", POSES), (Some(expected.clone()), vec![]));
    let toml = "[[pose]]\nduration = 0.5\nLKneePitch = 1.0\nHeadPitch = -0.25\n\
                [[pose]]\nstiffness = 0.4\n[[pose]]\nduration = 0.3\nLKneePitch = 2\n";
    assert_eq!(read("kick.toml", toml), (Some(expected), vec![]));
}

#[test]
fn what_the_store_of_the_thesis_writes_is_read() {
    let mut store = XmlConfig::from_text("nod.xml", "<?xml version=\"1.0\" ?>\n");
    for angle in [0.25, -0.5] {
        store.set_attributes("pose", &BTreeMap::from([("HeadPitch".to_owned(), angle)]), true).unwrap();
    }
    let pose = |angle| JointPose { seconds: 1.0, stiffness: None, angles: vec![(0, angle)] };
    assert_eq!(read("nod.xml", store.text()), (Some(vec![pose(0.25), pose(-0.5)]), vec![]));
    // And the store reads what is in a file with all attributes.
    let poses = XmlConfig::from_text("kick.xml", POSES).all_attributes::<f64>("pose").unwrap();
    assert_eq!((poses[0]["LKneePitch"], poses[1]["stiffness"], poses[2]["duration"]), (1.0, 0.4, 0.3));
}

#[test]
fn what_is_wrong_is_reported_with_place_and_hint() {
    for (text, expected) in [
        (
            "<pose LKneePich=1/>",
            "a.xml:1:7: error[E0304]: unknown attribute `LKneePich` of `pose` (did you mean `LKneePitch`?)",
        ),
        (
            "<poses>\n  <pose LKneePitch=90/>\n</poses>",
            "a.xml:2:20: error[E0306]: `LKneePitch` is `90`, expected a number from -0.0923 to 2.1125 \
             (the angle of the joint, rad)",
        ),
        (
            "<pose HeadPitch=NaN/>",
            "a.xml:1:17: error[E0306]: `HeadPitch` is `NaN`, expected a number from -0.672 to 0.5149 \
             (the angle of the joint, rad)",
        ),
        (
            "<pose duration=0 HeadPitch=0/>",
            "a.xml:1:16: error[E0306]: `duration` is `0`, expected a number from 0.012 to 60 \
             (the time of the way to the pose, s)",
        ),
        (
            "<pose duration=-1/>",
            "a.xml:1:16: error[E0306]: `duration` is `-1`, expected a number from 0.012 to 60 \
             (the time of the way to the pose, s)",
        ),
        (
            "<pose stiffness=1.5/>",
            "a.xml:1:17: error[E0306]: `stiffness` is `1.5`, expected a number from 0 to 1 \
             (that of all joints on the way)",
        ),
        (
            "<poses/>",
            "a.xml:1:1: error[E0305]: expected `pose`, the file holds none (a sequence has at least one pose)",
        ),
        (
            "",
            "a.xml:1:1: error[E0305]: expected `pose`, the file holds none (a sequence has at least one pose)",
        ),
    ] {
        let (poses, diagnostics) = read("a.xml", text);
        assert_eq!(poses, None, "{text}");
        assert_eq!(diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>(), [expected], "{text}");
    }
}

#[test]
fn a_joint_that_cannot_follow_is_a_warning() {
    let text =
        "<pose duration=0.1 LKneePitch=0/>\n<pose duration=0.1/>\n<pose duration=0.1 LKneePitch=0.96/>";
    let (poses, diagnostics) = read("a.xml", text);
    assert_eq!(poses.map(|poses| poses.len()), Some(3));
    assert_eq!(
        diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>(),
        [
            "a.xml:3:31: warning[E0371]: `LKneePitch` turns by 0.96 rad in 0.1 s, its motor by 6.40 rad/s at most \
          (it lags behind: it needs 0.15 s)"
        ]
    );
    let slower = text.replace("0.1 LKneePitch=0.96", "0.15 LKneePitch=0.96");
    assert_eq!(read("a.xml", &slower).1, []);
}

#[test]
fn a_file_that_is_not_there_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("kick.xml"), POSES).unwrap();
    assert_eq!(poses::load(&folder.path().join("kick.xml"), &anatomy()).0.map(|poses| poses.len()), Some(3));
    let (poses, diagnostics) = poses::load(&folder.path().join("kik.xml"), &anatomy());
    assert_eq!((poses, diagnostics[0].code), (None, "E0316"));
}

/// A text, with what a file of poses is made of and what it is not.
fn texts() -> impl Strategy<Value = String> {
    let name =
        prop::sample::select(vec!["LKneePitch", "HeadPitch", "duration", "stiffness", "RKnee", "pose"]);
    let value = prop_oneof![
        (-3.0..3.0).prop_map(|value: f64| value.to_string()),
        any::<f64>().prop_map(|value| value.to_string()),
        "\\PC{0,6}",
    ];
    let attribute = (name, value).prop_map(|(name, value)| format!(" {name}=\"{value}\""));
    let pose = prop::collection::vec(attribute, 0..4)
        .prop_map(|attributes| format!("<pose{}/>\n", attributes.concat()));
    let poses = prop::collection::vec(pose, 0..4).prop_map(|poses| poses.concat());
    prop_oneof![poses, "\\PC{0,60}", "[<>/= \"'a-z0-9\\-.\n]{0,60}"]
}

proptest! {
    #[test]
    fn any_text_gives_poses_within_the_limits_or_an_error(text in texts()) {
        let anatomy = anatomy();
        for name in ["a.xml", "a.toml"] {
            let (poses, diagnostics) = read(name, &text);
            prop_assert_eq!(poses.is_none(), diagnostics.iter().any(Diagnostic::is_error));
            for found in &diagnostics {
                prop_assert!(text.get(found.span.start..found.span.end).is_some(), "{:?}", found);
                prop_assert!(!found.to_string().is_empty());
            }
            for pose in poses.iter().flatten() {
                prop_assert!((0.012..=60.0).contains(&pose.seconds));
                prop_assert!(pose.stiffness.is_none_or(|stiffness| (0.0..=1.0).contains(&stiffness)));
                prop_assert!(pose.angles.iter().all(|&(joint, angle)| anatomy.joints[joint].limits.contains(angle)));
            }
        }
    }
}
