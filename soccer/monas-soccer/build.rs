//! Compiles the messages of the soccer player.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/soccer.proto"], &["proto"])
}
