//! A camera with a thread of its own, which keeps the newest image.

use std::io::Result;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use monas_robot::{Error, ErrorKind};

use crate::frame::Frame;

/// The longest wait for an image before a thread checks whether it should end.
const IMAGE_TIMEOUT: Duration = Duration::from_millis(200);
/// The time without an image after which a camera counts as lost.
const LOST_AFTER: Duration = Duration::from_secs(2);
/// The pause between two attempts to open a camera.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);

/// A source of images.
pub(crate) trait FrameSource {
    /// The next image. None if there is none within the time, or if it is damaged.
    ///
    /// # Errors
    /// The camera is lost.
    fn next_frame(&mut self, wait: Duration) -> Result<Option<Frame>>;
}

/// A camera whose images a thread takes.
///
/// The thread opens the camera, retries while it is missing or lost, and replaces an image that has
/// not been fetched by the next one.
pub(crate) struct CameraThread {
    shared: Arc<SharedFrame>,
    thread: Option<JoinHandle<()>>,
}

struct SharedFrame {
    state: Mutex<FrameState>,
    /// The thread should end.
    changed: Condvar,
}

#[derive(Default)]
struct FrameState {
    newest: Option<Frame>,
    ends: bool,
}

impl SharedFrame {
    fn lock(&self) -> MutexGuard<'_, FrameState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens the camera and takes its images, until the thread should end.
    fn run<Source: FrameSource>(&self, name: &str, open: impl Fn() -> Result<Source>) {
        let mut reported = String::new();
        while !self.lock().ends {
            let taken = open().and_then(|mut source| {
                reported.clear();
                self.take_frames(&mut source, monotonic_time)
            });
            let Err(error) = taken else { return };
            let message = error.to_string();
            if message != reported {
                tracing::warn!("camera `{name}` delivers no images: {message}; it is tried again");
                reported = message;
            }
            // Ended by `drop`.
            let _ = self.changed.wait_timeout_while(self.lock(), RETRY_INTERVAL, |state| !state.ends);
        }
    }

    fn take_frames(&self, source: &mut impl FrameSource, time: impl Fn() -> Duration) -> Result<()> {
        let mut last = time();
        loop {
            let frame = source.next_frame(IMAGE_TIMEOUT)?;
            let now = time();
            // A damaged image takes less time than a wait.
            if frame.is_some() {
                last = now;
            } else if now.saturating_sub(last) > LOST_AFTER {
                return Err(std::io::Error::other("no image has come for two seconds"));
            }
            let mut state = self.lock();
            if state.ends {
                return Ok(());
            }
            if frame.is_some() {
                state.newest = frame;
            }
        }
    }
}

impl CameraThread {
    /// Starts the thread of the camera that `open` opens.
    ///
    /// # Errors
    /// The system cannot create a thread.
    pub(crate) fn start<Source: FrameSource>(
        name: &'static str,
        open: impl Fn() -> Result<Source> + Send + 'static,
    ) -> std::result::Result<CameraThread, Error> {
        let state = Mutex::new(FrameState::default());
        let shared = Arc::new(SharedFrame { state, changed: Condvar::new() });
        let of_thread = shared.clone();
        let thread = std::thread::Builder::new()
            .name(name.into())
            .spawn(move || of_thread.run(name, open))
            .map_err(|error| Error::new(ErrorKind::Configuration, error.to_string()))?;
        Ok(CameraThread { shared, thread: Some(thread) })
    }

    /// Takes the newest image, if it has not been taken yet.
    pub(crate) fn newest(&self) -> Option<Frame> {
        self.shared.lock().newest.take()
    }
}

impl Drop for CameraThread {
    fn drop(&mut self) {
        self.shared.lock().ends = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The clock by which drivers stamp images.
pub(crate) fn monotonic_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;

    /// A camera that delivers what it receives, and is lost when the other end closes.
    struct Scripted(Receiver<Option<Frame>>);

    impl FrameSource for Scripted {
        fn next_frame(&mut self, _: Duration) -> Result<Option<Frame>> {
            self.0.recv().map_err(|_| Error::other("gone"))
        }
    }

    fn frame(seconds: u64) -> Frame {
        Frame { taken_at: Duration::from_secs(seconds), pixels: vec![seconds as u8] }
    }

    fn state() -> SharedFrame {
        SharedFrame { state: Mutex::default(), changed: Condvar::new() }
    }

    /// Runs until the source is lost; returns why it ended.
    fn run(shared: &SharedFrame, script: impl Fn(&Sender<Option<Frame>>)) -> String {
        let (sender, receiver) = channel();
        script(&sender);
        drop(sender);
        run_at(shared, 0, receiver)
    }

    /// As `run`, with this many milliseconds between two readings of the clock.
    fn run_at(shared: &SharedFrame, millis: u64, receiver: Receiver<Option<Frame>>) -> String {
        let time = AtomicU64::new(0);
        let clock = || Duration::from_millis(time.fetch_add(millis, Ordering::Relaxed));
        shared.take_frames(&mut Scripted(receiver), clock).unwrap_err().to_string()
    }

    #[test]
    fn the_newest_image_replaces_those_that_were_not_fetched() {
        let shared = state();
        let why =
            run(&shared, |camera| [1, 2, 3].iter().for_each(|&at| camera.send(Some(frame(at))).unwrap()));
        assert_eq!((shared.lock().newest.take(), why.as_str()), (Some(frame(3)), "gone"));
        run(&shared, |camera| [Some(frame(4)), None].into_iter().for_each(|it| camera.send(it).unwrap()));
        assert_eq!(shared.lock().newest.take(), Some(frame(4)), "a damaged image replaces nothing");
    }

    #[test]
    fn a_camera_counts_as_gone_after_two_seconds_without_images() {
        let ends = |millis, images: &[Option<Frame>]| {
            let (sender, receiver) = channel();
            images.iter().for_each(|image| sender.send(image.clone()).unwrap());
            drop(sender);
            run_at(&state(), millis, receiver)
        };
        let (gone, silent) = ("gone", "no image has come for two seconds");
        assert_eq!(ends(200, &vec![None; 10]), gone);
        assert_eq!(ends(200, &vec![None; 11]), silent);
        let one_in_ten: Vec<_> = (0..40).map(|at| (at % 10 == 9).then(|| frame(at))).collect();
        assert_eq!(ends(200, &one_in_ten), gone);
        // Damaged images, 30 a second.
        assert_eq!(ends(33, &vec![None; 60]), gone);
        assert_eq!(ends(33, &vec![None; 61]), silent);
    }

    #[test]
    fn dropping_a_missing_camera_ends_its_thread() {
        static OPENED: AtomicU64 = AtomicU64::new(0);
        let open = || {
            OPENED.fetch_add(1, Ordering::Relaxed);
            Err::<Scripted, _>(Error::from(ErrorKind::NotFound))
        };
        let camera = CameraThread::start("camera", open).unwrap();
        while OPENED.load(Ordering::Relaxed) == 0 {
            std::thread::yield_now();
        }
        assert_eq!(camera.newest(), None);
        drop(camera);
    }
}
