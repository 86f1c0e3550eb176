//! Reset of Vision.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use crate::{Calibration, topics};

/// Requests calibration of Vision: discards its estimates from before the robot stood.
#[derive(Clone, Copy, Debug, Default)]
pub struct SendCalibration;

impl Activity for SendCalibration {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let last = blackboard.read(topics::CALIBRATION).map_or(0, |calibration| calibration.number);
        blackboard.publish(topics::CALIBRATION, Calibration { number: last.wrapping_add(1) })?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(topics::CALIBRATION).publishes(topics::CALIBRATION)
    }
}

monas::activity!(SendCalibration);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;

    #[test]
    fn each_time_counts_on() {
        let mut stage = ActivityFixture::new();
        stage.run(&mut SendCalibration);
        stage.run(&mut SendCalibration);
        assert_eq!(stage.latest(topics::CALIBRATION).unwrap().number, 2);
    }
}
