//! Compiles the records of the runtime, and exports the build fingerprint of this crate.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    narukom_build::compile(&["proto/monas.proto", "proto/foxglove.proto"], &["proto"])?;
    let facts = [
        ("COMPILER", compiler()?),
        ("TARGET", variable("TARGET")),
        ("PROFILE", profile()),
        ("FLAGS", variable("CARGO_ENCODED_RUSTFLAGS").replace('\x1f', " ")),
        ("FEATURES", features()),
        ("LOCK", lock()?),
    ];
    for (name, fact) in facts {
        println!("cargo:rustc-env=MONAS_BUILD_{name}={}", fact.replace('\n', " ").trim());
    }
    println!("cargo:rerun-if-changed=build.rs");
    Ok(())
}

fn variable(name: &str) -> String {
    env::var(name).unwrap_or_default()
}

/// The version output of the compiler.
fn compiler() -> Result<String, std::io::Error> {
    let said = Command::new(variable("RUSTC")).arg("-V").output()?;
    Ok(String::from_utf8_lossy(&said.stdout).into_owned())
}

/// The profile's folder, with the settings that affect type layout and calling conventions.
fn profile() -> String {
    let out = PathBuf::from(variable("OUT_DIR"));
    // target/debug/build/monas-0123456789abcdef/out
    let folder = out.ancestors().nth(3).and_then(Path::file_name).unwrap_or_default().to_string_lossy();
    let (level, debug, panic) = (variable("OPT_LEVEL"), variable("DEBUG"), variable("CARGO_CFG_PANIC"));
    format!("{folder}, opt-level {level}, debug {debug}, panic {panic}")
}

/// The enabled features of this crate.
fn features() -> String {
    let names = env::vars().filter_map(|(name, _)| Some(name.strip_prefix("CARGO_FEATURE_")?.to_lowercase()));
    let mut names: Vec<String> = names.filter(|name| name != "default").collect();
    names.sort_unstable();
    names.join(" ")
}

/// The FNV-1a hash (64 bits) of the external crates in the lock file of the build: that of the
/// workspace of the target folder, otherwise that of this crate's workspace. Adding or removing a
/// workspace crate does not change it.
fn lock() -> Result<String, Box<dyn std::error::Error>> {
    let (out, own) = (PathBuf::from(variable("OUT_DIR")), PathBuf::from(variable("CARGO_MANIFEST_DIR")));
    let beside = |folder: &Path| Some(folder.join("Cargo.lock")).filter(|lock| lock.is_file());
    let Some(file) = out.ancestors().chain(own.ancestors()).find_map(beside) else {
        return Ok("none".into());
    };
    println!("cargo:rerun-if-changed={}", file.display());
    let text = std::fs::read_to_string(file)?;
    let crates = text.split("[[package]]").filter(|entry| entry.contains("\nsource = "));
    let hash = crates.flat_map(str::bytes).fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    Ok(format!("{hash:016x}"))
}
