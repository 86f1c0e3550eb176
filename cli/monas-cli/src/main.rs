//! The command `monas` with the activities of the soccer team.

mod bodies;
mod statecharts;

use monas_soccer as _; // its activities, topics and functions register themselves at link time

/// Counts allocations, so that `monas top` can mark activities that leak.
#[global_allocator]
static ALLOCATOR: monas_cli::CountingAllocator = monas_cli::CountingAllocator;

fn main() -> std::process::ExitCode {
    monas_cli::main()
}
