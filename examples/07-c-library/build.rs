//! Compiles the library with the C compiler of the computer that it is for.

fn main() {
    #[cfg(feature = "c")]
    {
        cc::Build::new().file("c/median.c").include("c").warnings_into_errors(true).compile("median");
        println!("cargo:rerun-if-changed=c");
    }
}
