//! Compiles the messages of the tests.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    narukom_build::compile(&["tests/proto/test.proto"], &["tests/proto"])?;
    Ok(())
}
