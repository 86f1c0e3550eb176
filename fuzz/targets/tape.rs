//! The target `tape`: see its module in `parser-tests`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| parser_tests::tape(data));
