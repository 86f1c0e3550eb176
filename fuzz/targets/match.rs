//! The target `match`: see its module in `parser-tests`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| parser_tests::match_file(data));
