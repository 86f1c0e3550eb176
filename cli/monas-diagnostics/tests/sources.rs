//! Each code that the workspace can emit is explained, and each explained code can be emitted.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot be prepared fails")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use monas_diagnostics::{ExplanationPart, FAMILIES, explanations, page};

/// The folders with the crates of the product.
const FOLDERS: [&str; 7] = ["charts", "methodology", "messages", "runtime", "robots", "soccer", "cli"];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && !["tests", "benches", "examples", "target"].contains(&name.as_str()) {
            sources(&path, found);
        } else if name.ends_with(".rs") && name != "tests.rs" {
            found.push(path);
        }
    }
}

/// The code of a literal, if it is one: a letter, then two or four digits.
fn is_code(literal: &str) -> bool {
    let (letter, digits) = literal.split_at_checked(1).unwrap_or_default();
    let count = if letter == "E" { 4 } else { 2 };
    ["E", "M", "S"].contains(&letter)
        && digits.len() == count
        && digits.bytes().all(|digit| digit.is_ascii_digit())
}

/// The codes in the string literals of a file, without comments, unit tests and bounds of ranges.
fn codes(text: &str) -> BTreeSet<String> {
    let product = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = product.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code: String = lines.flat_map(|line| [line, "\n"]).collect();
    let parts: Vec<&str> = code.split('"').collect();
    let literals = parts
        .windows(3)
        .filter(|around| is_code(around[1]) && !around[0].ends_with("..") && !around[2].starts_with(".."));
    literals.map(|around| around[1].to_owned()).collect()
}

fn emitted() -> BTreeMap<String, PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files = Vec::new();
    FOLDERS.iter().for_each(|folder| sources(&root.join(folder), &mut files));
    let mut found = BTreeMap::new();
    for file in files {
        for code in codes(&fs::read_to_string(&file).unwrap()) {
            found.entry(code).or_insert_with(|| file.clone());
        }
    }
    found
}

#[test]
fn codes_are_found_in_product_code_only() {
    let text = "// \"E0001\"\nfn a() { error(\"E0002\"); (\"E0003\"..\"E0009\").contains(\"M01\"); \"E03\" }\n\
                #[cfg(test)]\nmod tests { \"E0004\" }\n";
    assert_eq!(codes(text).into_iter().collect::<Vec<_>>(), ["E0002", "M01"]);
}

#[test]
fn each_code_of_the_sources_is_explained_and_no_other() {
    let (emitted, explained) = (emitted(), explanations());
    assert!(emitted.len() > 300, "{}", emitted.len());
    let known: BTreeSet<&str> = explained.iter().map(|it| it.code).collect();
    let missing: Vec<_> = emitted.iter().filter(|(code, _)| !known.contains(code.as_str())).collect();
    assert!(missing.is_empty(), "write sections in `explanations`: {missing:?}");
    let gone: Vec<&&str> = known.iter().filter(|code| !emitted.contains_key(**code)).collect();
    assert!(gone.is_empty(), "nothing emits: {gone:?}");
}

#[test]
fn explanations_are_sorted_and_complete() {
    let explained = explanations();
    assert!(explained.windows(2).all(|two| two[0].code < two[1].code), "codes are sorted and unique");
    assert_eq!(explained.len(), FAMILIES.iter().map(|family| family.explanations().count()).sum());
    for it in explained {
        let paragraphs: Vec<&str> = it
            .parts
            .iter()
            .filter_map(|part| match part {
                ExplanationPart::Paragraph(text) => Some(*text),
                _ => None,
            })
            .collect();
        let says_how = it.command().is_some() || paragraphs.iter().any(|text| text.starts_with("Arises: "));
        assert!(says_how, "{}: no example and no paragraph `Arises:`", it.code);
        assert!(paragraphs.len() >= 2 && !paragraphs[0].starts_with("Arises: "), "{}: no meaning", it.code);
        assert!(paragraphs.iter().any(|text| text.starts_with("Remedy: ")), "{}: no remedy", it.code);
        let width = |text: &str| text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        assert!(width(it.title) <= 70, "{}: the title is too long for a list", it.code);
        let prose: Vec<String> = paragraphs.iter().map(|&text| text.to_owned()).collect();
        assert!(width(&prose.join("\n")) <= 100, "{}: prose is wider than 100 columns", it.code);
    }
}

#[test]
fn the_page_has_an_index_and_includes_every_section() {
    let page = page();
    assert!(
        page.contains("\n| [E0205](#e0205-an-operator-lacks-a-term) | an operator lacks a term |\n"),
        "{page}"
    );
    assert_eq!(page.matches("\n| [").count(), explanations().len());
    let included = page.lines().filter_map(|line| line.strip_prefix("{{#include ")?.strip_suffix("}}"));
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let texts: Vec<String> = included.map(|file| fs::read_to_string(docs.join(file)).unwrap()).collect();
    assert_eq!(texts.concat().matches("\nRemedy: ").count(), explanations().len());
}
