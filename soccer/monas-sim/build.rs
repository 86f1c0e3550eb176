//! Compiles the messages about the simulated field.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/sim.proto"], &["proto"])
}
