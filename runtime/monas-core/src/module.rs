//! Modules: shared objects with activities, loaded into a running program.
//!
//! A module is a crate of the crate type `cdylib` with activities like any other, and one
//! additional line:
//!
//! ```
//! use monas_core::Blackboard;
//!
//! fn look(blackboard: &mut Blackboard) {
//!     tracing::info!("looking at {}", blackboard.now());
//! }
//! monas_core::activity!(fn look as "Look");
//! monas_core::module!();
//! # fn main() {}
//! ```
//!
//! `ModuleFile::load` of the crate `monas-module` loads it;
//! [`Registry::with_module`](crate::Registry::with_module) adds its activities. The element
//! `<module>libeyes.so</module>` of a configuration and the command `monas module load libeyes.so`
//! in a run do the same.
//!
//! # Compatibility
//!
//! Rust does not specify the layout of types, so a module is compatible only with a program built
//! by the same compiler from the same crates with the same options. This is checked twice: a
//! [note](BuildFingerprint) in a section of the file is read before any code of the module runs;
//! then, before anything else is called, the module returns fingerprints of types of Narukom and
//! Monas. Each difference is reported by name. Building the program and the module in one call of
//! cargo, as `monas module build` does, ensures compatibility.
//!
//! # Duplicated state
//!
//! A module has its own copy of all crates it uses, and so of their statics: it has its own
//! registry, whose contents it exports, and no access to the host's. Topics and functions are those
//! of the program. Its log lines go to the log of the host. A panic in the module is caught in it
//! and reported like that of any activity.
//!
//! # Lifetime
//!
//! A module is never unloaded: its messages, errors and names may be referenced anywhere. A file
//! loaded again is another copy in memory, so each reload increases the program's memory by the
//! size of the module.

pub mod log_bridge;
#[expect(clippy::module_inception, reason = "it is what the file is about")]
mod module;
pub mod module_abi;
pub mod note;
mod panic_boundary;

pub use module::Module;
pub use note::BuildFingerprint;

#[doc(hidden)]
pub use module_abi::{ModuleAbi, open};
#[doc(hidden)]
pub use note::{NoteSection, padded_length};

/// Makes a crate of the type `cdylib` a module: the activities it registers with
/// [`activity!`](crate::activity!) can be loaded while a program runs.
///
/// It is called once, in the crate's root. By default the module has the name of the crate;
/// activities of other linked crates are exported if these are named:
///
/// ```
/// # mod one { monas_core::module!(); }
/// # mod two {
/// monas_core::module!(name = eagle_eyes);
/// # }
/// # mod three {
/// monas_core::module!(name = all_eyes, with = [left_eye, right_eye]);
/// # }
/// # fn main() {}
/// ```
///
/// In a crate linked into a program (`use eyes as _;`) the line has no effect.
#[macro_export]
macro_rules! module {
    () => {
        $crate::module!(@ ::core::env!("CARGO_CRATE_NAME"), []);
    };
    (with = [$($other:ident),* $(,)?]) => {
        $crate::module!(@ ::core::env!("CARGO_CRATE_NAME"), [$($other),*]);
    };
    (name = $name:ident $(, with = [$($other:ident),* $(,)?])?) => {
        $crate::module!(@ ::core::stringify!($name), [$($($other),*)?]);
    };
    (@ $name:expr, [$($other:ident),*]) => {
        #[allow(unsafe_code)] // what a host finds by its name, and what it reads before it loads anything
        const _: () = {
            const OWN: &str = ::core::concat!(
                "module ", $name, "\npackage ",
                ::core::env!("CARGO_PKG_NAME"), " ", ::core::env!("CARGO_PKG_VERSION"), "\n"
            );

            #[used]
            #[unsafe(link_section = ".note.monas")]
            static NOTE: $crate::linked::NoteSection<{ $crate::linked::padded_length(OWN) }> =
                $crate::linked::NoteSection::new(OWN);

            extern "C" fn open(log: *const ::core::ffi::c_void, handed: *mut ::core::ffi::c_void) {
                let crates = [::core::env!("CARGO_CRATE_NAME"), $(::core::stringify!($other)),*];
                unsafe { $crate::linked::open(log, handed, &crates) };
            }

            #[unsafe(export_name = ::core::concat!("monas_module_", $name))]
            static GATE: $crate::linked::ModuleAbi = $crate::linked::ModuleAbi::new(open);
        };
    };
}
