//! In the steady state nothing is allocated: not to publish, not to deliver, not to read.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(unsafe_code, reason = "counting allocations takes an allocator")]

mod messages;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use messages::*;
use narukom::FieldValue;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: every call is passed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The only test of this file, so that nobody else allocates meanwhile.
#[test]
fn a_cycle_does_not_allocate() {
    let hub = hub();
    let (mut one, mut other, mut region) =
        (hub.blackboard("one"), hub.blackboard("other"), hub.blackboard("one"));
    let mut body = hub.publisher(STATE, "body").unwrap();
    let state = hub.topic("test/state").unwrap();
    let mut sum = 0;
    let mut cycle = |number: u64| {
        body.publish(Mark::new(number), at(number));
        for blackboard in [&mut one, &mut other] {
            blackboard.process_messages(at(number));
            sum += blackboard.read(STATE).map_or(0, |mark| mark.number);
            sum += blackboard.signals(SIGNAL).map(|mark| mark.number).sum::<u64>();
            sum += blackboard.recent(DATA, Duration::from_millis(2)).map(|mark| mark.number).sum::<u64>();
            sum += blackboard.nearest(DATA, at(number - 1)).map_or(0, |mark| mark.number);
            blackboard.publish(SIGNAL, Mark::new(number)).unwrap();
            blackboard.publish(DATA, Mark::new(number)).unwrap();
            blackboard.edit(state, |mark| mark.set_field(0, FieldValue::Uint(number)).unwrap()).unwrap();
            region.adopt(blackboard);
            sum += region.read(STATE).map_or(0, |mark| mark.number);
            blackboard.publish_all(at(number));
        }
    };
    // Rings, pools and lists grow until every place has been used once.
    (1..=2000).for_each(&mut cycle);
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    (2001..=4000).for_each(&mut cycle);
    let allocations = ALLOCATIONS.load(Ordering::Relaxed) - before;
    assert_eq!(allocations, 0, "in 2000 cycles");
    assert!(sum > 0);
}
