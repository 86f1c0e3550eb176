//! Compiles the messages that only the season uses.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/season.proto"], &["proto"])
}
