//! Loading a module, in the host: what is in its file has been checked, what is in its code is asked for here.

use std::ffi::c_void;
use std::path::Path;

use narukom::{Narukom, TOPICS, TopicDeclaration};
use yase::Diagnostic;

use super::file::{HINT, ModuleFile};
use super::forward::{self, HostLog};
use super::gate::{self, Contents, Gate, Handed};
use super::module::Module;

type Refusal = Vec<Diagnostic>;

impl ModuleFile {
    /// Loads the module. Its code stays in this process as long as that lives: who loads the file again, changed or not, gets another copy.
    ///
    /// # Errors
    /// Diagnostics: it was built otherwise (`E0361`), the system does not take it (`E0362`), its types are not those of this program
    /// (`E0363`), or what it brings does not fit (`E0364`).
    pub fn load(&self) -> Result<Module, Vec<Diagnostic>> {
        self.check()?;
        let name = self.note().module();
        let gate = enter(&self.bytes, name)?;
        shake_hands(gate, name)?;
        let Contents { activities, topics } = open(gate, name)?;
        know(&topics, name)?;
        if activities.is_empty() {
            let message = format!("module `{name}` has no activity");
            let hint = "`monas::activity!(Name)` beside a type or function makes it one";
            return Err(vec![Diagnostic::error("E0364", 0..0, message).with_hint(hint)]);
        }
        Ok(Module::new(self, activities))
    }
}

/// Has the system load a copy of the bytes, of which nobody can change what is mapped, and gives what the module exports.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "code that is loaded runs; that it fits has been checked as far as it can be")]
fn enter(bytes: &[u8], name: &str) -> Result<&'static Gate, Refusal> {
    use std::io::Write;

    let refused = |reason: String| {
        let message = format!("module `{name}` cannot be loaded: {reason}");
        let hint = "its copy lies in the folder for temporary files, which TMPDIR names, and has to be allowed to run there";
        vec![Diagnostic::error("E0362", 0..0, message).with_hint(hint)]
    };
    let copy = tempfile::Builder::new().prefix(&format!("{name}-")).suffix(".so").tempfile();
    let mut copy = copy.map_err(|error| refused(error.to_string()))?;
    copy.write_all(bytes).and_then(|()| copy.flush()).map_err(|error| refused(error.to_string()))?;
    // SAFETY: it was built by the same compiler for the same target as this program, and does nothing of its own when it is loaded.
    let library = unsafe { libloading::Library::new(copy.path()) };
    let library = library.map_err(|error| refused(error.to_string()))?;
    // The file goes here; what is mapped of it stays.
    drop(copy);
    let symbol = format!("monas_module_{name}\0");
    // SAFETY: whatever has a note of Monas exports a gate under this name.
    let gate = unsafe { library.get::<*const Gate>(symbol.as_bytes()) };
    let gate = gate.map(|symbol| *symbol).map_err(|error| refused(error.to_string()))?;
    // Activities, messages and names of it may be anywhere by then, so it is never unloaded.
    std::mem::forget(library);
    // SAFETY: it points into what stays mapped. Its first number says what the rest is, and is looked at first.
    unsafe { gate.as_ref() }.ok_or_else(|| refused("its gate is nowhere".into()))
}

#[cfg(not(target_os = "linux"))]
fn enter(_: &[u8], name: &str) -> Result<&'static Gate, Refusal> {
    let message = format!("module `{name}` cannot be loaded: that is for Linux only");
    let hint = "link its crate into the program: `use its_name as _;`";
    Err(vec![Diagnostic::error("E0362", 0..0, message).with_hint(hint)])
}

/// Before anything else of it is called: whether its types are those of this program.
fn shake_hands(gate: &Gate, name: &str) -> Result<(), Refusal> {
    let error = |message: String| Diagnostic::error("E0363", 0..0, message).with_hint(HINT);
    if gate.version != gate::VERSION {
        let (found, expected) = (gate.version, gate::VERSION);
        return Err(vec![error(format!(
            "module `{name}` talks to programs in way {found}, this one in way {expected}"
        ))]);
    }
    let own = gate::fingerprints();
    let mut found = vec![0; own.len()];
    let count = (gate.fingerprints)(found.as_mut_ptr(), found.len());
    if count != own.len() {
        return Err(vec![error(format!("module `{name}` names {count} types, this program {}", own.len()))]);
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

/// Gives the module its way to the log, and takes what it has.
fn open(gate: &Gate, name: &str) -> Result<Contents, Refusal> {
    let log: HostLog = forward::host_log();
    let mut handed: Handed = None;
    (gate.open)((&raw const log).cast::<c_void>(), (&raw mut handed).cast::<c_void>());
    let reason = match handed {
        Some(Ok(contents)) => return Ok(contents),
        Some(Err(reason)) => reason,
        None => "it hands nothing over".into(),
    };
    Err(vec![Diagnostic::error("E0364", 0..0, format!("module `{name}` cannot be opened: {reason}"))])
}

/// Whether this program has the topics that the module's code knows, with the same types of messages.
fn know(topics: &[TopicDeclaration], name: &str) -> Result<(), Refusal> {
    let known = |topic: &&TopicDeclaration| !TOPICS.iter().any(|known| known.path() == topic.path());
    let unknown = topics.iter().filter(known).map(|topic| {
        let message = format!("module `{name}` has the topic `{}`, which this program has not", topic.path());
        let hint = "topics are those of the program: have the program link the crate that declares it";
        Diagnostic::error("E0364", 0..0, message).with_hint(hint)
    });
    let unknown: Refusal = unknown.collect();
    if !unknown.is_empty() {
        return Err(unknown);
    }
    match Narukom::new("module", TOPICS.iter().chain(topics)) {
        Ok(_) => Ok(()),
        Err(error) => {
            let message = format!("module `{name}` does not fit this program: {error}");
            Err(vec![Diagnostic::error("E0364", 0..0, message).with_hint(HINT)])
        }
    }
}

impl Module {
    /// Reads and loads the file of a module.
    ///
    /// # Errors
    /// As those of [`ModuleFile::read`] and [`ModuleFile::load`].
    pub fn load(path: impl AsRef<Path>) -> Result<Module, Vec<Diagnostic>> {
        ModuleFile::read(path)?.load()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    extern "C" fn other_types(room: *mut u64, length: usize) -> usize {
        let own = gate::fingerprints();
        if length == own.len() {
            for (index, (_, number)) in own.into_iter().enumerate() {
                #[allow(unsafe_code, reason = "the test is the host, which has this room")]
                // SAFETY: there is room for so many.
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
        // SAFETY: the types are the same.
        unsafe {
            gate::hand_over(handed, &["monas"]);
        }
    }
    extern "C" fn silent(_: *const c_void, _: *mut c_void) {}

    fn codes(result: Result<impl Sized, Refusal>) -> Vec<String> {
        result.err().unwrap_or_default().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn another_type_is_refused_by_its_name() {
        let gate = Gate { fingerprints: other_types, ..Gate::new(silent) };
        let expected = "error[E0363]: module `eyes` was built with another `narukom::Moment` than this program \
                        (`monas module build` builds it as this program is built)";
        assert_eq!(codes(shake_hands(&gate, "eyes")), [expected]);
        assert_eq!(codes(shake_hands(&Gate::new(silent), "eyes")), [""; 0]);
    }

    #[test]
    fn another_way_to_talk_is_refused_before_anything_is_called() {
        let gate = Gate { version: 9, fingerprints: few_types, ..Gate::new(silent) };
        assert!(codes(shake_hands(&gate, "eyes"))[0].contains("way 9, this one in way 1"));
        let gate = Gate { fingerprints: few_types, ..Gate::new(silent) };
        assert!(codes(shake_hands(&gate, "eyes"))[0].contains("names 2 types, this program 8"));
    }

    #[test]
    fn a_module_that_hands_nothing_over_is_refused() {
        assert!(codes(open(&Gate::new(silent), "eyes"))[0].contains("it hands nothing over"));
        assert!(open(&Gate::new(opens), "eyes").is_ok_and(|contents| !contents.activities.is_empty()));
    }

    #[test]
    fn topics_have_to_be_those_of_the_program() {
        use narukom::State;
        let topic = TopicDeclaration::new::<State<crate::records::Change>>;
        let unknown = codes(know(&[topic("eyes/seen", "eyes")], "eyes"));
        assert!(unknown[0].contains("the topic `eyes/seen`, which this program has not"), "{unknown:?}");
        let other = codes(know(&[topic("monas/host", "eyes")], "eyes"));
        assert!(other[0].contains("declared with two message types"), "{other:?}");
        assert_eq!(codes(know(&TOPICS, "eyes")), [""; 0]);
    }

    #[test]
    fn what_the_system_does_not_take_is_refused_with_its_reason() {
        let refused = codes(enter(b"no library", "eyes").map(|_| ()));
        assert!(refused[0].starts_with("error[E0362]: module `eyes` cannot be loaded: "), "{refused:?}");
    }
}
