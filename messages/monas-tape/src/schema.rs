//! Validation of foreign schemas.

use prost_reflect::DescriptorPool;
use prost_reflect::prost::Message;
use prost_reflect::prost_types::FileDescriptorSet;

/// The types described by an encoded `FileDescriptorSet` from an untrusted source.
///
/// Only `proto2` and `proto3` are supported: `prost_reflect` rejects other syntaxes, such as
/// protobuf editions, in a way that may panic, so the syntax is checked first.
///
/// # Errors
/// The reason why it cannot be used.
pub fn descriptor_pool(bytes: &[u8]) -> Result<DescriptorPool, String> {
    let files = FileDescriptorSet::decode(bytes).map_err(|error| error.to_string())?;
    for file in &files.file {
        if let Some(other) = file.syntax.as_deref().filter(|syntax| !matches!(*syntax, "proto2" | "proto3")) {
            return Err(format!("`{}` is written in `{other}`, not in proto2 or proto3", file.name()));
        }
    }
    DescriptorPool::decode(bytes).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use prost_reflect::prost_types::FileDescriptorProto;

    use super::*;

    fn pool(syntax: Option<&str>) -> Result<DescriptorPool, String> {
        let file = FileDescriptorProto {
            name: Some("a.proto".into()),
            syntax: syntax.map(str::to_owned),
            ..FileDescriptorProto::default()
        };
        descriptor_pool(&FileDescriptorSet { file: vec![file] }.encode_to_vec())
    }

    #[test]
    fn schemas_in_another_syntax_are_refused() {
        assert!(pool(None).is_ok() && pool(Some("")).is_err() && pool(Some("proto3")).is_ok());
        let refused = pool(Some("editions")).expect_err("it is refused");
        assert_eq!(refused, "`a.proto` is written in `editions`, not in proto2 or proto3");
    }

    #[test]
    fn an_invalid_schema_is_rejected() {
        assert!(descriptor_pool(&[0xff; 5]).is_err());
    }
}
