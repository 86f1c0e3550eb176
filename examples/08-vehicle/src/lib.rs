//! A warehouse vehicle, from the role to the replay of a run. It brings loads from the shelves of
//! an aisle to the dock, and drives to its charger when the battery gets low.
//!
//! | file | contents |
//! |---|---|
//! | `models/courier.srm` | the behaviour: formulas, and when which branch is taken |
//! | `proto/vehicle.proto` | the messages between vehicle and behaviour |
//! | `src/activities.rs` | the activities that the role names |
//! | `src/simulated_warehouse.rs` | the body: an aisle, a battery, orders |
//! | `config/vehicle.xml` | the agents |
//! | `tests/low_battery.scenario` | what the role does when the battery gets low |
//!
//! ```sh
//! cargo build -p example-vehicle        # target/debug/vehicle, the command `monas` of this team
//! cd examples/08-vehicle
//! ../../target/debug/vehicle model check models/courier.srm
//! ../../target/debug/vehicle model run models/courier.srm tests/low_battery.scenario
//! ../../target/debug/vehicle run config/vehicle.xml --for 20s --record vehicle.mcap
//! ../../target/debug/vehicle tape replay vehicle.mcap --agents Courier --verify
//! ```
//!
//! and from another terminal, while it runs: `vehicle chart show Courier`, `vehicle topic echo
//! 'warehouse/*'`.

use narukom::{State, topic};

mod activities;
mod simulated_warehouse;

/// Messages between the vehicle and its behaviour.
pub mod messages {
    narukom::include_messages!("example.vehicle");
}

use messages::{Drive, Orders, Vehicle};

topic! {
    /// The measurements of the vehicle.
    pub VEHICLE: State<Vehicle> = "warehouse/vehicle";
    /// Commands to the vehicle.
    pub DRIVE: State<Drive> = "warehouse/drive";
    /// Loads that wait.
    pub ORDERS: State<Orders> = "warehouse/orders";
}

/// Position of the charger, m.
pub const CHARGER: f64 = 0.0;
/// Position of the dock, m.
pub const DOCK: f64 = 1.0;
/// The shelves are between these positions, m.
pub const SHELVES: (f64, f64) = (3.0, 9.0);
/// The vehicle is at a position if it is this near, m.
pub const POSITION_TOLERANCE: f64 = 0.02;
