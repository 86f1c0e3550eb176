//! An allocator that counts per thread.
#![allow(dead_code, unreachable_pub)]
#![allow(unsafe_code, reason = "counting allocations takes an allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    static ALLOCATED: Cell<u64> = const { Cell::new(0) };
    static FREED: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

fn add(counter: &'static std::thread::LocalKey<Cell<u64>>, number: u64) {
    // The counters of a thread that ends are already destroyed.
    let _ = counter.try_with(|counter| counter.set(counter.get() + number));
}

// SAFETY: every method passes its arguments unchanged to the system's allocator, so `System`
// upholds the contract of `GlobalAlloc`.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        add(&ALLOCATIONS, 1);
        add(&ALLOCATED, layout.size() as u64);
        // SAFETY: the caller upholds the contract of `alloc`, which `System` shares.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        add(&FREED, layout.size() as u64);
        // SAFETY: the caller guarantees that the block came from `alloc` above, that is from
        // `System`, with the same layout.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The number of allocations that `work` makes on this thread, and their bytes in total.
pub fn allocations(work: impl FnOnce()) -> (u64, u64) {
    let (count, bytes) = (ALLOCATIONS.get(), ALLOCATED.get());
    work();
    (ALLOCATIONS.get() - count, ALLOCATED.get() - bytes)
}

/// The bytes that this thread has allocated and not freed.
pub fn live() -> i64 {
    ALLOCATED.get() as i64 - FREED.get() as i64
}
