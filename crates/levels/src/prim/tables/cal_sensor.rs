use rcs_core::decision_table;

decision_table! {
    /// CAL-SENSOR (V.1.1): take the reading of the force sensor at rest as zero. A moving robot is stopped first.
    pub CAL_SENSOR: fn cal_sensor(enum CalSensorStep, super::Situation) -> super::Action {
        /// The robot comes to rest, and the sensor is read at rest.
        Reading {
            1: rest: UnderWay                    => Halt;
            2: rest: Settling                    => Wait;
            3: rest: Late                        => Fail(NotAtGoal);
            4: rest: Arrived, samples: Faulty    => Fail(SensorError);
            5: rest: Arrived, samples: Wanted    => Sample;
            6: rest: Arrived, samples: Complete  => Calibrate;
        }
    }
}
