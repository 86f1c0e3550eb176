//! Who holds memory: how many bytes each activity has asked for that nobody has given back.
//!
//! A program that wants to know takes [`Counting`] for its allocator:
//!
//! ```
//! #[global_allocator]
//! static ALLOCATOR: monas::memory::Counting = monas::memory::Counting;
//! # fn main() {}
//! ```
//!
//! While an activity is called in real time, what its thread asks for is noted in a table, by its address. Whoever gives it back, on whichever thread,
//! takes it off the account of who asked for it. So a message that an activity publishes is its own until a newer one takes its place, and what comes and goes
//! comes to nothing. An activity of which more and more stays is said to [grow](crate::ActivityStatistics::grows).
//!
//! Nothing is noted of what is asked for outside of such calls, and a program without this allocator notes nothing at all. The table has room for
//! 32,768 blocks: what does not fit is not counted, so that what is counted is never too much. A module has an allocator of its own, and what its code asks for
//! is not seen here.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU16, AtomicU64, AtomicUsize, Ordering};

/// The system's allocator, and a table of what activities have asked of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counting;

/// An account that memory is put down to; 0 is nobody's.
type Owner = u16;

/// How many accounts there are.
const OWNERS: usize = 4096;
/// Blocks lie in rows of so many, each in the row that its address says.
const ROW: usize = 8;
const ROWS: usize = 4096;
/// The size of a block takes so many bits of its entry, its owner the others.
const SIZE_BITS: u32 = 48;

static IS_COUNTING: AtomicBool = AtomicBool::new(false);
static ACCOUNTS: [AtomicI64; OWNERS] = [const { AtomicI64::new(0) }; OWNERS];
static NEXT_OWNER: AtomicU16 = AtomicU16::new(1);
/// How many blocks are in the table.
static BLOCKS: AtomicUsize = AtomicUsize::new(0);
static ADDRESSES: [[AtomicUsize; ROW]; ROWS] = [const { [const { AtomicUsize::new(0) }; ROW] }; ROWS];
static ENTRIES: [[AtomicU64; ROW]; ROWS] = [const { [const { AtomicU64::new(0) }; ROW] }; ROWS];

thread_local! {
    static WORKS_FOR: Cell<Owner> = const { Cell::new(0) };
}

/// An account of its own, which is opened when it is first used. Of more activities than there are accounts the later ones have none.
#[derive(Debug, Default)]
pub(crate) struct Account(AtomicU16);

impl Account {
    /// Does something whose memory is put down to this account.
    pub(crate) fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        if !IS_COUNTING.load(Ordering::Relaxed) {
            return work();
        }
        let _before = Before(WORKS_FOR.replace(self.owner()));
        work()
    }

    /// How many bytes are put down to it; none if nobody counts.
    pub(crate) fn held(&self) -> Option<u64> {
        match self.0.load(Ordering::Relaxed) {
            0 => None,
            owner => {
                let held = ACCOUNTS[usize::from(owner)].load(Ordering::Relaxed);
                Some(u64::try_from(held).unwrap_or_default())
            }
        }
    }

    fn owner(&self) -> Owner {
        match self.0.load(Ordering::Relaxed) {
            0 => self.open(),
            owner => owner,
        }
    }

    #[cold]
    fn open(&self) -> Owner {
        let take = |next: Owner| (usize::from(next) < OWNERS).then(|| next + 1);
        // An activity is called by one thread at a time.
        let taken = NEXT_OWNER.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).unwrap_or_default();
        self.0.store(taken, Ordering::Relaxed);
        taken
    }
}

/// Puts back whom the thread worked for, also when a panic goes by.
struct Before(Owner);

impl Drop for Before {
    fn drop(&mut self) {
        WORKS_FOR.set(self.0);
    }
}

fn row_of(address: usize) -> usize {
    // Addresses are multiples of 16; the golden ratio spreads them.
    let spread = (address >> 4).wrapping_mul(0x9E37_79B9_7F4A_7C15_u64 as usize);
    (spread >> (usize::BITS - ROWS.trailing_zeros())) % ROWS
}

/// Puts a block down to an owner, if there is room.
fn note(address: usize, size: usize, owner: Owner) {
    let row = row_of(address);
    for (known, entry) in ADDRESSES[row].iter().zip(&ENTRIES[row]) {
        if known.compare_exchange(0, address, Ordering::Acquire, Ordering::Relaxed).is_ok() {
            // Nobody else has this address before it is handed out.
            entry.store(u64::from(owner) << SIZE_BITS | size as u64, Ordering::Relaxed);
            BLOCKS.fetch_add(1, Ordering::Relaxed);
            ACCOUNTS[usize::from(owner)].fetch_add(size as i64, Ordering::Relaxed);
            return;
        }
    }
}

/// Takes a block off the account of its owner; nobody's, if it is not in the table.
fn strike(address: usize) -> Owner {
    if BLOCKS.load(Ordering::Relaxed) == 0 {
        return 0;
    }
    let row = row_of(address);
    for (known, entry) in ADDRESSES[row].iter().zip(&ENTRIES[row]) {
        if known.load(Ordering::Relaxed) == address {
            let entry = entry.load(Ordering::Relaxed);
            let (owner, size) = ((entry >> SIZE_BITS) as Owner, entry & ((1 << SIZE_BITS) - 1));
            ACCOUNTS[usize::from(owner)].fetch_sub(size as i64, Ordering::Relaxed);
            BLOCKS.fetch_sub(1, Ordering::Relaxed);
            known.store(0, Ordering::Release);
            return owner;
        }
    }
    0
}

/// Whom this thread works for.
fn works_for() -> Owner {
    // A thread that ends has lost it already.
    WORKS_FOR.try_with(Cell::get).unwrap_or_default()
}

#[allow(unsafe_code)] // an allocator is
// SAFETY: every block is the system's, as it gave it; the table holds addresses, and reads no memory behind them.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !IS_COUNTING.load(Ordering::Relaxed) {
            IS_COUNTING.store(true, Ordering::Relaxed);
        }
        // SAFETY: what is asked of this allocator may be asked of the system's.
        let block = unsafe { System.alloc(layout) };
        let owner = works_for();
        if owner != 0 && !block.is_null() {
            note(block as usize, layout.size(), owner);
        }
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // Before the system has it back: then it may be somebody else's.
        strike(block as usize);
        // SAFETY: it came from there, with this layout.
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let owner = strike(block as usize);
        // SAFETY: it came from there, with this layout.
        let moved = unsafe { System.realloc(block, layout, size) };
        let (address, held) = if moved.is_null() { (block, layout.size()) } else { (moved, size) };
        // It stays with whom it belonged to.
        if owner != 0 {
            note(address as usize, held, owner);
        }
        moved
    }
}

/// Growth is looked for in windows of so many calls.
const WINDOW: u32 = 32;
/// More is held in each of so many windows, one after the other, than ever in the one before,
const RISES: u32 = 8;
/// and so many bytes more in all.
const LEAST: u64 = 4096;

/// Whether what an activity holds grows from call to call.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Growth {
    /// What is held now.
    held: Option<u64>,
    /// Calls of this window, and the least that was held after one of them.
    calls: u32,
    floor: u64,
    /// The least of the window before, how many windows have risen one after the other, and from what.
    last: u64,
    rises: u32,
    from: u64,
    is_said: bool,
}

impl Growth {
    /// After a call so much is held. True if it is found to grow for the first time.
    pub(crate) fn add(&mut self, held: Option<u64>) -> bool {
        self.held = held;
        let Some(held) = held else { return false };
        self.floor = if self.calls == 0 { held } else { self.floor.min(held) };
        self.calls += 1;
        if self.calls < WINDOW {
            return false;
        }
        self.calls = 0;
        if self.floor > self.last {
            self.rises += 1;
        } else {
            (self.rises, self.from) = (0, self.floor);
        }
        self.last = self.floor;
        let is_new = self.grows() && !self.is_said;
        self.is_said |= is_new;
        is_new
    }

    /// Whether it does.
    pub(crate) fn grows(&self) -> bool {
        self.rises >= RISES && self.last.saturating_sub(self.from) >= LEAST
    }

    /// What is held; none if nobody counts.
    pub(crate) fn held(&self) -> Option<u64> {
        self.held
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn growing(held: impl Fn(u64) -> u64, calls: u64) -> (bool, u64) {
        let mut growth = Growth::default();
        let said = (0..calls).filter(|call| growth.add(Some(held(*call)))).count();
        (growth.grows(), said as u64)
    }

    #[test]
    fn what_rises_in_each_window_grows_and_is_said_once() {
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
    fn a_block_is_its_owners_until_anybody_gives_it_back() {
        // Addresses that the system gives to nobody, since it gives multiples of 16.
        let account = Account::default();
        let owner = account.open();
        note(0x1001, 100, owner);
        note(0x2001, 20, owner);
        assert_eq!(account.held(), Some(120));
        assert_eq!((strike(0x1001), strike(0x1001)), (owner, 0));
        assert_eq!(account.held(), Some(20));
        assert_eq!(strike(0x2001), owner);
    }

    #[test]
    fn what_does_not_fit_is_not_counted() {
        let account = Account::default();
        let owner = account.open();
        let same_row: Vec<usize> =
            (0..).map(|n| n * 16 + 3).filter(|at| row_of(*at) == 7).take(ROW + 1).collect();
        same_row.iter().for_each(|address| note(*address, 10, owner));
        assert_eq!(account.held(), Some(10 * ROW as u64));
        same_row.iter().for_each(|address| _ = strike(*address));
        assert_eq!(account.held(), Some(0));
    }
}
