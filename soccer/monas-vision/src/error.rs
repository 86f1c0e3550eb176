//! Errors of images and cameras.

/// An error of this crate: a message for people and an [`ErrorKind`] for programs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

/// The kinds of [`Error`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Width or height is zero, odd, or too large.
    Size,
    /// The number of bytes does not fit width and height.
    Length,
    /// An angle of view, a height or a pose is not finite or not possible.
    Camera,
    /// A sample of a colour lies outside its image, holds too few pixels, or has many colours.
    Sample,
    /// No image shows carpet, or two sampled colours cannot be distinguished.
    Colours,
}

impl Error {
    /// The kind of error, for programs.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Error {
        Error { kind, message: message.into() }
    }
}
