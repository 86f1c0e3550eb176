//! Kinds of bodies that configurations can name.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use crate::{BodyFault, BodyOption, Disturbances, Error, ErrorKind, FieldColours, Robot, Skill, WrappedBody};

/// A kind of body, as [`body_kind!`](crate::body_kind!) registers it at link time.
#[derive(Clone, Copy)]
pub struct BodyKind {
    /// The name that configurations use.
    pub name: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// The further attributes of `body` that a configuration may set, beside its address.
    pub options: &'static [BodyOption],
    /// Whether a body with these settings has a time of its own: each call of
    /// [`sense`](Robot::sense) then makes one cycle of a simulation elsewhere and waits for it, and
    /// the run is one in simulated time. Other bodies are in real time, or in the time of the
    /// simulated world around them.
    pub has_own_time: fn(&BodySettings) -> bool,
    /// The capabilities that a body with these settings lacks, or has only in part, compared with
    /// the bodies of the embedded field. They are reported before a run, with the activities
    /// concerned.
    pub limits: fn(&BodySettings, BodyEnvironment) -> Vec<BodyLimit>,
    /// Faults of settings whose options are each of their kind: contradictory values, files with
    /// wrong contents. A configuration with a fault is refused before a run.
    pub faults: fn(&BodySettings, BodyEnvironment) -> Vec<BodyFault>,
    /// Opens a body of this kind.
    pub open: OpenBody,
    /// Offers a body of a simulated world at an address through the interface of this kind, for
    /// agents in another process, which command it; none if this kind has no such interface.
    pub serve: Option<OpenBody>,
    /// Whether a body of this kind answers at an address, or at its usual one: what answers.
    pub probe: fn(Option<&str>) -> Result<String, Error>,
}

/// Opens a body at a site.
pub type OpenBody = fn(BodySite) -> Result<Box<dyn Robot>, Error>;

/// A capability that a body lacks, or has in a form that software may not expect.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BodyLimit {
    /// The limited capability.
    pub capability: Capability,
    /// How, as a clause: `the robot cannot stand up by itself`.
    pub effect: Cow<'static, str>,
}

impl BodyLimit {
    /// A limit of a skill.
    pub const fn skill(skill: Skill, effect: &'static str) -> BodyLimit {
        BodyLimit { capability: Capability::Skill(skill), effect: Cow::Borrowed(effect) }
    }

    /// A limit of what a topic of [`topics`](crate::topics) carries, given its path.
    pub const fn topic(path: &'static str, effect: &'static str) -> BodyLimit {
        BodyLimit { capability: Capability::Topic(path), effect: Cow::Borrowed(effect) }
    }

    /// As [`topic`](BodyLimit::topic), with an effect that was found on this computer.
    pub fn found(path: &'static str, effect: String) -> BodyLimit {
        BodyLimit { capability: Capability::Topic(path), effect: Cow::Owned(effect) }
    }
}

/// The environment of a body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BodyEnvironment {
    /// A place of its own: reality, or a simulation that the kind of the body reaches by itself.
    Own,
    /// The simulated world of a match, which may stand in for what the interface of the body lacks.
    Match,
}

/// A capability of a body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Capability {
    /// A skill.
    Skill(Skill),
    /// Publishing or executing the messages of the topic with this path.
    Topic(&'static str),
}

/// The address, settings and environment with which a body is opened.
#[derive(Default)]
pub struct BodySite {
    /// The address that the configuration names; by default the usual one of the kind.
    pub address: Option<String>,
    /// The options that the configuration gives.
    pub options: BTreeMap<String, String>,
    /// The body of the simulated world that the robot stands in, in simulated time; none on a
    /// robot.
    pub simulated: Option<Box<dyn Robot>>,
}

/// The body of a robot, as a configuration names it.
#[derive(Clone, PartialEq, Debug)]
pub struct BodySettings {
    /// The name of its kind.
    pub kind: String,
    /// The address of its interface; by default that of its kind.
    pub address: Option<String>,
    /// The options of its kind that are given.
    pub options: BTreeMap<String, String>,
    /// The output of its cameras.
    pub vision: CameraOutput,
    /// The width of its images, pixels; by default that of its kind.
    pub image_width: Option<u32>,
    /// The colours of the field that its images carry, for the calibration to begin with.
    pub colours: Option<FieldColours>,
    /// Simulated disturbances between the body and the software.
    pub disturbances: Disturbances,
}

/// The output of a body's cameras.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum CameraOutput {
    /// Finished sightings, without images: a simulated body then senses much faster.
    #[default]
    Sightings,
    /// Images, in which the robot's software finds what they show.
    Images,
}

impl CameraOutput {
    /// All, with the words that configurations use.
    pub const NAMES: [(&'static str, CameraOutput); 2] =
        [("sightings", CameraOutput::Sightings), ("images", CameraOutput::Images)];
}

/// The widths of images that configurations can choose, with their words.
pub const IMAGE_WIDTHS: [(&str, u32); 3] = [("160", 160), ("320", 320), ("640", 640)];

impl Default for BodySettings {
    /// The simulated world's own body, without disturbances.
    fn default() -> BodySettings {
        let disturbances = Disturbances::default();
        let (kind, options) = (BodyKind::DEFAULT.to_owned(), BTreeMap::new());
        let (vision, image_width, colours) = (CameraOutput::default(), None, None);
        BodySettings { kind, address: None, options, vision, image_width, colours, disturbances }
    }
}

impl BodySettings {
    /// Offers a simulated world's body at an address, for agents in another process that open a
    /// body of this kind there. The returned robot senses the body, and ignores commands.
    ///
    /// # Errors
    /// There is no such kind, it has no interface for other processes, the address cannot be used,
    /// or the simulated body has no images to deliver, or none of the width.
    pub fn serve(&self, mut simulated: Box<dyn Robot>, address: String) -> Result<Box<dyn Robot>, Error> {
        let kind = BodyKind::named(&self.kind)?;
        let serve = kind.serve.ok_or_else(|| {
            let message = format!(
                "a body of kind `{}` has no interface for agents in another process; one of kind `nao` has",
                kind.name
            );
            Error::new(ErrorKind::Configuration, message)
        })?;
        if self.vision == CameraOutput::Images {
            simulated.deliver_images(self.image_width)?;
        }
        let options = self.options.clone();
        serve(BodySite { address: Some(address), options, simulated: Some(simulated) })
    }

    /// The limits of the body there, see [`BodyKind::limits`]; empty for an unknown kind.
    pub fn limits(&self, surroundings: BodyEnvironment) -> Vec<BodyLimit> {
        BodyKind::named(&self.kind).map(|kind| (kind.limits)(self, surroundings)).unwrap_or_default()
    }

    /// The faults of the settings there, see [`BodyKind::faults`]; empty for an unknown kind.
    pub fn faults(&self, surroundings: BodyEnvironment) -> Vec<BodyFault> {
        BodyKind::named(&self.kind).map(|kind| (kind.faults)(self, surroundings)).unwrap_or_default()
    }

    /// Whether the body has a time of its own, see [`BodyKind::has_own_time`].
    pub fn has_own_time(&self) -> bool {
        BodyKind::named(&self.kind).is_ok_and(|kind| (kind.has_own_time)(self))
    }

    /// Opens the body, with the simulated world's body if there is one. The seed determines the
    /// disturbances.
    ///
    /// # Errors
    /// There is no such kind, the body does not answer, or it has no images to deliver, or none
    /// of the width.
    pub fn open(&self, simulated: Option<Box<dyn Robot>>, seed: u64) -> Result<Box<dyn Robot>, Error> {
        let kind = BodyKind::named(&self.kind)?;
        let (address, options) = (self.address.clone(), self.options.clone());
        let mut body = (kind.open)(BodySite { address, options, simulated })?;
        if self.vision == CameraOutput::Images {
            body.deliver_images(self.image_width)?;
        }
        Ok(match (&self.colours, self.disturbances == Disturbances::default()) {
            (None, true) => body,
            (colours, _) => {
                Box::new(WrappedBody::new(body, self.disturbances, seed).with_colours(colours.clone()))
            }
        })
    }
}

/// Every kind of body in the crates of this program.
#[doc(hidden)]
#[narukom::linkme::distributed_slice]
#[linkme(crate = narukom::linkme)]
pub static BODY_KINDS: [BodyKind];

/// Registers a kind of body, so that configurations can name it.
///
/// The linker drops a crate that the program does not mention, with its kinds: write `use its_name
/// as _;` in the program.
#[macro_export]
macro_rules! body_kind {
    ($kind:expr) => {
        const _: () = {
            #[allow(unsafe_code)] // the section of the executable that the linker collects
            #[$crate::linked::linkme::distributed_slice($crate::linked::BODY_KINDS)]
            #[linkme(crate = $crate::linked::linkme)]
            static KIND: $crate::BodyKind = $kind;
        };
    };
}

impl BodyKind {
    /// The kind of a simulated world's own bodies, which needs no name.
    pub const DEFAULT: &'static str = "field";

    /// All kinds of this program, by name.
    pub fn linked() -> Vec<BodyKind> {
        let mut kinds = BODY_KINDS.to_vec();
        kinds.sort_by_key(|kind| kind.name);
        kinds
    }

    /// The kind with a name.
    ///
    /// # Errors
    /// There is none; the error names those there are.
    pub fn named(name: &str) -> Result<BodyKind, Error> {
        let kinds = BodyKind::linked();
        kinds.iter().find(|kind| kind.name == name).copied().ok_or_else(|| {
            let names: Vec<String> = kinds.iter().map(|kind| format!("`{}`", kind.name)).collect();
            let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            let message = format!("there is no body of kind `{name}`; linked are {known}");
            Error::new(ErrorKind::Configuration, message)
        })
    }
}

impl fmt::Debug for BodyKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BodyKind({})", self.name)
    }
}
