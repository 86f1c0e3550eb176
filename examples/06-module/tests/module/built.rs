//! The files of the modules, which cargo has built with this test.

use std::path::{Path, PathBuf};

/// The module as it is.
pub(crate) fn eyes() -> PathBuf {
    folder().join("deps/libeyes.so")
}

/// The module after a change.
pub(crate) fn sharp_eyes() -> PathBuf {
    folder().join("examples/libsharp_eyes.so")
}

/// The module after one that was none for the better.
pub(crate) fn blind_eyes() -> PathBuf {
    folder().join("examples/libblind_eyes.so")
}

/// Where cargo puts what it builds.
fn folder() -> PathBuf {
    let program = Path::new(env!("CARGO_BIN_EXE_robot"));
    program.parent().expect("a program lies in a folder").to_path_buf()
}
