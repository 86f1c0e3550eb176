//! The mapping from paths to identifiers is injective and invertible, and yields valid Rust
//! identifiers.

use aseme_codegen::generate::{identifier, path_of};
use proptest::prelude::*;

fn segment() -> impl Strategy<Value = String> {
    let close = prop_oneof![
        Just('_'),
        Just('|'),
        Just('~'),
        Just('.'),
        Just('('),
        Just('/'),
        Just('['),
        Just('2'),
        Just('u'),
        Just('a'),
        Just('o'),
        Just('f'),
        Just('ω'),
        Just(' '),
        any::<char>(),
    ];
    let keyword =
        prop_oneof![Just("type"), Just("Self"), Just("self"), Just("of"), Just("__of__"), Just("u5f")];
    prop_oneof![
        prop::collection::vec(close, 0..8).prop_map(|characters| characters.into_iter().collect()),
        keyword.prop_map(str::to_owned),
    ]
}

fn path() -> impl Strategy<Value = Vec<String>> {
    prop::collection::vec(segment(), 1..4)
}

fn written(path: &[String]) -> String {
    identifier(&path.iter().map(String::as_str).collect::<Vec<_>>())
}

fn is_identifier(text: &str) -> bool {
    let plain = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    plain && !text.is_empty() && text != "_" && !text.starts_with(|first: char| first.is_ascii_digit())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_path_is_found_again(path in path()) {
        let identifier = written(&path);
        prop_assert!(is_identifier(&identifier), "{}", identifier);
        prop_assert_eq!(path_of(&identifier), Some(path));
    }

    #[test]
    fn two_paths_have_two_names(one in path(), other in path()) {
        prop_assert_eq!(written(&one) == written(&other), one == other);
    }

    #[test]
    fn parsed_models_are_written_equally(text in "[a-z_]{0,4}(__(of|par|or|u61|u7e|empty|x)__){0,2}[a-z_0-9]{0,4}") {
        if let Some(path) = path_of(&text) {
            prop_assert_eq!(written(&path), text);
        }
    }
}
