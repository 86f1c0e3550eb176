//! Compiles the messages for viewers that speak Foxglove's protocol.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/image.proto", "proto/scene.proto", "proto/state.proto"], &["proto"])
}
