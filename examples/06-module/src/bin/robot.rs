//! A robot's program as a team builds it. It does not know the module `eyes` but acts on its
//! messages.

use monas_soccer as _; // links the soccer topics that modules publish

fn main() -> std::process::ExitCode {
    monas_cli::main()
}
