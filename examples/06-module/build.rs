//! Strips debug information from the modules: it is most of the file, which is copied on every
//! load.

fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo:rustc-link-arg=-Wl,--strip-debug");
    }
    println!("cargo:rerun-if-changed=build.rs");
}
