//! Loads modules, shared objects with activities, into a running program.
//!
//! [`ModuleFile::read`] reads a file and its build fingerprint without running code of it;
//! [`ModuleFile::load`] compares the fingerprint with that of the program, loads a copy of the
//! file, compares types, and returns the [`Module`](monas_core::Module) for a
//! [`Registry`](monas_core::Registry). The part that is compiled into modules is
//! [`monas_core::module`](mod@monas_core::module), which also describes compatibility, state and
//! lifetime.
//!
//! ```no_run
//! use monas_core::Registry;
//! use monas_module::ModuleFile;
//!
//! let module = ModuleFile::read("libeyes.so").and_then(|file| file.load());
//! match module {
//!     Ok(module) => drop(Registry::linked().with_module(module)),
//!     Err(diagnostics) => diagnostics.iter().for_each(|diagnostic| eprintln!("{diagnostic}")),
//! }
//! ```

mod load;
mod module_file;

pub use module_file::{ModuleFile, read_fingerprint};
