//! Sensors of guarded moves and relative moves (extension).

use rcs_core::name::Name10;

use crate::files::{RelativeMove, SensorPara, index::name_at_key};

use super::{super::collected::Collected, Keyed, Linker};

impl Linker<'_> {
    pub(super) fn guarded_moves(&mut self, all: &Collected) {
        for entry in &all.sensors {
            self.files.sensors.push(SensorPara {
                name: entry.name.name,
                source: entry.source,
                which: entry.which,
                threshold: entry.threshold,
            });
        }
        let mut keyed = Keyed::with_capacity("this relative move at this location", all.relative_moves.len());
        for entry in &all.relative_moves {
            let (at, movetable) = (self.reference(entry.place), self.movetable(entry.movetable));
            let sensor = match entry.sensor {
                None => Some(Name10::EMPTY),
                Some(sensor) => self.find("sensor", sensor, |i| &i.sensors).map(|_| sensor.name),
            };
            if let (Some(at), Some(movetable), Some(sensor)) = (at, movetable, sensor) {
                let para = self.para(entry.para);
                let name = entry.name.name;
                self.files.relative_moves.push(RelativeMove { name, at, movetable, para, sensor });
                keyed.push(name_at_key(&name, at), 0, entry.at);
            }
        }
        [(self.indexes.relative_moves, self.origins.relative_moves)] = self.indexed_at([keyed]);
    }
}
