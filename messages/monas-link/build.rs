//! Compiles the messages of links, of control sockets, and of the examples.
fn main() -> Result<(), narukom_build::Error> {
    narukom_build::compile(&["proto/link.proto", "proto/control.proto", "proto/example.proto"], &["proto"])
}
