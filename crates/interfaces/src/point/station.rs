//! The words of the workstation's devices, which are not in the controller's records.

use core::ops::RangeInclusive;

use super::Group;

/// A word of a device of the workstation: `vise.PFIXTURE.clamped`, `drum.tool`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station<'n> {
    row: &'static Row,
    /// The location of the device, or the unit and sector of a tray; empty for a device that exists once.
    pub place: &'n str,
}

/// Beginning and end of a name, group, and maximum value.
type Row = (&'static str, &'static str, Group, i64);

/// A number of a program or a tool: one register.
const NUMBER: i64 = 0xFFFF;

/// Words that the workstation reads. The place is between the two parts of the name.
static READ: [Row; 14] = [
    ("vise.", ".opened", Group::Vise, 1),
    ("vise.", ".partial", Group::Vise, 1),
    ("vise.", ".clamped", Group::Vise, 1),
    ("vise.", ".program", Group::Vise, NUMBER),
    ("machine.", ".ready", Group::Machine, 1),
    ("machine.", ".busy", Group::Machine, 1),
    ("machine.", ".done", Group::Machine, 1),
    ("machine.", ".fault", Group::Machine, 1),
    ("machine.", ".clear", Group::Machine, 1),
    ("drum.gripped", "", Group::Drum, 1),
    ("drum.released", "", Group::Drum, 1),
    ("drum.tool", "", Group::Drum, NUMBER),
    ("air", "", Group::Supply, 1),
    ("safety.ok", "", Group::Supply, 1),
];

static WRITTEN: [Row; 9] = [
    ("vise.", ".open", Group::Vise, 1),
    ("vise.", ".partial", Group::Vise, 1),
    ("vise.", ".close", Group::Vise, 1),
    ("vise.", ".program", Group::Vise, NUMBER),
    ("machine.", ".start", Group::Machine, 1),
    ("machine.", ".program", Group::Machine, NUMBER),
    ("drum.grip", "", Group::Drum, 1),
    ("drum.release", "", Group::Drum, 1),
    ("drum.tool", "", Group::Drum, NUMBER),
];

/// A presence sensor of a tray, `tray.UNIT.SECTOR`. The sector is 0 for a unit without sectors.
static TRAY: Row = ("tray.", "", Group::Trays, 1);

impl<'n> Station<'n> {
    /// The word of a name that the workstation reads.
    #[must_use]
    pub fn read(name: &'n str) -> Option<Self> {
        READ.iter().find_map(|row| Self::of(row, name)).or_else(|| {
            let place = name.strip_prefix(TRAY.0)?;
            let (unit, sector) = place.split_once('.')?;
            let is_sector = sector.parse::<u8>().is_ok();
            (is_place(unit) && is_sector).then_some(Self { row: &TRAY, place })
        })
    }

    /// The word of a name that the workstation writes.
    #[must_use]
    pub fn written(name: &'n str) -> Option<Self> {
        WRITTEN.iter().find_map(|row| Self::of(row, name))
    }

    fn of(row: &'static Row, name: &'n str) -> Option<Self> {
        let place = name.strip_prefix(row.0)?.strip_suffix(row.1)?;
        let fits = if row.1.is_empty() { place.is_empty() } else { is_place(place) };
        fits.then_some(Self { row, place })
    }

    /// The words that a device of a group must have, as beginning and end of their names. Each presence sensor of a
    /// tray, the air and the safety circuit are optional.
    pub fn needed(group: Group, written: bool) -> impl Iterator<Item = (&'static str, &'static str)> {
        let rows: &[Row] = if written { &WRITTEN } else { &READ };
        let of_group = move |row: &&Row| row.2 == group && !matches!(group, Group::Supply | Group::Trays);
        rows.iter().filter(of_group).map(|row| (row.0, row.1))
    }

    /// The group of its devices.
    #[must_use]
    pub const fn group(&self) -> Group {
        self.row.2
    }

    /// Permitted values.
    #[must_use]
    pub const fn range(&self) -> RangeInclusive<i64> {
        RangeInclusive::new(0, self.row.3)
    }
}

/// True for the name of a location.
fn is_place(place: &str) -> bool {
    !place.is_empty() && !place.contains('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn station_words_are_found_with_their_place() {
        for (name, group, place) in [
            ("vise.PFIXTURE.clamped", Group::Vise, "PFIXTURE"),
            ("machine.V-VFIXTURE.done", Group::Machine, "V-VFIXTURE"),
            ("drum.tool", Group::Drum, ""),
            ("tray.UNIT_1.4", Group::Trays, "UNIT_1.4"),
            ("safety.ok", Group::Supply, ""),
        ] {
            let found = Station::read(name).unwrap();
            assert_eq!((found.group(), found.place), (group, place), "{name}");
        }
        for name in
            ["vise.clamped", "vise..clamped", "vise.A.B.clamped", "tray.UNIT_1", "tray.UNIT_1.x", "drum"]
        {
            assert_eq!(Station::read(name), None, "{name}");
        }
        assert_eq!(Station::written("vise.PFIXTURE.clamped"), None);
        assert_eq!(*Station::written("machine.PFIXTURE.program").unwrap().range().end(), 0xFFFF);
    }
}
