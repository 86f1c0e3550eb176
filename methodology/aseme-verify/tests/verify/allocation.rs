//! A monitor does not allocate after its construction.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use aseme_verify::properties::{Monitor, MonitorVerdict, bind, parse};
use yase::{Source, TypeEnvironment};

thread_local! {
    static TAKEN: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: every call is forwarded to the system's allocator.
#[allow(unsafe_code, reason = "counting allocations takes an allocator")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = TAKEN.try_with(|taken| taken.set(taken.get() + 1));
        // SAFETY: the caller's promises are the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are the system's.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_monitor_takes_no_memory() {
    let role = Source::new("r.srm", "Role: r\nLiveness:\nr = a . b . c\n");
    let chart = aseme_models::statechart_of(&role).0.compile(&TypeEnvironment::default()).unwrap();
    let text = "property \"p\": always ((in a implies eventually in b within 2 s) and (in b implies in b until in c within 1 s))";
    let mut monitor =
        Monitor::new(bind(&parse(text).0[0], &chart, &TypeEnvironment::default()).unwrap().plan);
    let letters = [1, 1, 2, 2, 4, 0];
    let before = TAKEN.with(Cell::get);
    let mut verdicts = [MonitorVerdict::Lost; 600];
    for (step, verdict) in verdicts.iter_mut().enumerate() {
        let now = step as u64 * 100_000_000;
        *verdict = monitor.step(letters[step % letters.len()], now);
        monitor.pass(now + 1);
    }
    assert_eq!(TAKEN.with(Cell::get), before);
    assert!(
        verdicts.iter().all(|it| matches!(it, MonitorVerdict::SoFar | MonitorVerdict::Awaited)),
        "{verdicts:?}"
    );
}
