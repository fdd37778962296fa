//! The steps of a command: the commands that Task and Subtask give to E-move, in order (V.3.1, V.4.1).
//!
//! The steps are those of the normal case: the right gripper is attached, no unexpected object is held, and vision
//! finds the object at its location.

use interfaces::{HwsCommand, emove::EmoveVerb};
use rcs_core::name::Name16;
use taskdata::files::{Location, LookupError, RefType, TaskData};

use crate::holster::{MissingRecord, PUT, TAKE, TAKEN, WORN, holster, object_of};

const PEDESTAL: &str = "PEDESTAL"; // holds an object (V.3.1 FIX-GRIP)
const PEDESTAL_SAFE: &str = "PED-SAFE"; // the robot waits here while the pedestal turns
const TOOL_TRANSFER: &str = "TOOL-TRNS"; // tool transfer to the drum

/// A command of E-move, or of a neighbour while the robot rests.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    Go {
        verb: EmoveVerb,
        /// The object determines grip, approach and depart.
        object: Option<Name16>,
        grip: i32,
        location: Location,
    },
    /// A named move, at a location.
    Relative {
        name: &'static str,
        location: Location,
    },
    Fingers {
        verb: EmoveVerb,
        object: Option<Name16>,
        grip: i32,
    },
    Locate,
    Pedestal(PedestalVerb),
    Engage(u8), // end effector id, in its holster
    Leave(u8),  // end effector id
    Take(u8),   // end effector id
    LetGoTool,
    GraspTool,
    Other(&'static str),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PedestalVerb {
    PreGrip, // hand open, table turned
    Grip,    // hand closed
    Flip,
    Release,
}

impl PedestalVerb {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::PreGrip => "pedestal PRE-GRIP",
            Self::Grip => "pedestal GRIP",
            Self::Flip => "pedestal FLIP",
            Self::Release => "pedestal RELEASE",
        }
    }
}

/// The steps of a command; `held` is the object that the robot holds, with its grip, if known. Errors: [`LookupError`]
/// for an unknown location or object, with the known ones.
pub fn steps(
    command: &HwsCommand,
    held: Option<(Name16, i32)>,
    data: &TaskData<'_>,
) -> Result<Vec<Step>, LookupError> {
    let maker = Maker { command, held, data };
    let object = command.object.is_some();
    let mut steps = Vec::new();
    match command.command.as_str() {
        "TRANSFER" => {
            maker.get(&mut steps)?;
            maker.regrip(&mut steps)?;
            maker.place(&mut steps)?;
            steps.push(maker.fingers(EmoveVerb::Release, command.destination_grip));
            maker.end_at(&mut steps)?;
        }
        "MOVE" if object => {
            maker.get(&mut steps)?;
            maker.regrip(&mut steps)?;
            maker.place(&mut steps)?;
        }
        "REFIXTURE" => {
            maker.get(&mut steps)?;
            maker.regrip(&mut steps)?;
            maker.place(&mut steps)?;
        }
        "MOVE" => steps.push(maker.to_location(command.destination, command.destination_sector)?),
        "ACQUIRE" => maker.get(&mut steps)?,
        "POSITION" => {
            steps.push(match maker.held {
                Some((object, grip)) => {
                    Step::Fingers { verb: EmoveVerb::Release, object: Some(object), grip }
                }
                None => Step::Other("RELEASE, if an object is held"),
            });
            maker.position(&mut steps)?;
        }
        "INSERT-TOOL" => maker.relative(&mut steps, &["INS-FAR", "INS-NEAR", "INS-IN"])?,
        "RELEASE-TOOL" => {
            steps.push(Step::LetGoTool);
            maker.relative(&mut steps, &["REL-SLIDE", "REL-BACK"])?;
            maker.end_at(&mut steps)?;
        }
        "ACQUIRE-TOOL" => {
            steps.push(maker.to_location(command.destination, command.destination_sector)?);
            maker.relative(&mut steps, &["ACQ-NEAR", "ACQ-STRIKE", "ACQ-SLIDE"])?;
            steps.push(Step::GraspTool);
        }
        "REMOVE-TOOL" => {
            maker.relative(&mut steps, &["REM-OUT"])?;
            maker.end_at(&mut steps)?;
        }
        _ => steps.push(Step::Other("the robot does not move")),
    }
    Ok(steps)
}

struct Maker<'a> {
    command: &'a HwsCommand,
    held: Option<(Name16, i32)>,
    data: &'a TaskData<'a>,
}

impl Maker<'_> {
    fn location(&self, name: Option<Name16>, sector: Option<i32>) -> Result<Location, LookupError> {
        let name = name.unwrap_or_default();
        self.data.resolve_location(&name, sector, self.command.object.as_ref())
    }

    fn held_object(&self) -> Option<(Name16, i32)> {
        self.held.filter(|(object, _)| Some(*object) == self.command.object)
    }

    const fn go(&self, verb: EmoveVerb, grip: i32, location: Location) -> Step {
        Step::Go { verb, object: self.command.object, grip, location }
    }

    const fn fingers(&self, verb: EmoveVerb, grip: i32) -> Step {
        Step::Fingers { verb, object: self.command.object, grip }
    }

    fn to_location(&self, name: Option<Name16>, sector: Option<i32>) -> Result<Step, LookupError> {
        let location = self.location(name, sector)?;
        Ok(Step::Go { verb: EmoveVerb::MovToLoc, object: None, grip: 0, location })
    }

    /// Adds GET-OBJECT, after a look at the object if vision is used there.
    fn get(&self, steps: &mut Vec<Step>) -> Result<(), LookupError> {
        let (command, grip) = (self.command, self.command.source_grip);
        if self.held_object().is_some() {
            return Ok(());
        }
        let location = self.location(command.source, command.source_sector)?;
        let view = command
            .object
            .and_then(|object| self.data.view(&object, &location.place))
            .filter(|(_, view)| view.enabled);
        if let Some((_, view)) = view.filter(|(_, view)| view.offset_from != RefType::Object) {
            steps.push(self.go(EmoveVerb::MovToVu, view.grip, location));
            steps.push(Step::Locate);
        }
        steps.push(self.go(EmoveVerb::MovToObj, grip, location));
        steps.push(self.fingers(EmoveVerb::GraspObj, grip));
        Ok(())
    }

    /// Adds FIX-GRIP if the grips at source and destination differ.
    fn regrip(&self, steps: &mut Vec<Step>) -> Result<(), LookupError> {
        let from = self.held_object().map_or(self.command.source_grip, |(_, grip)| grip);
        let to = self.command.destination_grip;
        if from == to {
            return Ok(());
        }
        let pedestal = self.location(Some(Name16::clipped(PEDESTAL)), None)?;
        steps.push(Step::Pedestal(PedestalVerb::PreGrip));
        steps.push(self.go(EmoveVerb::MovObjTo, from, pedestal));
        steps.push(Step::Pedestal(PedestalVerb::Grip));
        steps.push(self.fingers(EmoveVerb::Release, from));
        steps.push(self.to_location(Some(Name16::clipped(PEDESTAL_SAFE)), None)?);
        steps.push(Step::Pedestal(PedestalVerb::Flip));
        steps.push(self.go(EmoveVerb::MovToObj, to, pedestal));
        steps.push(self.fingers(EmoveVerb::GraspObj, to));
        steps.push(Step::Pedestal(PedestalVerb::Release));
        Ok(())
    }

    fn place(&self, steps: &mut Vec<Step>) -> Result<(), LookupError> {
        let command = self.command;
        let location = self.location(command.destination, command.destination_sector)?;
        steps.push(self.go(EmoveVerb::MovObjTo, command.destination_grip, location));
        Ok(())
    }

    fn end_at(&self, steps: &mut Vec<Step>) -> Result<(), LookupError> {
        if self.command.end_at.is_some() {
            steps.push(self.to_location(self.command.end_at, self.command.end_at_sector)?);
        }
        Ok(())
    }

    /// Adds POSITION to the source, or to the destination if that is null (SPECNOTES.md, contradiction 24).
    fn position(&self, steps: &mut Vec<Step>) -> Result<(), LookupError> {
        let c = self.command;
        let (name, sector, grip) = if c.source.is_none() {
            (c.destination, c.destination_sector, c.destination_grip)
        } else {
            (c.source, c.source_sector, c.source_grip)
        };
        if c.object.is_none() {
            steps.push(self.to_location(name, sector)?);
        } else {
            steps.push(self.go(EmoveVerb::MovToObj, grip, self.location(name, sector)?));
        }
        Ok(())
    }

    fn relative(&self, steps: &mut Vec<Step>, names: &[&'static str]) -> Result<(), LookupError> {
        let location = self.data.resolve_location::<16, 16>(&Name16::clipped(TOOL_TRANSFER), None, None)?;
        steps.extend(names.iter().map(|&name| Step::Relative { name, location }));
        Ok(())
    }
}

/// The steps of GET-ENDEFF (V.3.1): leave the attached gripper in its holster, and take the wanted one from its own.
/// Grippers are given by end effector id; `own` is `None` for a bare robot. Errors: [`MissingRecord`] if the task data do
/// not have a holster.
pub fn exchange(own: Option<u8>, wanted: u8, data: &TaskData<'_>) -> Result<Vec<Step>, MissingRecord> {
    let mut steps = Vec::new();
    if let Some(own) = own {
        let (go, location) = to_holster(own, WORN, data)?;
        let [down, seat, up] = PUT.map(|name| Step::Relative { name, location });
        steps.extend([go, down, seat, Step::Leave(own), up]);
    }
    let (go, location) = to_holster(wanted, TAKEN, data)?;
    let [fast, slow, back, lift, up] = TAKE.map(|name| Step::Relative { name, location });
    steps.extend([go, fast, Step::Engage(wanted), slow, Step::Take(wanted), back, lift, up]);
    Ok(steps)
}

fn to_holster(id: u8, grip: i32, data: &TaskData<'_>) -> Result<(Step, Location), MissingRecord> {
    let location = holster(id, grip, data)?;
    let object = Some(object_of(id));
    Ok((Step::Go { verb: EmoveVerb::MovToHol, object, grip, location }, location))
}
