//! Sensors of guarded moves and relative moves (extension).

use rcs_core::name::Name10;

use crate::files::{RelativeMove, SensorPara, index::relative_key};

use super::{super::collected::Collected, Linker, numbered};

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
        let (mut keys, mut ats) = (Vec::new(), Vec::new());
        for entry in &all.relative_moves {
            let (at, movetable) = (self.reference(entry.place), self.movetable(entry.movetable));
            let sensor = match entry.sensor {
                None => Some(Name10::EMPTY),
                Some(sensor) => self.find("sensor", sensor, |i| &i.sensors).map(|_| sensor.name),
            };
            if let (Some(at), Some(movetable), Some(sensor)) = (at, movetable, sensor)
                && let Some(key) = relative_key(&entry.name.name, at)
            {
                let para = self.para(entry.para);
                let name = entry.name.name;
                self.files.relative_moves.push(RelativeMove { name, at, movetable, para, sensor });
                ats.push(entry.at);
                keys.push(key);
            }
        }
        let keys = numbered(keys.into_iter());
        self.indexes.relative_moves = self.unique("this relative move at this location", &keys, &ats);
        self.origins.relative_moves = ats;
    }
}
