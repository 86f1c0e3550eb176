//! For build scripts: .proto files to messages with descriptors and field access by name.
