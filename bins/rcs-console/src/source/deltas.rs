//! The ticks of a log in memory: differences from tick to tick, and a whole image once per second. They need a fiftieth
//! of the memory of whole images. Any tick is decoded in at most 25 steps.

use interfaces::{CommonMemory, ExternalInputs};
use rcs_core::{
    Plain,
    plain::{DecodeError, from_bytes},
    tick::Tick,
};
use record::{delta::Codec, reader::LoggedTick, writer::FULL_SET};

use crate::rcs_console::picture::{Picture, Timing};

struct Kept {
    tick: Tick,
    full: bool, // true if the deltas are relative to zeros
    external: Vec<u8>,
    memory: Vec<u8>,
    timing: Option<Timing>,
}

struct Images {
    external: Vec<u8>,
    memory: Vec<u8>,
}

impl Images {
    fn zeros() -> Self {
        Self { external: vec![0; ExternalInputs::SIZE], memory: vec![0; CommonMemory::SIZE] }
    }
}

pub struct Deltas {
    external: Codec,
    memory: Codec,
    kept: Vec<Kept>,
    last: Images,
}

impl Deltas {
    pub fn new() -> Self {
        Self {
            external: Codec::new(ExternalInputs::STRUCT),
            memory: Codec::new(CommonMemory::STRUCT),
            kept: Vec::new(),
            last: Images::zeros(),
        }
    }

    /// Add the next tick, and return its picture.
    pub fn push(&mut self, logged: LoggedTick) -> Result<Picture, DecodeError> {
        let timing = logged.timing.map(|timing| Timing {
            controller_ns: timing.controller_ns,
            skipped: timing.skipped,
            allocations: None,
        });
        let now = Images { external: logged.external, memory: logged.memory };
        let picture = picture(logged.tick, &now, timing)?;
        let full = (self.kept.len() as u64).is_multiple_of(FULL_SET);
        let zeros = Images::zeros();
        let base = if full { &zeros } else { &self.last };
        let (mut external, mut memory) = (Vec::new(), Vec::new());
        self.external.encode(&base.external, &now.external, &mut external);
        self.memory.encode(&base.memory, &now.memory, &mut memory);
        self.kept.push(Kept { tick: logged.tick, full, external, memory, timing });
        self.last = now;
        Ok(picture)
    }

    pub fn range(&self) -> Option<(u64, u64)> {
        Some((self.kept.first()?.tick.0, self.kept.last()?.tick.0))
    }

    /// The picture of the last tick up to `tick`.
    pub fn picture(&self, tick: u64) -> Option<Picture> {
        let end = self.kept.partition_point(|kept| kept.tick.0 <= tick);
        let wanted = self.kept.get(..end)?;
        let base = wanted.iter().rposition(|kept| kept.full)?;
        let mut images = Images::zeros();
        for kept in wanted.get(base..)? {
            let sound = self.external.apply(&kept.external, &mut images.external)
                && self.memory.apply(&kept.memory, &mut images.memory);
            sound.then_some(())?;
        }
        let last = wanted.last()?;
        picture(last.tick, &images, last.timing).ok()
    }
}

fn picture(tick: Tick, images: &Images, timing: Option<Timing>) -> Result<Picture, DecodeError> {
    Ok(Picture { tick, external: from_bytes(&images.external)?, memory: from_bytes(&images.memory)?, timing })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::plain::Writer;

    fn image<T: Plain>(value: &T) -> Vec<u8> {
        let mut bytes = vec![0; T::SIZE];
        value.encode(&mut Writer::new(&mut bytes));
        bytes
    }

    #[test]
    fn stored_ticks_round_trip() {
        let mut deltas = Deltas::new();
        for tick in (1..=60).filter(|tick| *tick != 31) {
            let mut external = ExternalInputs::default();
            external.hws.number = tick;
            let mut memory = CommonMemory::default();
            memory.t3i.status.counters.frames = tick * 3;
            let logged = LoggedTick {
                tick: Tick(tick.into()),
                gap: 0,
                external: image(&external),
                memory: image(&memory),
                state: None,
                world: None,
                timing: None,
            };
            deltas.push(logged).expect("the images are whole");
        }
        assert_eq!(deltas.range(), Some((1, 60)));
        for (asked, found) in [(1, 1), (25, 25), (26, 26), (31, 30), (60, 60), (99, 60)] {
            let picture = deltas.picture(asked).expect("there is a tick before");
            assert_eq!(picture.tick, Tick(found.into()));
            assert_eq!(picture.external.hws.number, found);
            assert_eq!(picture.memory.t3i.status.counters.frames, found * 3);
        }
        assert!(deltas.picture(0).is_none());
    }
}
