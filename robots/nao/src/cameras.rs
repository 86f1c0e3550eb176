//! The two cameras of the head, and the messages with their images.

use std::collections::BTreeMap;
use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use monas_robot::{BodyFault, Error, Image, Images, ObjectSet};
use narukom::Timestamp;

use crate::camera_thread::{CameraThread, monotonic_time};
use crate::frame::{Frame, HEIGHT, WIDTH};
use crate::kinematics::{self, JointAngles, NaoCamera, Side};
use crate::video_device::VideoDevice;

/// The options of the cameras.
pub(crate) const TOP_OPTION: &str = "camera_top";
pub(crate) const BOTTOM_OPTION: &str = "camera_bottom";
pub(crate) const TURNED_OPTION: &str = "camera_top_turned";
pub(crate) const TODAY_OPTION: &str = "objects_of_today";

/// The cameras of a body: devices, mounting and the appearance of objects; by default those of a
/// Nao V6.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CameraConfig {
    /// The device of the upper camera.
    pub top: PathBuf,
    /// The device of the lower camera.
    pub bottom: PathBuf,
    /// Whether the upper camera delivers images that are upside down, as it is mounted; they are
    /// turned then.
    pub is_top_turned: bool,
    /// The appearance of ball and goals.
    pub objects: ObjectSet,
}

impl Default for CameraConfig {
    fn default() -> CameraConfig {
        CameraConfig {
            top: "/dev/video-top".into(),
            bottom: "/dev/video-bottom".into(),
            is_top_turned: true,
            objects: ObjectSet::Of2010,
        }
    }
}

impl CameraConfig {
    /// Reads the options of a configuration.
    pub(crate) fn of(options: &BTreeMap<String, String>) -> CameraConfig {
        let usual = CameraConfig::default();
        CameraConfig {
            top: options.get(TOP_OPTION).map_or(usual.top, PathBuf::from),
            bottom: options.get(BOTTOM_OPTION).map_or(usual.bottom, PathBuf::from),
            is_top_turned: options.get(TURNED_OPTION).is_none_or(|flag| flag != "0"),
            objects: match options.get(TODAY_OPTION).is_some_and(|flag| flag == "1") {
                true => ObjectSet::OfToday,
                false => ObjectSet::Of2010,
            },
        }
    }

    /// The cameras that cannot be used now, each with the reason and the option that names another
    /// device.
    pub(crate) fn missing(&self) -> Vec<String> {
        let cameras = [("upper", TOP_OPTION, &self.top), ("lower", BOTTOM_OPTION, &self.bottom)];
        let opened = cameras.into_iter().map(|(name, option, path)| (name, option, open(path)));
        let missing = opened.filter_map(|(name, option, opened)| {
            let why = opened.err()?;
            Some(format!("the robot sees nothing with its {name} camera, see the option `{option}`: {why}"))
        });
        missing.collect()
    }
}

/// Checks the width of images that a configuration asks for.
///
/// # Errors
/// The cameras deliver another width.
pub(crate) fn check_width(width: Option<u32>) -> Result<(), BodyFault> {
    match width {
        Some(width) if width as usize != WIDTH => {
            let message =
                format!("the images of a Nao are {WIDTH} pixels wide, not {width}; remove `image_width`");
            Err(BodyFault::new("image_width", message))
        }
        _ => Ok(()),
    }
}

/// Opens a camera.
fn open(path: &Path) -> Result<VideoDevice, CameraError> {
    VideoDevice::open(path).map_err(|error| CameraError { path: path.to_owned(), error })
}

/// Why a camera cannot be used.
#[derive(Debug)]
struct CameraError {
    path: PathBuf,
    error: std::io::Error,
}

impl fmt::Display for CameraError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        match self.error.kind() {
            ErrorKind::NotFound => write!(f, "there is no `{path}`"),
            ErrorKind::PermissionDenied => {
                write!(f, "`{path}` may not be opened; the group `video` may as a rule")
            }
            ErrorKind::ResourceBusy => write!(f, "`{path}` is used by another program"),
            _ => write!(f, "`{path}`: {}", self.error),
        }
    }
}

/// Both cameras while they take images.
pub(crate) struct Cameras {
    threads: [CameraThread; 2],
    pair: FramePair,
    objects: ObjectSet,
}

impl Cameras {
    /// Starts a thread for each camera. A missing camera is reported in the log, and used as soon
    /// as it appears.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub(crate) fn start(settings: &CameraConfig) -> Result<Cameras, Error> {
        let thread = |name, path: &Path, is_turned| {
            let path = path.to_owned();
            CameraThread::start(name, move || {
                let streamed = open(&path).and_then(|device| {
                    device.stream(is_turned).map_err(|error| CameraError { path: path.clone(), error })
                });
                streamed.map_err(|error| std::io::Error::other(error.to_string()))
            })
        };
        let top = thread(TOP_OPTION, &settings.top, settings.is_top_turned)?;
        let threads = [top, thread(BOTTOM_OPTION, &settings.bottom, false)?];
        Ok(Cameras { threads, pair: FramePair::default(), objects: settings.objects })
    }

    /// The newest images, with the pose that the cameras have in the posture of the joints. Never
    /// waits.
    pub(crate) fn take(&mut self, now: Timestamp, angles: &JointAngles) -> Option<Images> {
        let clock = monotonic_time();
        for (thread, frames) in self.threads.iter().zip(&mut self.pair.cameras) {
            if let Some(frame) = thread.newest() {
                frames.add(frame);
            }
        }
        let (taken_at, frames) = self.pair.take(clock)?;
        // The age of the images is the same on both clocks.
        let age = clock.saturating_sub(taken_at);
        let taken_at = now.as_nanos().saturating_sub(age.as_nanos() as u64);
        let objects = self.objects.into();
        Some(Images { objects, ..message(taken_at, frames, angles) })
    }
}

/// The message with the images of both cameras, or one.
fn message(taken_at: u64, frames: [Option<Frame>; 2], angles: &JointAngles) -> Images {
    let cameras = [NaoCamera::Top, NaoCamera::Bottom].into_iter().zip(frames);
    let images = cameras.filter_map(|(camera, frame)| Some(image(camera, frame?, angles)));
    Images { taken_at, images: images.collect(), ..Images::default() }
}

fn image(camera: NaoCamera, frame: Frame, angles: &JointAngles) -> Image {
    let height = kinematics::camera_in_torso(camera, angles).translation.z;
    // A foot that is lifted is higher.
    let ground = Side::BOTH.map(|side| kinematics::foot_in_torso(side, angles).translation.z);
    Image {
        width: WIDTH as u32,
        height: HEIGHT as u32,
        angle_of_view: camera.description().horizontal,
        camera_height: height - ground[0].min(ground[1]),
        camera_tilt: kinematics::camera_tilt(camera),
        pixels: frame.pixels,
    }
}

/// The newest images of two cameras that run at the same rate, but not at the same time.
///
/// A message has one time for all its images. The images of the two that are next to each other are
/// at most half a period apart; their mean is the time of both.
#[derive(Default)]
struct FramePair {
    cameras: [NewestFrame; 2],
}

/// The newest image of a camera that has not been put into a message.
#[derive(Default)]
struct NewestFrame {
    frame: Option<Frame>,
    /// When the last image was taken, and how much later than the one before.
    last: Option<Duration>,
    period: Option<Duration>,
}

/// The time between two images until it is known.
const DEFAULT_PERIOD: Duration = Duration::from_millis(33);
/// The periods without an image after which the other camera's images are delivered alone.
const MAX_MISSED_PERIODS: u32 = 3;

impl NewestFrame {
    fn add(&mut self, frame: Frame) {
        self.period = self.last.and_then(|last| frame.taken_at.checked_sub(last));
        self.last = Some(frame.taken_at);
        self.frame = Some(frame);
    }

    /// Whether the camera has delivered an image recently.
    fn is_silent(&self, now: Duration) -> bool {
        self.last.is_none_or(|last| {
            now.saturating_sub(last)
                > MAX_MISSED_PERIODS * self.period.unwrap_or(DEFAULT_PERIOD).max(DEFAULT_PERIOD)
        })
    }
}

impl FramePair {
    /// Takes the images for a message, with their time: both if they are near each other, one if
    /// the other camera is silent.
    fn take(&mut self, now: Duration) -> Option<(Duration, [Option<Frame>; 2])> {
        let [top, bottom] = &mut self.cameras;
        if let (Some(one), Some(other)) = (&top.frame, &bottom.frame) {
            let apart = one.taken_at.abs_diff(other.taken_at);
            let period = [&top.period, &bottom.period].into_iter().flatten().max().copied();
            let taken_at = one.taken_at.min(other.taken_at) + apart / 2;
            if 2 * apart <= period.unwrap_or(DEFAULT_PERIOD) {
                return Some((taken_at, [top.frame.take(), bottom.frame.take()]));
            }
        }
        if top.is_silent(now) == bottom.is_silent(now) {
            return None;
        }
        for camera in [&mut *top, &mut *bottom] {
            if camera.is_silent(now) {
                camera.frame = None;
            }
        }
        let taken_at = top.frame.as_ref().or(bottom.frame.as_ref())?.taken_at;
        Some((taken_at, [top.frame.take(), bottom.frame.take()]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motions::stand;

    fn frame(milliseconds: u64) -> Frame {
        Frame { taken_at: Duration::from_millis(milliseconds), pixels: vec![milliseconds as u8] }
    }

    /// Adds images at times, ms, in their order; returns the time and the images of each message.
    fn messages(images: &[(usize, u64)]) -> Vec<(u64, [Option<u64>; 2])> {
        let mut pair = FramePair::default();
        let message = |&(camera, at): &(usize, u64)| {
            pair.cameras[camera].add(frame(at));
            let (taken_at, frames) = pair.take(Duration::from_millis(at))?;
            let at = |frame: Option<Frame>| frame.map(|frame| frame.taken_at.as_millis() as u64);
            Some((taken_at.as_millis() as u64, frames.map(at)))
        };
        images.iter().filter_map(message).collect()
    }

    /// The first image of the upper camera, before the lower one has delivered any.
    const FIRST: (u64, [Option<u64>; 2]) = (100, [Some(100), None]);

    #[test]
    fn images_that_are_next_to_each_other_come_in_one_message() {
        let early: Vec<(usize, u64)> = (0..4).flat_map(|n| [(0, 100 + 33 * n), (1, 110 + 33 * n)]).collect();
        let pairs = (1..4).map(|n| (105 + 33 * n, [Some(100 + 33 * n), Some(110 + 33 * n)]));
        assert_eq!(messages(&early), [FIRST].into_iter().chain(pairs).collect::<Vec<_>>());
        // The lower camera's image is nearer to the upper camera's next one.
        let late: Vec<(usize, u64)> = (0..4).flat_map(|n| [(0, 100 + 33 * n), (1, 124 + 33 * n)]).collect();
        let pairs = (0..3).map(|n| (128 + 33 * n, [Some(133 + 33 * n), Some(124 + 33 * n)]));
        assert_eq!(messages(&late), [FIRST].into_iter().chain(pairs).collect::<Vec<_>>());
    }

    #[test]
    fn a_camera_goes_on_when_the_other_is_silent() {
        let images: Vec<(usize, u64)> =
            [(0, 100), (1, 104)].into_iter().chain((1..7).map(|n| (0, 100 + 33 * n))).collect();
        let seen = messages(&images);
        // The last image of the lower camera is 99 ms old at 203 ms.
        let alone = [232, 265, 298].map(|at| (at, [Some(at), None]));
        assert_eq!(seen[1..], alone, "{seen:?}");
    }

    #[test]
    fn messages_have_the_pose_of_the_cameras() {
        let mut angles = stand();
        let images = message(7, [Some(frame(1)), Some(frame(2))], &angles);
        let [top, bottom] = &images.images[..] else { panic!("{} images", images.images.len()) };
        assert_eq!((images.taken_at, &top.pixels[..], &bottom.pixels[..]), (7, &[1][..], &[2][..]));
        assert_eq!((top.width, top.height), (640, 480));
        // Torso 30.8 cm, neck 12.65 cm, cameras 6.4 and 1.8 cm.
        assert!((top.camera_height - 0.498).abs() < 0.001, "{}", top.camera_height);
        assert!((bottom.camera_height - 0.452).abs() < 0.001, "{}", bottom.camera_height);
        assert!((top.camera_tilt - 0.0209).abs() < 1e-4 && (bottom.camera_tilt - 0.6929).abs() < 1e-4);
        angles[crate::NaoJoint::HeadPitch as usize] = 0.4;
        let looking_down = message(7, [Some(frame(1)), None], &angles);
        assert_eq!(looking_down.images.len(), 1);
        assert!(looking_down.images[0].camera_height < top.camera_height - 0.02);
    }

    #[test]
    fn images_of_another_width_are_refused() {
        assert!(check_width(None).is_ok() && check_width(Some(640)).is_ok());
        let error = check_width(Some(320)).unwrap_err().to_string();
        assert_eq!(error, "the images of a Nao are 640 pixels wide, not 320; remove `image_width`");
    }

    #[test]
    fn missing_cameras_are_named_with_their_options() {
        let options = [(TOP_OPTION, "/dev/null"), (BOTTOM_OPTION, "/nowhere/camera"), (TURNED_OPTION, "0")];
        let options = options.map(|(name, value)| (name.to_owned(), value.to_owned())).into();
        let settings = CameraConfig::of(&options);
        assert!(!settings.is_top_turned && CameraConfig::default().is_top_turned);
        let [top, bottom] = &settings.missing()[..] else { panic!("{:?}", settings.missing()) };
        let sees_nothing = "the robot sees nothing with its";
        assert_eq!(
            *top,
            format!(
                "{sees_nothing} upper camera, see the option `camera_top`: `/dev/null`: it is not a camera of Video4Linux"
            )
        );
        assert_eq!(
            *bottom,
            format!(
                "{sees_nothing} lower camera, see the option `camera_bottom`: there is no `/nowhere/camera`"
            )
        );
    }

    #[test]
    fn missing_cameras_deliver_nothing_and_do_not_stop_the_body() {
        let settings =
            CameraConfig { top: "/dev/null".into(), bottom: "/nowhere".into(), ..CameraConfig::default() };
        let mut cameras = Cameras::start(&settings).unwrap();
        assert_eq!(cameras.take(Timestamp::from_nanos(5), &stand()), None);
    }
}
