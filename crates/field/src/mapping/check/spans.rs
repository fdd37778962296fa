//! Which registers and bits of a device are taken.

use std::collections::BTreeMap;

use couplers::{Area, Span};

use super::super::Slot;

/// The tables in the order of the spans.
const AREAS: [Area; 4] = [Area::Coil, Area::Discrete, Area::Input, Area::Holding];

fn number(area: Area) -> u8 {
    (0..).zip(AREAS).find(|(_, one)| *one == area).map_or(0, |(number, _)| number)
}

/// A register or bit of a device that a point has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Cell {
    device: usize,
    /// The table, in the order of [`AREAS`].
    area: u8,
    address: u16,
}

/// The registers and bits that points have.
#[derive(Debug, Default)]
pub(super) struct Taken {
    /// For each register the points that have a bit of it, or the whole.
    cells: BTreeMap<Cell, Vec<(Option<u8>, String)>>,
    /// The first register of each point.
    first: BTreeMap<String, Cell>,
}

impl Taken {
    /// Takes registers for a point.
    ///
    /// # Errors
    /// The point that already uses one of the addresses.
    pub(super) fn take(
        &mut self,
        name: &str,
        device: usize,
        (area, address, bit): (Area, u16, Option<u8>),
        registers: u16,
    ) -> Result<(), String> {
        for offset in 0..registers {
            let cell = Cell { device, area: number(area), address: address.saturating_add(offset) };
            let there = self.cells.entry(cell).or_default();
            let same = |other: &Option<u8>| other.is_none() || bit.is_none() || *other == bit;
            if let Some((_, other)) = there.iter().find(|(other, _)| same(other)) {
                return Err(other.clone());
            }
            there.push((bit, name.to_owned()));
        }
        self.first.insert(name.to_owned(), Cell { device, area: number(area), address });
        Ok(())
    }

    /// The spans that a device needs: one for each table, from the first register to the last.
    pub(super) fn spans(&self, device: usize) -> Vec<Span> {
        let spans = AREAS.into_iter().filter_map(|area| {
            let mut there =
                self.cells.keys().filter(|cell| cell.device == device && cell.area == number(area));
            let first = there.next()?.address;
            let last = there.next_back().map_or(first, |cell| cell.address);
            Some(Span { area, first, count: (last - first).saturating_add(1) })
        });
        spans.collect()
    }

    /// Sets word and bit of a point in the image that the spans make.
    pub(super) fn place(&self, name: &str, spans: &[Span], slot: &mut Slot) {
        let Some(cell) = self.first.get(name) else { return };
        let mut before = 0;
        for span in spans {
            if number(span.area) != cell.area {
                before += span.words();
                continue;
            }
            let offset = cell.address - span.first;
            if span.area.has_bits() {
                slot.word = before + usize::from(offset / 16);
                slot.bit = u8::try_from(offset % 16).ok();
            } else {
                slot.word = before + usize::from(offset);
            }
            return;
        }
    }
}
