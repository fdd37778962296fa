//! A command of the workstation controller with its names looked up (V.4.2): TRANSLATE-HWS-CMD of Figure IV.1.

use rcs_core::{
    coded_enum,
    interface::{HwsCommand, Reason, subtask::LocationKind},
    name::{Name10, Name16},
    pose::Pose,
    record,
};
use taskdata::files::TaskData;

use super::verb_of;
use crate::places::reason_of;

coded_enum! {
    /// Commands of Task (V.4.1), as far as the linkbar needs them.
    pub enum TaskVerb {
        /// None yet.
        None = "",
        /// Do nothing.
        Pause = "PAUSE",
        /// Move an object from one location to another.
        Transfer = "TRANSFER",
        /// Move an object to a location and hold it there, or move the robot.
        Move = "MOVE",
        /// Release what is held and move to a position.
        Position = "POSITION",
        /// Move to an object and grasp it.
        Acquire = "ACQUIRE",
    }
}

record! {
    /// One of the three locations of a command.
    pub struct Site {
        /// Name; empty if the command does not name the location.
        pub location: Name10,
        /// Its type.
        pub kind: LocationKind,
        /// Record of LOCPT.
        pub record: u32,
        /// Record of ARRAY-TABLE.
        pub array: u32,
        /// Record number of its T-POSE.
        pub pose: u32,
        /// Grip of the object there.
        pub grip: i32,
        /// Record of END-EFF-PARA for the object with that grip.
        pub parameters: u32,
    }
}

record! {
    /// A command, looked up.
    pub struct Plan {
        /// What to do.
        pub verb: TaskVerb,
        /// The object; empty for none.
        pub object: Name16,
        /// Gripper for the object; 0 if any will do.
        pub end_effector_id: u8,
        /// Where the object is.
        pub source: Site,
        /// Where it, or the robot, is to go.
        pub destination: Site,
        /// Where the robot is to be at the end.
        pub end_at: Site,
        /// Poses of the three sites.
        pub poses: [Pose; 3],
    }
}

/// Which fields a command must have.
struct Needs {
    object: bool,
    source: bool,
    destination: bool,
}

impl TaskVerb {
    /// Which fields the command must have; an object that is moved must be somewhere.
    const fn needs(self, handles_object: bool) -> Needs {
        match self {
            Self::None | Self::Pause | Self::Position => {
                Needs { object: false, source: false, destination: false }
            }
            Self::Transfer => Needs { object: true, source: true, destination: true },
            Self::Move => Needs { object: false, source: handles_object, destination: true },
            Self::Acquire => Needs { object: true, source: true, destination: false },
        }
    }
}

impl Plan {
    /// Look a command up.
    ///
    /// # Errors
    /// The [`Reason`] why it cannot be executed.
    pub fn new(command: &HwsCommand, data: &TaskData<'_>) -> Result<Self, Reason> {
        let verb = verb_of(command)?;
        let mut plan = Self { verb, object: command.object, ..Self::default() };
        if verb == TaskVerb::Pause {
            return Ok(plan);
        }
        let handles_object = !command.object.is_empty();
        if handles_object && data.object_named(&command.object).is_none() {
            return Err(Reason::UnknownObject);
        }
        let gripper = data.obj_grips(&command.object).map_or(0, |grips| grips.endeff_id);
        plan.end_effector_id = u8::try_from(gripper).map_err(|_| Reason::WrongGripper)?;

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
        plan.check(verb.needs(handles_object))
    }

    /// All that the command needs is there.
    fn check(self, needs: Needs) -> Result<Self, Reason> {
        let handles_object = !self.object.is_empty();
        if needs.object && !handles_object {
            return Err(Reason::NoObjectNamed);
        }
        for (needed, site) in [(needs.source, &self.source), (needs.destination, &self.destination)] {
            if needed && site.location.is_empty() {
                return Err(Reason::NoDestination);
            }
            if needed && handles_object && site.parameters == 0 {
                return Err(Reason::UnknownGrip);
            }
        }
        if self.verb == TaskVerb::Position {
            let site = self.position_site();
            if site.location.is_empty() {
                return Err(Reason::NoDestination);
            }
            if handles_object && site.parameters == 0 {
                return Err(Reason::UnknownGrip);
            }
        }
        Ok(self)
    }

    /// Where POSITION goes: the source location, an object where it is; the destination if the source is null (contradiction 24).
    #[must_use]
    pub const fn position_site(&self) -> Site {
        if self.source.record == 0 && self.source.array == 0 { self.destination } else { self.source }
    }
}

impl Site {
    /// Look a location up; an empty name gives an empty site. The pose goes to `pose`.
    fn new(
        command: &HwsCommand,
        name: &Name16,
        sector: i32,
        grip: i32,
        data: &TaskData<'_>,
        pose: &mut Pose,
    ) -> Result<Self, Reason> {
        if name.is_empty() {
            return Ok(Self { grip, ..Self::default() });
        }
        let object = if command.object.is_empty() { None } else { Some(&command.object) };
        let location = data.resolve_location(name, sector, object).map_err(|e| reason_of(&e))?;
        *pose = Pose::from_frame(&location.frame);
        Ok(Self {
            location: location.name,
            kind: location.place.kind,
            record: location.place.locpt.number(),
            array: location.place.array.number(),
            pose: 0,
            grip,
            parameters: data.object(&command.object, grip).map_or(0, |(id, _)| id.number()),
        })
    }
}
