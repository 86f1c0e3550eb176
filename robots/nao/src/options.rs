//! The options of this body in configurations.

use monas_robot::{BodyOption, OptionKind};

use crate::anatomy::{ANATOMY, anatomy};
use crate::cameras::{BOTTOM_OPTION, TODAY_OPTION, TOP_OPTION, TURNED_OPTION};
use crate::motions::{DIVE, FALL, KICK, STAND_UP};

/// The kind of an option that names a special action.
const POSES: OptionKind = OptionKind::Poses(anatomy);

/// All options.
pub(crate) const OPTIONS: &[BodyOption] = &[
    option(TOP_OPTION, OptionKind::Text, "the device of the upper camera; by default `/dev/video-top`"),
    option(BOTTOM_OPTION, OptionKind::Text, "the device of the lower camera; by default `/dev/video-bottom`"),
    option(
        TURNED_OPTION,
        OptionKind::Flag,
        "`0` if the upper camera's images are upright; by default they are turned, since it is mounted upside down",
    ),
    option(
        TODAY_OPTION,
        OptionKind::Flag,
        "`1` if the ball is black and white and the goals are white; by default they are of 2010",
    ),
    option(
        ANATOMY,
        OptionKind::Anatomy(anatomy),
        "a file in URDF: limits, speeds, masses and ranges of the walk of this robot",
    ),
    option(KICK, POSES, "a file of poses: the kick with the left foot, mirrored for the right one"),
    option(FALL, POSES, "a file of poses: the fall to the left, mirrored for the right"),
    option(DIVE, POSES, "a file of poses: the dive to the left, mirrored for the right"),
    option(STAND_UP, POSES, "a file of poses: getting up"),
];

const fn option(name: &'static str, kind: OptionKind, doc: &'static str) -> BodyOption {
    BodyOption { name, kind, doc }
}
