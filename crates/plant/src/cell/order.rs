//! Checks the names in a workstation action against the description, before the first tick of a job.

use diagnostics::nearest;
use geometry::frame::Frame;

use super::{WorkstationAction, WorkstationError};
use crate::description::{CellDescription, Nest, PartType};

pub(crate) enum TargetPlace<'c> {
    Nest(&'c Nest),
    /// On the floor of a tray, with this frame.
    Sector(Frame),
}

pub(crate) enum Machine<'c> {
    Vise,
    Nest(&'c Nest),
}

impl CellDescription {
    /// Check that all names in a workstation action are in the cell. On error: [`WorkstationError::suspects`] returns the
    /// wrong word.
    pub fn admits(&self, action: &WorkstationAction) -> Result<(), WorkstationError> {
        match action {
            WorkstationAction::Place { part, unit, sector, .. } => {
                self.spot(self.kind(part)?, unit, *sector).map(drop)
            }
            WorkstationAction::Put { part, .. } => self.kind(part).map(drop),
            WorkstationAction::ViseProgram { name } => {
                let known = || self.vise.program.iter().map(|program| &program.name);
                if known().any(|program| program == name) {
                    return Ok(());
                }
                Err(WorkstationError::UnknownProgram {
                    name: name.clone(),
                    known: known().cloned().collect(),
                })
            }
            WorkstationAction::Machine { from, to, location } => {
                let (from, to) = (self.kind(from)?, self.kind(to)?);
                self.machine_at(location, &from.name)?;
                to.is_made_of(from)
            }
            WorkstationAction::DrumTool { part } => {
                let tool = self.kind(part)?;
                let tools = || self.part.iter().filter(|kind| kind.tool).map(|kind| kind.name.clone());
                let no_tool = || WorkstationError::NoTool { name: part.clone(), known: tools().collect() };
                if tool.tool { Ok(()) } else { Err(no_tool()) }
            }
            WorkstationAction::Remove { .. }
            | WorkstationAction::ViseOpen
            | WorkstationAction::VisePartial
            | WorkstationAction::ViseClose
            | WorkstationAction::DrumGrip
            | WorkstationAction::DrumRelease
            | WorkstationAction::Joystick(_)
            | WorkstationAction::T3(_)
            | WorkstationAction::Table(_)
            | WorkstationAction::Resolvers(_) => Ok(()),
        }
    }

    pub(crate) fn kind(&self, name: &str) -> Result<&PartType, WorkstationError> {
        self.part(name).ok_or_else(|| WorkstationError::UnknownPart {
            name: name.into(),
            known: self.part.iter().map(|kind| kind.name.clone()).collect(),
        })
    }

    /// Place of a part in a sector of a unit. A part with nests is accepted only in a nest.
    pub(crate) fn spot(
        &self,
        kind: &PartType,
        unit: &str,
        sector: u16,
    ) -> Result<TargetPlace<'_>, WorkstationError> {
        let nests = || self.nest.iter().filter(|nest| nest.takes(kind));
        if nests().next().is_some() {
            let nest = nests().find(|nest| nest.location == unit && nest.sector == sector);
            return nest.map(TargetPlace::Nest).ok_or_else(|| WorkstationError::NoNest {
                part: kind.name.clone(),
                unit: unit.into(),
                sector,
                known: nests().map(|nest| (nest.location.clone(), nest.sector)).collect(),
            });
        }
        let tray = self.tray(unit).ok_or_else(|| WorkstationError::UnknownUnit {
            name: unit.into(),
            known: self.tray.iter().map(|tray| tray.unit.clone()).collect(),
        })?;
        let sectors = tray.sectors.len();
        let unknown = WorkstationError::UnknownSector { unit: unit.into(), sector, sectors };
        tray.sector(sector).map(TargetPlace::Sector).ok_or(unknown)
    }

    pub(crate) fn machine_at(&self, location: &str, part: &str) -> Result<Machine<'_>, WorkstationError> {
        if location == self.vise.location {
            return Ok(Machine::Vise);
        }
        let nests = || self.nest.iter().filter(|nest| nest.machining.is_some());
        let there = || nests().filter(|nest| nest.location == location);
        let its = there().find(|nest| nest.parts.iter().any(|one| one == part));
        its.or_else(|| there().next()).map(Machine::Nest).ok_or_else(|| {
            let known = [&self.vise.location].into_iter().chain(nests().map(|nest| &nest.location));
            WorkstationError::NoMachine { location: location.into(), known: known.cloned().collect() }
        })
    }

    pub fn has_vise_at(&self, location: &str) -> Result<(), WorkstationError> {
        if location == self.vise.location {
            return Ok(());
        }
        Err(WorkstationError::NoVise { location: location.into(), known: self.vise.location.clone() })
    }
}

impl PartType {
    /// Check that this part can be machined from a blank: same shape, no size larger.
    pub(crate) fn is_made_of(&self, blank: &Self) -> Result<(), WorkstationError> {
        let larger = self.size.iter().zip(blank.size).any(|(new, old)| *new > old + 1e-9);
        if larger || self.shape != blank.shape {
            return Err(WorkstationError::TooLarge { from: blank.name.clone(), to: self.name.clone() });
        }
        Ok(())
    }
}

impl WorkstationError {
    /// The wrong word of an action, and the nearest known one; `None` if no single word is wrong.
    #[must_use]
    pub fn suspects(&self) -> Option<(String, Option<&str>)> {
        let near = |word: &String, known: &'_ [String]| -> Option<usize> {
            let name = nearest(word, known.iter().map(String::as_str))?;
            known.iter().position(|one| one == name)
        };
        Some(match self {
            Self::UnknownPart { name, known }
            | Self::UnknownUnit { name, known }
            | Self::UnknownProgram { name, known }
            | Self::NoTool { name, known }
            | Self::NoMachine { location: name, known } => {
                (name.clone(), near(name, known).map(|at| known[at].as_str()))
            }
            Self::NoVise { location, known } => (location.clone(), Some(known)),
            Self::UnknownSector { sector, .. } => (sector.to_string(), None),
            Self::NoNest { unit, sector, known, .. } => {
                if known.iter().any(|(nest, _)| nest == unit) {
                    return Some((sector.to_string(), None));
                }
                (unit.clone(), nearest(unit, known.iter().map(|(nest, _)| nest.as_str())))
            }
            Self::TooLarge { to, .. } => (to.clone(), None),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Placement;

    fn cell() -> CellDescription {
        CellDescription::from_toml(include_str!("../../../../data/cell.toml")).unwrap()
    }

    fn place(part: &str, unit: &str, sector: u16) -> WorkstationAction {
        WorkstationAction::Place {
            part: part.into(),
            unit: unit.into(),
            sector,
            placement: Placement::Random,
        }
    }

    fn machine(from: &str, to: &str, location: &str) -> WorkstationAction {
        WorkstationAction::Machine { from: from.into(), to: to.into(), location: location.into() }
    }

    #[test]
    fn commands_of_the_jobs_are_admitted() {
        let cell = cell();
        for action in [
            place("LINKBAR1_BH", "UNIT_1", 4),
            place("SHAFT_BH", "UNIT_2", 7),
            machine("LINKBAR1_BH", "LINKBAR1", "PFIXTURE"),
            machine("SHAFT_BH", "SHAFT", "V-VFIXTURE"),
            WorkstationAction::ViseProgram { name: "CLEVIS".into() },
            WorkstationAction::DrumTool { part: "DRILL-2".into() },
        ] {
            assert_eq!(cell.admits(&action), Ok(()), "{action:?}");
        }
        assert_eq!(cell.has_vise_at("PFIXTURE"), Ok(()));
    }

    #[test]
    fn unknown_name_is_reported_with_the_nearest_of_the_cell() {
        let cell = cell();
        let blamed = |action: WorkstationAction| {
            let error = cell.admits(&action).expect_err("it names what there is not");
            error.suspects().map(|(word, near)| (word, near.unwrap_or("-").to_owned()))
        };
        let is = |word: &str, near: &str| Some((word.to_owned(), near.to_owned()));
        assert_eq!(blamed(place("LINKBAR1_HB", "UNIT_1", 4)), is("LINKBAR1_HB", "LINKBAR1_BH"));
        assert_eq!(blamed(place("LINKBAR1", "UNIT_3", 4)), is("UNIT_3", "UNIT_2"));
        assert_eq!(blamed(place("LINKBAR1", "UNIT_1", 5)), is("5", "-"));
        assert_eq!(blamed(place("SHAFT", "UNIT_2", 6)), is("6", "-"));
        assert_eq!(blamed(place("SHAFT", "V-VFIXTUR", 0)), is("V-VFIXTUR", "V-VFIXTURE"));
        assert_eq!(blamed(machine("LINKBAR1", "SHAFTS", "PFIXTURE")), is("SHAFTS", "SHAFT"));
        assert_eq!(blamed(machine("SHAFT_BH", "SHAFT", "PFIXTUR")), is("PFIXTUR", "PFIXTURE"));
        assert_eq!(blamed(machine("SHAFT", "SHAFT_BH", "PFIXTURE")), is("SHAFT_BH", "-"));
        let program = WorkstationAction::ViseProgram { name: "CLEVISS".into() };
        assert_eq!(blamed(program), is("CLEVISS", "CLEVIS"));
        let tool = WorkstationAction::DrumTool { part: "SHAFT".into() };
        assert_eq!(blamed(tool), is("SHAFT", "-"));
        let error = cell.has_vise_at("TABLE").expect_err("it is a table");
        assert_eq!(error.suspects(), Some(("TABLE".into(), Some("PFIXTURE"))));
    }
}
