//! Compiles what links say to each other, what control sockets say, and the messages of the examples.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/link.proto", "proto/control.proto", "proto/example.proto"], &["proto"])
}
