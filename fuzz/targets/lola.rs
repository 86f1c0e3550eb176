//! The target `lola`: see its module in `parser-tests`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| parser_tests::lola(data));
