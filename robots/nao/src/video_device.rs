//! Cameras through Video4Linux: the few calls of its streaming interface that a Nao needs.
//!
//! The interface of the kernel consists of C structures that `ioctl` fills. Crates for it either
//! generate these from C headers with libclang, or, in pure Rust, do not expose the time at which
//! an image was taken, which relates it to the joints. So the structures are here, for 64-bit
//! systems, whose layout the numbers of the calls contain.
#![allow(unsafe_code, reason = "the kernel fills structures and maps memory by calls that are unsafe")]

use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Result};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::ptr::NonNull;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::ioctl::{Opcode, Setter, Updater, ioctl, opcode};
use rustix::mm::{MapFlags, ProtFlags, mmap, munmap};

use crate::camera_thread::{FrameSource, monotonic_time};
use crate::frame::{Frame, HEIGHT, WIDTH, upright};

/// `struct v4l2_capability`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
struct Capability {
    driver: [u64; 2],
    card: [u64; 4],
    bus: [u64; 4],
    version: u32,
    capabilities: u32,
    device: u32,
    reserved: [u32; 3],
}

/// `struct v4l2_format` with a `struct v4l2_pix_format`.
#[repr(C)]
#[derive(Clone, Copy)]
struct Format {
    kind: u32,
    padding: u32,
    width: u32,
    height: u32,
    pixels: [u8; 4],
    field: u32,
    bytes_per_line: u32,
    bytes: u32,
    rest: [u32; 44],
}

/// `struct v4l2_streamparm` with a `struct v4l2_captureparm`.
#[repr(C)]
#[derive(Clone, Copy)]
struct Parameters {
    kind: u32,
    capability: u32,
    mode: u32,
    /// The time of a frame: numerator and denominator, s.
    period: [u32; 2],
    rest: [u32; 46],
}

/// `struct v4l2_requestbuffers`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
struct BufferRequest {
    count: u32,
    kind: u32,
    memory: u32,
    capabilities: u32,
    flags: u32,
}

/// `struct v4l2_buffer`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
struct Buffer {
    index: u32,
    kind: u32,
    used: u32,
    flags: u32,
    field: u32,
    padding: u32,
    seconds: i64,
    microseconds: i64,
    time_code: [u32; 4],
    sequence: u32,
    memory: u32,
    offset: u32,
    pointer: u32,
    length: u32,
    reserved: [u32; 3],
}

const QUERY_CAPABILITY: Opcode = opcode::read::<Capability>(b'V', 0);
const SET_FORMAT: Opcode = opcode::read_write::<Format>(b'V', 5);
const REQUEST_BUFFERS: Opcode = opcode::read_write::<BufferRequest>(b'V', 8);
const QUERY_BUFFER: Opcode = opcode::read_write::<Buffer>(b'V', 9);
const ENQUEUE: Opcode = opcode::read_write::<Buffer>(b'V', 15);
const DEQUEUE: Opcode = opcode::read_write::<Buffer>(b'V', 17);
const STREAM_ON: Opcode = opcode::write::<u32>(b'V', 18);
const SET_PARAMETERS: Opcode = opcode::read_write::<Parameters>(b'V', 22);

/// `V4L2_BUF_TYPE_VIDEO_CAPTURE`.
const CAPTURE: u32 = 1;
/// `V4L2_MEMORY_MMAP`.
const MAPPED: u32 = 1;
/// `V4L2_CAP_VIDEO_CAPTURE`, `V4L2_CAP_STREAMING` and `V4L2_CAP_DEVICE_CAPS`.
const CAN_CAPTURE: u32 = 0x0000_0001;
const CAN_STREAM: u32 = 0x0400_0000;
const HAS_DEVICE: u32 = 0x8000_0000;
/// `V4L2_BUF_FLAG_ERROR`; `V4L2_BUF_FLAG_TIMESTAMP_MASK` and `V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC`.
const DAMAGED: u32 = 0x0000_0040;
const CLOCK: u32 = 0x0000_e000;
const MONOTONIC: u32 = 0x0000_2000;
/// Y U Y V, the format of all images here.
const YUYV: [u8; 4] = *b"YUYV";
/// Images per second.
const RATE: u32 = 30;
/// Buffers between the driver and this program: one is read while the others fill.
const BUFFERS: u32 = 4;

/// Calls the driver with a structure that it reads and writes.
///
/// # Safety
/// `T` has the layout of the structure that the call `OPCODE` reads and writes.
unsafe fn exchange<const OPCODE: Opcode, T>(device: &File, value: &mut T) -> Result<()> {
    // SAFETY: `value` is valid for reads and writes, and has the layout of the call's structure by
    // the contract of this function. All its bit patterns are values of integers.
    let called = rustix::io::retry_on_intr(|| unsafe { ioctl(device, Updater::<OPCODE, T>::new(value)) });
    Ok(called?)
}

/// A camera that is opened, in the format of [`Frame`].
pub(crate) struct VideoDevice {
    device: File,
    bytes_per_line: usize,
}

impl VideoDevice {
    /// Opens a camera, and sets its format and rate.
    ///
    /// # Errors
    /// There is no such file, it may not be opened, it is not a camera, or one without the format.
    pub(crate) fn open(path: &Path) -> Result<VideoDevice> {
        let flags = rustix::fs::OFlags::NONBLOCK.bits() as i32;
        let device = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path)?;
        let mut found = Capability::default();
        // SAFETY: the call takes a `struct v4l2_capability`.
        unsafe { exchange::<QUERY_CAPABILITY, _>(&device, &mut found) }.map_err(|_| not_a_camera())?;
        let can = if found.capabilities & HAS_DEVICE != 0 { found.device } else { found.capabilities };
        if can & CAN_CAPTURE == 0 || can & CAN_STREAM == 0 {
            return Err(not_a_camera());
        }
        let bytes_per_line = set_format(&device)?;
        let mut parameters =
            Parameters { kind: CAPTURE, capability: 0, mode: 0, period: [1, RATE], rest: [0; 46] };
        // SAFETY: the call takes a `struct v4l2_streamparm`. A camera without a choice refuses it,
        // and keeps its own rate.
        let _ = unsafe { exchange::<SET_PARAMETERS, _>(&device, &mut parameters) };
        Ok(VideoDevice { device, bytes_per_line })
    }

    /// Begins to take images. The images of a camera that is mounted upside down are turned.
    ///
    /// # Errors
    /// The camera is used by another program, or it is gone.
    pub(crate) fn stream(self, is_turned: bool) -> Result<VideoStream> {
        let mut request =
            BufferRequest { count: BUFFERS, kind: CAPTURE, memory: MAPPED, ..Default::default() };
        // SAFETY: the call takes a `struct v4l2_requestbuffers`.
        unsafe { exchange::<REQUEST_BUFFERS, _>(&self.device, &mut request) }?;
        let mappings =
            (0..request.count).map(|index| Mapping::of(&self.device, index)).collect::<Result<_>>()?;
        let stream =
            VideoStream { mappings, device: self.device, bytes_per_line: self.bytes_per_line, is_turned };
        for index in 0..request.count {
            stream.enqueue(index)?;
        }
        // SAFETY: the call takes an `int`, which it reads.
        rustix::io::retry_on_intr(|| unsafe {
            ioctl(&stream.device, Setter::<STREAM_ON, u32>::new(CAPTURE))
        })?;
        Ok(stream)
    }
}

/// Sets the format; returns the bytes of a row.
fn set_format(device: &File) -> Result<usize> {
    let mut format = Format {
        kind: CAPTURE,
        padding: 0,
        width: WIDTH as u32,
        height: HEIGHT as u32,
        pixels: YUYV,
        field: 0,
        bytes_per_line: 0,
        bytes: 0,
        rest: [0; 44],
    };
    // SAFETY: the call takes a `struct v4l2_format`; its kind says that it holds the one of pixels.
    unsafe { exchange::<SET_FORMAT, _>(device, &mut format) }?;
    let Format { width, height, pixels, bytes_per_line, .. } = format;
    if (width as usize, height as usize, pixels) != (WIDTH, HEIGHT, YUYV) {
        let pixels = pixels.escape_ascii();
        let message = format!("it delivers {width}x{height} `{pixels}` in place of {WIDTH}x{HEIGHT} `YUYV`");
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    Ok(bytes_per_line as usize)
}

fn not_a_camera() -> Error {
    Error::new(ErrorKind::Unsupported, "it is not a camera of Video4Linux")
}

/// A buffer of the driver in the memory of this program, for reading.
struct Mapping {
    start: NonNull<u8>,
    length: usize,
}

impl Mapping {
    fn of(device: &File, index: u32) -> Result<Mapping> {
        let mut buffer = Buffer { index, kind: CAPTURE, memory: MAPPED, ..Buffer::default() };
        // SAFETY: the call takes a `struct v4l2_buffer`.
        unsafe { exchange::<QUERY_BUFFER, _>(device, &mut buffer) }?;
        let length = buffer.length as usize;
        let (flags, offset) = (MapFlags::SHARED, u64::from(buffer.offset));
        // SAFETY: the kernel chooses where the new mapping is, so that it overlaps no other memory.
        let start = unsafe { mmap(std::ptr::null_mut(), length, ProtFlags::READ, flags, device, offset) }?;
        let start = NonNull::new(start.cast()).ok_or_else(|| Error::other("the buffer is not mapped"))?;
        Ok(Mapping { start, length })
    }

    /// The bytes of a buffer.
    ///
    /// # Safety
    /// The buffer is dequeued as long as the bytes are used: the driver writes into one in its
    /// queue.
    unsafe fn bytes(&self) -> &[u8] {
        // SAFETY: the mapping is readable, `length` bytes long, and lives as long as `self`. The
        // driver does not write into it by the contract of this function.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.length) }
    }
}

impl Drop for Mapping {
    fn drop(&mut self) {
        // SAFETY: the memory is a whole mapping of this type, and no borrow of it is left.
        let _ = unsafe { munmap(self.start.as_ptr().cast(), self.length) };
    }
}

/// A camera that takes images. Closing the device ends that.
pub(crate) struct VideoStream {
    mappings: Vec<Mapping>,
    device: File,
    bytes_per_line: usize,
    is_turned: bool,
}

impl VideoStream {
    /// Gives a buffer to the driver. No borrow of its bytes is left: they are borrowed only in
    /// `take`.
    fn enqueue(&self, index: u32) -> Result<()> {
        let mut buffer = Buffer { index, kind: CAPTURE, memory: MAPPED, ..Buffer::default() };
        // SAFETY: the call takes a `struct v4l2_buffer`.
        unsafe { exchange::<ENQUEUE, _>(&self.device, &mut buffer) }
    }

    /// The image in a buffer that has been dequeued; none if it is damaged.
    fn take(&self, buffer: &Buffer) -> Option<Frame> {
        let mapping = self.mappings.get(buffer.index as usize)?;
        if buffer.flags & DAMAGED != 0 {
            return None;
        }
        // SAFETY: the caller has dequeued the buffer, and enqueues it after this function.
        let bytes = unsafe { mapping.bytes() }.get(..buffer.used as usize)?;
        let taken_at = match buffer.flags & CLOCK == MONOTONIC {
            true => Duration::from_secs(buffer.seconds.try_into().ok()?)
                .checked_add(Duration::from_micros(buffer.microseconds.try_into().ok()?))?,
            false => monotonic_time(),
        };
        Some(Frame { taken_at, pixels: upright(bytes, self.bytes_per_line, self.is_turned)? })
    }
}

impl FrameSource for VideoStream {
    fn next_frame(&mut self, wait: Duration) -> Result<Option<Frame>> {
        let mut ready = [PollFd::new(&self.device, PollFlags::IN)];
        let timeout = Timespec { tv_sec: wait.as_secs() as i64, tv_nsec: wait.subsec_nanos().into() };
        if rustix::io::retry_on_intr(|| poll(&mut ready, Some(&timeout)))? == 0 {
            return Ok(None);
        }
        let mut buffer = Buffer { kind: CAPTURE, memory: MAPPED, ..Buffer::default() };
        // SAFETY: the call takes a `struct v4l2_buffer`.
        match unsafe { exchange::<DEQUEUE, _>(&self.device, &mut buffer) } {
            Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(None),
            dequeued => dequeued?,
        }
        let frame = self.take(&buffer);
        self.enqueue(buffer.index)?;
        Ok(frame)
    }
}

#[cfg(test)]
mod tests {
    use std::mem::{offset_of, size_of};

    use super::*;

    #[test]
    fn structures_and_calls_are_those_of_the_kernel() {
        let calls = [
            (QUERY_CAPABILITY, 0x8068_5600),
            (SET_FORMAT, 0xc0d0_5605),
            (REQUEST_BUFFERS, 0xc014_5608),
            (QUERY_BUFFER, 0xc058_5609),
            (ENQUEUE, 0xc058_560f),
            (DEQUEUE, 0xc058_5611),
            (STREAM_ON, 0x4004_5612),
            (SET_PARAMETERS, 0xc0cc_5616),
        ];
        for (call, number) in calls {
            assert_eq!(call, number, "{number:x}");
        }
        assert_eq!((offset_of!(Capability, capabilities), offset_of!(Capability, device)), (84, 88));
        assert_eq!((offset_of!(Format, width), offset_of!(Format, bytes_per_line)), (8, 24));
        assert_eq!((offset_of!(Parameters, period), size_of::<BufferRequest>()), (12, 20));
        let buffer = [
            offset_of!(Buffer, seconds),
            offset_of!(Buffer, sequence),
            offset_of!(Buffer, offset),
            offset_of!(Buffer, length),
        ];
        assert_eq!(buffer, [24, 56, 64, 72]);
    }

    #[test]
    fn what_is_no_camera_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "no camera").unwrap();
        let kind = |path: &Path| VideoDevice::open(path).map(drop).unwrap_err().kind();
        assert_eq!(kind(&folder.path().join("none")), ErrorKind::NotFound);
        assert_eq!(kind(&file), ErrorKind::Unsupported);
        assert_eq!(kind(Path::new("/dev/null")), ErrorKind::Unsupported);
        assert_eq!(kind(folder.path()), ErrorKind::IsADirectory);
    }
}
