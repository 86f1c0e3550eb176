//! Compiles the records of the runtime.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/monas.proto"], &["proto"])
}
