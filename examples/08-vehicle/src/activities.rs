//! The activities of the courier: each drives to one place or does one thing there, and returns
//! when that is done. None of them knows what comes next.

use std::time::Duration;

use monas::{Blackboard, BoxError, Progress};

use crate::messages::{Drive, Vehicle};
use crate::{CHARGER, DOCK, DRIVE, ORDERS, POSITION_TOLERANCE, VEHICLE};

/// Fastest speed, m/s.
const MAX_SPEED: f64 = 0.8;
/// Speed for each metre of distance, 1/s: the vehicle brakes smoothly.
const GAIN: f64 = 1.5;
/// The battery is charged up to here.
const FULL_CHARGE: f64 = 0.95;

/// Called again when the vehicle has measured, at the latest after this time.
const NEXT_MEASUREMENT: Progress = Progress::after(Duration::from_millis(200));

fn vehicle(board: &Blackboard) -> Vehicle {
    board.read(VEHICLE).copied().unwrap_or_default()
}

/// Commands the vehicle and reports whether the work is done; a vehicle that is done stands.
fn command(board: &mut Blackboard, speed: f64, lift: bool, done: bool) -> Result<Progress, BoxError> {
    let speed = if done { 0.0 } else { speed };
    board.publish(DRIVE, Drive { speed, lift })?;
    Ok(if done { Progress::Done } else { NEXT_MEASUREMENT })
}

fn drive_to(board: &mut Blackboard, goal: f64) -> Result<Progress, BoxError> {
    let Vehicle { position, loaded, .. } = vehicle(board);
    let distance = goal - position;
    command(
        board,
        (GAIN * distance).clamp(-MAX_SPEED, MAX_SPEED),
        loaded,
        distance.abs() < POSITION_TOLERANCE,
    )
}

fn drive_to_shelf(board: &mut Blackboard) -> Result<Progress, BoxError> {
    let shelf = board.read(ORDERS).map(|orders| orders.shelf);
    drive_to(board, shelf.ok_or("there is no order")?)
}

fn drive_to_dock(board: &mut Blackboard) -> Result<Progress, BoxError> {
    drive_to(board, DOCK)
}

fn drive_to_charger(board: &mut Blackboard) -> Result<Progress, BoxError> {
    drive_to(board, CHARGER)
}

fn pick_up(board: &mut Blackboard) -> Result<Progress, BoxError> {
    let done = vehicle(board).loaded;
    command(board, 0.0, true, done)
}

fn put_down(board: &mut Blackboard) -> Result<Progress, BoxError> {
    let done = !vehicle(board).loaded;
    command(board, 0.0, false, done)
}

fn charge(board: &mut Blackboard) -> Result<Progress, BoxError> {
    let done = vehicle(board).charge >= FULL_CHARGE;
    command(board, 0.0, false, done)
}

monas::activity!(fn drive_to_shelf as "DriveToShelf");
monas::activity!(fn drive_to_dock as "DriveToDock");
monas::activity!(fn drive_to_charger as "DriveToCharger");
monas::activity!(fn pick_up as "PickUp");
monas::activity!(fn put_down as "PutDown");
monas::activity!(fn charge as "Charge");
