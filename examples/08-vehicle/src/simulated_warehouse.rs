//! The body and its world: a vehicle in an aisle, and orders that come in.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Timestamp, Topics};

use crate::messages::{Drive, Orders, Vehicle};
use crate::{CHARGER, DRIVE, ORDERS, POSITION_TOLERANCE, SHELVES, VEHICLE};

/// Seconds from one order to the next.
const ORDER_INTERVAL: f64 = 25.0;
/// Charge that a metre takes.
const CHARGE_PER_METRE: f64 = 0.01;
/// Charge gained in a second at the charger.
const CHARGE_PER_SECOND: f64 = 0.02;
/// Fraction of its way that the fork moves in a second.
const LIFT_PER_SECOND: f64 = 0.5;

/// Moves the vehicle as commanded, and counts loads.
#[derive(Default)]
struct SimulatedWarehouse {
    vehicle: Vehicle,
    /// Height of the fork, 0 to 1.
    lift: f64,
    orders: Orders,
    last: Option<Timestamp>,
    /// Seconds until the next order.
    next_order: f64,
}

impl SimulatedWarehouse {
    fn step(&mut self, drive: &Drive, seconds: f64) {
        let Vehicle { position, charge, loaded } = &mut self.vehicle;
        let distance = if *charge > 0.0 { drive.speed * seconds } else { 0.0 };
        *position += distance;
        *charge -= distance.abs() * CHARGE_PER_METRE;
        if (*position - CHARGER).abs() < POSITION_TOLERANCE && drive.speed == 0.0 {
            *charge += CHARGE_PER_SECOND * seconds;
        }
        *charge = charge.clamp(0.0, 1.0);
        let direction = if drive.lift { 1.0 } else { -1.0 };
        self.lift = (self.lift + direction * LIFT_PER_SECOND * seconds).clamp(0.0, 1.0);
        if !*loaded && self.lift >= 1.0 {
            (*loaded, self.orders.waiting) = (true, self.orders.waiting.saturating_sub(1));
        } else if self.lift <= 0.0 {
            *loaded = false;
        }
    }
}

impl Activity for SimulatedWarehouse {
    fn configure(&mut self, parameters: &Parameters) {
        self.vehicle.charge = parameters.number("charge").unwrap_or(1.0);
    }

    fn execute(&mut self, board: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = board.now();
        let seconds = self.last.map_or(0.0, |last| now.as_secs_f64() - last.as_secs_f64());
        self.last = Some(now);
        let drive = board.read(DRIVE).copied().unwrap_or_default();
        self.step(&drive, seconds);
        self.next_order -= seconds;
        if self.next_order <= 0.0 {
            self.next_order += ORDER_INTERVAL;
            self.orders.waiting += 1;
            self.orders.shelf = SHELVES.0 + (SHELVES.1 - SHELVES.0) * board.random().uniform();
        }
        board.publish(ORDERS, self.orders)?;
        board.publish(VEHICLE, self.vehicle)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(DRIVE).publishes(ORDERS).publishes(VEHICLE)
    }
}

monas::activity!(SimulatedWarehouse);
