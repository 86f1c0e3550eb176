//! Compiles the messages of a heated room.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/heating.proto"], &["proto"])
}
