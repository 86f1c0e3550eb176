//! Interface between a module and its host: one side is compiled into the module, the other into
//! the program.
//!
//! Both contain a copy of this crate. Until the copies are known to be equal, only C types cross:
//! [`ModuleAbi`] and the numbers returned by [`fingerprints`]. After that the types are equal on
//! both sides, and Rust types cross.

use std::any::TypeId;
use std::ffi::c_void;

use narukom::TopicDeclaration;

use super::log_bridge::{self, HostLog};
use super::panic_boundary::PanicBoundary;
use crate::activity::Activity;
use crate::call;
use crate::registry::{ACTIVITIES, ActivityDeclaration, package};

/// Version of this interface.
pub const VERSION: u32 = 1;

/// Exported by a module under the name `monas_module_` and its name.
#[doc(hidden)]
#[repr(C)]
pub struct ModuleAbi {
    /// [`VERSION`], in every version of this interface.
    pub version: u32,
    /// Writes [`fingerprints`] to a buffer with room for the given number of values and returns
    /// their number.
    pub fingerprints: extern "C" fn(*mut u64, usize) -> usize,
    /// Takes a [`HostLog`] and writes [`ModuleExports`], by pointers to these.
    pub open: extern "C" fn(*const c_void, *mut c_void),
}

impl ModuleAbi {
    /// The interface of a module, with the `open` function that selects the crates whose activities
    /// it exports.
    pub const fn new(open: extern "C" fn(*const c_void, *mut c_void)) -> ModuleAbi {
        ModuleAbi { version: VERSION, fingerprints: write_fingerprints, open }
    }
}

/// The contents of a module, or why it has none; `None` before the call.
pub type ModuleExports = Option<Result<ModuleContents, String>>;

/// The contents of a module.
pub struct ModuleContents {
    /// Its activities, without those registered by other crates.
    pub activities: Vec<ModuleActivity>,
    /// The topics used by its code, with the types of their messages.
    pub topics: Vec<TopicDeclaration>,
}

/// An activity of a module.
#[derive(Clone, Copy)]
pub struct ModuleActivity {
    /// The name under which it is registered.
    pub name: &'static str,
    /// The Rust module it was registered in.
    pub module: &'static str,
    declaration: ActivityDeclaration,
    make: fn(&ActivityDeclaration) -> ActivityResult,
}

type ActivityResult = Result<Box<dyn Activity>, String>;

impl ModuleActivity {
    /// Constructs an instance; a panic is caught in the module.
    pub(crate) fn make(&self) -> ActivityResult {
        (self.make)(&self.declaration)
    }
}

/// Types whose equality implies that both sides have the same crates, compiled equally.
fn markers() -> [(&'static str, TypeId); 8] {
    [
        ("narukom::Blackboard", TypeId::of::<narukom::Blackboard>()),
        ("narukom::Timestamp", TypeId::of::<narukom::Timestamp>()),
        ("narukom::Narukom", TypeId::of::<narukom::Hub>()),
        ("narukom::TopicDeclaration", TypeId::of::<TopicDeclaration>()),
        ("monas::Activity", TypeId::of::<dyn Activity>()),
        ("monas::Parameters", TypeId::of::<crate::Parameters>()),
        ("monas::records::Change", TypeId::of::<crate::records::Change>()),
        ("monas::BoxError", TypeId::of::<crate::BoxError>()),
    ]
}

/// A number for each marker type; numbers are equal if the types are.
pub fn fingerprints() -> [(&'static str, u64); 8] {
    // The printed form is the only access to the value of a `TypeId`.
    markers().map(|(name, id)| (name, fnv(format!("{id:?}").as_bytes())))
}

/// FNV-1a, 64 bits.
fn fnv(bytes: &[u8]) -> u64 {
    let mix = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, mix)
}

#[expect(unsafe_code, reason = "the host says where it wants the numbers")]
extern "C" fn write_fingerprints(room: *mut u64, length: usize) -> usize {
    let known = fingerprints();
    if !room.is_null() {
        for (index, (_, number)) in known.iter().take(length).enumerate() {
            // SAFETY: the host guarantees room for `length` numbers, and `index < length`.
            unsafe { room.add(index).write(*number) };
        }
    }
    known.len()
}

/// Called by a module's `open`, in the module.
///
/// # Safety
/// The pointers refer to a [`HostLog`] and to [`ModuleExports`] of the same types as here.
#[doc(hidden)]
#[expect(unsafe_code, reason = "the way to the log is named by a pointer")]
pub unsafe fn open(log: *const c_void, handed: *mut c_void, crates: &[&str]) {
    // SAFETY: the caller guarantees that `log` points to a valid `HostLog` of this type.
    let log = unsafe { &*log.cast::<HostLog>() };
    if call::caught(|| log_bridge::install(*log)).is_ok() {
        // SAFETY: the caller guarantees that `handed` points to a valid `ModuleExports` of this
        // type.
        unsafe { export_contents(handed, crates) };
    }
}

/// Exports the contents of the module.
///
/// # Safety
/// The pointer refers to [`ModuleExports`] of the same type as here.
#[expect(unsafe_code, reason = "what is handed over is named by a pointer")]
pub unsafe fn export_contents(handed: *mut c_void, crates: &[&str]) {
    let contents = call::caught(|| contents(crates)).map_err(|failure| failure.to_string());
    // SAFETY: the caller guarantees that `handed` points to a valid `ModuleExports` of this type.
    unsafe { *handed.cast::<ModuleExports>() = Some(contents) };
}

/// The registrations of these crates of the module.
pub(crate) fn contents(crates: &[&str]) -> ModuleContents {
    let own = ACTIVITIES.iter().filter(|declaration| crates.contains(&package(declaration.module)));
    let mut activities: Vec<ModuleActivity> = own
        .map(|declaration| ModuleActivity {
            name: declaration.name,
            module: declaration.module,
            declaration: *declaration,
            make: PanicBoundary::made,
        })
        .collect();
    // The linker's order is unspecified.
    activities.sort_by_key(|activity| (activity.name, activity.module));
    ModuleContents { activities, topics: narukom::TOPICS.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_numbers_are_written_than_there_is_room_for() {
        let known = fingerprints();
        let mut room = [7; 10];
        assert_eq!(write_fingerprints(room.as_mut_ptr(), 3), known.len());
        assert_eq!(room[..4], [known[0].1, known[1].1, known[2].1, 7]);
        assert_eq!(write_fingerprints(room.as_mut_ptr(), room.len()), known.len());
        assert_eq!(room[known.len()..], [7, 7]);
        assert_eq!(write_fingerprints(std::ptr::null_mut(), 0), known.len());
    }

    #[test]
    fn types_have_different_numbers() {
        let mut numbers = fingerprints().map(|(_, number)| number).to_vec();
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers.len(), fingerprints().len());
    }

    #[test]
    fn only_activities_of_the_named_crates_are_handed_over() {
        assert!(contents(&["unknown"]).activities.is_empty());
        let own = contents(&["monas_core"]);
        assert!(own.activities.iter().any(|activity| activity.name == "RegistryTestStand"));
        assert!(own.topics.iter().any(|topic| topic.path() == "monas/change"));
    }
}
