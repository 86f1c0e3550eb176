//! The command `monas` with the activities of the soccer team linked in.

mod statecharts;

use monas_soccer as _; // its activities, topics and functions register themselves at link time

fn main() -> std::process::ExitCode {
    monas_cli::main()
}
