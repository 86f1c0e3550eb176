//! Leaves out of the modules what only debuggers read: it is most of the file, which is copied whenever it is loaded.

fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo:rustc-link-arg=-Wl,--strip-debug");
    }
    println!("cargo:rerun-if-changed=build.rs");
}
