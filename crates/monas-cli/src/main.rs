//! The command `monas` with the activities of the soccer team linked in.

mod statecharts;

use monas_soccer as _; // its activities, topics and functions register themselves at link time

/// `monas top` names activities that leak.
#[global_allocator]
static ALLOCATOR: monas_cli::Counting = monas_cli::Counting;

fn main() -> std::process::ExitCode {
    monas_cli::main()
}
