//! The activity that each thread of this process has called last, for a report of a crash.
//!
//! A crash handler may neither allocate nor take a lock. Threads therefore store addresses of texts
//! that are never freed into a table of fixed size, and the handler reads them.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use std::sync::{Mutex, PoisonError};

/// The most threads with activities that are reported.
const THREADS: usize = 512;

static TABLE: [ThreadEntry; THREADS] = [const { ThreadEntry::free() }; THREADS];

/// Each text once, and never freed: there are as many as there are names of activities.
static TEXTS: Mutex<BTreeSet<&'static InternedText>> = Mutex::new(BTreeSet::new());

/// A text that is never freed.
#[derive(PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct InternedText(String);

impl InternedText {
    /// The text with this content.
    pub fn of(text: String) -> &'static InternedText {
        let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
        let text = InternedText(text);
        if let Some(known) = texts.get(&text) {
            return known;
        }
        let text: &'static InternedText = Box::leak(Box::new(text));
        texts.insert(text);
        text
    }

    /// The text itself.
    pub fn as_str(&'static self) -> &'static str {
        &self.0
    }
}

/// What a thread has called last.
struct ThreadEntry {
    is_taken: AtomicBool,
    activity: AtomicPtr<InternedText>,
    is_running: AtomicBool,
}

impl ThreadEntry {
    const fn free() -> ThreadEntry {
        ThreadEntry {
            is_taken: AtomicBool::new(false),
            activity: AtomicPtr::new(std::ptr::null_mut()),
            is_running: AtomicBool::new(false),
        }
    }

    fn set(&self, activity: Option<&'static InternedText>, is_running: bool) {
        if let Some(activity) = activity {
            self.activity.store(std::ptr::from_ref(activity).cast_mut(), Ordering::Release);
        }
        self.is_running.store(is_running, Ordering::Relaxed);
    }
}

/// The entry of a thread, which is free again when the thread ends.
struct OwnEntry(Option<&'static ThreadEntry>);

impl OwnEntry {
    fn take() -> OwnEntry {
        let is_free = |entry: &&ThreadEntry| !entry.is_taken.swap(true, Ordering::AcqRel);
        let entry = TABLE.iter().find(is_free);
        if let Some(entry) = entry {
            entry.activity.store(std::ptr::null_mut(), Ordering::Relaxed);
            entry.is_running.store(false, Ordering::Relaxed);
            CURRENT.set(entry);
        }
        OwnEntry(entry)
    }
}

impl Drop for OwnEntry {
    fn drop(&mut self) {
        if let Some(entry) = self.0 {
            // What it says stays until another thread takes it: `exit` destroys the thread-locals
            // of its thread before it calls the handlers of the exit.
            entry.is_taken.store(false, Ordering::Release);
        }
    }
}

thread_local! {
    static OWN: OwnEntry = OwnEntry::take();
    /// The address of the entry, which has no destructor.
    static CURRENT: Cell<*const ThreadEntry> = const { Cell::new(std::ptr::null()) };
}

/// This thread calls an activity.
pub(crate) fn begin(activity: &'static InternedText) {
    set(Some(activity), true);
}

/// The activity has returned; this thread continues the call of `outer`, if it was within one.
pub(crate) fn end(outer: Option<&'static InternedText>) {
    set(outer, outer.is_some());
}

fn set(activity: Option<&'static InternedText>, is_running: bool) {
    // The thread-local is destroyed already when the thread ends.
    let _ = OWN.try_with(|own| {
        if let Some(entry) = own.0 {
            entry.set(activity, is_running);
        }
    });
}

/// The activity that a thread has called last.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ThreadActivity {
    /// `robot/agent/activity`.
    pub activity: &'static str,
    /// Whether the call has not returned.
    pub is_running: bool,
    /// Whether it is the calling thread.
    pub is_current: bool,
}

/// Calls `look` with the activity of each thread that has called one. Neither allocates nor takes a
/// lock, so that a signal handler may use it.
pub fn each(mut look: impl FnMut(ThreadActivity)) {
    let current = CURRENT.get();
    for entry in &TABLE {
        let is_running = entry.is_running.load(Ordering::Relaxed);
        let is_current = std::ptr::eq(entry, current);
        if let Some(activity) = text(&entry.activity)
            && (is_running || entry.is_taken.load(Ordering::Acquire))
        {
            look(ThreadActivity { activity, is_running, is_current });
        }
    }
}

#[expect(unsafe_code, reason = "a crash handler reads what other threads have stored, without a lock")]
fn text(stored: &AtomicPtr<InternedText>) -> Option<&'static str> {
    // SAFETY: the pointer is null or was made from a `&'static InternedText`, which is complete
    // before it is stored and never freed.
    unsafe { stored.load(Ordering::Acquire).as_ref() }.map(InternedText::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own() -> Vec<ThreadActivity> {
        let mut found = Vec::new();
        each(|activity| found.extend(activity.is_current.then_some(activity)));
        found
    }

    #[test]
    fn the_last_activity_of_a_thread_and_the_call_around_it_are_known() {
        let name = |name: &str| InternedText::of(name.to_owned());
        assert_eq!(own(), []);
        begin(name("blue-2/Attacker/Walk"));
        let walk = ThreadActivity { activity: "blue-2/Attacker/Walk", is_running: true, is_current: true };
        assert_eq!(own(), [walk]);
        begin(name("blue-2/Attacker/Kick"));
        assert_eq!(own(), [ThreadActivity { activity: "blue-2/Attacker/Kick", ..walk }]);
        end(Some(name("blue-2/Attacker/Walk")));
        assert_eq!(own(), [walk]);
        end(None);
        assert_eq!(own(), [ThreadActivity { is_running: false, ..walk }]);
    }

    #[test]
    fn a_thread_that_has_ended_is_known_only_if_it_ended_in_a_call() {
        let own = OwnEntry::take();
        let entry = own.0.unwrap();
        entry.set(Some(InternedText::of("red-1/Goalie/Dive".to_owned())), true);
        let is_known = || {
            let mut is_known = false;
            each(|one| is_known |= one.activity == "red-1/Goalie/Dive");
            is_known
        };
        drop(own);
        assert!(is_known());
        entry.set(None, false);
        assert!(!is_known());
    }

    #[test]
    fn a_text_is_stored_once() {
        let address = |text: &str| std::ptr::from_ref(InternedText::of(text.to_owned()));
        assert_eq!(address("a"), address("a"));
        assert_ne!(address("a"), address("b"));
    }
}
