//! What each thread calls at present, readable by other threads: for watchdogs.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::activity_context::ActivityContext;

/// The activity that one thread calls. The thread writes it; others only read.
#[derive(Default)]
pub struct CallSlot {
    function: AtomicU32,
    called: Mutex<SlotContent>,
}

#[derive(Default)]
struct SlotContent {
    context: Option<Arc<ActivityContext>>,
    /// Counts beginnings and ends of calls. It changes with the context, under one lock: otherwise
    /// a reader could see one call with two numbers.
    changes: u64,
}

/// A call that a thread has begun and not ended.
#[derive(Clone, Debug)]
pub struct OpenCall {
    /// The activity.
    pub context: Arc<ActivityContext>,
    /// The function that is called.
    pub function: ActivityFunction,
    /// Equal numbers of a slot mean the same call.
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
}

thread_local! {
    static OWN: Arc<CallSlot> = Arc::default();
}

impl CallSlot {
    /// The slot of the calling thread.
    pub fn of_this_thread() -> Arc<CallSlot> {
        OWN.with(Arc::clone)
    }

    /// The call in progress, if any.
    pub fn open_call(&self) -> Option<OpenCall> {
        let (context, number) = {
            let content = self.content();
            (content.context.clone()?, content.changes)
        };
        let function = match self.function.load(Ordering::Relaxed) {
            0 => ActivityFunction::Start,
            1 => ActivityFunction::Execute,
            _ => ActivityFunction::Stop,
        };
        // A call that ended or began meanwhile is another one at the next look.
        Some(OpenCall { context, function, number })
    }

    /// Replaces the activity that is called. Returns the one before.
    fn replace(&self, called: Option<Arc<ActivityContext>>) -> Option<Arc<ActivityContext>> {
        let mut content = self.content();
        content.changes += 1;
        std::mem::replace(&mut content.context, called)
    }

    fn content(&self) -> MutexGuard<'_, SlotContent> {
        self.called.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Marks a call of an activity on this thread until it is dropped.
pub(crate) struct CallMark(Option<Arc<ActivityContext>>);

impl CallMark {
    pub(crate) fn begin(context: &Arc<ActivityContext>) -> CallMark {
        CallMark(OWN.with(|slot| slot.replace(Some(context.clone()))))
    }
}

impl Drop for CallMark {
    fn drop(&mut self) {
        // The thread-local is destroyed already when the thread ends.
        let _ = OWN.try_with(|slot| slot.replace(self.0.take()));
    }
}

/// Notes the function that this thread calls.
pub(crate) fn calls(function: ActivityFunction) {
    OWN.with(|slot| slot.function.store(function as u32, Ordering::Relaxed));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_thread_sees_the_call_until_it_ends() {
        let slot = CallSlot::of_this_thread();
        let seen = |slot: &Arc<CallSlot>| {
            std::thread::scope(|threads| threads.spawn(|| slot.open_call()).join().unwrap())
        };
        assert!(seen(&slot).is_none());
        let outer = ActivityContext::new("red-1", "mind", "Outer");
        let mark = CallMark::begin(&outer);
        calls(ActivityFunction::Stop);
        let first = seen(&slot).unwrap();
        assert_eq!((first.context.activity.as_str(), first.function), ("Outer", ActivityFunction::Stop));
        assert_eq!(seen(&slot).unwrap().number, first.number, "the same call");
        let inner = CallMark::begin(&ActivityContext::new("red-1", "mind", "Inner"));
        assert_eq!(seen(&slot).unwrap().context.activity, "Inner");
        drop(inner);
        let again = seen(&slot).unwrap();
        assert_eq!(again.context.activity, "Outer");
        assert_ne!(again.number, first.number, "it has made progress");
        drop(mark);
        assert!(seen(&slot).is_none());
    }
}
