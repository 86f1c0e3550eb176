//! Memory held by activities: bytes that each activity has allocated and that are not yet freed.
//!
//! A program enables it by using [`CountingAllocator`] as its allocator:
//!
//! ```
//! #[global_allocator]
//! static ALLOCATOR: monas_core::memory::CountingAllocator = monas_core::memory::CountingAllocator;
//! # fn main() {}
//! ```
//!
//! While an activity is called in real time, allocations of its thread are entered in a table by
//! address. A deallocation on any thread debits the account of the allocating activity. A message
//! that an activity publishes therefore counts for it until a newer one replaces it, and temporary
//! allocations cancel out. An activity whose held memory keeps rising
//! [grows](crate::ActivityStatistics::grows).
//!
//! Allocations outside such calls are not entered, and a program without this allocator counts
//! nothing. The table has room for 32,768 blocks: blocks that do not fit are not counted, so that
//! counts are never too high. A module has its own allocator, whose allocations are not counted
//! here.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU16, AtomicU64, AtomicUsize, Ordering};

/// The system allocator with a table of allocations by activities.
#[derive(Clone, Copy, Debug, Default)]
pub struct CountingAllocator;

/// Number of an account; 0 for none.
type AccountId = u16;

/// Number of accounts.
const ACCOUNT_COUNT: usize = 4096;
/// Number of entries per row; the address of a block selects its row.
const ENTRIES_PER_ROW: usize = 8;
const ROWS: usize = 4096;
/// Number of bits of an entry for the size of the block; the others hold its owner.
const SIZE_BITS: u32 = 48;

static IS_COUNTING: AtomicBool = AtomicBool::new(false);
static ACCOUNTS: [AtomicI64; ACCOUNT_COUNT] = [const { AtomicI64::new(0) }; ACCOUNT_COUNT];
static NEXT_OWNER: AtomicU16 = AtomicU16::new(1);
/// Number of blocks in the table.
static BLOCKS: AtomicUsize = AtomicUsize::new(0);
static ADDRESSES: [[AtomicUsize; ENTRIES_PER_ROW]; ROWS] =
    [const { [const { AtomicUsize::new(0) }; ENTRIES_PER_ROW] }; ROWS];
static ENTRIES: [[AtomicU64; ENTRIES_PER_ROW]; ROWS] =
    [const { [const { AtomicU64::new(0) }; ENTRIES_PER_ROW] }; ROWS];

thread_local! {
    static WORKS_FOR: Cell<AccountId> = const { Cell::new(0) };
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The number of allocations that this thread has made; zero without the counting allocator.
pub fn allocations() -> u64 {
    ALLOCATIONS.get()
}

/// An account for one activity, opened at its first use. When all accounts are in use, further
/// activities have none.
#[derive(Debug, Default)]
pub struct Account(AtomicU16);

impl Account {
    /// Runs a function and charges its allocations to this account.
    pub fn with_account<T>(&self, work: impl FnOnce() -> T) -> T {
        if !IS_COUNTING.load(Ordering::Relaxed) {
            return work();
        }
        let _before = AccountGuard(WORKS_FOR.replace(self.owner()));
        work()
    }

    /// The bytes charged to it; none without the counting allocator.
    pub(crate) fn held(&self) -> Option<u64> {
        match self.0.load(Ordering::Relaxed) {
            0 => None,
            owner => {
                let held = ACCOUNTS[usize::from(owner)].load(Ordering::Relaxed);
                Some(u64::try_from(held).unwrap_or_default())
            }
        }
    }

    fn owner(&self) -> AccountId {
        match self.0.load(Ordering::Relaxed) {
            0 => self.open(),
            owner => owner,
        }
    }

    #[cold]
    fn open(&self) -> AccountId {
        let take = |next: AccountId| (usize::from(next) < ACCOUNT_COUNT).then(|| next + 1);
        // Only one thread at a time calls an activity.
        let taken = NEXT_OWNER.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).unwrap_or_default();
        self.0.store(taken, Ordering::Relaxed);
        taken
    }
}

/// Restores the previous account of the thread, also when unwinding.
struct AccountGuard(AccountId);

impl Drop for AccountGuard {
    fn drop(&mut self) {
        WORKS_FOR.set(self.0);
    }
}

fn row_of(address: usize) -> usize {
    // Addresses are multiples of 16; the golden ratio spreads them.
    let spread = (address >> 4).wrapping_mul(0x9E37_79B9_7F4A_7C15_u64 as usize);
    (spread >> (usize::BITS - ROWS.trailing_zeros())) % ROWS
}

/// Enters a block for an owner, if there is room.
fn note(address: usize, size: usize, owner: AccountId) {
    let row = row_of(address);
    for (known, entry) in ADDRESSES[row].iter().zip(&ENTRIES[row]) {
        if known.compare_exchange(0, address, Ordering::Acquire, Ordering::Relaxed).is_ok() {
            // No other thread uses this address before the allocation returns.
            entry.store(u64::from(owner) << SIZE_BITS | size as u64, Ordering::Relaxed);
            BLOCKS.fetch_add(1, Ordering::Relaxed);
            ACCOUNTS[usize::from(owner)].fetch_add(size as i64, Ordering::Relaxed);
            return;
        }
    }
}

/// Removes a block and debits its owner; returns 0 if it is not in the table.
fn forget_block(address: usize) -> AccountId {
    if BLOCKS.load(Ordering::Relaxed) == 0 {
        return 0;
    }
    let row = row_of(address);
    for (known, entry) in ADDRESSES[row].iter().zip(&ENTRIES[row]) {
        if known.load(Ordering::Relaxed) == address {
            let entry = entry.load(Ordering::Relaxed);
            let (owner, size) = ((entry >> SIZE_BITS) as AccountId, entry & ((1 << SIZE_BITS) - 1));
            ACCOUNTS[usize::from(owner)].fetch_sub(size as i64, Ordering::Relaxed);
            BLOCKS.fetch_sub(1, Ordering::Relaxed);
            known.store(0, Ordering::Release);
            return owner;
        }
    }
    0
}

/// The current account of this thread.
fn current_account() -> AccountId {
    // The thread-local is destroyed already when the thread ends.
    WORKS_FOR.try_with(Cell::get).unwrap_or_default()
}

#[allow(unsafe_code)] // an allocator is
// SAFETY: every call is passed to the system allocator unchanged; the table stores addresses as
// numbers and never dereferences them.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !IS_COUNTING.load(Ordering::Relaxed) {
            IS_COUNTING.store(true, Ordering::Relaxed);
        }
        // The thread-local is destroyed already when the thread ends.
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller upholds the contract of `alloc` for `layout`, which is passed on
        // unchanged.
        let block = unsafe { System.alloc(layout) };
        let owner = current_account();
        if owner != 0 && !block.is_null() {
            note(block as usize, layout.size(), owner);
        }
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // Before the deallocation: afterwards another thread may receive the address.
        forget_block(block as usize);
        // SAFETY: `block` was allocated by the system allocator with `layout`.
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let owner = forget_block(block as usize);
        // SAFETY: `block` was allocated by the system allocator with `layout`; the caller
        // guarantees a valid size.
        let moved = unsafe { System.realloc(block, layout, size) };
        let (address, held) = if moved.is_null() { (block, layout.size()) } else { (moved, size) };
        // The block keeps its owner.
        if owner != 0 {
            note(address as usize, held, owner);
        }
        moved
    }
}

/// Length of a window in calls.
const WINDOW: u32 = 32;
/// Growth: the minimum rises in this many consecutive windows,
const WINDOWS_OF_GROWTH: u32 = 8;
/// and by at least this many bytes in total.
const MIN_GROWTH: u64 = 4096;

/// Detects whether the memory held by an activity grows from call to call.
#[derive(Clone, Copy, Debug, Default)]
pub struct LeakDetector {
    /// Bytes held now.
    held: Option<u64>,
    /// Calls of this window, and the minimum held after one of them.
    calls: u32,
    floor: u64,
    /// Minimum of the previous window, if there was one, number of consecutive rising windows, and
    /// the minimum before them.
    last: Option<u64>,
    rising_windows: u32,
    from: u64,
    is_said: bool,
}

impl LeakDetector {
    /// Adds the bytes held after a call. True when growth is detected for the first time.
    pub(crate) fn add(&mut self, held: Option<u64>) -> bool {
        self.held = held;
        let Some(held) = held else { return false };
        self.floor = if self.calls == 0 { held } else { self.floor.min(held) };
        self.calls += 1;
        if self.calls < WINDOW {
            return false;
        }
        self.calls = 0;
        // The use in the first window is the baseline, not growth.
        if self.last.is_some_and(|last| self.floor > last) {
            self.rising_windows += 1;
        } else {
            (self.rising_windows, self.from) = (0, self.floor);
        }
        self.last = Some(self.floor);
        let is_new = self.grows() && !self.is_said;
        self.is_said |= is_new;
        is_new
    }

    /// Whether growth was detected.
    pub fn grows(&self) -> bool {
        self.rising_windows >= WINDOWS_OF_GROWTH
            && self.last.is_some_and(|last| last.saturating_sub(self.from) >= MIN_GROWTH)
    }

    /// Bytes held; none without the counting allocator.
    pub fn held(&self) -> Option<u64> {
        self.held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn growing(held: impl Fn(u64) -> u64, calls: u64) -> (bool, u64) {
        let mut growth = LeakDetector::default();
        let said = (0..calls).filter(|call| growth.add(Some(held(*call)))).count();
        (growth.grows(), said as u64)
    }

    #[test]
    fn memory_that_rises_in_each_window_is_reported_once() {
        assert_eq!(growing(|call| 100 * call, 1000), (true, 1));
        assert_eq!(growing(|call| 100 * call, 200), (false, 0), "that may be a history that fills");
        assert_eq!(
            growing(|call| 1000 + call / 100, 10_000),
            (false, 0),
            "it is little, and stands in between"
        );
        assert_eq!(growing(|call| 10_000 * (call % 31), 10_000), (false, 0), "it comes and goes");
        assert_eq!(
            growing(|call| 100 * call.min(500), 1000),
            (false, 1),
            "it has grown, and does not any more"
        );
    }

    #[test]
    fn memory_held_from_the_beginning_is_no_growth() {
        assert_eq!(growing(|call| 8192 + 8 * call, 300), (false, 0), "it grew by less than 4 KiB");
        assert_eq!(growing(|_| 8192, 1000), (false, 0));
        assert_eq!(growing(|call| 8192 + 100 * call, 1000), (true, 1));
    }

    #[test]
    fn a_block_is_its_owners_until_anybody_gives_it_back() {
        // Addresses that the system never returns, since it returns multiples of 16.
        let account = Account::default();
        let owner = account.open();
        note(0x1001, 100, owner);
        note(0x2001, 20, owner);
        assert_eq!(account.held(), Some(120));
        assert_eq!((forget_block(0x1001), forget_block(0x1001)), (owner, 0));
        assert_eq!(account.held(), Some(20));
        assert_eq!(forget_block(0x2001), owner);
    }

    #[test]
    fn mismatches_are_not_counted() {
        let account = Account::default();
        let owner = account.open();
        let same_row: Vec<usize> =
            (0..).map(|n| n * 16 + 3).filter(|at| row_of(*at) == 7).take(ENTRIES_PER_ROW + 1).collect();
        same_row.iter().for_each(|address| note(*address, 10, owner));
        assert_eq!(account.held(), Some(10 * ENTRIES_PER_ROW as u64));
        same_row.iter().for_each(|address| _ = forget_block(*address));
        assert_eq!(account.held(), Some(0));
    }
}
