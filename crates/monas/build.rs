//! Compiles the records of the runtime, and the messages of its tests.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/monas.proto", "tests/proto/test.proto"], &["proto", "tests/proto"])
}
