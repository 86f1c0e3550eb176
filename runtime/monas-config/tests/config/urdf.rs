//! Descriptions of robots: what is read, what is reported, and that no text makes the reader panic.
#![allow(clippy::unwrap_used)] // tests

use monas_config::urdf;
use monas_kinematics::LinkTree;
use monas_robot::{Anatomy, Limits, Skill};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use yase::{Diagnostic, Source};

/// An arm as tools write it: a link for the world, shapes, and elements of other programs.
const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="world"/>
  <link name="base">
    <visual><geometry><mesh filename="package://arm/base.stl"/></geometry><material name="grey"/></visual>
    <collision><origin xyz="0 0 0.1"/><geometry><box size="1 1 0.2"/></geometry></collision>
    <inertial>
      <mass value="2"/><origin xyz="0 0 0.1" rpy="0 0 0"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
  </link>
  <joint name="finger" type="prismatic">
    <parent link="hand"/><child link="finger"/><axis xyz="0 2 0"/>
    <limit lower="0" upper="0.05" effort="1" velocity="0.1"/>
  </joint>
  <joint name="fixed_base" type="fixed">
    <axis xyz="0 0 0"/><parent link="world"/><child link="base"/><origin rpy="0 0 1.5707963267948966" xyz="1 0 0"/>
  </joint>
  <joint name="turn" type="continuous"><parent link="base"/><child link="hand"/><origin xyz="0 0 0.5"/></joint>
  <joint name="other_finger" type="prismatic">
    <parent link="hand"/><child link="other_finger"/><axis xyz="0 1 0"/>
    <mimic joint="finger" multiplier="-1" offset="0.01"/>
  </joint>
  <link name="hand"/>
  <link name="finger"/>
  <link name="other_finger"/>
  <transmission name="t"><joint name="turn"/><actuator name="m"/></transmission>
  <gazebo reference="hand"><sensor name="eye" type="camera"><pose>0 0 0 0 0 0</pose></sensor></gazebo>
  <monas cycle="20ms" radio="128" leds="true">
    <head yaw="turn"/>
    <walk x="-0.1 0.4" turn="-1 1"/>
    <camera name="eye" link="hand" horizontal="1.2" vertical="0.9"/>
    <skill>KickLeft</skill>
    <skill>StandUp</skill>
  </monas>
</robot>
"#;

fn read(text: &str) -> (Option<Anatomy>, Vec<Diagnostic>) {
    urdf::read(&Source::new("a.urdf", text))
}

/// The diagnostics of a text, which is an error.
fn wrong(text: &str) -> Vec<String> {
    let (anatomy, diagnostics) = read(text);
    assert_eq!(anatomy, None);
    diagnostics.iter().map(ToString::to_string).collect()
}

/// The diagnostics of the arm with one text replaced.
fn changed(from: &str, to: &str) -> Vec<String> {
    assert_eq!(ARM.matches(from).count(), 1, "{from}");
    wrong(&ARM.replace(from, to))
}

#[test]
fn what_tools_write_is_read() {
    let (arm, diagnostics) = read(ARM);
    assert_eq!(diagnostics, []);
    let arm = arm.unwrap();
    assert_eq!((&*arm.model, arm.cycle.as_millis(), arm.radio, arm.has_leds), ("arm", 20, 128, true));
    let names: Vec<&str> = arm.joints.iter().map(|joint| &*joint.name).collect();
    assert_eq!(names, ["finger", "turn"], "in the order of the file, without fixed ones");
    assert_eq!((arm.joints[0].limits, arm.joints[0].speed), (Limits::new(0.0, 0.05), Some(0.1)));
    assert!(arm.joints[1].limits.contains(1e9) && arm.joints[1].speed.is_none());
    assert_eq!((arm.head_yaw, arm.head_pitch), (arm.joints[1].limits, Limits::symmetric(0.0)));
    assert_eq!((arm.walk_x, arm.walk_y), (Limits::new(-0.1, 0.4), Limits::symmetric(0.0)));
    assert_eq!(arm.skills, [Skill::KickLeft, Skill::StandUp]);
    assert_eq!((arm.cameras[0].link, arm.cameras[0].vertical), (arm.link("hand"), 0.9));
    assert!(arm.links.iter().enumerate().all(|(index, link)| link.parent.is_none_or(|it| it < index)));
    assert_eq!((arm.links[0].name.as_str(), arm.links[0].parent), ("world", None));
}

#[test]
fn links_are_where_the_description_places_them() {
    let arm = read(ARM).0.unwrap();
    // The base is turned to the left, so that the hand's y points backwards.
    let tree = LinkTree::new(&arm);
    let at = |link: &str, angles: &[f64]| tree.in_torso(arm.link(link).unwrap(), Point3::origin(), angles);
    let near = |one: Point3<f64>, x, y, z| (one - Point3::new(x, y, z)).norm() < 1e-12;
    assert!(near(at("finger", &[0.04, 0.0]), 0.96, 0.0, 0.5), "{}", at("finger", &[0.04, 0.0]));
    assert!(near(at("other_finger", &[0.04, 0.0]), 1.03, 0.0, 0.5));
    // Without an axis the joint turns about x: the finger goes up.
    assert!(near(at("finger", &[0.04, std::f64::consts::FRAC_PI_2]), 1.0, 0.0, 0.54));
    assert!(near(tree.centre_of_mass(&[0.0; 2]), 1.0, 0.0, 0.1) && tree.mass() == 2.0);
}

#[test]
fn what_is_wrong_is_reported_with_place_and_hint() {
    for (from, to, expected) in [
        (
            "cycle=\"20ms\" ",
            "",
            "a.urdf:30:4: error[E0305]: `monas` lacks the attribute `cycle` \
          (`cycle` is a time of at least `100µs`, such as `200ms`)",
        ),
        ("upper=\"0.05\"", "upper=\"-1\"", "a.urdf:15:6: error[E0372]: `lower` is 0, above `upper`, -1"),
        (
            "upper=\"0.05\"",
            "uper=\"0.05\"",
            "a.urdf:15:22: error[E0304]: unknown attribute `uper` of `limit` \
          (did you mean `upper`?)",
        ),
        ("xyz=\"0 2 0\"", "xyz=\"0 0 0\"", "a.urdf:14:49: error[E0372]: the axis has no direction"),
        (
            "xyz=\"0 2 0\"",
            "xyz=\"0 2\"",
            "a.urdf:14:59: error[E0306]: `xyz` is `0 2`, expected 3 numbers \
          separated by blanks",
        ),
        (
            "\"continuous\"",
            "\"ball\"",
            "a.urdf:20:28: error[E0306]: `type` is `ball`, expected one of \
          `revolute`, `continuous`, `prismatic` or `fixed`",
        ),
        (
            "\"continuous\"",
            "\"revolute\"",
            "a.urdf:20:4: error[E0372]: a joint of this type needs a `limit` \
          (one that turns without end is `continuous`)",
        ),
        (
            "<mimic joint=\"finger\"",
            "<mimic joint=\"fingers\"",
            "a.urdf:23:19: error[E0372]: there is no joint \
          that can be followed `fingers` (did you mean `finger`?)",
        ),
        (
            "<link name=\"hand\"/>",
            "<link name=\"hnd\"/>",
            "a.urdf:14:19: error[E0372]: there is no link `hand` \
          (did you mean `hnd`?)",
        ),
        (
            "<link name=\"hand\"/>",
            "<link name=\"hand\"/><link name=\"hand\"/>",
            "a.urdf:25:23: error[E0372]: \
          the link `hand` is there twice",
        ),
        (
            "<child link=\"other_finger\"/>",
            "<child link=\"finger\"/>",
            "a.urdf:27:4: error[E0372]: no joint \
          connects `other_finger` with `world` (each link but one, the torso, is the child of one joint)",
        ),
        (
            "<head yaw=\"turn\"/>",
            "<head yaw=\"trn\"/>",
            "a.urdf:31:16: error[E0372]: there is no joint `trn` \
          (did you mean `turn`?)",
        ),
        (
            "x=\"-0.1 0.4\"",
            "x=\"0.4 -0.1\"",
            "a.urdf:32:14: error[E0306]: `x` is `0.4 -0.1`, the least number \
          comes first",
        ),
        (
            "<skill>KickLeft</skill>",
            "<skill>KickLef</skill>",
            "a.urdf:34:12: error[E0306]: `skill` is `KickLef`, \
          expected one of `KickLeft`, `KickRight`, `FallLeft`, `FallRight`, `DiveLeft`, `DiveRight` or `StandUp`",
        ),
        (
            "<camera name",
            "<camra name",
            "a.urdf:33:6: error[E0303]: unknown element `camra` (did you mean `camera`?)",
        ),
        (
            "value=\"2\"",
            "value=\"-2\"",
            "a.urdf:9:20: error[E0306]: `value` is `-2`, expected a number of at \
          least 0",
        ),
    ] {
        let found = changed(from, to);
        assert!(
            found.contains(&expected.to_owned()),
            "{to}:
{found:#?}"
        );
    }
}

#[test]
fn a_circle_and_a_file_without_a_robot_are_reported() {
    let joint = |from, to| {
        format!("<joint name='{from}{to}' type='fixed'><parent link='{from}'/><child link='{to}'/></joint>")
    };
    let links = "<link name='t'/><link name='a'/><link name='b'/>";
    let joints = [joint("a", "b"), joint("b", "a")].concat();
    assert_eq!(
        wrong(&format!("<robot name='r'>{links}{joints}<monas cycle='1ms'/></robot>")),
        ["a.urdf:1:34: error[E0372]: no joints lead from the torso to `a` \
          (each link but one, the torso, is the child of one joint)"]
    );
    assert_eq!(
        wrong("<robots/>"),
        ["a.urdf:1:2: error[E0303]: unknown element `robots` (did you mean `robot`?)"]
    );
    assert_eq!(wrong(""), ["a.urdf:1:1: error[E0301]: not XML: the document does not have a root node"]);
    let deep = ["<a>".repeat(100_000), "</a>".repeat(100_000)].concat();
    assert_eq!(wrong(&deep), ["a.urdf:1:190: error[E0301]: more than 64 elements are in one another"]);
    let macros = wrong("<robot name='r'><xacro:leg side='left'/></robot>");
    assert!(macros[0].ends_with("(expand the file with the program `xacro` first)"), "{macros:?}");
}

#[test]
fn a_robot_of_its_own_may_differ_in_limits_and_masses_only() {
    let model = read(ARM).0.unwrap();
    let variant = |from: &str, to: &str| {
        let source = Source::new("own.urdf", ARM.replace(from, to));
        let (own, diagnostics) = urdf::read_variant(&source, &model);
        assert_eq!(own.is_none(), diagnostics.iter().any(Diagnostic::is_error));
        (own, diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>())
    };
    let own = variant("upper=\"0.05\"", "upper=\"0.03\"").0.unwrap();
    assert_eq!(own.joints[0].limits.high, 0.03);
    assert_eq!(variant("value=\"2\"", "value=\"2.5\"").0.unwrap().links[1].mass, 2.5);
    assert_eq!(
        variant("upper=\"0.05\"", "upper=\"0.06\"").1,
        ["own.urdf:13:4: warning[E0374]: `finger` may move further or faster than in `arm` \
          (its range there is 0 to 0.05, its speed 0.1)"]
    );
    // A further link, before the others of the file.
    let shell = "<link name=\"shell\"/><joint name=\"glue\" type=\"fixed\"><parent link=\"base\"/>\
                 <child link=\"shell\"/></joint><joint name=\"turn\" type=\"continuous\">";
    let own = variant("<joint name=\"turn\" type=\"continuous\">", shell).0.unwrap();
    assert_ne!(own.cameras[0].link, model.cameras[0].link);
    let hint = "(limits, speeds, masses and the ranges of the walk are a robot's own)";
    for (from, to, message) in [
        (
            "origin xyz=\"0 0 0.5\"",
            "origin xyz=\"0 0 0.6\"",
            "own.urdf:20:4: error[E0373]: `hand` is at xyz 0 0 0.6, \
          rpy 0 0 0, in `arm` at xyz 0 0 0.5, rpy 0 0 0",
        ),
        (
            "xyz=\"0 2 0\"",
            "xyz=\"0 -2 0\"",
            "own.urdf:13:4: error[E0373]: `finger` moves otherwise than in `arm`",
        ),
        ("\"turn\"", "\"tuurn\"", "own.urdf:20:4: error[E0373]: joint 1 is `tuurn`, in `arm` it is `turn`"),
        (
            "radio=\"128\"",
            "radio=\"0\"",
            "own.urdf:30:4: error[E0373]: `monas` differs from that of `arm`: radio",
        ),
    ] {
        let text = format!("{message} {hint}");
        assert_eq!(variant(from, to).1, [text]);
    }
}

proptest! {
    #[test]
    fn any_text_is_read_or_reported(text in "\\PC*") {
        let (anatomy, diagnostics) = read(&text);
        prop_assert_eq!(anatomy.is_none(), diagnostics.iter().any(Diagnostic::is_error));
    }

    /// A file with a part cut or replaced.
    #[test]
    fn any_change_is_read_or_reported(at in 0..ARM.len(), length in 0_usize..40, word in "[a-z0-9 <>/\"=.-]{0,8}") {
        let end = (at + length).min(ARM.len());
        let text = [&ARM[..at], &word, &ARM[end..]].concat();
        let (anatomy, diagnostics) = read(&text);
        prop_assert_eq!(anatomy.is_none(), diagnostics.iter().any(Diagnostic::is_error));
        if let Some(anatomy) = anatomy {
            let (tree, angles) = (LinkTree::new(&anatomy), vec![0.1; anatomy.joints.len()]);
            for (index, link) in anatomy.links.iter().enumerate() {
                prop_assert!(link.parent.is_none_or(|parent| parent < index));
                prop_assert!(tree.in_torso(index, link.centre.into(), &angles).iter().all(|it| it.is_finite()));
            }
        }
    }

    #[test]
    fn a_chain_of_joints_is_the_product_of_its_poses(
        poses in prop::collection::vec((prop::array::uniform6(-1.0..1.0_f64), -1.0..1.0_f64), 1..6),
    ) {
        let (mut parts, mut expected) = (String::from("<link name='l0'/>"), Isometry3::identity());
        for (index, ([x, y, z, roll, pitch, yaw], angle)) in poses.iter().enumerate() {
            let next = index + 1;
            parts += &format!(
                "<link name='l{next}'/><joint name='j{next}' type='revolute'><parent link='l{index}'/>\
                 <child link='l{next}'/><origin xyz='{x} {y} {z}' rpy='{roll} {pitch} {yaw}'/>\
                 <axis xyz='0 0 1'/><limit lower='-2' upper='2' effort='1' velocity='1'/></joint>"
            );
            let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), *yaw)
                * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), *pitch)
                * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), *roll);
            let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), *angle);
            expected *= Isometry3::from_parts(Translation3::new(*x, *y, *z), rotation * turned);
        }
        let (chain, diagnostics) = read(&format!("<robot name='chain'>{parts}<monas cycle='1ms'/></robot>"));
        prop_assert_eq!(diagnostics, []);
        let (chain, angles) = (chain.unwrap(), poses.iter().map(|(_, angle)| *angle).collect::<Vec<_>>());
        let tree = LinkTree::new(&chain);
        let last = tree.pose_in_torso(poses.len(), Isometry3::identity(), &angles);
        prop_assert!((last.translation.vector - expected.translation.vector).norm() < 1e-9);
        prop_assert!(last.rotation.angle_to(&expected.rotation) < 1e-6);
        let point = Point3::new(0.3, -0.2, 0.1);
        prop_assert!((tree.in_torso(poses.len(), point, &angles) - last * point).norm() < 1e-9);
    }
}
