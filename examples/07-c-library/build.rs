//! Compiles the library with the C compiler of the target.

fn main() {
    #[cfg(feature = "c")]
    {
        cc::Build::new().file("c/median.c").include("c").warnings_into_errors(true).compile("median");
        println!("cargo:rerun-if-changed=c");
    }
}
