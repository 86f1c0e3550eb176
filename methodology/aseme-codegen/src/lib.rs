//! Rust crates generated from statecharts.
//!
//! [`generate`] writes a statechart as the files of a Rust crate: each guard and action becomes a
//! Rust function over the messages of the program, and each activity a call that the compiler
//! checks. The engine of `yase` still interprets the chart, so traces and semantics stay the same.
//! [`build`] does this in a build script; `monas generate` does it for crates whose generated code
//! is committed. Only [`build`] reads and writes files.
//!
//! Generated code is committed or regenerated, never edited: names are mapped one to one between
//! paths of states and identifiers ([`generate::identifier`]), so that a compiler error leads back
//! to the model.
//!
//! ```
//! use aseme_codegen::generate::{RustBindings, generate};
//! use yase::Source;
//!
//! let model = Source::new("visitor.srm", "visitor = (look . greet)~");
//! let (chart, findings) = aseme_models::statechart_of(&model);
//! assert_eq!(findings, []);
//! let files = generate(&chart, &RustBindings::default()).expect("the chart can be written as Rust");
//! assert!(files.contains_key("src/lib.rs"));
//! ```

pub mod build;
pub mod generate;
