//! History of sensor readings.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use monas_robot::topics as body;
use nalgebra::Isometry2;

use crate::functionality::geometry::heading;
use crate::{SensorEntry, convert, topics};

/// Keeps a history of sensor readings with accumulated odometry, so that an image can be related to
/// the poses of head and robot at the time it was taken.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sensors;

impl Activity for Sensors {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        // The accumulated odometry is stored in the history, so a restarted activity continues from
        // its last entry.
        let last = blackboard.read(topics::SENSORS).copied();
        let felt_until = last.map_or(0, |entry| entry.measured_at);
        let mut odometry = last.map_or(Isometry2::identity(), |entry| entry.odometry());
        let felt =
            blackboard.recent(body::SENSORS, Duration::MAX).filter(|felt| felt.measured_at > felt_until);
        let entries: Vec<SensorEntry> = felt
            .map(|felt| {
                odometry *= convert::odometry(felt.message);
                entry(felt.message, &odometry)
            })
            .collect();
        for entry in entries {
            blackboard.publish(topics::SENSORS, entry)?;
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(body::SENSORS).reads(topics::SENSORS).publishes(topics::SENSORS)
    }
}

fn entry(felt: &monas_robot::Sensors, odometry: &Isometry2<f64>) -> SensorEntry {
    SensorEntry {
        measured_at: felt.measured_at,
        head_yaw: felt.head_yaw,
        head_pitch: felt.head_pitch,
        torso_roll: felt.torso_roll,
        torso_pitch: felt.torso_pitch,
        odometry_x: odometry.translation.x,
        odometry_y: odometry.translation.y,
        odometry_heading: heading(odometry),
    }
}

monas::activity!(Sensors);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::{ActivityFixture, TICK};

    fn felt(measured_at: u64, odometry_x: f64) -> monas_robot::Sensors {
        monas_robot::Sensors { measured_at, odometry_x, head_yaw: 0.3, ..Default::default() }
    }

    #[test]
    fn the_history_sums_the_odometry_up_and_takes_nothing_twice() {
        let mut stage = ActivityFixture::new();
        for step in 1..=5 {
            stage.publish(body::SENSORS, felt(step, 0.1));
        }
        assert_eq!(stage.count_arrivals(topics::SENSORS), 0);
        stage.run(&mut Sensors);
        assert_eq!(stage.count_arrivals(topics::SENSORS), 5);
        let last = stage.latest(topics::SENSORS).unwrap();
        assert!((last.odometry_x - 0.5).abs() < 1e-12 && last.measured_at == 5 && last.head_yaw == 0.3);
        stage.wait(TICK).run(&mut Sensors);
        assert_eq!(stage.count_arrivals(topics::SENSORS), 0);
        stage.publish(body::SENSORS, felt(6, 0.1)).run(&mut Sensors);
        assert!(
            (stage.latest(topics::SENSORS).unwrap().odometry_x - 0.6).abs() < 1e-12,
            "another instance goes on"
        );
    }
}
