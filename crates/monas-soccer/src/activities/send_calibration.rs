//! Asking Vision to begin afresh.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use crate::{Calibration, topics};

/// Asks Vision to calibrate: to forget what it thought to have seen before the robot stood.
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
    use crate::activities::stage::Stage;

    #[test]
    fn each_time_counts_on() {
        let mut stage = Stage::new();
        stage.run(&mut SendCalibration);
        stage.run(&mut SendCalibration);
        assert_eq!(stage.said(topics::CALIBRATION).unwrap().number, 2);
    }
}
