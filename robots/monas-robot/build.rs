//! Compiles the body's messages.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/body.proto"], &["proto"])
}
