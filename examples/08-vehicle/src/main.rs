//! The command `monas` with the activities of the vehicle.

use example_vehicle as _; // links its activities and topics

fn main() -> std::process::ExitCode {
    monas_cli::main()
}
