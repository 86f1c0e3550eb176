//! Compiles the messages of the vehicle.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/vehicle.proto"], &["proto"])
}
