//! A command of the workstation controller with its names looked up (V.4.2): TRANSLATE-HWS-CMD of Figure
//! IV.1.

use rcs_core::{
    Plain,
    interface::{HwsCommand, Reason, subtask::LocationKind},
    name::{Name10, Name16},
    pose::Pose,
};
use taskdata::files::{Reference, TaskData};

use crate::places::{named, reason_of};

/// Commands of Task (V.4.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskVerb {
    /// None yet.
    #[text = ""]
    None,
    /// Do nothing.
    #[text = "PAUSE"]
    Pause,
    /// Move an object from one location to another.
    #[text = "TRANSFER"]
    Transfer,
    /// Move an object to a location and hold it there, or move the robot.
    #[text = "MOVE"]
    Move,
    /// Release what is held and move to a position.
    #[text = "POSITION"]
    Position,
    /// Move to an object and grasp it.
    #[text = "ACQUIRE"]
    Acquire,
    /// Take an object, regrip it on the pedestal and move it to a location.
    #[text = "REFIXTURE"]
    Refixture,
    /// Insert a tool into the tool drum.
    #[text = "INSERT-TOOL"]
    InsertTool,
    /// Let go of a tool in the drum.
    #[text = "RELEASE-TOOL"]
    ReleaseTool,
    /// Move to a tool in the drum and grasp it.
    #[text = "ACQUIRE-TOOL"]
    AcquireTool,
    /// Pull a tool out of the drum.
    #[text = "REMOVE-TOOL"]
    RemoveTool,
    /// Connect the Data System.
    #[text = "STARTUP"]
    Startup,
    /// Disconnect it.
    #[text = "SHUTDOWN"]
    Shutdown,
}

/// `endeff-id#` of the tool gripper (VII.7.2).
pub const TOOL_GRIPPER: u8 = 3;

/// One of the three locations of a command.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Site {
    /// Name; empty if the command does not name the location.
    pub location: Name10,
    /// Its type.
    pub kind: LocationKind,
    /// Record of LOCPT.
    pub record: u32,
    /// Record of ARRAY-TABLE.
    pub array: u32,
    /// Sector from 1, or 0.
    pub sector: i32,
    /// Record number of its T-POSE.
    pub pose: u32,
    /// Grip of the object there.
    pub grip: i32,
    /// Record of END-EFF-PARA for the object with that grip.
    pub parameters: u32,
}

/// A command, looked up.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Plan {
    /// What to do.
    pub verb: TaskVerb,
    /// The object; empty for none.
    pub object: Name16,
    /// Its serial number.
    pub serial: Name16,
    /// Gripper for the object; 0 if any will do.
    pub end_effector_id: u8,
    /// Where the object is.
    pub source: Site,
    /// Where it, or the robot, is to go.
    pub destination: Site,
    /// Where the robot is to be at the end.
    pub end_at: Site,
    /// The object is moved from or to the MBD, of which the data base keeps account.
    pub concerns_mbd: bool,
    /// Poses of the three sites.
    pub poses: [Pose; 3],
}

/// Which fields a command must have.
struct Needs {
    object: bool,
    source: bool,
    destination: bool,
}

impl TaskVerb {
    /// The command that a word means. Ten characters are compared, as all processes below do
    /// (SPECNOTES.md, contradiction 22).
    #[must_use]
    pub fn of(word: &Name16) -> Option<Self> {
        let word = Name10::clipped(word.as_str());
        Self::ALL.iter().copied().find(|verb| *verb != Self::None && Name10::clipped(verb.text()) == word)
    }

    /// Which fields the command must have; an object that is moved must be somewhere.
    const fn needs(self, handles_object: bool) -> Needs {
        let (object, source, destination) = match self {
            Self::None
            | Self::Pause
            | Self::Startup
            | Self::Shutdown
            | Self::Position
            | Self::InsertTool
            | Self::ReleaseTool
            | Self::RemoveTool => (false, false, false),
            Self::Transfer | Self::Refixture => (true, true, true),
            Self::Move => (false, handles_object, true),
            Self::Acquire => (true, true, false),
            Self::AcquireTool => (true, false, true),
        };
        Needs { object, source, destination }
    }

    /// True if the fields of the command mean nothing.
    const fn is_bare(self) -> bool {
        matches!(self, Self::None | Self::Pause | Self::Startup | Self::Shutdown)
    }

    /// True for the four tool commands.
    const fn is_for_tools(self) -> bool {
        matches!(self, Self::InsertTool | Self::ReleaseTool | Self::AcquireTool | Self::RemoveTool)
    }

    /// True if the object is carried from the source to the destination.
    const fn carries(self) -> bool {
        matches!(self, Self::Transfer | Self::Move | Self::Refixture)
    }
}

impl Plan {
    /// Look a command up.
    ///
    /// # Errors
    /// The [`Reason`] why it cannot be executed.
    pub fn new(command: &HwsCommand, data: &TaskData<'_>) -> Result<Self, Reason> {
        let verb = TaskVerb::of(&command.command).ok_or(Reason::UnknownCommand)?;
        let mut plan = Self { verb, ..Self::default() };
        if verb.is_bare() {
            return Ok(plan);
        }
        (plan.object, plan.serial) = (command.object, command.serial);
        let handles_object = !command.object.is_empty();
        if handles_object && data.object_named(&command.object).is_none() {
            return Err(Reason::UnknownObject);
        }
        let gripper = data.obj_grips(&command.object).map_or(0, |grips| grips.endeff_id);
        plan.end_effector_id = u8::try_from(gripper).map_err(|_| Reason::WrongGripper)?;
        if verb.is_for_tools() && !handles_object {
            plan.end_effector_id = TOOL_GRIPPER;
        }

        let [source, destination, end_at] = &mut plan.poses;
        plan.source =
            Site::new(command, &command.source, command.source_sector, command.source_grip, data, source)?;
        plan.destination = Site::new(
            command,
            &command.destination,
            command.destination_sector,
            command.destination_grip,
            data,
            destination,
        )?;
        plan.end_at = Site::new(command, &command.end_at, command.end_at_sector, 0, data, end_at)?;
        plan.concerns_mbd = handles_object
            && matches!(verb, TaskVerb::Transfer | TaskVerb::Move)
            && (plan.source.is_in_mbd(data) || plan.destination.is_in_mbd(data));
        plan.check(verb.needs(handles_object), data)
    }

    /// All that the command needs is there.
    fn check(self, needs: Needs, data: &TaskData<'_>) -> Result<Self, Reason> {
        let handles_object = !self.object.is_empty();
        if needs.object && !handles_object {
            return Err(Reason::NoObjectNamed);
        }
        for (needed, site) in [(needs.source, &self.source), (needs.destination, &self.destination)] {
            if needed && site.location.is_empty() {
                return Err(Reason::NoDestination);
            }
            if needed && handles_object && site.parameters == 0 && !self.verb.is_for_tools() {
                return Err(Reason::UnknownGrip);
            }
        }
        if self.verb == TaskVerb::Position {
            self.check_position()?;
        }
        if self.verb.is_for_tools() && handles_object {
            if self.end_effector_id != TOOL_GRIPPER {
                return Err(Reason::WrongGripper);
            }
            if self.tool_grip().1 == 0 {
                return Err(Reason::UnknownGrip);
            }
        }
        let regrip = handles_object && self.verb.carries() && self.source.grip != self.destination.grip;
        if regrip && data.ped_para(&self.object).is_none() {
            return Err(Reason::NoPedestalData);
        }
        Ok(self)
    }

    fn check_position(&self) -> Result<(), Reason> {
        let site = self.position_site();
        if site.location.is_empty() {
            Err(Reason::NoDestination)
        } else if !self.object.is_empty() && site.parameters == 0 {
            Err(Reason::UnknownGrip)
        } else {
            Ok(())
        }
    }

    /// Where POSITION goes: the source location, an object where it is; the destination if the source is null
    /// (SPECNOTES.md, contradiction 24).
    #[must_use]
    pub const fn position_site(&self) -> Site {
        if self.source.record == 0 && self.source.array == 0 { self.destination } else { self.source }
    }

    /// The grip of a tool command's tool, and its record of END-EFF-PARA: those of the source if it has one,
    /// else those of the destination.
    #[must_use]
    pub const fn tool_grip(&self) -> (i32, u32) {
        let site = if self.source.parameters == 0 { &self.destination } else { &self.source };
        (site.grip, site.parameters)
    }
}

impl Site {
    /// Look a location up; an empty name gives a site without one. The pose goes to `pose`.
    fn new(
        command: &HwsCommand,
        name: &Name16,
        sector: i32,
        grip: i32,
        data: &TaskData<'_>,
        pose: &mut Pose,
    ) -> Result<Self, Reason> {
        let parameters = data.object(&command.object, grip).map_or(0, |(id, _)| id.number());
        if name.is_empty() {
            return Ok(Self { grip, parameters, ..Self::default() });
        }
        let object = if command.object.is_empty() { None } else { Some(&command.object) };
        let location = data.resolve_location(name, sector, object).map_err(|e| reason_of(&e))?;
        *pose = Pose::from_frame(&location.frame);
        Ok(Self {
            location: location.name,
            kind: location.place.kind,
            record: location.place.locpt.number(),
            array: location.place.array.number(),
            sector: location.sector,
            pose: 0,
            grip,
            parameters,
        })
    }

    /// True if the location is one of the MBD's.
    fn is_in_mbd(&self, data: &TaskData<'_>) -> bool {
        let owner = data.owner_named(&Name10::clipped(named::MBD));
        let point = crate::places::place_of(self.kind, self.record, self.array).locpt;
        owner.is_some_and(|owner| !point.is_null() && data.is_member(owner, Reference::location_point(point)))
    }
}
