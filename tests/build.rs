//! Compiles the messages of the season.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/season.proto"], &["proto"])
}
