//! Common rows of ACQUIRE-TOOL and RELEASE-TOOL.

use rcs_core::decision_table;

decision_table! {
    /// SLIDE: without power the force sensor loses its zero reading, and a guarded move cannot start. Half-way between
    /// tool and strike plate open fingers touch neither, so the sensor is calibrated there before the slide continues.
    pub SLIDE: fn slide(struct of super::Senses) -> super::Action or () {
        1: work: Busy                                                      => consult;
        2: work: Over, drum: Sliding, spread: Open, bias: Missing          => CalSensor(Drum);
        3: work: Over, drum: Sliding, spread: Open, bias: AtDrum | AtSafe  => consult;
        4: work: Over, drum: Sliding, spread: Narrow | Unknown             => consult;
        5: work: Over, drum: Off | Before | Entering | Inside | Clear      => consult;
    }
}
