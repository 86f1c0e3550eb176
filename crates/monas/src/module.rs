//! Modules: shared objects with activities, which are loaded into a program that runs.
//!
//! A module is a crate of the crate type `cdylib` with activities like any other, and one line more:
//!
//! ```
//! use monas::Blackboard;
//!
//! fn look(blackboard: &mut Blackboard) {
//!     tracing::info!("looking at {}", blackboard.now());
//! }
//! monas::activity!(fn look as "Look");
//! monas::module!();
//! # fn main() {}
//! ```
//!
//! [`Module::load`] loads it, and a [`Registry`](crate::Registry) [with it](crate::Registry::with_module) knows its activities. In a
//! configuration `<module>libeyes.so</module>` does so; in a run, `monas module load libeyes.so`.
//!
//! # Whether it fits
//!
//! Rust says nothing of how its types lie in memory, so a module fits only the program that was built with the same compiler from the
//! same crates in the same way. Two looks tell: a [note](BuildNote) in a section of the file is read before any of its code
//! runs; then, before anything else of it is called, the module is asked for numbers that stand for types of Narukom and
//! Monas. Whatever differs is refused by its name. Who builds the program and the module in one call of cargo, as `monas
//! module build` does, has what fits.
//!
//! # What is twice
//!
//! A module has its own copy of all crates that it uses, and so of what is static in them: it has a registry of its own, which it hands
//! over, and it knows nothing of the host's. Topics and functions are those of the program. Its log lines go to the log of the host.
//! Whatever panics in it is caught in it, and told as what any activity does that panics.
//!
//! # It stays
//!
//! A module is never unloaded: messages, errors and names of it may be anywhere. A file that is loaded again is another copy in
//! memory, so a program that reloads all day grows by the size of the module each time.

mod file;
pub(crate) mod forward;
pub(crate) mod gate;
mod guarded;
mod load;
#[expect(clippy::module_inception, reason = "it is what the file is about")]
mod module;
mod note;

pub use file::ModuleFile;
pub use module::Module;
pub use note::BuildNote;

#[doc(hidden)]
pub use gate::{Gate, open};
#[doc(hidden)]
pub use note::{NoteSection, padded_length};

/// Makes a crate of the type `cdylib` a module: what it has registered by [`activity!`](crate::activity!) can be loaded while a program runs.
///
/// It is written once, in the crate's root. The module is called like the crate, or as it says; activities of other crates that the module
/// links are handed over if these are named:
///
/// ```
/// # mod one { monas::module!(); }
/// # mod two {
/// monas::module!(name = eagle_eyes);
/// # }
/// # mod three {
/// monas::module!(name = all_eyes, with = [left_eye, right_eye]);
/// # }
/// # fn main() {}
/// ```
///
/// Linked into a program like any other crate (`use eyes as _;`), it is one: the line does nothing then.
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
            static GATE: $crate::linked::Gate = $crate::linked::Gate::new(open);
        };
    };
}
