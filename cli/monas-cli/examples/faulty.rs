//! A program whose activity ends the process in its tenth call, by `FAULT=abort`, `exit`, `segv` or
//! `overflow`, or does not return, by `FAULT=hang`. Tests look at what is reported and recorded.

use std::hint::black_box;
use std::sync::atomic::{AtomicU32, Ordering};

use monas::Blackboard;

static CALLS: AtomicU32 = AtomicU32::new(0);

fn faulty(_: &mut Blackboard) {
    if CALLS.fetch_add(1, Ordering::Relaxed) < 9 {
        return;
    }
    match std::env::var("FAULT").as_deref() {
        Ok("abort") => std::process::abort(),
        Ok("exit") => std::process::exit(7),
        Ok("segv") => segv(),
        Ok("overflow") => drop(black_box(overflow(1))),
        Ok("hang") => hang(),
        _ => {}
    }
}
monas::activity!(fn faulty as "Faulty");

fn steady(_: &mut Blackboard) {}
monas::activity!(fn steady as "Steady");

#[allow(unsafe_code, reason = "the fault is the purpose")]
fn segv() {
    let nowhere = black_box(std::ptr::without_provenance::<u32>(8));
    // SAFETY: there is no memory at this address: the process ends here.
    black_box(unsafe { nowhere.read_volatile() });
}

fn hang() {
    eprintln!("the activity hangs");
    loop {
        std::thread::park();
    }
}

#[allow(unconditional_recursion, reason = "the fault is the purpose")]
fn overflow(depth: u64) -> u64 {
    let frame = black_box([depth; 512]);
    overflow(black_box(depth)).wrapping_add(frame[1])
}

fn main() -> std::process::ExitCode {
    monas_cli::main()
}
