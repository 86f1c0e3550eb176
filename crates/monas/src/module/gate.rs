//! What a module and its host say to each other: the module's side is compiled into the module, the host's into the program.
//!
//! Both hold a copy of this crate. While it is not certain that the copies are equal, nothing crosses but what C knows: the [`Gate`], and
//! the numbers that [`fingerprints`] gives. After that types are the same on both sides, and what crosses is Rust.

use std::any::TypeId;
use std::ffi::c_void;

use narukom::TopicDeclaration;

use super::forward::{self, HostLog};
use super::guarded::Guarded;
use crate::activity::Activity;
use crate::call;
use crate::registry::{ACTIVITIES, ActivityDeclaration, package};

/// The number of this way to talk.
pub(super) const VERSION: u32 = 1;

/// What a module exports, under the name `monas_module_` and its own.
#[doc(hidden)]
#[repr(C)]
pub struct Gate {
    /// [`VERSION`], whatever follows.
    pub(super) version: u32,
    /// Writes [`fingerprints`] to where there is room for so many numbers, and gives how many it has.
    pub(super) fingerprints: extern "C" fn(*mut u64, usize) -> usize,
    /// Takes a [`HostLog`] and hands over [`Handed`], by pointers to these.
    pub(super) open: extern "C" fn(*const c_void, *mut c_void),
}

impl Gate {
    /// The gate of a module, whose own `open` says which crates' activities it has.
    pub const fn new(open: extern "C" fn(*const c_void, *mut c_void)) -> Gate {
        Gate { version: VERSION, fingerprints: write_fingerprints, open }
    }
}

/// What a module hands over, or why it does not.
pub(super) type Handed = Option<Result<Contents, String>>;

/// What is in a module.
pub(super) struct Contents {
    /// Its activities; those that other crates in it have registered are none of its own.
    pub(super) activities: Vec<ModuleActivity>,
    /// The topics that its code knows, with the types of their messages.
    pub(super) topics: Vec<TopicDeclaration>,
}

/// An activity of a module.
#[derive(Clone, Copy)]
pub(crate) struct ModuleActivity {
    pub(crate) name: &'static str,
    /// The module of Rust it was registered in.
    pub(crate) module: &'static str,
    declaration: ActivityDeclaration,
    make: fn(&ActivityDeclaration) -> Made,
}

type Made = Result<Box<dyn Activity>, String>;

impl ModuleActivity {
    /// A new instance; that it panics is caught where it does.
    pub(crate) fn make(&self) -> Made {
        (self.make)(&self.declaration)
    }
}

/// The types whose equality says that both sides have the same crates, made in the same way.
fn markers() -> [(&'static str, TypeId); 8] {
    [
        ("narukom::Blackboard", TypeId::of::<narukom::Blackboard>()),
        ("narukom::Moment", TypeId::of::<narukom::Moment>()),
        ("narukom::Narukom", TypeId::of::<narukom::Narukom>()),
        ("narukom::TopicDeclaration", TypeId::of::<TopicDeclaration>()),
        ("monas::Activity", TypeId::of::<dyn Activity>()),
        ("monas::Parameters", TypeId::of::<crate::Parameters>()),
        ("monas::records::Change", TypeId::of::<crate::records::Change>()),
        ("monas::BoxError", TypeId::of::<crate::BoxError>()),
    ]
}

/// A number for each marker type; two are equal if the types are.
pub(super) fn fingerprints() -> [(&'static str, u64); 8] {
    // What a type's number looks like when it is printed is all that can be had of it.
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
            // SAFETY: the host has room for `length` numbers there, and `index` is less.
            unsafe { room.add(index).write(*number) };
        }
    }
    known.len()
}

/// What a module's own `open` calls, in the module.
///
/// # Safety
/// The pointers are to a [`HostLog`] and to a [`Handed`] of the same types as here.
#[doc(hidden)]
#[expect(unsafe_code, reason = "the way to the log is named by a pointer")]
pub unsafe fn open(log: *const c_void, handed: *mut c_void, crates: &[&str]) {
    // SAFETY: see above.
    let log = unsafe { &*log.cast::<HostLog>() };
    if call::caught(|| forward::install(*log)).is_ok() {
        // SAFETY: see above.
        unsafe { hand_over(handed, crates) };
    }
}

/// Hands over what is in the module.
///
/// # Safety
/// The pointer is to a [`Handed`] of the same type as here.
#[expect(unsafe_code, reason = "what is handed over is named by a pointer")]
pub(super) unsafe fn hand_over(handed: *mut c_void, crates: &[&str]) {
    let contents = call::caught(|| contents(crates)).map_err(|failure| failure.to_string());
    // SAFETY: see above.
    unsafe { *handed.cast::<Handed>() = Some(contents) };
}

/// What is registered in these crates of the module.
pub(super) fn contents(crates: &[&str]) -> Contents {
    let own = ACTIVITIES.iter().filter(|declaration| crates.contains(&package(declaration.module)));
    let mut activities: Vec<ModuleActivity> = own
        .map(|declaration| ModuleActivity {
            name: declaration.name,
            module: declaration.module,
            declaration: *declaration,
            make: Guarded::made,
        })
        .collect();
    // The linker's order is nobody's order.
    activities.sort_by_key(|activity| (activity.name, activity.module));
    Contents { activities, topics: narukom::TOPICS.to_vec() }
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
        assert!(contents(&["nobody"]).activities.is_empty());
        let own = contents(&["monas"]);
        assert!(own.activities.iter().any(|activity| activity.name == "RegistryTestStand"));
        assert!(own.topics.iter().any(|topic| topic.path() == "monas/change"));
    }
}
