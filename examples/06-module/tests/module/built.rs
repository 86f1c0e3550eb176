//! The files of the modules that cargo builds with this test.

use std::path::{Path, PathBuf};

/// The original module.
pub(crate) fn eyes() -> PathBuf {
    folder().join("deps/libeyes.so")
}

/// The module after a valid change.
pub(crate) fn sharp_eyes() -> PathBuf {
    folder().join("examples/libsharp_eyes.so")
}

/// The module after a faulty change.
pub(crate) fn blind_eyes() -> PathBuf {
    folder().join("examples/libblind_eyes.so")
}

/// The folder of cargo's build results.
fn folder() -> PathBuf {
    let program = Path::new(env!("CARGO_BIN_EXE_robot"));
    program.parent().expect("a program lies in a folder").to_path_buf()
}
