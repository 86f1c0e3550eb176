//! A robot's program as a team builds it. It knows nothing of the eyes; what they say, it does.

use monas_soccer as _; // the topics of soccer, which modules publish on

fn main() -> std::process::ExitCode {
    monas_cli::main()
}
