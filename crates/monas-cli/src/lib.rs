//! The command monas, as a library and a five-line binary
