//! The activity that each thread of this process calls at present, or has called last: for log
//! lines, watchdogs, and the report of a crash.
//!
//! A crash handler may neither allocate nor take a lock. A slot therefore consists of atomics that
//! only its thread writes. Slots form a list that is never shortened: the slot of a thread that has
//! ended is taken by another. The memory that a slot refers to is never freed.

use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU8, AtomicU64, Ordering, fence};

use crate::activity_name::ActivityName;

/// The newest slot; each refers to the next older one.
static NEWEST: AtomicRef<CallSlot> = AtomicRef::none();

/// Number of threads that have taken a slot.
static THREADS: AtomicU64 = AtomicU64::new(0);

/// The call of one thread.
struct CallSlot {
    /// The number of the thread; 0 while the slot is free.
    thread: AtomicU64,
    /// Two for each change of the fields below; odd while they change. A reader that finds it even
    /// and unchanged has seen one state.
    changes: AtomicU64,
    name: AtomicRef<ActivityName>,
    cycle: AtomicU64,
    function: AtomicU8,
    is_running: AtomicBool,
    /// Set before the slot is in the list.
    older: AtomicRef<CallSlot>,
}

/// A reference that is absent or lives as long as the process.
struct AtomicRef<T: 'static>(AtomicPtr<T>);

impl<T> AtomicRef<T> {
    const fn none() -> AtomicRef<T> {
        AtomicRef(AtomicPtr::new(std::ptr::null_mut()))
    }

    fn set(&self, value: Option<&'static T>) {
        self.0.store(pointer(value), Ordering::Release);
    }

    #[expect(unsafe_code, reason = "the standard library has no atomic reference")]
    fn get(&self) -> Option<&'static T> {
        // SAFETY: only `none`, `set` and `replace_if` write the pointer. It is null or comes from a
        // `&'static T`, which was complete before it was stored with `Release`.
        unsafe { self.0.load(Ordering::Acquire).as_ref() }
    }

    /// Replaces the reference if it is still the given one; returns whether it was.
    fn replace_if(&self, old: Option<&'static T>, new: &'static T) -> bool {
        let (old, new) = (pointer(old), pointer(Some(new)));
        self.0.compare_exchange(old, new, Ordering::AcqRel, Ordering::Relaxed).is_ok()
    }
}

fn pointer<T>(value: Option<&'static T>) -> *mut T {
    value.map_or(std::ptr::null_mut(), |value| std::ptr::from_ref(value).cast_mut())
}

/// A call that a thread has begun and not ended.
#[derive(Clone, Debug)]
pub struct OpenCall {
    /// The activity.
    pub name: &'static ActivityName,
    /// The function that is called.
    pub function: ActivityFunction,
    /// Equal numbers of a thread mean the same call.
    pub number: u64,
}

/// A function of an activity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ActivityFunction {
    /// `start`
    Start,
    /// `execute`
    Execute,
    /// `stop`
    Stop,
}

impl ActivityFunction {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            ActivityFunction::Start => "start",
            ActivityFunction::Execute => "execute",
            ActivityFunction::Stop => "stop",
        }
    }

    const fn of(number: u8) -> ActivityFunction {
        match number {
            0 => ActivityFunction::Start,
            1 => ActivityFunction::Execute,
            _ => ActivityFunction::Stop,
        }
    }
}

/// The activity that a thread calls, or has called last.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LastCall {
    /// The activity.
    pub name: &'static ActivityName,
    /// Whether the call has not returned.
    pub is_running: bool,
    /// Whether it is the calling thread.
    pub is_current: bool,
}

/// A thread whose calls other threads observe.
pub struct CallingThread {
    slot: &'static CallSlot,
    number: u64,
}

impl CallingThread {
    /// The calling thread.
    pub fn current() -> CallingThread {
        OWN_SLOT.with(|own| CallingThread { slot: own.slot, number: own.number })
    }

    /// Whether it is the calling thread.
    pub fn is_current(&self) -> bool {
        self.number == CallingThread::current().number
    }

    /// Whether the thread has ended.
    pub fn has_ended(&self) -> bool {
        self.slot.thread.load(Ordering::Acquire) != self.number
    }

    /// The call in progress, if any. A call that begins or ends during this is not reported.
    pub fn open_call(&self) -> Option<OpenCall> {
        let slot = self.slot;
        let number = slot.changes.load(Ordering::Acquire);
        let function = ActivityFunction::of(slot.function.load(Ordering::Relaxed));
        let is_running = slot.is_running.load(Ordering::Relaxed);
        let name = slot.name.get()?;
        fence(Ordering::Acquire);
        let is_one_state = number.is_multiple_of(2) && slot.changes.load(Ordering::Relaxed) == number;
        let is_open = is_running && is_one_state && !self.has_ended();
        is_open.then_some(OpenCall { name, function, number })
    }
}

/// Calls `look` with the last call of each thread that has called an activity. Neither allocates
/// nor takes a lock, so that a signal handler may use it.
pub fn each(mut look: impl FnMut(LastCall)) {
    let current = CURRENT_SLOT.get();
    let mut next = NEWEST.get();
    while let Some(slot) = next {
        let is_running = slot.is_running.load(Ordering::Relaxed);
        let is_current = current.is_some_and(|current| std::ptr::eq(slot, current));
        // A thread that has ended matters only if it ended in a call.
        if let Some(name) = slot.name.get()
            && (is_running || slot.thread.load(Ordering::Acquire) != 0)
        {
            look(LastCall { name, is_running, is_current });
        }
        next = slot.older.get();
    }
}

/// Passes the activity that this thread calls, and its cycle, to a function.
pub fn called(look: impl FnOnce(&'static ActivityName, u64)) {
    if CURRENT_SLOT.get().is_none() {
        return;
    }
    // The thread-local is destroyed already when the thread ends.
    let called = OWN_SLOT.try_with(|own| own.slot.call()).ok().flatten();
    if let Some(call) = called {
        look(call.name, call.cycle);
    }
}

/// A call as its thread sees it.
#[derive(Clone, Copy)]
struct Call {
    name: &'static ActivityName,
    cycle: u64,
    function: u8,
}

impl CallSlot {
    const fn new(thread: u64) -> CallSlot {
        CallSlot {
            thread: AtomicU64::new(thread),
            changes: AtomicU64::new(0),
            name: AtomicRef::none(),
            cycle: AtomicU64::new(0),
            function: AtomicU8::new(0),
            is_running: AtomicBool::new(false),
            older: AtomicRef::none(),
        }
    }

    /// A slot for a new thread: a free one, or one that is added to the list.
    fn take(thread: u64) -> &'static CallSlot {
        let mut next = NEWEST.get();
        while let Some(slot) = next {
            if slot.thread.compare_exchange(0, thread, Ordering::AcqRel, Ordering::Relaxed).is_ok() {
                slot.change(|| {
                    slot.name.set(None);
                    slot.is_running.store(false, Ordering::Relaxed);
                });
                return slot;
            }
            next = slot.older.get();
        }
        let slot: &'static CallSlot = Box::leak(Box::new(CallSlot::new(thread)));
        loop {
            let newest = NEWEST.get();
            slot.older.set(newest);
            if NEWEST.replace_if(newest, slot) {
                return slot;
            }
        }
    }

    /// The call in progress, on its own thread.
    fn call(&self) -> Option<Call> {
        let (cycle, function) = (self.cycle.load(Ordering::Relaxed), self.function.load(Ordering::Relaxed));
        let name = self.name.get().filter(|_| self.is_running.load(Ordering::Relaxed))?;
        Some(Call { name, cycle, function })
    }

    /// Changes the call, on its own thread. The activity of the last call stays.
    fn set(&self, call: Option<Call>) {
        self.change(|| {
            if let Some(Call { name, cycle, function }) = call {
                self.name.set(Some(name));
                self.cycle.store(cycle, Ordering::Relaxed);
                self.function.store(function, Ordering::Relaxed);
            }
            self.is_running.store(call.is_some(), Ordering::Relaxed);
        });
    }

    /// Carries out a change that readers see as a whole.
    fn change(&self, change: impl FnOnce()) {
        let changes = self.changes.load(Ordering::Relaxed);
        self.changes.store(changes + 1, Ordering::Relaxed);
        fence(Ordering::Release);
        change();
        self.changes.store(changes + 2, Ordering::Release);
    }
}

/// The slot of a thread, which is free again when the thread ends.
struct OwnSlot {
    slot: &'static CallSlot,
    number: u64,
}

impl OwnSlot {
    fn take() -> OwnSlot {
        let number = THREADS.fetch_add(1, Ordering::Relaxed) + 1;
        let slot = CallSlot::take(number);
        CURRENT_SLOT.set(Some(slot));
        OwnSlot { slot, number }
    }
}

impl Drop for OwnSlot {
    fn drop(&mut self) {
        // The last call stays until another thread takes the slot: `exit` destroys the
        // thread-locals of its thread before it calls the handlers of the exit.
        self.slot.thread.store(0, Ordering::Release);
    }
}

thread_local! {
    static OWN_SLOT: OwnSlot = OwnSlot::take();
    /// The same slot, without a destructor: a signal handler reads it.
    static CURRENT_SLOT: Cell<Option<&'static CallSlot>> = const { Cell::new(None) };
}

/// Marks a call of an activity on this thread until it is dropped, also when unwinding. Then this
/// thread continues the call around it, if there is one.
pub(crate) struct CallMark {
    outer: Option<Call>,
    /// It belongs to its thread.
    of_thread: PhantomData<*const ()>,
}

impl CallMark {
    pub(crate) fn begin(name: &'static ActivityName, cycle: u64) -> CallMark {
        let call = Call { name, cycle, function: ActivityFunction::Execute as u8 };
        let outer = OWN_SLOT.try_with(|own| {
            let outer = own.slot.call();
            own.slot.set(Some(call));
            outer
        });
        // The thread-local is destroyed already when the thread ends.
        CallMark { outer: outer.ok().flatten(), of_thread: PhantomData }
    }
}

impl Drop for CallMark {
    fn drop(&mut self) {
        let _ = OWN_SLOT.try_with(|own| own.slot.set(self.outer));
    }
}

/// Notes the function that this thread calls.
pub(crate) fn calls(function: ActivityFunction) {
    let _ = OWN_SLOT.try_with(|own| {
        own.slot.change(|| own.slot.function.store(function as u8, Ordering::Relaxed));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(activity: &str) -> &'static ActivityName {
        ActivityName::of("red-1", "mind", activity)
    }

    #[test]
    fn another_thread_sees_the_call_until_it_ends() {
        let thread = CallingThread::current();
        let seen = || std::thread::scope(|threads| threads.spawn(|| thread.open_call()).join().unwrap());
        assert!(seen().is_none());
        let mark = CallMark::begin(name("Outer"), 1);
        calls(ActivityFunction::Stop);
        let first = seen().unwrap();
        assert_eq!((first.name, first.function), (name("Outer"), ActivityFunction::Stop));
        assert_eq!(seen().unwrap().number, first.number, "the same call");
        let inner = CallMark::begin(name("Inner"), 2);
        assert_eq!(seen().unwrap().name, name("Inner"));
        drop(inner);
        let again = seen().unwrap();
        assert_eq!((again.name, again.function), (name("Outer"), ActivityFunction::Stop));
        assert_ne!(again.number, first.number, "it has made progress");
        drop(mark);
        assert!(seen().is_none());
    }

    #[test]
    fn a_reader_sees_no_mixture_of_two_calls() {
        let (sender, thread) = std::sync::mpsc::channel();
        let ends = AtomicBool::new(false);
        std::thread::scope(|threads| {
            threads.spawn(|| {
                sender.send(CallingThread::current()).unwrap();
                let names = [name("Even"), name("Odd")];
                let mut calls_made = 0;
                while !ends.load(Ordering::Relaxed) {
                    let is_odd = calls_made % 2 == 1;
                    let _mark = CallMark::begin(names[usize::from(is_odd)], calls_made);
                    calls(if is_odd { ActivityFunction::Stop } else { ActivityFunction::Start });
                    calls_made += 1;
                }
            });
            let thread = thread.recv().unwrap();
            let (mut seen, mut last) = (0, 0);
            while seen < 1000 {
                let Some(call) = thread.open_call() else { continue };
                let is_mixed = match call.function {
                    ActivityFunction::Start => call.name != name("Even"),
                    ActivityFunction::Stop => call.name != name("Odd"),
                    // Between the beginning of the call and that of its function.
                    ActivityFunction::Execute => false,
                };
                assert!(!is_mixed, "{call:?}");
                assert!(call.number >= last, "{call:?} after {last}");
                (seen, last) = (seen + 1, call.number);
            }
            ends.store(true, Ordering::Relaxed);
        });
    }

    #[test]
    fn a_thread_that_has_ended_has_no_calls_though_another_takes_its_slot() {
        let call = || {
            drop(CallMark::begin(name("Last"), 1));
            CallingThread::current()
        };
        let ended = std::thread::scope(|threads| threads.spawn(call).join().unwrap());
        assert!(ended.has_ended() && ended.open_call().is_none());
        let next = OwnSlot::take();
        next.slot.set(Some(Call { name: name("Next"), cycle: 1, function: 0 }));
        assert!(ended.has_ended() && ended.open_call().is_none());
        next.slot.set(None);
    }

    fn own() -> Vec<LastCall> {
        let mut found = Vec::new();
        each(|call| found.extend(call.is_current.then_some(call)));
        found
    }

    #[test]
    fn the_last_activity_of_a_thread_and_the_call_around_it_are_known() {
        let last = |name, is_running| [LastCall { name, is_running, is_current: true }];
        let cycle = || {
            let mut found = None;
            called(|name, cycle| found = Some((name, cycle)));
            found
        };
        assert_eq!((own(), cycle()), (Vec::new(), None));
        let walk = CallMark::begin(name("Walk"), 7);
        assert_eq!((own(), cycle()), (last(name("Walk"), true).to_vec(), Some((name("Walk"), 7))));
        let kick = CallMark::begin(name("Kick"), 0);
        assert_eq!((own(), cycle()), (last(name("Kick"), true).to_vec(), Some((name("Kick"), 0))));
        drop(kick);
        assert_eq!((own(), cycle()), (last(name("Walk"), true).to_vec(), Some((name("Walk"), 7))));
        drop(walk);
        assert_eq!((own(), cycle()), (last(name("Walk"), false).to_vec(), None));
    }

    #[test]
    fn a_thread_that_has_ended_is_known_only_if_it_ended_in_a_call() {
        let own = OwnSlot::take();
        let slot = own.slot;
        slot.set(Some(Call { name: name("Dive"), cycle: 1, function: 0 }));
        let is_known = || {
            let mut is_known = false;
            each(|call| is_known |= call.name == name("Dive"));
            is_known
        };
        drop(own);
        assert!(is_known());
        slot.set(None);
        assert!(!is_known());
    }
}
