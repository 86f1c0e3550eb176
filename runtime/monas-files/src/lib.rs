//! Safe handling of files: texts of the user, recordings, and files that are trusted.
//!
//! - An [`AtomicFile`] replaces a file in one step: readers see the old content or the new one, and
//!   a full disk leaves the old one. [`write()`] is its short form. Every command that writes a
//!   file of the user uses it.
//! - An [`ExclusiveFile`] belongs to one process while it is written. A name that exists is left
//!   alone and the next free one is taken, unless replacing it was requested. Tapes and logs use
//!   it.
//! - [`private_folder`] and [`open_trusted`] check owner and mode of what a process relies on: the
//!   folder of its sockets, and code that it loads.
//!
//! # Design rationale
//!
//! - **The check and the use are one step.** A file is created with `O_EXCL` or locked before it is
//!   truncated, and a trusted file is checked by the descriptor it is read from, so that nothing
//!   can be exchanged in between.
//! - **No clock and no thread.** All functions return when the system has done the work.
//!
//! # Example
//!
//! ```
//! use std::io::Write;
//!
//! use monas_files::{ExclusiveFile, ExistingFile};
//!
//! # let folder = tempfile::tempdir()?;
//! let role = folder.path().join("goalie.srm");
//! monas_files::write(&role, b"Role: goalie\n")?;
//!
//! let tape = folder.path().join("goalie.mcap");
//! let first = ExclusiveFile::create(&tape, ExistingFile::Keep)?;
//! let second = ExclusiveFile::create(&tape, ExistingFile::Keep)?;
//! assert_eq!(first.path(), tape);
//! assert_eq!(second.path(), folder.path().join("goalie-2.mcap"));
//! # Ok::<(), std::io::Error>(())
//! ```

mod atomic_file;
mod exclusive_file;
mod ownership;

pub use atomic_file::{AtomicFile, write, write_new};
pub use exclusive_file::{ExclusiveFile, ExistingFile, numbered};
pub use ownership::{check_private, open_trusted, private_folder};
