//! Loads a module into the host. The file has been checked before; the code is checked here.

use std::ffi::c_void;

use narukom::{Hub, TOPICS, TopicDeclaration};
use yase::Diagnostic;

use crate::module_file::{BUILD_HINT, ModuleFile};
use monas_core::module::Module;
use monas_core::module::log_bridge::{self, HostLog};
use monas_core::module::module_abi::{self, ModuleAbi, ModuleContents, ModuleExports};

type LoadError = Vec<Diagnostic>;

impl ModuleFile {
    /// Loads the module. Its code stays in this process until it ends: loading the file again,
    /// changed or not, makes another copy.
    ///
    /// # Errors
    /// Diagnostics: it was built differently (`E0361`), the system cannot load it (`E0362`), its
    /// types differ from those of this program (`E0363`), or its contents conflict (`E0364`).
    pub fn load(&self) -> Result<Module, Vec<Diagnostic>> {
        self.check()?;
        let name = self.note().module();
        let gate = enter(&self.bytes, name)?;
        check_compatibility(gate, name)?;
        let ModuleContents { activities, topics } = open(gate, name)?;
        check_topics(&topics, name)?;
        if activities.is_empty() {
            let message = format!("module `{name}` has no activity");
            let hint = "register one by `monas::activity!(Name)`";
            return Err(vec![Diagnostic::error("E0364", 0..0, message).with_hint(hint)]);
        }
        Ok(Module::new(&self.path, self.digest(), self.note().clone(), activities))
    }
}

/// Loads a copy of the bytes, so that the mapped file cannot be modified, and returns its exported
/// `ModuleAbi`.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "code that is loaded runs; that it fits has been checked as far as it can be")]
fn enter(bytes: &[u8], name: &str) -> Result<&'static ModuleAbi, LoadError> {
    use std::io::Write;

    let refused = |reason: String| {
        let message = format!("module `{name}` cannot be loaded: {reason}");
        let hint = "its copy is in the folder for temporary files (TMPDIR), which must permit execution";
        vec![Diagnostic::error("E0362", 0..0, message).with_hint(hint)]
    };
    let copy = tempfile::Builder::new().prefix(&format!("{name}-")).suffix(".so").tempfile();
    let mut copy = copy.map_err(|error| refused(error.to_string()))?;
    copy.write_all(bytes).and_then(|()| copy.flush()).map_err(|error| refused(error.to_string()))?;
    // SAFETY: the module was built by the same compiler for the same target, and has no
    // initializers with side effects.
    let library = unsafe { libloading::Library::new(copy.path()) };
    let library = library.map_err(|error| refused(error.to_string()))?;
    // Removes the file; its mapping stays.
    drop(copy);
    let symbol = format!("monas_module_{name}\0");
    // SAFETY: every file with a note of Monas exports a `ModuleAbi` under this name.
    let gate = unsafe { library.get::<*const ModuleAbi>(symbol.as_bytes()) };
    let gate = gate.map(|symbol| *symbol).map_err(|error| refused(error.to_string()))?;
    // Its activities, messages and names may be referenced anywhere, so it is never unloaded.
    std::mem::forget(library);
    // SAFETY: the pointer refers to the mapping, which is never removed. The version is the first
    // field and is checked before the others are used.
    unsafe { gate.as_ref() }.ok_or_else(|| refused("it has no module interface".into()))
}

#[cfg(not(target_os = "linux"))]
fn enter(_: &[u8], name: &str) -> Result<&'static ModuleAbi, LoadError> {
    let message = format!("module `{name}` cannot be loaded: modules need Linux");
    let hint = "link its crate into the program: `use its_name as _;`";
    Err(vec![Diagnostic::error("E0362", 0..0, message).with_hint(hint)])
}

/// Checks, before anything else is called, that the types of the module are those of this program.
fn check_compatibility(gate: &ModuleAbi, name: &str) -> Result<(), LoadError> {
    let error = |message: String| Diagnostic::error("E0363", 0..0, message).with_hint(BUILD_HINT);
    if gate.version != module_abi::VERSION {
        let (found, expected) = (gate.version, module_abi::VERSION);
        return Err(vec![error(format!(
            "module `{name}` has interface version {found}, this program {expected}"
        ))]);
    }
    let own = module_abi::fingerprints();
    let mut found = vec![0; own.len()];
    let count = (gate.fingerprints)(found.as_mut_ptr(), found.len());
    if count != own.len() {
        return Err(vec![error(format!("module `{name}` has {count} types, this program {}", own.len()))]);
    }
    let differing: Vec<Diagnostic> = own
        .iter()
        .zip(found)
        .filter(|((_, number), found)| number != found)
        .map(|((marker, _), _)| {
            error(format!("module `{name}` was built with another `{marker}` than this program"))
        })
        .collect();
    if differing.is_empty() { Ok(()) } else { Err(differing) }
}

/// Connects the module to the log and takes its contents.
fn open(gate: &ModuleAbi, name: &str) -> Result<ModuleContents, LoadError> {
    let log: HostLog = log_bridge::host_log();
    let mut handed: ModuleExports = None;
    (gate.open)((&raw const log).cast::<c_void>(), (&raw mut handed).cast::<c_void>());
    let reason = match handed {
        Some(Ok(contents)) => return Ok(contents),
        Some(Err(reason)) => reason,
        None => "it exports nothing".into(),
    };
    Err(vec![Diagnostic::error("E0364", 0..0, format!("module `{name}` cannot be opened: {reason}"))])
}

/// Checks that this program has the topics used by the module's code, with the same message types.
fn check_topics(topics: &[TopicDeclaration], name: &str) -> Result<(), LoadError> {
    let known = |topic: &&TopicDeclaration| !TOPICS.iter().any(|known| known.path() == topic.path());
    let unknown = topics.iter().filter(known).map(|topic| {
        let message = format!("module `{name}` has the topic `{}`, which this program lacks", topic.path());
        let hint = "link the crate that declares the topic into the program";
        Diagnostic::error("E0364", 0..0, message).with_hint(hint)
    });
    let unknown: LoadError = unknown.collect();
    if !unknown.is_empty() {
        return Err(unknown);
    }
    match Hub::new("module", TOPICS.iter().chain(topics)) {
        Ok(_) => Ok(()),
        Err(error) => {
            let message = format!("module `{name}` does not fit this program: {error}");
            Err(vec![Diagnostic::error("E0364", 0..0, message).with_hint(BUILD_HINT)])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(_: &mut narukom::Blackboard) {}
    monas_core::activity!(fn look as "ModuleTestLook");

    extern "C" fn other_types(room: *mut u64, length: usize) -> usize {
        let own = module_abi::fingerprints();
        if length == own.len() {
            for (index, (_, number)) in own.into_iter().enumerate() {
                #[allow(unsafe_code, reason = "the test is the host, which has this room")]
                // SAFETY: the buffer has room for the given number of values.
                unsafe {
                    room.add(index).write(if index == 1 { number ^ 1 } else { number });
                }
            }
        }
        own.len()
    }
    extern "C" fn few_types(_: *mut u64, _: usize) -> usize {
        2
    }
    extern "C" fn opens(_: *const c_void, handed: *mut c_void) {
        #[allow(unsafe_code, reason = "both sides are here")]
        // SAFETY: `check_compatibility` has verified that the types on both sides are equal.
        unsafe {
            module_abi::export_contents(handed, &["monas_module"]);
        }
    }
    extern "C" fn silent(_: *const c_void, _: *mut c_void) {}

    fn codes(result: Result<impl Sized, LoadError>) -> Vec<String> {
        result.err().unwrap_or_default().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn another_type_is_refused_by_its_name() {
        let gate = ModuleAbi { fingerprints: other_types, ..ModuleAbi::new(silent) };
        let expected = "error[E0363]: module `eyes` was built with another `narukom::Timestamp` than this program \
                        (build it like this program by `monas module build`)";
        assert_eq!(codes(check_compatibility(&gate, "eyes")), [expected]);
        assert_eq!(codes(check_compatibility(&ModuleAbi::new(silent), "eyes")), [""; 0]);
    }

    #[test]
    fn another_way_to_talk_is_refused_before_anything_is_called() {
        let gate = ModuleAbi { version: 9, fingerprints: few_types, ..ModuleAbi::new(silent) };
        assert!(codes(check_compatibility(&gate, "eyes"))[0].contains("interface version 9, this program 1"));
        let gate = ModuleAbi { fingerprints: few_types, ..ModuleAbi::new(silent) };
        assert!(codes(check_compatibility(&gate, "eyes"))[0].contains("has 2 types, this program 8"));
    }

    #[test]
    fn a_module_that_hands_nothing_over_is_refused() {
        assert!(codes(open(&ModuleAbi::new(silent), "eyes"))[0].contains("it exports nothing"));
        assert!(open(&ModuleAbi::new(opens), "eyes").is_ok_and(|contents| !contents.activities.is_empty()));
    }

    #[test]
    fn topics_have_to_be_those_of_the_program() {
        use narukom::State;
        let topic = TopicDeclaration::new::<State<monas_core::records::Change>>;
        let unknown = codes(check_topics(&[topic("eyes/seen", "eyes")], "eyes"));
        assert!(unknown[0].contains("the topic `eyes/seen`, which this program lacks"), "{unknown:?}");
        let other = codes(check_topics(&[topic("monas/host", "eyes")], "eyes"));
        assert!(other[0].contains("declared with two message types"), "{other:?}");
        assert_eq!(codes(check_topics(&TOPICS, "eyes")), [""; 0]);
    }

    #[test]
    fn settings_rejected_by_the_system_have_a_reason() {
        let refused = codes(enter(b"no library", "eyes").map(|_| ()));
        assert!(refused[0].starts_with("error[E0362]: module `eyes` cannot be loaded: "), "{refused:?}");
    }
}
